/* SPDX-License-Identifier: Apache-2.0 */
/*
 * safe_state.h: what the bridge does without PWM, freewheel or active short circuit. Slow loop,
 * 1 kHz.
 *
 * Of the states whose phase current, charging current and bus voltage are admissible, the one with
 * the smaller braking torque; both computed from the model below (README, The safe state). Integers
 * in SI milli-units; the cost is a few divisions, and nearly nothing below the EMF limit.
 */
#ifndef MONITOR_SAFE_STATE_H
#define MONITOR_SAFE_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/bridge.h"

/* Steady state of one way to let go. Magnitudes >= 0. */
typedef struct {
    int32_t torque_mNm;  /* braking, at the airgap, without iron loss */
    int32_t current_mA;  /* peak phase */
    int32_t charging_mA; /* into the bus */
    int32_t bus_mV;      /* that it settles at */
} letting_go_t;

typedef struct {
    int32_t speed_mrad_s; /* mechanical, magnitude: the speed upper bound */
    int32_t winding_temperature_cC;
    int32_t bus_voltage_mV;    /* an end of the sensor's range counts as unknown above */
    bool battery_open;         /* the contactor is open: nothing holds the bus */
    int32_t charge_current_mA; /* admissible, of this wheel, >= 0 */
    int32_t i_d_mA, i_q_mA;    /* of the latest period, peak phase */
    int32_t turning_mrad_s;    /* mechanical, forward positive, by the sensor that gives the angle
                                  of that current; 0: unknown, the current is in any frame */
    bridge_mode_t bridge;      /* safe state of the step before */
} safe_state_input_t;

typedef struct {
    bridge_mode_t bridge;   /* BRIDGE_OFF or a short circuit */
    int32_t emf_mV;         /* w psi, peak phase */
    letting_go_t freewheel; /* the diodes rectify the EMF into the bus: zero below the EMF limit; at
                               the present bus voltage only with BRIDGE_OFF */
    int32_t torque_mNm;     /* braking, of the state chosen */
} safe_state_t;

/* Switches of one side closed. */
letting_go_t safe_state_short(const config_t *config, const safe_state_input_t *in);

/* The choice. An active short circuit ends where freewheel would be chosen at
 * monitor.short_release of the bus voltage as well, and the energy of its current fits into the
 * bus below the devices' rating (short_exit.h). */
safe_state_t safe_state_step(const config_t *config, const safe_state_input_t *in);

/* True if an active short circuit that began now would take the current beyond the over-current
 * trip on its way, where freewheel does not exceed phase current and device voltage. From i the
 * current circles around the settled short circuit's, i_s: up to |i_s| + |i - i_s|. */
bool safe_state_short_surges(const config_t *config, const safe_state_input_t *in,
                             const letting_go_t *freewheel);

/* Without a choice: a switch is stuck closed on this side, BRIDGE_SHORT or BRIDGE_SHORT_HIGH, so
 * the bridge cannot open. */
safe_state_t safe_state_shorted(const config_t *config, const safe_state_input_t *in,
                                bridge_mode_t side);

#endif
