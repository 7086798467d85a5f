/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The gate driver on the board, a DRV8301 (data sheet SLOS719, section numbers are its), or a
 * DRV8302 (SLES267), which starts, latches and reports a fault alike and has pins instead of a bus:
 * the threshold is the voltage at OC_ADJ (7.3.4.2), M_OC high latches (7.3.4.1.2), low limits
 * (7.3.4.1.1). EN_GATE (7.4.1) is that of the DRV8301. Over-currents are those of one switch.
 */
#include <string.h>

#include "boards.h"
#include "parts.h"

enum {
    START_ms = 10,          /* t_SPI_READY at most (6.9) */
    CLOCK_LEAST_TICKS = 33, /* 100 ns */
    HIGH_LEAST_TICKS = 134, /* 400 ns of nSCS */
    RESET_QUICK_us = 10,
    RESET_FULL_us = 20,
    STATUS_1 = 0,
    STATUS_2 = 1,
    CONTROL_1 = 2,
    CONTROL_2 = 3,
    FAULT = 1 << 10,
    PVDD_UV = 1 << 8,
    FETLA_OC = 1 << 4,
    GATE_RESET = 1 << 2,
    LIMIT = 0, /* OCP_MODE */
    LATCH_SHUTDOWN = 1,
    DEVICE_ID = 1
};

/* Table 13, in mV. */
static const uint16_t V_DS_mV[32] = {60,  68,  76,   86,   97,   109,  123,  138,  155,  175, 197,
                                     222, 250, 282,  317,  358,  403,  454,  511,  576,  648, 730,
                                     822, 926, 1043, 1175, 1324, 1491, 1679, 1892, 2131, 2400};

static bool is_switched(void)
{
    return boards_chosen()->enable.port != 0;
}

static bool takes_commands(const chip_t *chip)
{
    return !is_switched() || chip->now >= chip->driver.ready;
}

static bool has_bus(void)
{
    return boards_chosen()->nscs.port != 0;
}

static bool drives_high(chip_t *chip, wire_t wire)
{
    return chip_drives_high(chip, wire.port, wire.pin);
}

static void full_reset(chip_driver_t *driver)
{
    driver->control[0] = 0;
    driver->control[1] = 0;
    driver->latched = 0;
    driver->status = 0;
}

void chip_driver_reset(chip_t *chip)
{
    const chip_driver_t fresh = {.ready = CHIP_NEVER, .select = true};
    chip->driver = fresh;
}

static void look_at_enable(chip_t *chip)
{
    chip_driver_t *driver = &chip->driver;
    const bool enabled = is_switched() && drives_high(chip, boards_chosen()->enable);
    if (enabled == driver->enabled) {
        return;
    }
    driver->enabled = enabled;
    if (!enabled) {
        driver->disabled_at = chip->now;
        driver->ready = CHIP_NEVER;
        return;
    }
    const chip_ticks_t low = chip->now - driver->disabled_at;
    driver->ready = chip->now + (chip_ticks_t)START_ms * 1000U * CHIP_TICKS_PER_US;
    if (low >= RESET_FULL_us * CHIP_TICKS_PER_US || driver->disabled_at == 0) {
        full_reset(driver);
    } else if (low <= RESET_QUICK_us * CHIP_TICKS_PER_US) {
        if (chip_timer1_drives(chip)) {
            chip_note(chip, "gate driver: a reset while the bridge switches");
        }
        driver->latched = 0;
        driver->ready = chip->now;
    } else {
        chip_note(chip, "EN_GATE low for more than 10 and less than 20 us");
    }
}

static uint32_t read_register(chip_t *chip, uint32_t address)
{
    chip_driver_t *driver = &chip->driver;
    switch (address) {
    case STATUS_1: {
        const uint32_t now = chip->fault.gate_driver_fault ? PVDD_UV : 0U;
        const uint32_t value = driver->status | now;
        driver->status = 0; /* reports what has come since the last reading */
        return value | (value != 0 || driver->latched != 0 ? FAULT : 0U);
    }
    case STATUS_2:
        return DEVICE_ID;
    case CONTROL_1:
    case CONTROL_2:
        return driver->control[address - CONTROL_1];
    default:
        return 0;
    }
}

