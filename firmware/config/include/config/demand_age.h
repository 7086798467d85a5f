/* SPDX-License-Identifier: Apache-2.0 */
/*
 * demand_age.h: when a demand is lost. Any context.
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

#endif
