/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Triple injected simultaneous conversion (RM0090 section 13.9.1), started by TIM1 near the top of
 * its count:
 *
 *     ADC1: current a, bus voltage        ADC2: current b, winding temperature
 *     ADC3: current c, switch temperature
 *
 * On a board with two shunts ADC2 has current c, and b is minus their sum.
 *
 * 21 MHz: 15 cycles of sampling, 12 of conversion each (DERIVATIONS, Sampling time). The interrupt
 * comes 2.6 us after the trigger.
 *
 * The two pedal inputs are regular conversions of ADC1 and ADC2, one a millisecond, started by
 * software; an injected sequence interrupts and restarts them (section 13.3.9). The board has none
 * for a brake pedal.
 */
#include "hal/analog.h"

#include "analog_start.h"
#include "board.h"
#include "current_code.h"
#include "hal/upcall.h"
#include "interrupts.h"
#define COLD __attribute__((cold)) /* optimised for size */
#include "registers/adc.h"
#include "registers/rcc.h"
#include "rotor_sensor_sample.h"
#include "vectors.h"

enum {
    MULTI_TRIPLE_INJECTED_SIMULTANEOUS = 0x15,
    PRESCALER_BY_4 = 1,      /* 84 MHz / 4 */
    SAMPLE_84_CYCLES = 4,    /* pedals: 4 us behind a divider */
    SAMPLE_15_CYCLES = 1,    /* code of the sampling time; 3 cycles, code 0, are too short */
    TRIGGER_TIM1_TRGO = 1,   /* JEXTSEL */
    TRIGGER_RISING_EDGE = 1, /* JEXTEN */
    TWO_CONVERSIONS = 1,     /* JL: takes JSQ3 and JSQ4, results in JDR1 and JDR2 */
    INVERTED = BOARD_CURRENT_INVERTED != 0,
    TWO_CURRENTS = BOARD_CURRENT_CHANNELS == 2,
    /* What ADC2 and ADC3 convert together with current a. */
    CHANNEL_OF_SECOND = TWO_CURRENTS ? BOARD_CHANNEL_CURRENT_C : BOARD_CHANNEL_CURRENT_B,
    CHANNEL_OF_THIRD = TWO_CURRENTS ? BOARD_CHANNEL_SWITCH_TEMPERATURE : BOARD_CHANNEL_CURRENT_C
};

/* 13.13.4, 13.13.5: SMPR1 has the channels from 10 on. */
COLD static void set_sampling_time(adc_registers_t *adc, uint32_t channel, uint32_t code)
{
    if (channel >= 10) {
        adc->SMPR1 |= code << 3U * (channel - 10U);
    } else {
        adc->SMPR2 |= code << 3U * channel;
    }
}

COLD static void configure(adc_registers_t *adc, uint32_t first_channel, uint32_t second_channel)
{
    adc->CR1 = ADC_CR1_SCAN;
    adc->SMPR1 = 0;
    adc->SMPR2 = 0;
    set_sampling_time(adc, BOARD_CHANNEL_ACCELERATOR_A, SAMPLE_84_CYCLES);
    set_sampling_time(adc, BOARD_CHANNEL_ACCELERATOR_B, SAMPLE_84_CYCLES);
    set_sampling_time(adc, first_channel, SAMPLE_15_CYCLES);
    set_sampling_time(adc, second_channel, SAMPLE_15_CYCLES);
    adc->JSQR = ((uint32_t)TWO_CONVERSIONS << ADC_JSQR_JL_Pos) |
                (first_channel << ADC_JSQR_JSQ3_Pos) | (second_channel << ADC_JSQR_JSQ4_Pos);
    adc->CR2 = ADC_CR2_ADON;
}

