/* SPDX-License-Identifier: Apache-2.0 */
/*
 * modes_rig.h: the state machine of the modes after init, and the input sequence that leads to each
 * mode.
 */
#ifndef MODES_RIG_H
#define MODES_RIG_H

#include "core/q15.h"
#include "modes/modes.h"
#include "paper_vehicle.h"
#include "unity.h"

static config_t config;
static modes_state_t state;
static modes_input_t in;

/* No fault, no demand, standstill. */
static const modes_input_t CALM = {
    .lost_reason = REASON_DEMAND_TIMEOUT,
    .config_accepted = true,
    .selftest_passed = true,
    .offsets_done = true,
    .offsets_plausible = true,
    .rotor_valid = true,
    .rolling = false,
    .at_rest = true,
    .enable = false,
    .torque_demanded = false,
    .fault_reset = false,
    .warning = false,
    .warning_reason = REASON_NONE,
    .fault = REASON_NONE,
    .bridge = BRIDGE_OFF,
};

static inline void start(void)
{
    config = paper_vehicle();
    modes_init(&state);
    in = CALM;
}

static inline modes_output_t step(void)
{
    return modes_step(&state, &config, &in);
}

static inline modes_output_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        step();
    }
    return step();
}

/* Starts and steps to a mode. Leaves `in` as it must be to stay in that mode. */
static inline void start_in(operating_mode_t mode)
{
    start();
    switch (mode) {
    case MODE_BOOT:
        in.config_accepted = false;
        break;
    case MODE_SELFTEST:
        in.selftest_passed = false;
        step();
        break;
    case MODE_OFFSET_CAL:
        in.offsets_done = false;
        run(2);
        break;
    case MODE_READY:
        run(10);
        break;
    case MODE_RUN:
        in.enable = true;
        run(10);
        break;
    case MODE_LIMP:
        in.enable = true;
        in.warning = true;
        in.warning_reason = REASON_ROTOR_UNCERTAIN;
        run(10);
        break;
    case MODE_FAULT:
        run(10);
        in.fault = REASON_OVERCURRENT;
        step();
        in.fault = REASON_NONE;
        break;
    }
    TEST_ASSERT_EQUAL_INT(mode, state.mode);
}

static inline void assert_mode(operating_mode_t mode, modes_output_t out)
{
    TEST_ASSERT_EQUAL_STRING(operating_mode_text(mode), operating_mode_text(out.mode));
}

#endif
