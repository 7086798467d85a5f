/* SPDX-License-Identifier: Apache-2.0 */
/*
 * regen_map.h: the braking torque that returns the most energy, from the table in the
 * configuration.
 *
 * The table holds the UNCLAMPED optimum (tools/regen_table, closed form) over wheel speed and
 * winding temperature: clamping at run time keeps the interpolation error of a few points
 * negligible, a stored clamped curve would not. Bilinear; outside the grid the nearest edge counts.
 * Below the speed where regeneration begins the stored line goes on below zero, so that it is
 * straight where it begins; what is read there is zero.
 */
#ifndef TORQUE_REGEN_MAP_H
#define TORQUE_REGEN_MAP_H

#include <stdint.h>

#include "config/config.h"

/* Magnitude >= 0 of the loss-optimal braking torque at the airgap, mNm. Symmetric in the sign of
 * speed. */
int32_t regen_map_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                             int32_t winding_temperature_cC);

#endif
