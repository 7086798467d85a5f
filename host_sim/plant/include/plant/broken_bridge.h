/* SPDX-License-Identifier: Apache-2.0 */
/*
 * broken_bridge.h: bridge and wires with a fault, averaged over the PWM period, on phases.h.
 *
 * Every leg is a voltage behind a resistance, or open; the star point floats, so an open phase
 * leaves two-phase operation and its terminal follows the back-EMF. Of a period, share d belongs to
 * the high side and 1 - d to the low side; in the share of a switch that does not close the diodes
 * conduct: V_bus + V_f while current flows out of the motor, -V_f while it flows in. A leg with
 * diodes alone is open while its terminal lies between the rails.
 *
 *   phase open          the leg is open for ever
 *   phases shorted      two terminals joined by a resistance; their legs share it
 *   switch open         its share goes to the diodes
 *   switch closed       the leg is at its rail, whatever is commanded
 *   leg stuck           as a switch closed, but its driver keeps the other one open
 *
 * Protection: gate drivers with desaturation detection open all switches but the stuck ones and
 * hold the fault line when a switch closes onto a stuck one, or when shorted phases are driven
 * apart for longer than the blanking time. Two periods without PWM release them, so that a short
 * circuit can be commanded; on the other side than the stuck switch's it opens them again. What the
 * short of two phases itself carries does not pass the current sensors at the top of the count,
 * where all low sides conduct, and is left out of the accounts; so is a rectified current of
 * shorted phases.
 *
 * Twenty steps a period; the averaged bridge of inverter.h where nothing is broken: torque and
 * losses agree within 1 %.
 */
#ifndef PLANT_BROKEN_BRIDGE_H
#define PLANT_BROKEN_BRIDGE_H

#include <stdbool.h>

#include "plant/fault.h"
#include "plant/inverter.h"
#include "plant/phases.h"

typedef enum {
    BROKEN_BRIDGE_PWM,
    BROKEN_BRIDGE_OFF,
    BROKEN_BRIDGE_SHORT_LOW,
    BROKEN_BRIDGE_SHORT_HIGH
} broken_bridge_mode_t;

typedef struct {
    broken_bridge_mode_t mode;
    plant_abc_t duty; /* high-side share of each leg, 0 .. 1 */
    double bus_voltage_v;
} broken_bridge_command_t;

typedef struct {
    bool desaturated;  /* the drivers have opened the switches: fault line */
    int quiet_periods; /* since then without PWM */
} broken_bridge_t;

typedef struct {
    pmsm_flow_t machine;
    inverter_flow_t bridge;
} broken_bridge_flow_t;

bool broken_bridge_present(const fault_params_t *params);

/* For step->duration_s; rotor and flow as pmsm_step(). */
broken_bridge_flow_t broken_bridge_step(const fault_params_t *params, broken_bridge_t *state,
                                        const inverter_t *inverter, const pmsm_t *machine,
                                        pmsm_state_t *rotor, const broken_bridge_command_t *command,
                                        const pmsm_step_t *step);

#endif
