/* SPDX-License-Identifier: Apache-2.0 */
/* TIM1, centre-aligned, as a source of gate signals and triggers (RM0090 section 17, whose numbers
 * are below; RM0440 section 28). */
#include "parts.h"

enum { PWM_1 = 6, PWM_2 = 7, TRGO_UPDATE = 2, TRGO_OC4REF = 7, LEGS = 3 };
static const uint32_t COMPARE[4] = {CHIP_TIM1_CCR1, CHIP_TIM1_CCR2, CHIP_TIM1_CCR3, CHIP_TIM1_CCR4};

uint32_t chip_timer_ticks(const chip_t *chip)
{
    const uint32_t bus = chip_bus_ticks(chip, CHIP_RCC_CFGR_PPRE2);
    return chip_field(chip, CHIP_RCC_CFGR, CHIP_RCC_CFGR_PPRE2) < 4U ? bus : bus / 2U;
}

static uint32_t clock_ticks(const chip_t *chip)
{
    return chip_timer_ticks(chip) * (chip_get(chip, CHIP_TIM1_PSC) + 1U);
}

static uint32_t compare_mode(const chip_t *chip, int channel)
{
    const uint32_t at = channel < 2 ? CHIP_TIM1_CCMR1_OUTPUT : CHIP_TIM1_CCMR2_OUTPUT;
    return chip_get(chip, at) >> ((channel & 1) != 0 ? 12 : 4) & 7U;
}

static bool is_preloaded(const chip_t *chip, int channel)
{
    const uint32_t at = channel < 2 ? CHIP_TIM1_CCMR1_OUTPUT : CHIP_TIM1_CCMR2_OUTPUT;
    return (chip_get(chip, at) >> ((channel & 1) != 0 ? 11 : 3) & 1U) != 0;
}

static void load_active(chip_t *chip)
{
    for (int i = 0; i < 4; i++) {
        chip->timer1.active_compare[i] = chip_get(chip, COMPARE[i]);
    }
    chip->timer1.active_top = chip_get(chip, CHIP_TIM1_ARR);
}

/* 17.3.3: an end of the count is an update when the repetition counter is zero. */
static bool update(chip_t *chip)
{
    chip_timer1_t *timer = &chip->timer1;
    if (timer->repetitions > 0) {
        timer->repetitions--;
        return false;
    }
    timer->repetitions = chip_get(chip, CHIP_TIM1_RCR) & 0xFFU;
    load_active(chip);
    *chip_at(chip, CHIP_TIM1_SR) |= CHIP_TIM1_SR_UIF;
    return true;
}

/* When the trigger output rises in the half of the count that begins now. */
static void expect_trigger(chip_t *chip)
{
    chip_timer1_t *timer = &chip->timer1;
    const uint32_t source = chip_field(chip, CHIP_TIM1_CR2, CHIP_TIM1_CR2_MMS);
    const uint32_t ticks = clock_ticks(chip);
    const uint32_t compare = timer->active_compare[3];
    timer->trigger = CHIP_NEVER;
    if (source != TRGO_OC4REF || compare > timer->active_top) {
        return;
    }
    const uint32_t mode = compare_mode(chip, 3);
    if (mode == PWM_2 && !timer->down) {
        timer->trigger = timer->next_end - (chip_ticks_t)(timer->active_top - compare) * ticks;
    } else if (mode == PWM_1 && timer->down) {
        timer->trigger = timer->next_end - (chip_ticks_t)(compare > 0 ? compare - 1U : 0U) * ticks;
    }
}

static void begin_half(chip_t *chip, chip_ticks_t begin)
{
    chip_timer1_t *timer = &chip->timer1;
    timer->next_end = begin + (chip_ticks_t)timer->active_top * clock_ticks(chip);
    if (timer->next_end <= begin) {
        timer->next_end = begin + CHIP_TICKS_PER_US; /* ARR = 0 blocks the counter */
    }
    expect_trigger(chip);
}

void chip_timer1_reset(chip_t *chip)
{
    const chip_timer1_t fresh = {.next_end = CHIP_NEVER, .trigger = CHIP_NEVER};
    chip->timer1 = fresh;
    load_active(chip);
}

static void start(chip_t *chip)
{
    chip_timer1_t *timer = &chip->timer1;
    if (chip_field(chip, CHIP_TIM1_CR1, CHIP_TIM1_CR1_CMS) == 0) {
        chip_note(chip, "TIM1 started edge-aligned");
        return;
    }
    if (chip->fault.timer_stuck) {
        return;
    }
    timer->runs = true;
    timer->down = false;
    begin_half(chip, chip->now);
}

/* 17.3.12. */
static void watch_break(chip_t *chip)
{
    const uint32_t flags = chip_part_break(chip);
    if (flags != 0) {
        *chip_at(chip, CHIP_TIM1_SR) |= flags;
        *chip_at(chip, CHIP_TIM1_BDTR) &= ~CHIP_TIM1_BDTR_MOE;
    }
}

