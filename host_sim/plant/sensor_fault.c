/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/sensor_fault.h"

#include <math.h>

#include "plant/numbers.h"

enum { PHASES_MEASURED = 3, HIGHEST_CODE = 4095, HALF_CODES = 2048 };
static const double TURN_DEG = 360.0;
static const double ON = 0.5; /* a switch given as a number */

bool sensor_fault_present(const fault_params_t *p)
{
#define PRESENT(name, lowest, highest, unit, text) || p->name != 0.0
    return false SENSOR_FAULT_PARAMETERS(PRESENT);
#undef PRESENT
}

static double within_turn(double turn)
{
    return turn - floor(turn);
}

static double seen_turn(const fault_params_t *p, sensor_fault_t *state, double theta_turn,
                        double period_s)
{
    const bool holds = p->rotor_frozen > ON || p->rotor_reversed > ON;
    if (holds && !state->has_angle) {
        state->kept_theta_turn = theta_turn;
    }
    state->has_angle = holds;
    state->slip_turn += p->rotor_slip_deg_per_s * period_s / TURN_DEG;
    if (p->rotor_slip_deg_per_s == 0.0) {
        state->slip_turn = 0.0;
    }
    double seen = theta_turn;
    if (p->rotor_frozen > ON) {
        seen = state->kept_theta_turn;
    } else if (p->rotor_reversed > ON) {
        seen = 2.0 * state->kept_theta_turn - theta_turn;
    }
    return within_turn(seen + p->rotor_jump_deg / TURN_DEG + state->slip_turn);
}

sensor_view_t sensor_fault_before(const fault_params_t *p, sensor_fault_t *state,
                                  const sensor_view_t *truth, double full_scale_a, double period_s)
{
    const unsigned mask = (unsigned)p->current_sensors;
    state->offset_share = p->current_drift_per_s != 0.0
                              ? state->offset_share + p->current_drift_per_s * period_s
                              : 0.0;
    const double added_a = (p->current_offset + state->offset_share) * full_scale_a;
    double i_a[PHASES_MEASURED] = {truth->current_a.a, truth->current_a.b, truth->current_a.c};
    for (unsigned x = 0; x < PHASES_MEASURED; x++) {
        if ((mask >> x & 1U) != 0U) {
            i_a[x] = i_a[x] * (1.0 + p->current_gain_error) + added_a;
        }
    }
    const sensor_view_t out = {
        .current_a = {.a = i_a[0], .b = i_a[1], .c = i_a[2]},
        .bus_voltage_v = truth->bus_voltage_v * (1.0 + p->bus_gain_error),
        .theta_turn = seen_turn(p, state, truth->theta_turn, period_s),
    };
    state->bounce_s += period_s;
    if (state->bounce_s >= p->hall_bounce_s) {
        state->bounce_s = 0.0;
        state->interrupted = !state->interrupted;
    }
    return out;
}

static uint16_t code_of_share(double share, double middle, double scale)
{
    return (uint16_t)plant_clamp(middle + share * scale + 0.5, 0.0, HIGHEST_CODE);
}

void sensor_fault_after(const fault_params_t *p, sensor_fault_t *state, random_t *random,
                        sensors_sample_t *sample)
{
    const bool holds = p->current_frozen > ON || p->bus_frozen > ON;
    if (holds && !state->has_codes) {
        for (int x = 0; x < PHASES_MEASURED; x++) {
            state->kept_current_code[x] = sample->phase_current_code[x];
        }
        state->kept_bus_code = sample->bus_voltage_code;
    }
    state->has_codes = holds;
    const unsigned mask = (unsigned)p->current_sensors;
    for (unsigned x = 0; x < PHASES_MEASURED; x++) {
        if ((mask >> x & 1U) != 0U && p->current_stuck > ON) {
            sample->phase_current_code[x] = code_of_share(p->current_shown, HALF_CODES, HALF_CODES);
        } else if ((mask >> x & 1U) != 0U && p->current_frozen > ON) {
            sample->phase_current_code[x] = state->kept_current_code[x];
        }
    }
    if (p->bus_stuck > ON) {
        sample->bus_voltage_code = code_of_share(p->bus_shown, 0.0, 2.0 * HALF_CODES);
    } else if (p->bus_frozen > ON) {
        sample->bus_voltage_code = state->kept_bus_code;
    }
    unsigned lines = sample->hall_state;
    if (p->hall_floating > 0.0) {
        const unsigned floating = (unsigned)p->hall_floating;
        const unsigned levels = (unsigned)(random_uniform(random) * 8.0);
        lines = (lines & ~floating) | (levels & floating);
    }
    if (state->interrupted) {
        lines |= (unsigned)p->hall_bouncing;
    }
    sample->hall_state = (uint8_t)lines;
}
