/* SPDX-License-Identifier: Apache-2.0 */
/*
 * loss_maps.h: the two look-up tables of least loss in the configuration (tools/regen_table makes
 * them; firmware/torque/README.md, Loss maps). 1 kHz. Linear along every axis; outside the grid the
 * nearest edge counts.
 */
#ifndef TORQUE_LOSS_MAPS_H
#define TORQUE_LOSS_MAPS_H

#include <stdint.h>

#include "config/config.h"
#include "core/grid.h"

/*
 * Optimal regenerative torque map: the braking torque at the airgap that returns the most energy at
 * this wheel speed and winding temperature. Magnitude >= 0, mN m, without any limit. Symmetric in
 * the sign of speed; zero below the speed where regeneration begins.
 */
int32_t loss_maps_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                             int32_t winding_temperature_cC);

/*
 * Minimum-loss d-current map (MTPA and loss-minimising): the terminal i_d, peak phase, mA, that
 * makes an airgap torque (signed, positive forward) with the least power out of the battery. All
 * entries zero: i_d = 0 control.
 */
typedef struct {
    const int32_t *line_mA; /* next lower speed and temperature, from the first torque on */
    int32_t next_speed, next_temperature; /* entries between two of them */
    int32_t speed_q20, temperature_q20;   /* share of the next one */
    int32_t points, step_log2;            /* along torque */
    int32_t zero_mNm;                     /* from the first point to zero torque */
} loss_maps_row_t;

/* Position in the map for a speed and a winding temperature. Once per slow step. */
loss_maps_row_t loss_maps_row_at(const config_t *config, int32_t speed_mrad_s,
                                 int32_t winding_temperature_cC);

/* The same for a torque along the rotation: driving positive, braking negative. */
int32_t loss_maps_row_d_mA(const loss_maps_row_t *row, int32_t along_mNm);

int32_t loss_maps_d_current_mA(const config_t *config, int32_t speed_mrad_s,
                               int32_t winding_temperature_cC, int32_t airgap_torque_mNm);

#endif
