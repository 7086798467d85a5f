/* SPDX-License-Identifier: Apache-2.0 */
/*
 * steps.h: the two steps of the firmware as the oracle sees them. A program that is linked with
 * steps.c and the options of oracle_watches() (CMakeLists.txt) calls the steps through it, without
 * a change of its own.
 */
#ifndef ORACLE_STEPS_H
#define ORACLE_STEPS_H

#include "controller/controller.h"

void oracle_fast(const controller_fast_t *fast, const fast_output_t *output);

/* report: what the step was given. */
void oracle_slow(const controller_slow_t *slow, const fast_report_t *report,
                 const slow_output_t *output, const fast_setpoint_t *setpoint,
                 const torque_limits_t *limits);

#endif
