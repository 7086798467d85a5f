/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/lift_off.h"

#include "core/q15.h"

lift_off_t lift_off_split(const torque_limits_t *limits, int32_t demand_mNm, int32_t electric_mNm,
                          int32_t coasting_mNm)
{
    lift_off_t out = {.motor_mNm = 0, .hydraulic_mNm = 0, .reason = REASON_NONE};
    if (demand_mNm <= 0) {
        return out;
    }
    const limit_t abs_line = limits->braking[TORQUE_LINE_ABS];
    const limit_t blend_out = limits->braking[TORQUE_LINE_BLEND_OUT];
    const limit_t gain = limits->braking[TORQUE_LINE_CURRENT_GAIN];
    limit_t bound = torque_limits_tightest(limits->braking, 0, TORQUE_LINE_CURRENT_GAIN);
    limit_tighten(&bound, abs_line.torque_mNm, abs_line.reason);
    const int32_t at_speed_mNm = q_min(demand_mNm, q_max(bound.torque_mNm - electric_mNm, 0));
    /* P is a parabola over T, zero at C and as far beyond its lowest point T_opt. */
    const int32_t zero_power_mNm =
        q_max(q_saturate64(2 * (int64_t)limits->optimum_mNm - coasting_mNm), coasting_mNm);
    limit_tighten(&bound, zero_power_mNm, REASON_LOSS_OPTIMUM);
    limit_tighten(&bound, blend_out.torque_mNm, blend_out.reason);
    limit_tighten(&bound, gain.torque_mNm, gain.reason);
    out.motor_mNm = q_min(demand_mNm, q_max(bound.torque_mNm - electric_mNm, 0));
    out.hydraulic_mNm = at_speed_mNm - out.motor_mNm;
    out.reason = out.motor_mNm < demand_mNm ? bound.reason : REASON_NONE;
    return out;
}
