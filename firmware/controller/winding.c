/* SPDX-License-Identifier: Apache-2.0 */
#include "winding.h"

#include "config/bases.h"
#include "core/divide.h"
#include "core/q15.h"
#include "motor/flux_map.h"

enum {
    LARGEST_Q16 = 1048576,
    LEAST_CHORD_SHARE = 64,   /* of the current base: a smaller i_q has the inductance at zero */
    LARGEST_CHORD_Q15 = 26214 /* 4/5 */
};

/* Of fluxes and inductances that stand for a map at some point, as the configuration's constants.
 */
typedef struct {
    int32_t inductance_nH, of_inductance_nH; /* here; of the constants */
    int32_t flux_nWb;                        /* beside inductance times current */
} local_axis_t;

/* psi - L i */
static int32_t beside_nWb(int32_t psi_nWb, int32_t inductance_nH, int32_t i_mA)
{
    return q_saturate64(psi_nWb - divide_by_thousand((int64_t)inductance_nH * i_mA));
}

/* k_p = k_i/(1 - exp(-R T/L)) is k_i/2 and a part that grows with L, to (R T/L)^2/12. */
static winding_axis_t axis_at(const winding_axis_t *constants, const local_axis_t *local,
                              const config_t *config)
{
    const int32_t half_integral_q16 = constants->integral_pu_q24 >> 9;
    const int32_t of_nH = q_divisor(local->of_inductance_nH);
    const int32_t grown_q16 =
        q_scale(constants->proportional_pu_q16 - half_integral_q16, local->inductance_nH, of_nH);
    const int32_t proportional_q16 = q_clamp(half_integral_q16 + grown_q16, 1, LARGEST_Q16);
    const winding_axis_t out = {
        .proportional_pu_q16 = proportional_q16,
        .integral_pu_q24 = constants->integral_pu_q24,
        .inductance_pu_q16 = q_clamp(
            q_scale(constants->inductance_pu_q16, local->inductance_nH, of_nH), 1, LARGEST_Q16),
        .flux_pu_q16 = q_limit(q_scale(config->current_loop.flux_pu_q16, local->flux_nWb,
                                       q_divisor(config->motor.flux_linkage_nWb)),
                               LARGEST_Q16),
        .anti_windup_q28 = winding_anti_windup_q28(constants->integral_pu_q24, proportional_q16),
    };
    return out;
}

/* psi_q/i_q; around zero, where the map is straight, the inductance. */
static int32_t chord_nH(const config_t *config, const flux_map_point_t *at, int32_t i_q_mA)
{
    const int32_t size_mA = q_abs(i_q_mA);
    const bool small = size_mA < config->drive.current_full_scale_mA / LEAST_CHORD_SHARE;
    return small ? at->q_nH : q_scale(q_abs(at->q_nWb), 1000, q_divisor(size_mA));
}

static int32_t middle_mA(const config_t *config, int32_t from_pu, int32_t to_pu)
{
    return bases_current_mA(config, (from_pu + to_pu) / 2);
}

const winding_t *winding_at(const config_t *config, const winding_t *constants, winding_path_t path,
                            int32_t winding_temperature_cC, winding_t *out)
{
    const config_motor_t *motor = &config->motor;
    const int32_t i_d_mA = middle_mA(config, path.from_pu.d, path.to_pu.d);
    const int32_t i_q_mA = middle_mA(config, path.from_pu.q, path.to_pu.q);
    const flux_map_point_t at =
        flux_map_at(config, i_d_mA + flux_map_shift_mA(config, winding_temperature_cC), i_q_mA);
    const local_axis_t d = {.inductance_nH = at.d_nH,
                            .of_inductance_nH = motor->d_inductance_nH,
                            .flux_nWb = beside_nWb(at.d_nWb, at.d_nH, i_d_mA)};
    const local_axis_t q = {.inductance_nH = at.q_nH,
                            .of_inductance_nH = motor->q_inductance_nH,
                            .flux_nWb = beside_nWb(at.q_nWb, at.q_nH, i_q_mA)};
    const int32_t chord_q15 =
        q_scale(constants->chord_q_q15, chord_nH(config, &at, i_q_mA), q.of_inductance_nH);
    out->d = axis_at(&constants->d, &d, config);
    out->q = axis_at(&constants->q, &q, config);
    out->chord_q_q15 = q_clamp(chord_q15, 0, LARGEST_CHORD_Q15);
    return out;
}
