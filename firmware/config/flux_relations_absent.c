/* SPDX-License-Identifier: Apache-2.0 */
/* A port without flux maps. */
#include <stddef.h>

#include "config/flux_largest.h"
#include "flux_relations.h"

const char *flux_map_broken(const config_t *config)
{
    return config->flux_map.d_points == 0 ? NULL : "flux_map.d_points = 0: no maps on this port";
}

int32_t config_flux_map_largest_nH(const config_t *config)
{
    (void)config;
    return 0;
}
