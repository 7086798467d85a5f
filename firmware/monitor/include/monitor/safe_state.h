/* SPDX-License-Identifier: Apache-2.0 */
/*
 * safe_state.h: what the bridge does without PWM, freewheel or active short circuit. Slow loop,
 * 1 kHz.
 *
 * Of the states whose phase current, charging current and bus voltage are admissible, the one with
 * the smaller braking torque; both computed from the steady state of the machine (DERIVATIONS.md,
 * The safe state). Integers in SI milli-units; the cost is a few divisions, and nearly nothing
 * below the EMF limit.
 */
#ifndef MONITOR_SAFE_STATE_H
#define MONITOR_SAFE_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"
#include "core/measured.h"
#include "core/monitored.h"

/* Of these functions bound_mrad_s is the speed upper bound, mechanical, a magnitude; battery_gone:
 * nothing holds the bus, so freewheel makes neither torque nor current. An end of the bus sensor's
 * range counts as unknown above. Currents beyond 10 kA count as that. */

/* Steady state with the switches of one side closed: no charging current, the bus as it is. */
steady_state_t safe_state_short(const config_t *config, const measured_t *now,
                                int32_t bound_mrad_s);

/* The choice, BRIDGE_OFF or BRIDGE_SHORT; before: that of the step before. An active short circuit
 * ends where freewheel would be chosen at monitor.short_release of the bus voltage as well, and the
 * energy of its current fits into the bus below the devices' rating (short_exit.h). */
safe_state_t safe_state_step(const config_t *config, const measured_t *now, bridge_mode_t before,
                             int32_t bound_mrad_s, bool battery_gone);

/* True if an active short circuit that began now would take the current beyond the over-current
 * trip on its way, where freewheel does not exceed phase current and device voltage. From i the
 * current circles around the settled short circuit's, i_s: up to |i_s| + |i - i_s|. */
bool safe_state_short_surges(const config_t *config, const measured_t *now, int32_t bound_mrad_s,
                             const steady_state_t *freewheel);

/* Without a choice: a switch is stuck closed on this side, BRIDGE_SHORT or BRIDGE_SHORT_HIGH, so
 * the bridge cannot open. Freewheel has no torque and no current then. */
safe_state_t safe_state_shorted(const config_t *config, const measured_t *now, int32_t bound_mrad_s,
                                bridge_mode_t side);

#endif
