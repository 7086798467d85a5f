/* SPDX-License-Identifier: Apache-2.0 */
/*
 * finding_times.h: the times of the table of findings (core/findings.h) for a configuration.
 */
#ifndef CONFIG_FINDING_TIMES_H
#define CONFIG_FINDING_TIMES_H

#include "config/config.h"
#include "core/findings.h"

/* A row whose check has a filter of its own counts at once. Divides; once at start. */
void finding_times(const config_t *config, finding_times_t times[FINDING_COUNT]);

#endif
