/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/road.h"

#include "core/divide.h"
#include "core/q15.h"

enum {
    FILTER_ms = 64,
    LONGEST_ms = 1024,       /* without a change: the speed is constant */
    MOST_mNm = (1 << 23) - 1 /* largest torque that is known */
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

static void begin(road_state_t *state, int32_t speed_abs_mrad_s)
{
    state->shown_mrad_s = speed_abs_mrad_s;
    state->since_ms = 0;
    state->known_mNm_ms = 0;
}

/* The shown speed has changed. */
static void see(road_state_t *state, int32_t speed_abs_mrad_s)
{
    /* g m^2 times mrad/s is mN m times ms. */
    const int64_t change_mrad_s = (int64_t)speed_abs_mrad_s - state->shown_mrad_s;
    const int64_t impulse_mNm_ms = state->inertia_g_m2 * change_mrad_s - state->known_mNm_ms;
    const int32_t mean_mNm = limited_mNm(q_saturate64(impulse_mNm_ms) / state->since_ms);
    const int32_t weight = q_min(state->since_ms, FILTER_ms);
    state->torque_mNm += (mean_mNm - state->torque_mNm) * weight / FILTER_ms;
    begin(state, speed_abs_mrad_s);
}

int32_t road_step(road_state_t *state, const config_t *config, int32_t speed_mrad_s,
                  int32_t motor_mNm, int32_t hydraulic_mNm, bool trusted)
{
    const int32_t speed_abs_mrad_s = q_abs(speed_mrad_s);
    const bool backwards = speed_mrad_s < 0;
    const bool rolled = state->rolls && backwards == state->backwards;
    state->backwards = backwards;
    state->rolls = trusted && speed_abs_mrad_s > config->brake.blend_out_end_mrad_s / 2 + 1;
    if (!state->rolls || !rolled) {
        begin(state, speed_abs_mrad_s);
    } else {
        const int64_t along_mNm = backwards ? -(int64_t)motor_mNm : motor_mNm;
        state->known_mNm_ms += limited_mNm(along_mNm - hydraulic_mNm);
        state->since_ms++;
        if (speed_abs_mrad_s != state->shown_mrad_s || state->since_ms >= LONGEST_ms) {
            see(state, speed_abs_mrad_s);
        }
    }
    return q_max(-state->torque_mNm, 0);
}
