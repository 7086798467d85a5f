/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/road.h"

#include "core/divide.h"
#include "core/q15.h"

enum {
    FILTER_LOG2 = 6,         /* 64 ms */
    MOST_mNm = (1 << 23) - 1 /* largest input of the filter */
};

/* m r^2; of the largest share and radius 4 * 10^8, by way of 2 * 10^11 g mm and 4 * 10^17. */
static int32_t inertia_g_m2(const config_t *config)
{
    const int32_t share_g = config->vehicle.mass_g / q_divisor(config->battery.driven_wheels);
    const int64_t radius_um = config->vehicle.wheel_radius_um;
    return (int32_t)divide_by_billion(divide_by_thousand(share_g * radius_um) * radius_um);
}

void road_init(road_state_t *state, const config_t *config)
{
    const road_state_t unknown = {.inertia_g_m2 = inertia_g_m2(config)};
    *state = unknown;
}

static int32_t limited_mNm(int64_t torque_mNm)
{
    return q_clamp(q_saturate64(torque_mNm), -MOST_mNm, MOST_mNm);
}

int32_t road_step(road_state_t *state, const config_t *config, int32_t speed_mrad_s,
                  int32_t motor_mNm, int32_t hydraulic_mNm, bool trusted)
{
    const bool backwards = speed_mrad_s < 0;
    const bool rolled = state->rolls && backwards == state->backwards;
    state->backwards = backwards;
    state->rolls = trusted && q_abs(speed_mrad_s) > config->brake.blend_out_end_mrad_s / 2 + 1;
    if (state->rolls) {
        const int32_t speed_q8_mrad_s = q_saturate64((int64_t)q_abs(speed_mrad_s) * 256);
        const int64_t along_mNm = backwards ? -(int64_t)motor_mNm : motor_mNm;
        const int32_t known_mNm = limited_mNm(along_mNm - hydraulic_mNm);
        if (!rolled) {
            state->speed_lp_q8_mrad_s = speed_q8_mrad_s;
            filter_reset(&state->known_lp_mNm, known_mNm, FILTER_LOG2);
        }
        const int32_t change_q8_mrad_s =
            (speed_q8_mrad_s - state->speed_lp_q8_mrad_s) / (1 << FILTER_LOG2);
        state->speed_lp_q8_mrad_s += change_q8_mrad_s;
        const int32_t filtered_mNm = filter_step(&state->known_lp_mNm, known_mNm, FILTER_LOG2);
        /* g m^2 times mrad/s in a millisecond is mN m. */
        const int64_t inertial_mNm = (int64_t)state->inertia_g_m2 * change_q8_mrad_s / 256;
        state->torque_mNm = limited_mNm(inertial_mNm - filtered_mNm);
    }
    return q_max(-state->torque_mNm, 0);
}
