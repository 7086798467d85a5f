/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Dual injected simultaneous conversion (RM0440 section 21.4.31), started by TIM1 near the top of
 * its count:
 *
 *     ADC1: current a, bus voltage, switch temperature, accelerator        ADC2: current b
 *
 * There are two converters, so current c is minus the sum of the other two. All are injected: with
 * regular conversions beside them the chip's errata would matter. The interrupt comes 3.9 us after
 * the trigger (README, Sampling).
 */
#include "hal/analog.h"

#include "analog_start.h"
#include "board.h"
#include "current_code.h"
#include "hal/upcall.h"
#include "interrupts.h"
#include "registers/adc.h"
#include "registers/opamp.h"
#include "registers/rcc.h"
#include "rotor_sensor_sample.h"
#include "vectors.h"
#include "wait.h"

enum {
    DUAL_INJECTED_SIMULTANEOUS = 5,
    CLOCK_CORE_BY_4 = 3,        /* CKMODE: 42.5 MHz, in step with the timer */
    SAMPLE_12_CYCLES = 2,       /* and a half: currents, 0.29 us */
    SAMPLE_24_CYCLES = 3,       /* and a half: temperature and accelerator, 0.58 us */
    SAMPLE_47_CYCLES = 4,       /* and a half: bus voltage behind 16.3 kOhm, 1.12 us */
    TRIGGER_TIM1_TRGO = 0,      /* JEXTSEL */
    TRIGGER_RISING_EDGE = 1,    /* JEXTEN */
    INPUT_OF_PIN = 0,           /* VP_SEL: VINP0 */
    GAIN_INSIDE = 2,            /* VM_SEL: the amplifier's own divider */
    GAIN_16_BIAS_AT_VINM0 = 11, /* PGA_GAIN */
    POLLS_REGULATOR = 1500,     /* 30 us at least; the data sheet says 20 */
    POLLS_CALIBRATION = 20000,  /* 116 cycles: 3 us */
    POLLS_AMPLIFIER = 500       /* 10 us at least; the data sheet says 3 .. 6 us to wake up */
};

static void start_amplifier(volatile uint32_t *control, pin_t in, pin_t bias, pin_t out)
{
    gpio_make_analog(in);
    gpio_make_analog(bias);
    gpio_make_analog(out);
    const uint32_t setting = (uint32_t)INPUT_OF_PIN << OPAMP_OPAMP1_CSR_VP_SEL_Pos |
                             (uint32_t)GAIN_INSIDE << OPAMP_OPAMP1_CSR_VM_SEL_Pos |
                             (uint32_t)GAIN_16_BIAS_AT_VINM0 << OPAMP_OPAMP1_CSR_PGA_GAIN_Pos |
                             OPAMP_OPAMP1_CSR_OPAHSM;
    *control = setting;
    *control = setting | OPAMP_OPAMP1_CSR_OPAEN;
}

static void set_sampling_time(adc_registers_t *adc, uint32_t channel, uint32_t code)
{
    if (channel >= 10) {
        adc->SMPR2 |= code << 3U * (channel - 10U);
    } else {
        adc->SMPR1 |= code << 3U * channel;
    }
}

/* Out of deep power-down, calibrated, on (21.4.6, 21.4.8, 21.4.9). The pauses are polls of a
 * register that do not end by what they read. */
static bool switch_on(adc_registers_t *adc)
{
    adc->CR = 0;
    adc->CR = ADC_CR_ADVREGEN;
    (void)wait_for(&adc->CR, 0, 1, POLLS_REGULATOR);
    adc->CR = ADC_CR_ADVREGEN | ADC_CR_ADCAL;
    if (!wait_for(&adc->CR, ADC_CR_ADCAL, 0, POLLS_CALIBRATION)) {
        return false;
    }
    (void)wait_for(&adc->CR, 0, 1, POLLS_AMPLIFIER); /* four cycles after the calibration */
    adc->ISR = ADC_ISR_ADRDY;
    adc->CR = ADC_CR_ADVREGEN | ADC_CR_ADEN;
    return wait_for(&adc->ISR, ADC_ISR_ADRDY, ADC_ISR_ADRDY, POLLS_CALIBRATION);
}

