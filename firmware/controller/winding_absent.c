/* SPDX-License-Identifier: Apache-2.0 */
/* A port without flux maps: the constants are the motor. */
#include "winding.h"

const winding_t *winding_at(const config_t *config, const winding_t *constants, winding_path_t path,
                            int32_t winding_temperature_cC, winding_t *out)
{
    (void)config;
    (void)path;
    (void)winding_temperature_cC;
    (void)out;
    return constants;
}
