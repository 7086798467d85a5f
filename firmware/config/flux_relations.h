/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flux_relations.h: relations of config_t.flux_map, for `validate` alone.
 *
 *     flux_relations.c         the map's
 *     flux_relations_absent.c  for a port whose flash has no space for maps
 * (firmware/motor/flux_map.h): an image with one is refused
 */
#ifndef CONFIG_FLUX_RELATIONS_H
#define CONFIG_FLUX_RELATIONS_H

#include "config/config.h"

/* The text of the first one that does not hold; NULL: all do. config: every field in its range. */
const char *flux_map_broken(const config_t *config);

#endif