bool analog_init(void)
{
    RCC->APB2ENR |= RCC_APB2ENR_SYSCFGEN; /* the amplifiers' clock */
    RCC->AHB2ENR |= RCC_AHB2ENR_ADC12EN;
    (void)RCC->AHB2ENR;
    start_amplifier(&OPAMP->OPAMP1_CSR, BOARD_CURRENT_A_IN, BOARD_CURRENT_A_BIAS,
                    BOARD_CURRENT_A_OUT);
    start_amplifier(&OPAMP->OPAMP2_CSR, BOARD_CURRENT_B_IN, BOARD_CURRENT_B_BIAS,
                    BOARD_CURRENT_B_OUT);
    gpio_make_analog(BOARD_BUS_VOLTAGE);
    gpio_make_analog(BOARD_SWITCH_TEMPERATURE);
    gpio_make_analog(BOARD_ACCELERATOR_A);
    ADC12_COMMON->CCR = (uint32_t)DUAL_INJECTED_SIMULTANEOUS << ADC12_COMMON_CCR_DUAL_Pos |
                        (uint32_t)CLOCK_CORE_BY_4 << ADC12_COMMON_CCR_CKMODE_Pos;
    if (!switch_on(ADC1) || !switch_on(ADC2)) {
        return false;
    }
    set_sampling_time(ADC1, BOARD_CHANNEL_CURRENT_A, SAMPLE_12_CYCLES);
    set_sampling_time(ADC1, BOARD_CHANNEL_BUS_VOLTAGE, SAMPLE_47_CYCLES);
    set_sampling_time(ADC1, BOARD_CHANNEL_SWITCH_TEMPERATURE, SAMPLE_24_CYCLES);
    set_sampling_time(ADC1, BOARD_CHANNEL_ACCELERATOR_A, SAMPLE_24_CYCLES);
    set_sampling_time(ADC2, BOARD_CHANNEL_CURRENT_B, SAMPLE_12_CYCLES);
    ADC1->CFGR = ADC_CFGR_JQDIS;
    ADC2->CFGR = ADC_CFGR_JQDIS;
    ADC1->JSQR = (uint32_t)(4 - 1) << ADC_JSQR_JL_Pos |
                 (uint32_t)TRIGGER_TIM1_TRGO << ADC_JSQR_JEXTSEL_Pos |
                 (uint32_t)TRIGGER_RISING_EDGE << ADC_JSQR_JEXTEN_Pos |
                 (uint32_t)BOARD_CHANNEL_CURRENT_A << ADC_JSQR_JSQ1_Pos |
                 (uint32_t)BOARD_CHANNEL_BUS_VOLTAGE << ADC_JSQR_JSQ2_Pos |
                 (uint32_t)BOARD_CHANNEL_SWITCH_TEMPERATURE << ADC_JSQR_JSQ3_Pos |
                 (uint32_t)BOARD_CHANNEL_ACCELERATOR_A << ADC_JSQR_JSQ4_Pos;
    /* The second converter starts with the first, whatever its own trigger is. */
    ADC2->JSQR = (uint32_t)BOARD_CHANNEL_CURRENT_B << ADC_JSQR_JSQ1_Pos;
    ADC1->CR |= ADC_CR_JADSTART; /* from here on a trigger converts */
    return true;
}

void analog_start(void)
{
    ADC1->ISR = ADC_ISR_JEOC | ADC_ISR_JEOS; /* the first interrupt belongs to a whole period */
    ADC1->IER = ADC_IER_JEOSIE;
    interrupts_enable(INTERRUPT_ADC, PRIORITY_PWM_PERIOD);
}

void adc_handler(void)
{
    ADC1->ISR = ADC_ISR_JEOC | ADC_ISR_JEOS; /* cleared by writing 1 */
    rotor_sensor_sample();
    app_pwm_period_isr();
}

void analog_read(analog_sample_t *sample)
{
    const bool inverted = BOARD_CURRENT_INVERTED != 0;
    const uint16_t a = current_code_about(ADC1->JDR1, BOARD_CURRENT_ZERO_CODE, inverted);
    const uint16_t b = current_code_about(ADC2->JDR1, BOARD_CURRENT_ZERO_CODE, inverted);
    sample->phase_current_code[0] = a;
    sample->phase_current_code[1] = b;
    sample->phase_current_code[2] = current_code_third(a, b);
    sample->bus_voltage_code = (uint16_t)ADC1->JDR2;
}

analog_scale_t analog_scale(void)
{
    const analog_scale_t scale = {.current_full_scale_mA = BOARD_CURRENT_FULL_SCALE_mA,
                                  .voltage_full_scale_mV = BOARD_VOLTAGE_FULL_SCALE_mV,
                                  .low_side_least_ns =
                                      BOARD_AMPLIFIER_SETTLING_ns + ANALOG_SAMPLING_ns,
                                  .switch_25C_code = BOARD_SWITCH_25C_code};
    return scale;
}

/* The board has no input for one: the firmware estimates it. */
int32_t analog_winding_temperature_cC(const analog_curve_t *curve)
{
    (void)curve;
    return ANALOG_TEMPERATURE_BROKEN_cC;
}

int32_t analog_switch_temperature_cC(const analog_curve_t *curve)
{
    return analog_curve_cC(curve, (int32_t)ADC1->JDR3);
}

/* Converted in every period. */
bool analog_pedals(uint16_t code[ANALOG_PEDAL_CHANNELS])
{
    code[0] = (uint16_t)ADC1->JDR4;
    code[1] = 0;
    code[2] = 0;
    code[3] = 0;
    return true;
}
