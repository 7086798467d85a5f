/* SPDX-License-Identifier: Apache-2.0 */
/*
 * demand_age.h: when a demand is lost, and whether it needs own messages that leave. Any context.
 */
#ifndef CONFIG_DEMAND_AGE_H
#define CONFIG_DEMAND_AGE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

/* True beyond brake.demand_timeout_ms. age_ms: since the last valid demand. */
static inline bool demand_is_lost(const config_t *config, uint32_t age_ms)
{
    return age_ms > (uint32_t)config->brake.demand_timeout_ms;
}

/* True where the motor may brake only while this wheel's messages leave: the braking demand comes
 * by CAN, and the hydraulic brake takes its own path while no message comes. */
static inline bool demand_needs_transmission(const config_t *config)
{
    return config->brake.max_hydraulic_torque_mNm > 0 && config->driver.no_other_brake == 0 &&
           config->pedals.brake_channels == 0;
}

#endif
