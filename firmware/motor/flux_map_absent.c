/* SPDX-License-Identifier: Apache-2.0 */
/* A port without flux maps: the constants are the motor. */
#include "flux_constants.h"

bool flux_map_present(const config_t *config)
{
    (void)config;
    return false;
}

flux_map_point_t flux_map_at(const config_t *config, int32_t i_d_mA, int32_t i_q_mA)
{
    return flux_map_of_constants(&config->motor, i_d_mA, i_q_mA);
}

int32_t flux_map_shift_mA(const config_t *config, int32_t winding_temperature_cC)
{
    (void)config;
    (void)winding_temperature_cC;
    return 0;
}
