/* SPDX-License-Identifier: Apache-2.0 */
/* A port without flux maps. */
#include <stddef.h>

#include "flux_relations.h"

const char *flux_map_broken(const config_t *config)
{
    return config->flux_map.d_points == 0 ? NULL : "flux_map.d_points = 0: no maps on this port";
}
