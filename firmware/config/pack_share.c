/* SPDX-License-Identifier: Apache-2.0 */
#include "config/pack_share.h"

#include <stdbool.h>

#include "core/q15.h"

enum { SHARE_BITS = 15 };

int32_t pack_share_mA(const config_battery_t *battery, int32_t pack_mA)
{
    return battery->pack_share_q15 > 0
               ? (int32_t)(((int64_t)pack_mA * battery->pack_share_q15) >> SHARE_BITS)
               : pack_mA / q_divisor(battery->driven_wheels);
}

int32_t pack_share_whole_mA(const config_battery_t *battery, int32_t own_mA)
{
    const bool shared = battery->pack_share_q15 > 0;
    return q_scale(own_mA, shared ? 1 << SHARE_BITS : battery->driven_wheels,
                   shared ? battery->pack_share_q15 : 1);
}