/* 7.5.1.2: a frame is decoded when nSCS rises; its answer goes out with the next. */
static void decode(chip_t *chip)
{
    chip_driver_t *driver = &chip->driver;
    if (driver->bits != 16) {
        chip_note(chip, "gate driver: a frame of %u bits", driver->bits);
        driver->answer = 1U << 15;
        return;
    }
    const uint32_t address = driver->in >> 11 & 0xFU;
    if ((driver->in >> 15 & 1U) != 0) {
        driver->answer = address << 11 | read_register(chip, address);
        return;
    }
    if (address == CONTROL_1 || address == CONTROL_2) {
        uint32_t value = driver->in & 0x7FFU;
        if (address == CONTROL_1 && (value & GATE_RESET) != 0) {
            driver->latched = 0;
            value &= ~(uint32_t)GATE_RESET;
        }
        driver->control[address - CONTROL_1] = value & (address == CONTROL_1 ? 0x7FFU : 0x7FU);
    } else {
        chip_note(chip, "gate driver: a write to register %u", address);
    }
    driver->answer = address << 11;
}

static void select_frame(chip_t *chip, bool high, bool clock)
{
    chip_driver_t *driver = &chip->driver;
    driver->select = high;
    if (clock) {
        chip_note(chip, "gate driver: nSCS changes while the clock is high");
    }
    if (high) {
        driver->selected_at = chip->now;
        if (takes_commands(chip)) {
            decode(chip);
        }
        return;
    }
    if (!takes_commands(chip)) {
        chip_note(chip, "gate driver: a frame before it is ready");
    }
    if (chip->now - driver->selected_at < HIGH_LEAST_TICKS && driver->selected_at != 0) {
        chip_note(chip, "gate driver: nSCS high for less than 400 ns");
    }
    driver->in = 0;
    driver->bits = 0;
    driver->out = driver->answer;
}

/* SDO changes at the rising edge, SDI is taken at the falling one. */
static void clock_edge(chip_t *chip, bool high)
{
    chip_driver_t *driver = &chip->driver;
    driver->clock = high;
    if (driver->select) {
        return;
    }
    if (high) {
        if (driver->bits > 0 && chip->now - driver->risen_at < CLOCK_LEAST_TICKS) {
            chip_note(chip, "gate driver: a clock of less than 100 ns");
        }
        driver->risen_at = chip->now;
        driver->data_out = (driver->out >> 15 & 1U) != 0;
        driver->out <<= 1;
    } else {
        driver->in = driver->in << 1 | (drives_high(chip, boards_chosen()->sdi) ? 1U : 0U);
        driver->bits++;
    }
}

void chip_driver_pins(chip_t *chip)
{
    look_at_enable(chip);
    if (!has_bus()) {
        return;
    }
    const wire_t nscs = boards_chosen()->nscs;
    const bool clock = drives_high(chip, boards_chosen()->sclk);
    /* Floating, its pull-up holds nSCS. */
    const bool high = !chip_drives_low(chip, nscs.port, nscs.pin);
    if (high != chip->driver.select) {
        select_frame(chip, high, clock);
    }
    if (clock != chip->driver.clock) {
        clock_edge(chip, clock);
    }
}

static uint32_t threshold_mV(const chip_t *chip)
{
    return has_bus() ? V_DS_mV[chip->driver.control[0] >> 6] : boards_chosen()->oc_adj_mV;
}

static uint32_t over_current_mode(const chip_t *chip)
{
    if (has_bus()) {
        return chip->driver.control[0] >> 4 & 3U;
    }
    return chip->fault.driver_mode_low ? LIMIT : LATCH_SHUTDOWN;
}

/* A limit is reported at nOCTW, which no board wires. */
void chip_driver_watch(chip_t *chip)
{
    chip_driver_t *driver = &chip->driver;
    const bool over = is_switched() && takes_commands(chip) && chip_timer1_drives(chip) &&
                      chip->fault.low_side_a_mV >= threshold_mV(chip);
    const uint32_t mode = over_current_mode(chip);
    if (over && mode == LATCH_SHUTDOWN) {
        driver->latched |= FETLA_OC;
    }
    driver->limits = over && mode == LIMIT;
    driver->status |= over ? FETLA_OC : 0U;
}

bool chip_driver_holds_a_leg(const chip_t *chip)
{
    return chip->driver.latched != 0 || chip->driver.limits;
}

bool chip_driver_pulls_fault(const chip_t *chip)
{
    return chip->fault.gate_driver_fault || !takes_commands(chip) || chip->driver.latched != 0;
}

bool chip_driver_drives(const chip_t *chip)
{
    return !chip->fault.gate_driver_fault && takes_commands(chip);
}

bool chip_driver_data(const chip_t *chip)
{
    return chip->fault.driver_silent || (!chip->driver.select && chip->driver.data_out);
}
