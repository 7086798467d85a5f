/* SPDX-License-Identifier: Apache-2.0 */
/*
 * physics.h: relations that hold in any drive, by wide margins in real ones. Beyond them the model
 * of the motor leaves the number formats that it was designed for (firmware/motor/DERIVATIONS.md).
 * tools/regen_table refuses the same, by the keys of the TOML file.
 */
#ifndef CONFIG_PHYSICS_H
#define CONFIG_PHYSICS_H

#include "config/config.h"

/* The text of the first one that does not hold; NULL: all do. config: every field in its range. */
const char *physics_broken(const config_t *config);

#endif