COLD bool analog_init(void)
{
    gpio_make_analog(BOARD_CURRENT_A);
    if (pin_is_wired(BOARD_CURRENT_B)) {
        gpio_make_analog(BOARD_CURRENT_B);
    }
    gpio_make_analog(BOARD_CURRENT_C);
    gpio_make_analog(BOARD_BUS_VOLTAGE);
    gpio_make_analog(BOARD_WINDING_TEMPERATURE);
    gpio_make_analog(BOARD_SWITCH_TEMPERATURE);
    gpio_make_analog(BOARD_ACCELERATOR_A);
    gpio_make_analog(BOARD_ACCELERATOR_B);
    RCC->APB2ENR |= RCC_APB2ENR_ADC1EN | RCC_APB2ENR_ADC2EN | RCC_APB2ENR_ADC3EN;
    (void)RCC->APB2ENR;
    ADC_COMMON->CCR = ((uint32_t)MULTI_TRIPLE_INJECTED_SIMULTANEOUS << ADC_COMMON_CCR_MULTI_Pos) |
                      ((uint32_t)PRESCALER_BY_4 << ADC_COMMON_CCR_ADCPRE_Pos);
    configure(ADC1, BOARD_CHANNEL_CURRENT_A, BOARD_CHANNEL_BUS_VOLTAGE);
    configure(ADC2, CHANNEL_OF_SECOND, BOARD_CHANNEL_WINDING_TEMPERATURE);
    configure(ADC3, CHANNEL_OF_THIRD, BOARD_CHANNEL_SWITCH_TEMPERATURE);
    ADC1->SQR3 = (uint32_t)BOARD_CHANNEL_ACCELERATOR_A << ADC_SQR3_SQ1_Pos;
    ADC2->SQR3 = (uint32_t)BOARD_CHANNEL_ACCELERATOR_B << ADC_SQR3_SQ1_Pos;
    /* The converters need 3 us from ADON to the first start (data sheet t_STAB): what they convert
     * before that is only looked at after analog_start(), much later. */
    ADC1->CR2 |= ((uint32_t)TRIGGER_TIM1_TRGO << ADC_CR2_JEXTSEL_Pos) |
                 ((uint32_t)TRIGGER_RISING_EDGE << ADC_CR2_JEXTEN_Pos);
    return (ADC1->CR2 & ADC2->CR2 & ADC3->CR2 & ADC_CR2_ADON) != 0;
}

void analog_start(void)
{
    ADC1->SR = 0; /* the first interrupt belongs to a whole period */
    ADC1->CR1 |= ADC_CR1_JEOCIE;
    interrupts_enable(INTERRUPT_ADC, PRIORITY_PWM_PERIOD);
}

void adc_handler(void)
{
    ADC1->SR = ~(uint32_t)(ADC_SR_JEOC |
                           ADC_SR_JSTRT); /* flags are cleared by writing 0, the others are left */
    rotor_sensor_sample();
    app_pwm_period_isr();
}

void analog_read(analog_sample_t *sample)
{
    sample->phase_current_code[0] = current_code(ADC1->JDR1, INVERTED);
    if (TWO_CURRENTS) {
        sample->phase_current_code[2] = current_code(ADC2->JDR1, INVERTED);
        sample->phase_current_code[1] =
            current_code_third(sample->phase_current_code[0], sample->phase_current_code[2]);
    } else {
        sample->phase_current_code[1] = current_code(ADC2->JDR1, INVERTED);
        sample->phase_current_code[2] = current_code(ADC3->JDR1, INVERTED);
    }
    sample->bus_voltage_code = (uint16_t)ADC1->JDR2;
}

analog_scale_t analog_scale(void)
{
    const analog_scale_t scale = {.current_full_scale_mA = BOARD_CURRENT_FULL_SCALE_mA,
                                  .voltage_full_scale_mV = BOARD_VOLTAGE_FULL_SCALE_mV,
                                  .low_side_least_ns =
                                      BOARD_SHUNTS == BOARD_SHUNTS_LOW_SIDE
                                          ? BOARD_AMPLIFIER_SETTLING_ns + ANALOG_SAMPLING_ns
                                          : 0,
                                  .switch_25C_code = BOARD_SWITCH_25C_code};
    return scale;
}

int32_t analog_winding_temperature_cC(const analog_curve_t *curve)
{
    return analog_curve_cC(curve, (int32_t)ADC2->JDR2);
}

int32_t analog_switch_temperature_cC(const analog_curve_t *curve)
{
    return analog_curve_cC(curve, (int32_t)ADC3->JDR2);
}

/* Takes the conversions started a millisecond ago; reading clears their flags. */
COLD bool analog_pedals(uint16_t code[ANALOG_PEDAL_CHANNELS])
{
    const bool converted = (ADC1->SR & ADC2->SR & ADC_SR_EOC) != 0;
    if (converted) {
        code[0] = (uint16_t)ADC1->DR;
        code[1] = (uint16_t)ADC2->DR;
        code[2] = 0;
        code[3] = 0;
    }
    ADC1->CR2 |= ADC_CR2_SWSTART;
    ADC2->CR2 |= ADC_CR2_SWSTART;
    return converted;
}
