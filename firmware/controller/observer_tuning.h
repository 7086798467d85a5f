/* SPDX-License-Identifier: Apache-2.0 */
/*
 * observer_tuning.h: what the fast loop's EMF observer needs of the slow loop, and what its report
 * says in the slow loop's terms. 1 kHz.
 */
#ifndef CONTROLLER_OBSERVER_TUNING_H
#define CONTROLLER_OBSERVER_TUNING_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "controller/operating_point.h"
#include "core/fast_messages.h"

/* modulation_limit_q15: foc_modulation_limit_q15(). Divides. */
observer_constants_t observer_constants(const config_t *config, int32_t modulation_limit_q15);

/* By how much the observer's flux leads the rotor, with the sign of the speed: atan(c cot(w T/2)),
 * to 0.2 degrees. A quarter turn at standstill. Divides. */
uint16_t observer_lead_turn(const observer_leak_t *leak, int32_t speed_q32);

/* lambda one millisecond later: towards half the speed in a salient machine, at most its start's.
 * speed_q32: 0 at a start. Divides. */
void observer_leak_step(observer_leak_t *leak, const observer_constants_t *constants,
                        int32_t speed_q32, bool acquired);

/* |x| of the magnets' flux at a speed: flux_q14 cos(lead). */
int32_t observer_expected_flux_q14(const observer_constants_t *constants, uint16_t lead_turn);

/* For the present bus voltage, winding temperature and lead; not in use. */
observer_tuning_t observer_tuning(const observer_constants_t *constants, const winding_t *winding,
                                  const observer_leak_t *leak, const config_t *config,
                                  int32_t v_dc_pu, uint16_t lead_turn,
                                  int32_t winding_temperature_cC);

#endif
