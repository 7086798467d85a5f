/* SPDX-License-Identifier: Apache-2.0 */
/*
 * current_expectation.h: the current that must flow at a setpoint, for the fast monitor. 1 kHz.
 *
 * It gets a quarter of it: a sampled current vector that falls from above that to zero, from one
 * period to the next, is a sensor's and not the motor's (monitor/DERIVATIONS.md, The fast trip).
 */
#ifndef CONTROLLER_CURRENT_EXPECTATION_H
#define CONTROLLER_CURRENT_EXPECTATION_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"

/* Square of a quarter of the shorter of this setpoint's reference and the one before, Q30, at most
 * that of the largest reference; 0 where they point in different directions, where that is no more
 * than twice what a dead sensor may show, and where the bridge did not switch with the one before.
 * References: 16 bits. */
uint32_t current_expectation(const config_t *config, dq_t reference_pu, dq_t before_pu,
                             bool switching);

#endif
