/* SPDX-License-Identifier: Apache-2.0 */
/* configurations.h: the configurations that come with the firmware, and variations of them that the
 * firmware accepts. */
#ifndef ORACLE_CONFIGURATIONS_H
#define ORACLE_CONFIGURATIONS_H

#include <stdbool.h>

#include "config/config.h"
#include "random.h"

enum { CONFIGURATIONS = 5 };

/* 0 <= index < CONFIGURATIONS */
const char *configuration_name(int index);
const config_t *configuration_shipped(int index);

/* Whether the firmware's validator accepts it, with the checksum that this function gives it. */
bool configuration_is_accepted(config_t *config);

/* Changes up to `most` fields at random. A change that the firmware's validator refuses is left
 * out. */
void configuration_vary(config_t *config, random_t *random, int most);

#endif