/* 17.4.18: what the lock level no longer lets be changed. */
static uint32_t unlocked(chip_t *chip, uint32_t value)
{
    static const uint32_t LOCKED = CHIP_TIMER1_LOCKED;
    const uint32_t before = chip_get(chip, CHIP_TIM1_BDTR);
    if ((before & CHIP_TIM1_BDTR_LOCK) == 0) {
        return value;
    }
    if (((before ^ value) & LOCKED) != 0) {
        chip_note(chip, "BDTR: a locked bit written");
    }
    return (before & LOCKED) | (value & ~LOCKED);
}

static void write_compare(chip_t *chip, int channel, uint32_t value)
{
    *chip_at(chip, COMPARE[channel]) = value & 0xFFFFU;
    if (!is_preloaded(chip, channel)) {
        chip->timer1.active_compare[channel] = value & 0xFFFFU;
        if (chip->timer1.runs && channel < LEGS) {
            chip_note(chip, "CCR%d acts at once, without preload", channel + 1);
        }
    }
}

bool chip_timer1_write(chip_t *chip, uint32_t address, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        if (address == COMPARE[i]) {
            write_compare(chip, i, value);
            return true;
        }
    }
    switch (address) {
    case CHIP_TIM1_SR: /* cleared by writing 0 */
        *chip_at(chip, address) &= value;
        watch_break(chip);
        return true;
    case CHIP_TIM1_CR1:
        if (chip->timer1.runs && ((value ^ chip_get(chip, address)) & CHIP_TIM1_CR1_CMS) != 0) {
            chip_note(chip, "CMS changed while TIM1 counts");
        }
        *chip_at(chip, address) = value & ~CHIP_TIM1_CR1_DIR;
        if ((value & CHIP_TIM1_CR1_CEN) != 0 && !chip->timer1.runs) {
            start(chip);
        } else if ((value & CHIP_TIM1_CR1_CEN) == 0) {
            chip->timer1.runs = false;
        }
        return true;
    case CHIP_TIM1_EGR:
        if ((value & CHIP_TIM1_EGR_UG) != 0) {
            chip->timer1.repetitions = 0;
            (void)update(chip);
        }
        return true;
    case CHIP_TIM1_BDTR:
        *chip_at(chip, address) = unlocked(chip, value);
        watch_break(chip);
        return true;
#ifdef CHIP_TIM1_AF2
    case CHIP_TIM1_AF2: /* 28.6.26 */
        if ((chip_get(chip, CHIP_TIM1_BDTR) & CHIP_TIM1_BDTR_LOCK) != 0) {
            chip_note(chip, "AF2 written while it is locked");
            return true;
        }
        return false;
#endif
    case CHIP_TIM1_ARR:
        if ((chip_get(chip, CHIP_TIM1_CR1) & CHIP_TIM1_CR1_ARPE) == 0) {
            chip->timer1.active_top = value & 0xFFFFU;
        }
        return false;
    default:
        return false;
    }
}

uint32_t chip_timer1_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    watch_break(chip);
    switch (address) {
    case CHIP_TIM1_CR1:
        return value | (chip->timer1.down ? CHIP_TIM1_CR1_DIR : 0);
    case CHIP_TIM1_SR:
    case CHIP_TIM1_BDTR:
        return chip_get(chip, address);
    default:
        return value;
    }
}

chip_ticks_t chip_timer1_next(chip_t *chip)
{
    const chip_timer1_t *timer = &chip->timer1;
    if (!timer->runs) {
        return CHIP_NEVER;
    }
    return timer->trigger < timer->next_end ? timer->trigger : timer->next_end;
}

void chip_timer1_events(chip_t *chip)
{
    chip_timer1_t *timer = &chip->timer1;
    watch_break(chip);
    if (timer->runs && chip->now >= timer->trigger) {
        const chip_ticks_t half = (chip_ticks_t)timer->active_top * clock_ticks(chip);
        const chip_ticks_t top = timer->down ? timer->next_end - half : timer->next_end;
        chip->adc.trigger_from_top = (int64_t)(timer->trigger - top);
        timer->trigger = CHIP_NEVER;
        chip->adc.is_triggered = chip_adc_listens(chip);
    }
    while (timer->runs && chip->now >= timer->next_end) {
        const chip_ticks_t end = timer->next_end;
        timer->down = !timer->down;
        const bool updated = update(chip);
        if (updated && chip_field(chip, CHIP_TIM1_CR2, CHIP_TIM1_CR2_MMS) == TRGO_UPDATE) {
            chip->adc.is_triggered = chip_adc_listens(chip);
        }
        begin_half(chip, end);
    }
}

/* ---- gates ---- */

/* Counts of a period of 2 x top in which a channel's reference is active. */
static uint32_t active_counts(const chip_t *chip, int leg)
{
    const uint32_t top = chip->timer1.active_top;
    const uint32_t compare = chip->timer1.active_compare[leg];
    const uint32_t below = compare > top ? top : compare;
    switch (compare_mode(chip, leg)) {
    case PWM_1: /* active below the compare value; equal to the top: off for one count */
        return compare == top ? top - 1U : below;
    case PWM_2:
        return top - below;
    default:
        return UINT32_MAX;
    }
}

