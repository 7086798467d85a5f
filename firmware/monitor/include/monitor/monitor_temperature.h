/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitor_temperature.h: one temperature sensor against an estimate of what it measures. Slow loop,
 * 1 kHz.
 *
 * A reading outside the sensor's range is replaced by the estimate at once and named after
 * monitor.sensor_fault_time. A sensor that stays where it is while the estimate moves by
 * monitor.stuck_rise is stuck; then the hotter of both is used. DERIVATIONS.md, Temperature
 * sensors.
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
    int32_t measured_cC; /* -100 000 .. 100 000 */
    int32_t estimate_cC; /* of the part that the sensor is mounted on, -32 700 .. 32 700 */
    int32_t slowest_cC;  /* of what the sensor follows at the latest, likewise; equal without one */
    bool estimated;
    int32_t limit_cC; /* end of the derating; from MONITOR_TEMPERATURE_OFF_cC on no sensor is
                         expected */
} monitor_temperature_input_t;

typedef struct {
    int32_t used_cC;
    bool broken; /* warning: outside its range, or stuck */
} monitor_temperature_output_t;

/* The sensor counts as good; its movement is watched from its first reading on. */
void monitor_temperature_init(monitor_temperature_state_t *state);

/* True if a reading is outside the range of a working sensor. */
bool monitor_temperature_outside(const config_t *config, int32_t measured_cC);

/* What is used is the reading of a good sensor or more; of a broken one the estimate, corrected by
 * at most MONITOR_TEMPERATURE_OFFSET_MOST_cC, or MONITOR_TEMPERATURE_BROKEN_cC without an estimate;
 * the reading as it is where no sensor is expected. */
monitor_temperature_output_t monitor_temperature_step(monitor_temperature_state_t *state,
                                                      const config_t *config,
                                                      const monitor_temperature_input_t *in);

#endif
