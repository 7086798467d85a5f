/* SPDX-License-Identifier: Apache-2.0 */
/*
 * monitored.h: what the monitor concludes in a slow step, beside its findings: how fast the wheel
 * may be turning, and what the bridge does without PWM.
 */
#ifndef CORE_MONITORED_H
#define CORE_MONITORED_H

#include <stdbool.h>
#include <stdint.h>

#include "core/bridge.h"

/* Of freewheel or a short circuit. Magnitudes >= 0. */
typedef struct {
    int32_t torque_mNm;  /* braking, at the airgap, without iron loss */
    int32_t current_mA;  /* peak phase */
    int32_t charging_mA; /* into the bus */
    int32_t bus_mV;      /* that it settles at */
} steady_state_t;

typedef struct {
    bridge_mode_t bridge;     /* BRIDGE_OFF or a short circuit */
    int32_t emf_mV;           /* w psi at the speed upper bound, peak phase */
    steady_state_t freewheel; /* zero below the EMF limit; only with BRIDGE_OFF */
    int32_t torque_mNm;       /* braking, of the state chosen */
} safe_state_t;

typedef struct {
    safe_state_t safe;
    int32_t bound_mrad_s; /* the speed upper bound, mechanical, magnitude */
    bool standstill;      /* it is below monitor.standstill */
    bool at_rest;         /* likewise, and no sensor has shown it by stopping (monitor_speed.h) */
    bool emf_conducts;    /* the EMF drives a current in the safe state: no zero to be seen */
    bool offsets_plausible;
    bool release_trip;        /* the bus is back: the fast loop forgets its over-voltage trip */
    bool release_break;       /* a stuck switch calls for a short circuit: the bridge may leave the
                                 hardware's latch, but not its trip */
    int32_t flux_missing_q15; /* share of the flux that makes no torque, 0 .. 16 384, by a bus
                                 voltage that the battery's message confirms */
    int32_t current_missing_q15; /* share of the current that the sensors do not show, by the
                                    battery's, 0 .. 13 107 */
} monitored_t;

/* Charging current of freewheel, of this motor; 0 in a short circuit. */
static inline int32_t safe_state_charging_mA(const safe_state_t *safe)
{
    return safe->bridge == BRIDGE_OFF ? safe->freewheel.charging_mA : 0;
}

#endif
