/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bus.h: what lies between the pack's terminals and the bridges: a cable, a contactor and the
 * capacitors.
 *
 *     i_b = (E - v) / R        (0 with the contactor open)        C dv/dt = i_b - i
 *     R = pack + cable
 *
 * bus_step() takes the energy the bridges drew during a step and finds the current i that is
 * constant over it and makes exactly that energy. v(t) then runs exponentially towards E - R i, so
 * means and end are exact for any R C, and
 *
 *     chemical = terminal heat + cable heat + bridges
 *                + change of polarisation + change of capacitor
 *
 * holds to rounding: the heat of the resistances is what the exact integral of v i_b leaves over,
 * never negative.
 *
 * Capacitance 0: no capacitor, the bridges are connected to the end of the cable; the contactor
 * must then be closed. With the contactor open the bridges' energy comes out of the capacitor and
 * goes into it, v^2 = v0^2 - 2 W / C, v at least 0.1 V; a request beyond its energy empties it, and
 * what is missing, of one step, is booked as negative heat of the cable.
 */
#ifndef PLANT_BUS_H
#define PLANT_BUS_H

#include <stdbool.h>

#include "plant/battery.h"
#include "plant/parameter.h"

/* clang-format off */
#define BUS_PARAMETERS(X) \
    X(capacitance_f,         0.0,  10.0, "F",   "of all bridges' capacitors together; 0: none") \
    X(cable_resistance_ohm,  0.0,  10.0, "ohm", "from the pack to the bus, both ways") \
    X(contactor_open,        0.0,  1.0,  "",    "1: the pack is disconnected (needs a capacitance)")
/* clang-format on */

typedef struct {
    BUS_PARAMETERS(PLANT_PARAMETER_MEMBER)
} bus_params_t;

typedef struct {
    double
        voltage_v;  /* at the bridges: at the end of the last step; without a capacitor its mean */
    bool collapsed; /* with a pack: more power was requested than it can give */
} bus_state_t;

typedef struct {
    battery_flow_t battery;
    double cable_j; /* heat */
} bus_flow_t;

/* Charged to the pack's own voltage. */
bus_state_t bus_init(const battery_state_t *battery);

/* dc_j: energy drawn by the bridges during this step, whose length is the battery's. */
bus_flow_t bus_step(const bus_params_t *params, bus_state_t *state,
                    const battery_params_t *battery_params, battery_state_t *battery, double dc_j);

/* Energy in the capacitor. */
double bus_stored_j(const bus_params_t *params, const bus_state_t *state);

#endif
