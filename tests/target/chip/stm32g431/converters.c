/* SPDX-License-Identifier: Apache-2.0 */
/* Two converters (RM0440 section 21): from deep power-down over regulator and calibration to ready;
 * dual injected simultaneous mode (21.4.31) in the core's own clock. */
#include <math.h>

#include "analog.h"

enum {
    CONVERTERS = 2,
    DUAL_INJECTED = 5,
    CLOCK_CORE_BY_4 = 3,
    TIM1_TRGO = 0,
    RISING_EDGE = 1,
    MOST_MHZ = 60,     /* data sheet, f_ADC in range 1 */
    REGULATOR_us = 20, /* t_ADCVREG_STUP */
    CALIBRATION_CYCLES = 116,
    AFTER_CALIBRATION_CYCLES = 4, /* 21.4.8 */
    STABLE_us = 1,                /* t_STAB */
    CONVERSION_HALVES = 25,       /* 12.5 cycles */
    CODE_MOST = ANALOG_CODES - 1
};
/* Of a cycle, with the core's clock by 4 (data sheet, t_LATR). */
static const double LATENCY_CYCLES = 2.125;
static const uint32_t ISR[CONVERTERS] = {CHIP_ADC1_ISR, CHIP_ADC2_ISR};

/* Registers of the other converter, at the same offsets as ADC1's. */
static uint32_t of(uint32_t converter, uint32_t address_of_first)
{
    return address_of_first - CHIP_ADC1_ISR + ISR[converter];
}

static uint32_t clock_ticks(chip_t *chip)
{
    if (chip_field(chip, CHIP_ADC12_COMMON_CCR, CHIP_ADC12_COMMON_CCR_CKMODE) != CLOCK_CORE_BY_4) {
        chip_note(chip, "converters: a clock that is not modelled");
    }
    const uint32_t ticks = 4U * chip->ticks_per_cycle;
    if (ticks * MOST_MHZ < CHIP_TICKS_PER_US) {
        chip_note(chip, "converters at %u MHz", (unsigned)(CHIP_TICKS_PER_US / ticks));
    }
    return ticks;
}

/* An input: the pin, and what drives it on this board, in Ohm. */
typedef struct {
    uint8_t converter, channel;
    char port;
    uint8_t pin;
    double source_ohm;
} input_t;
static const input_t INPUTS[] = {
    {0, 1, 'A', 0, 16267.0}, /* bus voltage: 169 and 18 kOhm */
    {0, 3, 'A', 2, 100.0},   /* amplifier 1 */
    {0, 5, 'B', 14, 4700.0}, /* switch temperature: at most its resistor to ground */
    {0, 11, 'B', 12, 5000.0} /* potentiometer of at most 20 kOhm */,
    {1, 3, 'A', 6, 100.0} /* amplifier 2 */
};

static const input_t *input_of(uint32_t converter, uint32_t channel)
{
    for (unsigned i = 0; i < sizeof INPUTS / sizeof INPUTS[0]; i++) {
        if (INPUTS[i].converter == converter && INPUTS[i].channel == channel) {
            return &INPUTS[i];
        }
    }
    return NULL;
}

static uint32_t sampling_halves(const chip_t *chip, uint32_t converter, uint32_t channel)
{
    static const uint16_t HALVES[8] = {5, 13, 25, 49, 95, 185, 495, 1281};
    const uint32_t at = of(converter, channel < 10 ? CHIP_ADC1_SMPR1 : CHIP_ADC1_SMPR2);
    return HALVES[chip_get(chip, at) >> 3U * (channel % 10U) & 7U];
}

/* For a quarter of a code: the converter's switch has 1 kOhm, its capacitor 5 pF (data sheet);
 * ln 2^14 = 9.704. */
