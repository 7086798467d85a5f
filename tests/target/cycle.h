/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle.h: the inputs of both step functions over a whole drive, as a file of 16-byte units in the
 * order in which the steps are called. A fast step's inputs are one unit, a slow step's are two.
 * The last byte of a first unit says which. Little-endian, as both machines are.
 */
#ifndef TARGET_CYCLE_H
#define TARGET_CYCLE_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/controller.h"

#define CYCLE_FILE "cycle.trace" /* in the working directory of both programs */
#define CYCLE_NAME "urban cycle ECE-15"

enum { CYCLE_UNIT_BYTES = 16 };

typedef struct {
    uint16_t phase_current_code[3];
    uint16_t bus_voltage_code;
    uint16_t rotor_angle_turn;
    uint16_t encoder_count, encoder_index_count;
    uint8_t hall_state;
    uint8_t flags;
} cycle_fast_t;

typedef struct {
    int32_t drive_torque_mNm, brake_torque_mNm;
    uint32_t demand_age_ms;
    uint8_t reserved[3]; /* 0 */
    uint8_t flags;
    int32_t bms_charge_current_mA, bms_discharge_current_mA;
    int32_t winding_temperature_cC, switch_temperature_cC;
} cycle_slow_t;

_Static_assert(sizeof(cycle_fast_t) == CYCLE_UNIT_BYTES, "one unit");
_Static_assert(sizeof(cycle_slow_t) == 2 * CYCLE_UNIT_BYTES, "two units");

cycle_fast_t cycle_of_fast(const fast_input_t *in);
cycle_slow_t cycle_of_slow(const slow_input_t *in);

/* Whether a unit begins a slow step's inputs. */
bool cycle_is_slow(const cycle_fast_t *unit);

fast_input_t cycle_fast_input(const cycle_fast_t *kept);
slow_input_t cycle_slow_input(const cycle_slow_t *kept);

#endif
