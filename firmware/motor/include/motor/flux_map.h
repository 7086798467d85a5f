/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flux_map.h: flux linkages and incremental inductances of a motor whose iron saturates, at a pair
 * of currents. Slow loop, about 200 instructions.
 *
 * Currents are the torque-producing ones (behind the iron branch), peak phase; i_d with the current
 * as which the temperature of the magnets acts (flux_map_shift_mA()). Fluxes are bilinear over the
 * points of config_t.flux_map; beyond its ends they go on straight for half a step and are constant
 * from there on. The inductances are the changes of flux over one step around the currents, so that
 * they have no steps at the points. Without a map both are those of motor.flux_linkage_nWb,
 * d_inductance_nH and q_inductance_nH.
 */
#ifndef MOTOR_FLUX_MAP_H
#define MOTOR_FLUX_MAP_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

typedef struct {
    int32_t d_nWb, q_nWb;         /* psi_d, psi_q */
    int32_t d_nH, q_nH, cross_nH; /* d psi_d/d i_d, d psi_q/d i_q > 0; d psi_d/d i_q */
} flux_map_point_t;

bool flux_map_present(const config_t *config);

/* Saturates. i_q of either sign: psi_d and the two inductances do not depend on it, psi_q and the
 * cross inductance turn with it. */
flux_map_point_t flux_map_at(const config_t *config, int32_t i_d_mA, int32_t i_q_mA);

/* The d current as which the temperature of the magnets acts, <= 0 when warmer than the map: where
 * psi_d at i_q = 0 is the flux of the magnets. 0 without a map. */
int32_t flux_map_shift_mA(const config_t *config, int32_t winding_temperature_cC);

#endif