/* Table 79 (complementary outputs with break) and the pins: both gates of a leg must be driven, in
 * antiphase and active high. */
static bool leg_is_connected(chip_t *chip, unsigned leg)
{
    const uint32_t enabled = chip_get(chip, CHIP_TIM1_CCER) >> 4U * leg & 0xFU;
    static const chip_pin_t GATES[LEGS][2] = {CHIP_GATE_PINS};
    if (!chip_pin_selects(chip, GATES[leg][0]) || !chip_pin_selects(chip, GATES[leg][1]) ||
        (enabled & 5U) != 5U) {
        chip_note(chip, "leg %u: only some of its gates are driven", leg);
        return false;
    }
    if ((enabled & 0xAU) != 0) {
        chip_note(chip, "leg %u: a gate of reversed polarity", leg);
        return false;
    }
    return true;
}

/* 17.4.18, DTG. */
static uint32_t dead_time_clocks(uint32_t code)
{
    if ((code & 0x80U) == 0) {
        return code;
    }
    if ((code & 0xC0U) == 0x80U) {
        return (64U + (code & 0x3FU)) * 2U;
    }
    return (32U + (code & 0x1FU)) * ((code & 0x20U) == 0 ? 8U : 16U);
}

chip_gates_t chip_gates(chip_t *chip)
{
    chip_gates_t gates = {.bridge = CHIP_BRIDGE_OFF, .top_counts = chip->timer1.active_top};
    watch_break(chip);
    const uint32_t settings = chip_get(chip, CHIP_TIM1_BDTR);
    const bool drives = (settings & CHIP_TIM1_BDTR_MOE) != 0;
    /* Off: with OSSI the idle states, which must not switch anything on. */
    const uint32_t idle = chip_get(chip, CHIP_TIM1_CR2) >> 8 & 0x3FU;
    if (!drives) {
        if (idle != 0 && (settings & CHIP_TIM1_BDTR_OSSI) != 0) {
            chip_note(chip, "a gate is on in the idle state");
            gates.bridge = CHIP_BRIDGE_FORBIDDEN;
        }
        return gates;
    }
    const chip_drivers_t drivers = chip_part_drivers(chip);
    if (drivers == CHIP_DRIVERS_OFF) {
        return gates; /* the gate driver holds all gates low */
    }
    if (drivers == CHIP_DRIVERS_HOLD_A_LEG) {
        chip_note(chip, "the gate driver holds one leg off and the others switch");
        gates.bridge = CHIP_BRIDGE_FORBIDDEN;
        return gates;
    }
    gates.bridge = CHIP_BRIDGE_SWITCHES;
    gates.dead_time_ticks = dead_time_clocks(settings & CHIP_TIM1_BDTR_DTG) * clock_ticks(chip);
    if (!chip->timer1.runs) {
        chip_note(chip, "the outputs are on and TIM1 stands");
        gates.bridge = CHIP_BRIDGE_FORBIDDEN;
    }
    for (unsigned leg = 0; leg < LEGS; leg++) {
        gates.high_on_counts[leg] = active_counts(chip, (int)leg);
        if (!leg_is_connected(chip, leg) || gates.high_on_counts[leg] == UINT32_MAX) {
            gates.bridge = CHIP_BRIDGE_FORBIDDEN;
        }
    }
    return gates;
}

bool chip_timer1_drives(const chip_t *chip)
{
    return chip->timer1.runs && (chip_get(chip, CHIP_TIM1_BDTR) & CHIP_TIM1_BDTR_MOE) != 0;
}

/* About the top of the count, at which compare values are updated: on the way up the active one
 * counts, on the way down the one that is written. Until the switch of the other side is on the
 * diode has a current into the motor; a current out of it waits for the low side's own switch. */
bool chip_low_side_conducts(chip_t *chip, unsigned leg, bool into_motor, int64_t before_ticks)
{
    const chip_timer1_t *timer = &chip->timer1;
    const uint32_t settings = chip_get(chip, CHIP_TIM1_BDTR);
    if ((settings & CHIP_TIM1_BDTR_MOE) == 0 || !timer->runs) {
        return true;
    }
    const int64_t ticks = clock_ticks(chip);
    const int64_t top = timer->active_top;
    const int64_t dead = (int64_t)dead_time_clocks(settings & CHIP_TIM1_BDTR_DTG) * ticks;
    const int64_t low_from = (timer->active_compare[leg] - top) * ticks + (into_motor ? 0 : dead);
    const int64_t low_to =
        (top - (int64_t)chip_get(chip, COMPARE[leg])) * ticks + (into_motor ? dead : 0);
    const int64_t hold = chip_hold_from_top_ticks(chip);
    return hold - chip->adc.sampling - before_ticks >= low_from && hold <= low_to;
}

bool chip_outputs_on(const chip_t *chip)
{
    return (chip_get(chip, CHIP_TIM1_BDTR) & CHIP_TIM1_BDTR_MOE) != 0;
}
