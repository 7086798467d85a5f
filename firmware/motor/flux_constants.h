/* SPDX-License-Identifier: Apache-2.0 */
/* flux_constants.h: the fluxes of a motor without a map, for flux_map.c and flux_map_absent.c. */
#ifndef MOTOR_FLUX_CONSTANTS_H
#define MOTOR_FLUX_CONSTANTS_H

#include "core/divide.h"
#include "core/q15.h"
#include "motor/flux_map.h"

static inline flux_map_point_t flux_map_of_constants(const config_motor_t *motor, int32_t i_d_mA,
                                                     int32_t i_q_mA)
{
    const flux_map_point_t out = {
        .d_nWb = q_saturate64(motor->flux_linkage_nWb +
                              divide_by_thousand((int64_t)motor->d_inductance_nH * i_d_mA)),
        .q_nWb = q_saturate64(divide_by_thousand((int64_t)motor->q_inductance_nH * i_q_mA)),
        .d_nH = motor->d_inductance_nH,
        .q_nH = motor->q_inductance_nH,
        .cross_nH = 0,
    };
    return out;
}

#endif
