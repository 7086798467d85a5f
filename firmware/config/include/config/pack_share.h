/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pack_share.h: this motor's share of what the battery management allows the whole pack. All motors
 * on a pack have shares of at most 1 together, so that they never take more than it allows.
 */
#ifndef CONFIG_PACK_SHARE_H
#define CONFIG_PACK_SHARE_H

#include <stdint.h>

#include "config/config.h"

/* Rounded down, at least for a pack_mA >= 0. */
int32_t pack_share_mA(const config_battery_t *battery, int32_t pack_mA);

/* The pack's current of which own_mA is this motor's share; saturating. Divides. */
int32_t pack_share_whole_mA(const config_battery_t *battery, int32_t own_mA);

#endif