static uint32_t convert(chip_t *chip, uint32_t converter, uint32_t channel, uint32_t halves)
{
    const input_t *input = input_of(converter, channel);
    if (input == NULL) {
        chip_note(chip, "ADC%u: nothing is at channel %u", converter + 1U, channel);
        return 0;
    }
    if (!chip_pin_is_analog(chip, input->port, input->pin)) {
        chip_note(chip, "ADC%u: the pin of channel %u is not analogue", converter + 1U, channel);
        return 0;
    }
    const double seconds = 0.5 * halves * clock_ticks(chip) / (double)CHIP_TICKS_PER_SECOND;
    if (seconds < (input->source_ohm + 1e3) * 5e-12 * 9.704) {
        chip_note(chip, "ADC%u: %.1f cycles of sampling are too few for channel %u", converter + 1U,
                  0.5 * halves, channel);
    }
    const double code = floor(analog_pin_V(chip, input->port, input->pin) * ANALOG_CODES * 1e6 /
                                  ANALOG_REFERENCE_uV +
                              0.5);
    return code < 0.0 ? 0U : (code > CODE_MOST ? CODE_MOST : (uint32_t)code);
}

void chip_adc_reset(chip_t *chip)
{
    const chip_converters_t fresh = {.injected_end = CHIP_NEVER,
                                     .regular_end = {CHIP_NEVER, CHIP_NEVER},
                                     .regulated = {CHIP_NEVER, CHIP_NEVER},
                                     .calibrated = {CHIP_NEVER, CHIP_NEVER},
                                     .ready = {CHIP_NEVER, CHIP_NEVER}};
    chip->adc = fresh;
}

static bool is_on(const chip_t *chip, uint32_t converter)
{
    return (chip_get(chip, of(converter, CHIP_ADC1_CR)) & CHIP_ADC1_CR_ADEN) != 0 &&
           chip->now >= chip->adc.ready[converter];
}

bool chip_adc_listens(const chip_t *chip)
{
    return is_on(chip, 0) && (chip_get(chip, CHIP_ADC1_CR) & CHIP_ADC1_CR_JADSTART) != 0 &&
           chip_field(chip, CHIP_ADC1_JSQR, CHIP_ADC1_JSQR_JEXTSEL) == TIM1_TRGO &&
           chip_field(chip, CHIP_ADC1_JSQR, CHIP_ADC1_JSQR_JEXTEN) == RISING_EDGE;
}

static bool takes_part(chip_t *chip, uint32_t converter)
{
    return is_on(chip, converter) &&
           (converter == 0 ||
            chip_field(chip, CHIP_ADC12_COMMON_CCR, CHIP_ADC12_COMMON_CCR_DUAL) == DUAL_INJECTED);
}

/* 21.7.16: JSQ1 first, result in JDR1. */
static chip_ticks_t inject(chip_t *chip, uint32_t converter)
{
    static const uint8_t SHIFT[4] = {9, 15, 21, 27};
    const uint32_t sequence = chip_get(chip, of(converter, CHIP_ADC1_JSQR));
    const uint32_t count = (sequence & 3U) + 1U;
    const chip_ticks_t latency = (chip_ticks_t)(LATENCY_CYCLES * clock_ticks(chip));
    uint32_t halves = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t channel = sequence >> SHIFT[i] & 0x1FU;
        const uint32_t sampling = sampling_halves(chip, converter, channel);
        if (i == 0) {
            const int64_t until_hold = (int64_t)(latency + sampling * clock_ticks(chip) / 2U);
            chip->adc.hold_from_top = chip->adc.trigger_from_top + until_hold;
            chip->adc.sampling = (int64_t)(sampling * clock_ticks(chip) / 2U);
        }
        halves += sampling + CONVERSION_HALVES;
        *chip_at(chip, of(converter, CHIP_ADC1_JDR1) + 4U * i) =
            convert(chip, converter, channel, sampling);
    }
    return chip->now + latency + (chip_ticks_t)halves * clock_ticks(chip) / 2U;
}

int64_t chip_hold_from_top_ticks(const chip_t *chip)
{
    return chip->adc.hold_from_top;
}

void chip_adc_inject(chip_t *chip)
{
    if (chip->fault.converter_stuck) {
        return;
    }
    if (chip->adc.injected_end != CHIP_NEVER) {
        chip_note(chip, "a trigger during a conversion");
        return;
    }
    chip_ticks_t end = 0;
    for (uint32_t i = 0; i < CONVERTERS; i++) {
        if (takes_part(chip, i)) {
            const chip_ticks_t own = inject(chip, i);
            end = own > end ? own : end;
        }
    }
    chip->adc.injected_end = end;
}

