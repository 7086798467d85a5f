/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/current_setpoint.h"

#include "config/bases.h"
#include "core/isqrt.h"
#include "core/q15.h"
#include "torque/loss_maps.h"

/* What the fast reach can have added: nothing above zero, nothing beyond its own limit. */
static int32_t weakening_within_mA(const config_t *config, int32_t i_d_weakening_mA)
{
    const int32_t most_mA =
        bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15);
    return q_clamp(i_d_weakening_mA, -most_mA, 0);
}

/* The map's i_d and field weakening's part of it, not further down than the larger of the two may
 * go alone. */
static int32_t direct_current_mA(const config_t *config, int32_t map_mA, int32_t weakening_mA)
{
    const int32_t most_mA =
        bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15);
    return q_max(map_mA + weakening_mA, q_min(map_mA, -most_mA));
}

static int32_t map_d_mA(const config_t *config, const motor_model_t *model, int32_t torque_mNm)
{
    const int64_t airgap_mNm = (int64_t)torque_mNm + model->friction_mNm;
    return loss_maps_d_current_mA(config, model->speed_mrad_s, model->winding_temperature_cC,
                                  q_saturate64(airgap_mNm));
}

motor_current_t current_setpoint_unlimited(const config_t *config, const motor_model_t *model,
                                           int32_t torque_mNm, int32_t i_d_weakening_mA)
{
    const int32_t weakening_mA = weakening_within_mA(config, i_d_weakening_mA);
    const int32_t i_d_mA =
        direct_current_mA(config, map_d_mA(config, model, torque_mNm), weakening_mA);
    const motor_current_t out = {
        .d_mA = i_d_mA,
        .q_mA = motor_model_current_q_mA(model, config, torque_mNm, i_d_mA),
    };
    return out;
}

static int64_t square(int32_t x)
{
    return (int64_t)x * x;
}

current_setpoint_t current_setpoint_step(const config_t *config, const motor_model_t *model,
                                         int32_t torque_mNm, int32_t i_d_weakening_mA)
{
    const int32_t most_mA = config->motor.max_phase_current_mA;
    const int32_t weakening_mA = weakening_within_mA(config, i_d_weakening_mA);
    motor_current_t i = current_setpoint_unlimited(config, model, torque_mNm, i_d_weakening_mA);
    const int64_t length2 = square(i.d_mA) + square(i.q_mA);
    const bool limited = length2 > square(most_mA);
    if (limited) {
        /* The map belongs to a torque that cannot be: take the share of it that the circle leaves
         * of both currents. */
        const int32_t length_mA = q_saturate64((int64_t)isqrt64((uint64_t)length2));
        const int32_t map_mA =
            q_scale(map_d_mA(config, model, torque_mNm), most_mA, q_max(length_mA, 1));
        i.d_mA = q_clamp(direct_current_mA(config, map_mA, weakening_mA), -most_mA, most_mA);
        const int32_t left_mA = (int32_t)isqrt64((uint64_t)(square(most_mA) - square(i.d_mA)));
        i.q_mA =
            q_clamp(motor_model_current_q_mA(model, config, torque_mNm, i.d_mA), -left_mA, left_mA);
    }
    const current_setpoint_t out = {
        .i_d_mA = q_clamp(i.d_mA - weakening_mA, -most_mA, most_mA),
        .i_q_mA = i.q_mA,
        .limited = limited,
    };
    return out;
}
