/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config_lines.h: the fields of a configuration as lines of text, "motor.pole_pairs 4", named as in
 * the TOML's image and in the validator's refusals; the unit is in the name. The maps are
 * left out, because each holds hundreds of numbers.
 */
#ifndef APP_CONFIG_LINES_H
#define APP_CONFIG_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/text.h"
#include "config/config.h"

/* Adds the `number`-th (from 0) of the fields whose name begins with `prefix`; false if there are
 * not that many. */
bool config_lines_get(const config_t *config, const char *prefix, uint32_t number, text_t *line);

#endif
