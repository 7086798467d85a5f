/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pack_share.h: this motor's share of what the battery management allows the whole pack. All motors
 * on a pack have shares of at most 1 together, so that they never take more than it allows.
 */
#ifndef CONFIG_PACK_SHARE_H
#define CONFIG_PACK_SHARE_H

#include "config/config.h"
#include "core/q15.h"

/* pack_mA of any sign. */
static inline int32_t pack_share_mA(const config_battery_t *battery, int32_t pack_mA)
{
    if (battery->pack_share_q15 > 0) {
        return (int32_t)((int64_t)pack_mA * battery->pack_share_q15 / 32768);
    }
    return pack_mA / q_divisor(battery->driven_wheels);
}

/* The pack's current of which own_mA is this motor's share; saturating. */
static inline int32_t pack_share_whole_mA(const config_battery_t *battery, int32_t own_mA)
{
    return battery->pack_share_q15 > 0 ? q_scale(own_mA, 32768, battery->pack_share_q15)
                                       : q_scale(own_mA, battery->driven_wheels, 1);
}

#endif
