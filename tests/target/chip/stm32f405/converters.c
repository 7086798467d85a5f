/* SPDX-License-Identifier: Apache-2.0 */
/* Three converters: triple injected simultaneous mode (RM0090 section 13.9.1), regular conversions
 * of one channel by software. */
#include "parts.h"

enum {
    TRIPLE_INJECTED = 0x15,
    TIM1_TRGO = 1,
    RISING_EDGE = 1,
    CONVERSION_CYCLES = 12,
    LATENCY_CYCLES = 3, /* of an injected trigger (data sheet, table 67) */
    FASTEST_TICKS = 10, /* 36 MHz at most (data sheet, table 67): 336 / 36 = 9.3 */
    CODE_MOST = 4095
};
static const uint32_t STATUS[3] = {CHIP_ADC1_SR, CHIP_ADC2_SR, CHIP_ADC3_SR};

/* Registers of the other converters, at the same offsets as ADC1's. */
static uint32_t of(uint32_t converter, uint32_t address_of_first)
{
    return address_of_first - CHIP_ADC1_SR + STATUS[converter];
}

static uint32_t clock_ticks(chip_t *chip)
{
    const uint32_t divider = 2U * (chip_field(chip, CHIP_C_ADC_CCR, CHIP_C_ADC_CCR_ADCPRE) + 1U);
    const uint32_t ticks = chip_bus_ticks(chip, CHIP_RCC_CFGR_PPRE2) * divider;
    if (ticks < FASTEST_TICKS) {
        chip_note(chip, "converters at %u MHz", 336U / ticks);
    }
    return ticks;
}

/* Data sheet, equation 1: for a quarter of a code a source may have so much; an amplifier behind a
 * filter has 1 kOhm at most. R_ADC 6 kOhm, C_ADC 4 pF; ln 2^14 = 9.704. */
static void check_sampling_time(chip_t *chip, uint32_t converter, uint32_t cycles)
{
    const double seconds = (cycles - 0.5) * clock_ticks(chip) / (double)CHIP_TICKS_PER_SECOND;
    if (seconds / (4e-12 * 9.704) - 6e3 < 1e3) {
        chip_note(chip, "ADC%u: %u cycles of sampling are too few", converter + 1U, cycles);
    }
}

static uint32_t sampling_cycles(const chip_t *chip, uint32_t converter, uint32_t channel)
{
    static const uint16_t CYCLES[8] = {3, 15, 28, 56, 84, 112, 144, 480};
    const uint32_t at = of(converter, channel < 10 ? CHIP_ADC1_SMPR2 : CHIP_ADC1_SMPR1);
    return CYCLES[chip_get(chip, at) >> 3U * (channel % 10U) & 7U];
}

/* Pins of the inputs that the converters have in common, and of ADC12_IN4 to 9, 14 and 15, whose
 * numbers are pins of port F at ADC3 (data sheet, table 7). */
static bool input_is_analog(const chip_t *chip, uint32_t converter, uint32_t channel)
{
    if (converter == 2 && ((channel >= 4 && channel <= 9) || channel >= 14)) {
        return false;
    }
    if (channel < 8) {
        return chip_pin_is_analog(chip, 'A', channel);
    }
    return channel < 10 ? chip_pin_is_analog(chip, 'B', channel - 8U)
                        : chip_pin_is_analog(chip, 'C', channel - 10U);
}

static uint32_t convert(chip_t *chip, uint32_t converter, uint32_t channel)
{
    if (channel >= CHIP_ANALOG_CHANNELS) {
        chip_note(chip, "ADC%u: channel %u", converter + 1U, channel);
        return 0;
    }
    if (!input_is_analog(chip, converter, channel)) {
        chip_note(chip, "ADC%u: the pin of channel %u is not analogue", converter + 1U, channel);
        return 0;
    }
    const uint32_t code = chip->in.analog_code[channel];
    return code > CODE_MOST ? CODE_MOST : code;
}

void chip_adc_reset(chip_t *chip)
{
    const chip_converters_t fresh = {.injected_end = CHIP_NEVER,
                                     .regular_end = {CHIP_NEVER, CHIP_NEVER}};
    chip->adc = fresh;
}

bool chip_adc_listens(const chip_t *chip)
{
    const uint32_t control = chip_get(chip, CHIP_ADC1_CR2);
    return (control & CHIP_ADC1_CR2_ADON) != 0 &&
           chip_field(chip, CHIP_ADC1_CR2, CHIP_ADC1_CR2_JEXTSEL) == TIM1_TRGO &&
           chip_field(chip, CHIP_ADC1_CR2, CHIP_ADC1_CR2_JEXTEN) == RISING_EDGE;
}

