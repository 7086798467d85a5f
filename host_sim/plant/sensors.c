/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/sensors.h"

#include <math.h>

#include "plant/numbers.h"

enum { CODE_BITS = 12, CODES = 4096, ANGLE_TURN = 65536 };

static const uint8_t HALL_STATE[SENSORS_HALL_SECTORS] = {5, 1, 3, 2, 6, 4};

/* As the lines show a state: first B and C exchanged, then lines inverted. */
static uint8_t wired(uint8_t state, unsigned lines)
{
    const unsigned exchanged =
        (lines & 8U) != 0 ? (state & 1U) | (state & 2U) << 1 | (state & 4U) >> 1 : state;
    return (uint8_t)(exchanged ^ (lines & 7U));
}

static double within_turn(double turn)
{
    return turn - floor(turn);
}

/* Edges as the rotor meets them from angle 0 on: misplacement may carry one across it. */
static void sort_edges(sensors_t *sensors)
{
    for (int k = 1; k < SENSORS_HALL_SECTORS; k++) {
        const double edge = sensors->edge_turn[k];
        const uint8_t state = sensors->state_from[k];
        int to = k;
        while (to > 0 && sensors->edge_turn[to - 1] > edge) {
            sensors->edge_turn[to] = sensors->edge_turn[to - 1];
            sensors->state_from[to] = sensors->state_from[to - 1];
            to--;
        }
        sensors->edge_turn[to] = edge;
        sensors->state_from[to] = state;
    }
}

sensors_t sensors_init(const sensors_params_t *params)
{
    const double bits = plant_min(floor(params->adc_bits), CODE_BITS);
    const double steps = exp2(bits);
    const double steps_per_a = 0.5 * steps / params->current_full_scale_a;
    sensors_t out = {
        .steps_per_a = {steps_per_a * (1.0 + params->current_a_gain_error),
                        steps_per_a * (1.0 + params->current_b_gain_error),
                        steps_per_a * (1.0 + params->current_c_gain_error)},
        .steps_per_v = steps / params->voltage_full_scale_v * (1.0 + params->bus_gain_error),
        .middle_steps = 0.5 * steps,
        .highest_step = steps - 1.0,
        .codes_per_step = (uint32_t)(CODES / steps),
        .offset_a = {params->current_offset_a, -params->current_offset_a, params->current_offset_a},
        .current_noise_a = params->current_noise_a,
        .bus_voltage_noise_v = params->bus_voltage_noise_v,
        .angle_offset_turn = params->angle_offset_deg / 360.0,
        .angle_error_turn = params->angle_error_deg / 360.0,
    };
    const double edges_deg[SENSORS_HALL_SECTORS] = {
        params->hall_edge_0_deg, params->hall_edge_1_deg, params->hall_edge_2_deg,
        params->hall_edge_3_deg, params->hall_edge_4_deg, params->hall_edge_5_deg};
    for (int k = 0; k < SENSORS_HALL_SECTORS; k++) {
        const double error_deg =
            k % 2 == 0 ? params->hall_edge_error_deg : -params->hall_edge_error_deg;
        out.edge_turn[k] = within_turn((edges_deg[k] + error_deg) / 360.0);
        out.state_from[k] = wired(HALL_STATE[k], (unsigned)params->hall_lines);
    }
    sort_edges(&out);
    return out;
}

uint8_t sensors_hall_state(const sensors_t *sensors, double theta_turn)
{
    int passed = 0;
    for (int k = 0; k < SENSORS_HALL_SECTORS; k++) {
        passed += theta_turn >= sensors->edge_turn[k] ? 1 : 0;
    }
    return sensors->state_from[passed > 0 ? passed - 1 : SENSORS_HALL_SECTORS - 1];
}

/* What an angle sensor shows: 65 536 = one electrical turn. */
static inline uint16_t shown_turn(const sensors_t *sensors, double theta_turn)
{
    double shown = theta_turn;
    if (sensors->angle_error_turn > 0.0 || sensors->angle_offset_turn != 0.0) {
        shown = within_turn(theta_turn + sensors->angle_offset_turn +
                            sensors->angle_error_turn * sin(PLANT_TWO_PI * theta_turn));
    }
    return (uint16_t)((uint32_t)(shown * ANGLE_TURN + 0.5) % ANGLE_TURN);
}

/* steps: quantity in steps of the converter from the bottom of its range. */
static inline uint16_t code_of(const sensors_t *sensors, double steps)
{
    const double level = plant_clamp(steps + 0.5, 0.0, sensors->highest_step);
    return (uint16_t)((uint32_t)level * sensors->codes_per_step);
}

sensors_sample_t sensors_sample(const sensors_t *sensors, const sensors_fault_t *fault,
                                random_t *random, plant_abc_t current_a, double bus_voltage_v,
                                double theta_turn)
{
    double i_a[3] = {current_a.a + sensors->offset_a[0] + fault->offset_a,
                     current_a.b + sensors->offset_a[1] - fault->offset_a,
                     current_a.c + sensors->offset_a[2] + fault->offset_a};
    double v_dc = bus_voltage_v;
    if (sensors->current_noise_a > 0.0) {
        for (int x = 0; x < 3; x++) {
            i_a[x] += sensors->current_noise_a * random_gaussian(random);
        }
    }
    if (sensors->bus_voltage_noise_v > 0.0) {
        v_dc += sensors->bus_voltage_noise_v * random_gaussian(random);
    }
    sensors_sample_t out;
    for (int x = 0; x < 3; x++) {
        out.phase_current_code[x] =
            code_of(sensors, sensors->middle_steps + i_a[x] * sensors->steps_per_a[x]);
    }
    out.bus_voltage_code = code_of(sensors, v_dc * sensors->steps_per_v);
    out.rotor_angle_turn = shown_turn(sensors, theta_turn);
    const unsigned lines =
        sensors_hall_state(sensors, theta_turn) & ~(unsigned)fault->hall_stuck_low;
    out.hall_state = (uint8_t)(lines | fault->hall_stuck_high);
    return out;
}
