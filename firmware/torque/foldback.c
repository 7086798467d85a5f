/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/foldback.h"

#include "core/q15.h"

enum { STEPS = 8, LEAVE_ZERO_DIVISOR = 64 };

bool foldback_near(uint16_t *steps, int32_t inside_mV, int32_t width_mV)
{
    if (inside_mV < 2 * (int64_t)width_mV) {
        *steps = FOLDBACK_NEAR_STEPS;
    } else if (*steps > 0) {
        *steps = (uint16_t)(*steps - 1U);
    }
    return *steps > 0;
}

int32_t foldback_current_mA(const foldback_t *foldback, bool near, int32_t inside_mV,
                            int32_t now_mA)
{
    const int32_t most_mA = foldback->most_mA;
    const int64_t width_mV = foldback->width_mV;
    if (most_mA <= 0 || inside_mV <= -width_mV) {
        return 0;
    }
    if (!near) {
        return most_mA;
    }
    const int32_t now = q_clamp(now_mA, 0, most_mA);
    const int64_t beside_mV = inside_mV - width_mV * now / most_mA;
    const int64_t moving_mA = (int64_t)now + most_mA / LEAVE_ZERO_DIVISOR;
    return q_clamp(q_saturate64(now + moving_mA * beside_mV / ((int64_t)STEPS * foldback->span_mV)),
                   0, most_mA);
}
