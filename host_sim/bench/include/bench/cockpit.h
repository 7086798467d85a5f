/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cockpit.h: the driver's feet on pedals that are wired to a controller: sensors, 12-bit converter,
 * the firmware's pedals/pedals.h. 1 kHz. Without driver.uses_pedals the demand is a message.
 */
#ifndef BENCH_COCKPIT_H
#define BENCH_COCKPIT_H

#include "bench/driver.h"
#include "pedals/pedals.h"
#include "plant/pedal_sensors.h"

typedef struct {
    pedals_state_t pedals;
    pedals_output_t out; /* of the last millisecond, wheel of share 1 */
} cockpit_t;

cockpit_t cockpit_init(void);

/* received: the message that comes by CAN, with its age. Afterwards `out` is the demand. */
void cockpit_step(cockpit_t *cockpit, const config_t *config, const driver_params_t *driver,
                  const pedal_sensors_params_t *sensors, const wheel_demand_t *received,
                  double received_age_s);

/* What the brake system sees of the pedal by itself, N m at a wheel of share 1. */
double cockpit_brake_nm(const config_t *config, const driver_params_t *driver);

#endif
