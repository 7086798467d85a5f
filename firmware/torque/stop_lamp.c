/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/stop_lamp.h"

#include "core/q15.h"
#include "core/scaled.h"

enum {
    THOUSANDTH_q24 = 16777,    /* 2^24 / 1000 */
    LEAST_LOG2 = 3,            /* of the filters' time constant: the least time with light */
    DECEL_MOST_MM_S2 = 1000000 /* 100 g: a wheel that jumps, not a vehicle that brakes */
};

void stop_lamp_init(stop_lamp_state_t *state)
{
    const stop_lamp_state_t zero = {0};
    *state = zero;
}

bool stop_lamp_step(stop_lamp_state_t *state, const config_t *config, int32_t speed_mrad_s,
                    int32_t brake_demand_mNm)
{
    const config_brake_t *brake = &config->brake;
    const int32_t speed_q8 = q_saturate64((int64_t)q_abs(speed_mrad_s) * 256);
    const int32_t filter_steps = 1 << brake->stop_lamp_filter_log2;
    if (!state->started) {
        state->started = true;
        state->speed_lp_q8_mrad_s = speed_q8;
    }
    const int32_t before_q8 = state->speed_lp_q8_mrad_s;
    state->speed_lp_q8_mrad_s += (speed_q8 - before_q8) / filter_steps; /* both are >= 0 */
    /* mrad/s in a millisecond, times um: um/s^2 */
    const int64_t decel_um_s2 =
        ((int64_t)before_q8 - state->speed_lp_q8_mrad_s) * config->vehicle.wheel_radius_um >> 8;
    const int32_t raw_mm_s2 =
        q_limit(scaled_multiply(q_saturate64(decel_um_s2), THOUSANDTH_q24), DECEL_MOST_MM_S2);
    const int32_t decel_mm_s2 =
        filter_step(&state->decel_lp_mm_s2, raw_mm_s2, (unsigned)brake->stop_lamp_filter_log2);

    if (brake_demand_mNm > 0 || decel_mm_s2 > brake->stop_lamp_on_mm_s2) {
        state->lit = true;
        state->quiet_ms = 0;
    } else if (decel_mm_s2 < brake->stop_lamp_off_mm_s2) {
        state->quiet_ms = (uint16_t)q_min(state->quiet_ms + 1, filter_steps << LEAST_LOG2);
        state->lit = state->lit && state->quiet_ms < filter_steps << LEAST_LOG2;
    }
    return state->lit;
}