/* 21.4.6, 21.4.8, 21.4.9: regulator, calibration, enable, start, each after the one before. */
static void write_control(chip_t *chip, uint32_t i, uint32_t value)
{
    chip_converters_t *adc = &chip->adc;
    const uint32_t at = of(i, CHIP_ADC1_CR);
    const uint32_t before = chip_get(chip, at);
    const uint32_t cycle = clock_ticks(chip);
    *chip_at(chip, at) = value;
    if ((value & CHIP_ADC1_CR_DEEPPWD) != 0 || (value & CHIP_ADC1_CR_ADVREGEN) == 0) {
        adc->regulated[i] = CHIP_NEVER;
        adc->ready[i] = CHIP_NEVER;
        return;
    }
    if ((before & CHIP_ADC1_CR_ADVREGEN) == 0) {
        adc->regulated[i] = chip->now + REGULATOR_us * CHIP_TICKS_PER_US;
    }
    if ((value & (CHIP_ADC1_CR_ADCAL | CHIP_ADC1_CR_ADEN)) != 0 && chip->now < adc->regulated[i]) {
        chip_note(chip, "ADC%u: used before its regulator is up", i + 1U);
    }
    if ((value & ~before & CHIP_ADC1_CR_ADCAL) != 0) {
        adc->calibrated[i] = chip->now + (chip_ticks_t)CALIBRATION_CYCLES * cycle;
        if ((before & CHIP_ADC1_CR_ADEN) != 0) {
            chip_note(chip, "ADC%u: calibrated while it is on", i + 1U);
        }
    }
    if ((value & ~before & CHIP_ADC1_CR_ADEN) != 0) {
        const chip_ticks_t after = (chip_ticks_t)AFTER_CALIBRATION_CYCLES * cycle;
        if (adc->calibrated[i] == CHIP_NEVER || chip->now < adc->calibrated[i] + after) {
            chip_note(chip, "ADC%u: switched on before the end of a calibration", i + 1U);
        }
        adc->ready[i] = chip->now + STABLE_us * CHIP_TICKS_PER_US;
    }
    if ((value & CHIP_ADC1_CR_JADSTART) != 0 && chip->now < adc->ready[i]) {
        chip_note(chip, "ADC%u: started before it is ready", i + 1U);
    }
}

bool chip_adc_write(chip_t *chip, uint32_t address, uint32_t value)
{
    for (uint32_t i = 0; i < CONVERTERS; i++) {
        if (address == ISR[i]) {
            *chip_at(chip, address) &= ~value; /* cleared by writing 1 */
            return true;
        }
        if (address == of(i, CHIP_ADC1_CR)) {
            write_control(chip, i, value);
            return true;
        }
    }
    const uint32_t on = chip_get(chip, CHIP_ADC1_CR) | chip_get(chip, CHIP_ADC2_CR);
    if (address == CHIP_ADC12_COMMON_CCR && (on & CHIP_ADC1_CR_ADEN) != 0) {
        chip_note(chip, "ADC: CCR written while a converter is on");
    }
    return false;
}

uint32_t chip_adc_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    for (uint32_t i = 0; i < CONVERTERS; i++) {
        if (address == ISR[i]) {
            return value | (is_on(chip, i) ? CHIP_ADC1_ISR_ADRDY : 0);
        }
        if (address == of(i, CHIP_ADC1_CR) && chip->now >= chip->adc.calibrated[i]) {
            *chip_at(chip, address) = value & ~CHIP_ADC1_CR_ADCAL;
            return value & ~CHIP_ADC1_CR_ADCAL;
        }
    }
    return value;
}

chip_ticks_t chip_adc_next(chip_t *chip)
{
    return chip->adc.injected_end;
}

void chip_adc_events(chip_t *chip)
{
    chip_converters_t *adc = &chip->adc;
    if (chip->now < adc->injected_end) {
        return;
    }
    adc->injected_end = CHIP_NEVER;
    for (uint32_t i = 0; i < CONVERTERS; i++) {
        if (takes_part(chip, i)) {
            *chip_at(chip, ISR[i]) |= CHIP_ADC1_ISR_JEOC | CHIP_ADC1_ISR_JEOS;
        }
    }
    chip->needs_attention = true;
}