static bool takes_part(chip_t *chip, uint32_t converter)
{
    const bool triple = chip_field(chip, CHIP_C_ADC_CCR, CHIP_C_ADC_CCR_MULT) == TRIPLE_INJECTED;
    const bool on = (chip_get(chip, of(converter, CHIP_ADC1_CR2)) & CHIP_ADC1_CR2_ADON) != 0;
    return on && (converter == 0 || triple);
}

/* 13.13.12: a sequence of n takes the last n of JSQ1 to JSQ4 and puts the results in JDR1 to n. */
static chip_ticks_t inject(chip_t *chip, uint32_t converter)
{
    const uint32_t sequence = chip_get(chip, of(converter, CHIP_ADC1_JSQR));
    const uint32_t count = (sequence >> 20 & 3U) + 1U;
    uint32_t cycles = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t channel = sequence >> 5U * (4U - count + i) & 0x1FU;
        const uint32_t sampling = sampling_cycles(chip, converter, channel);
        check_sampling_time(chip, converter, sampling);
        if (i == 0) {
            const int64_t ticks = (int64_t)(LATENCY_CYCLES + sampling) * clock_ticks(chip);
            chip->adc.hold_from_top = chip->adc.trigger_from_top + ticks;
            chip->adc.sampling = (int64_t)sampling * clock_ticks(chip);
        }
        cycles += sampling + CONVERSION_CYCLES;
        *chip_at(chip, of(converter, CHIP_ADC1_JDR1) + 4U * i) = convert(chip, converter, channel);
    }
    if (count > 1 && (chip_get(chip, of(converter, CHIP_ADC1_CR1)) & CHIP_ADC1_CR1_SCAN) == 0) {
        chip_note(chip, "ADC%u: a sequence without SCAN", converter + 1U);
    }
    return chip->now + (chip_ticks_t)(LATENCY_CYCLES + cycles) * clock_ticks(chip);
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
    for (uint32_t i = 0; i < 3; i++) {
        if (takes_part(chip, i)) {
            const chip_ticks_t own = inject(chip, i);
            end = own > end ? own : end;
        }
    }
    chip->adc.injected_end = end;
}

static void start_regular(chip_t *chip, uint32_t converter)
{
    const uint32_t channel = chip_get(chip, of(converter, CHIP_ADC1_SQR3)) & 0x1FU;
    const uint32_t cycles = sampling_cycles(chip, converter, channel) + CONVERSION_CYCLES;
    *chip_at(chip, of(converter, CHIP_ADC1_DR)) = convert(chip, converter, channel);
    chip->adc.regular_end[converter] = chip->now + (chip_ticks_t)cycles * clock_ticks(chip);
}

bool chip_adc_write(chip_t *chip, uint32_t address, uint32_t value)
{
    for (uint32_t i = 0; i < 3; i++) {
        if (address == STATUS[i]) {
            *chip_at(chip, address) &= value; /* cleared by writing 0 */
            return true;
        }
        if (address == of(i, CHIP_ADC1_CR2)) {
            *chip_at(chip, address) = value & ~CHIP_ADC1_CR2_SWSTART;
            const bool on = (value & CHIP_ADC1_CR2_ADON) != 0;
            if ((value & CHIP_ADC1_CR2_SWSTART) != 0 && on && i < 2U) {
                start_regular(chip, i);
            }
            return true;
        }
    }
    return false;
}

uint32_t chip_adc_read(chip_t *chip, uint32_t address)
{
    for (uint32_t i = 0; i < 3; i++) {
        if (address == of(i, CHIP_ADC1_DR)) {
            *chip_at(chip, STATUS[i]) &= ~CHIP_ADC1_SR_EOC; /* cleared by reading the result */
        }
    }
    return chip_get(chip, address);
}

chip_ticks_t chip_adc_next(chip_t *chip)
{
    const chip_converters_t *adc = &chip->adc;
    chip_ticks_t next = adc->injected_end;
    for (int i = 0; i < 2; i++) {
        next = adc->regular_end[i] < next ? adc->regular_end[i] : next;
    }
    return next;
}

void chip_adc_events(chip_t *chip)
{
    chip_converters_t *adc = &chip->adc;
    if (chip->now >= adc->injected_end) {
        adc->injected_end = CHIP_NEVER;
        for (uint32_t i = 0; i < 3; i++) {
            if (takes_part(chip, i)) {
                *chip_at(chip, STATUS[i]) |= CHIP_ADC1_SR_JEOC | CHIP_ADC1_SR_JSTRT;
            }
        }
        chip->needs_attention = true;
    }
    for (uint32_t i = 0; i < 2; i++) {
        if (chip->now >= adc->regular_end[i]) {
            adc->regular_end[i] = CHIP_NEVER;
            *chip_at(chip, STATUS[i]) |= CHIP_ADC1_SR_EOC | CHIP_ADC1_SR_STRT;
        }
    }
}
