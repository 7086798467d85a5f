/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_map.h: the demagnetising current of least loss, from the table in the configuration.
 *
 * For every torque there are many pairs of i_d and i_q; one of them takes the least power out of
 * the battery (or returns the most). The table holds its i_d over torque, speed and, where that is
 * worth it, winding temperature (tools/regen_table, joint minimum of copper, iron and inverter
 * losses); i_q follows from the torque and the i_d that really flows (motor_model.h), so the torque
 * is exact and an interpolated i_d costs power in second order only. Bus voltage is no axis: under
 * a voltage limit the least power lies on the limit, and that is where field weakening at constant
 * torque goes by itself.
 *
 * Torque counts in the direction of rotation: driving is positive, braking negative, whichever way
 * the wheel turns. Linear along every axis; outside the grid the nearest edge counts. All entries
 * 0: i_d = 0 control.
 */
#ifndef TORQUE_CURRENT_MAP_H
#define TORQUE_CURRENT_MAP_H

#include <stdint.h>

#include "config/config.h"

/* Terminal i_d, mA, for an airgap torque (signed, positive forward) at a mechanical speed and a
 * winding temperature. */
int32_t current_map_d_mA(const config_t *config, int32_t speed_mrad_s,
                         int32_t winding_temperature_cC, int32_t airgap_torque_mNm);

#endif
