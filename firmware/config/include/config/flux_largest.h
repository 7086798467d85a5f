/* SPDX-License-Identifier: Apache-2.0 */
/* flux_largest.h: the largest inductance of a flux map, for the full scales of its users. */
#ifndef CONFIG_FLUX_LARGEST_H
#define CONFIG_FLUX_LARGEST_H

#include <stdint.h>

#include "config/config.h"

/* Of either axis, nH: the steepest change of flux between two points, which no chord or tangent
 * exceeds; 0 without a map. config: valid. For start-up. */
int32_t config_flux_map_largest_nH(const config_t *config);

#endif
