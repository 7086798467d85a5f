/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_temperature.h: one temperature sensor against an estimate of what it measures. Slow loop,
 * 1 kHz.
 *
 * A reading outside the sensor's range is replaced by the estimate at once and named after
 * monitor.sensor_fault_time. A sensor that stays where it is while the estimate moves by
 * monitor.stuck_rise is stuck; then the hotter of both is used. README, Temperature sensors.
 */
#ifndef MONITOR_MONITOR_TEMPERATURE_H
#define MONITOR_MONITOR_TEMPERATURE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

enum {
    /* What is used for a broken sensor without an estimate: no torque. As hal/analog.h reports. */
    MONITOR_TEMPERATURE_BROKEN_cC = 29999,
    /* Milliseconds of plausible readings after which a sensor is taken for good again. */
    MONITOR_TEMPERATURE_HEAL_STEPS = 1000,
    /* The estimate is corrected by what a good sensor showed, at most 20 K, over 2^14 ms. */
    MONITOR_TEMPERATURE_OFFSET_MOST_cC = 2000,
    MONITOR_TEMPERATURE_OFFSET_LOG2 = 14
};

typedef struct {
    int32_t kept_cC, kept_estimate_cC; /* when the sensor last moved */
    int32_t offset_q16;                /* sensor less estimate, cC */
    uint16_t outside_steps;
    uint16_t heal_steps; /* left until a broken sensor counts as good */
    bool stuck;
    bool started;
} monitor_temperature_state_t;

typedef struct {
    int32_t measured_cC;
    int32_t estimate_cC; /* of the part that the sensor is mounted on */
    int32_t slowest_cC;  /* estimate of what the sensor follows at the latest; equal without one */
    bool estimated;
    int32_t limit_cC; /* end of the derating; from MONITOR_TEMPERATURE_OFF_cC on no sensor is
                         expected */
} monitor_temperature_input_t;

typedef struct {
    int32_t used_cC;
    bool broken; /* warning: outside its range, or stuck */
} monitor_temperature_output_t;

/* @post !state->started && !state->stuck && state->heal_steps == 0 && state->offset_q16 == 0
 *
 * @post temperature_sensor_holds(state)
 */
void monitor_temperature_init(monitor_temperature_state_t *state);

/* True if a reading is outside the range of a working sensor.
 *
 * @post !result || measured_cC < 0 || measured_cC > 10000
 *
 * @post result || is_within(measured_cC, -20000, 29998)
 */
bool monitor_temperature_outside(const config_t *config, int32_t measured_cC);

/* @pre is_within(in->measured_cC, -100000, 100000) && is_within(in->estimate_cC, -32700, 32700) &&
 * is_within(in->slowest_cC, -32700, 32700)
 *
 * @pre is_within(state->kept_cC, -20000, 29998) && is_within(state->kept_estimate_cC, -32700,
 * 32700)
 *
 * @pre is_within(state->offset_q16, -MONITOR_TEMPERATURE_OFFSET_MOST_cC * 65536,
 * MONITOR_TEMPERATURE_OFFSET_MOST_cC * 65536) && state->heal_steps <=
 * MONITOR_TEMPERATURE_HEAL_STEPS
 *
 * @post is_within(state->kept_cC, -20000, 29998) && is_within(state->kept_estimate_cC, -32700,
 * 32700)
 *
 * @post is_within(state->offset_q16, -MONITOR_TEMPERATURE_OFFSET_MOST_cC * 65536,
 * MONITOR_TEMPERATURE_OFFSET_MOST_cC * 65536) && state->heal_steps <=
 * MONITOR_TEMPERATURE_HEAL_STEPS
 *
 * @post in->limit_cC < MONITOR_TEMPERATURE_OFF_cC || (!result.broken && result.used_cC ==
 * in->measured_cC)
 *
 * @post in->limit_cC >= MONITOR_TEMPERATURE_OFF_cC || is_within(in->measured_cC,
 * config->monitor.lowest_temperature_cC, config->monitor.highest_temperature_cC) ? result.used_cC
 * >= in->measured_cC : in->estimated ? is_within(result.used_cC, in->estimate_cC - 2000,
 * in->estimate_cC + 2000) : result.used_cC == MONITOR_TEMPERATURE_BROKEN_cC
 *
 * @post in->limit_cC >= MONITOR_TEMPERATURE_OFF_cC || result.broken == (state->heal_steps > 0)
 */
monitor_temperature_output_t monitor_temperature_step(monitor_temperature_state_t *state,
                                                      const config_t *config,
                                                      const monitor_temperature_input_t *in);

#endif
