/* SPDX-License-Identifier: Apache-2.0 */
/*
 * measured.h: what is known of this millisecond, in SI. The controller writes it once a slow step
 * (controller/measure.h); monitor, modes, torque and bridge choice read it by const pointer.
 *
 * Currents and voltages are peak phase values in the rotor frame of the angle in use; means are
 * over the averaging window, the PWM periods since the previous report. Motor torque, current and
 * speed are positive when they drive forward, the bus current out of the battery.
 *
 * The raw report and the input stand beside what is derived from them: the monitor reads the report
 * with coarse bounds of its own, so that one wrong derivation cannot deceive torque and monitor
 * alike; a limit or a check reads an input that nothing is derived from where it was sent.
 */
#ifndef CORE_MEASURED_H
#define CORE_MEASURED_H

#include <stdbool.h>
#include <stdint.h>

#include "core/bridge.h"
#include "core/fast_messages.h"
#include "core/frames.h"
#include "core/slow_messages.h"

/* Whose rotor angle is in use. */
typedef enum { ANGLE_BY_SENSOR = 0, ANGLE_BY_OBSERVER = 1 } angle_by_t;

enum { TEMPERATURE_NONE_cC = -32700 }; /* no temperature: colder than any */

typedef struct {
    const fast_report_t *report;     /* as the fast loop sent it */
    const slow_input_t *in;          /* as vehicle, battery and board sent it */
    const battery_limits_t *battery; /* of it, as the battery management reported it */
    reason_t trip;                   /* of the fast monitor; MEMORY where the word is damaged */
    /* Rotor */
    bool angle_valid; /* the angle in use may make torque */
    angle_by_t angle_by;
    bool sensor_wrong;     /* the observer contradicts the rotor sensor */
    bool rotor_observed;   /* the observer knows the angle, whatever the sensor shows */
    int32_t speed_mrad_s;  /* of the angle in use, mechanical, signed */
    int32_t sensor_mrad_s; /* of the rotor sensor, whose angle may not be known yet; likewise */
    /* Means */
    dq_t sampled_pu; /* of the samples, without correction, Q15 */
    int32_t i_d_mA, i_q_mA;
    int32_t bus_voltage_mV;
    int32_t bus_current_mA; /* of this wheel, from phase voltage and current */
    /* Of the latest period */
    int32_t i_d_weakening_mA; /* mean current that field weakening adds to i_d, <= 0 */
    int32_t phase_voltage_mV; /* mean that may be commanded, a reserve below field weakening */
    int32_t latest_i_d_mA, latest_i_q_mA; /* sampled */
    int32_t latest_u_d_mV, latest_u_q_mV; /* applied */
    /* Temperatures */
    const wheel_temperatures_t *shown; /* by the sensors, of any value */
    int32_t winding_temperature_cC; /* of resistance and magnets: the sensor's, else the model's */
    int32_t winding_hotter_cC;      /* how much hotter it is for the limit: of sensor and model the
                                       hotter one */
    int32_t switch_temperature_cC;  /* the hotter of sensor and model: for the limit */
    wheel_temperatures_t sensed;    /* by a sensor alone; TEMPERATURE_NONE_cC: only a model says how
                                       hot it is, and braking torque keeps to these currents, peak
                                       phase, which last for ever */
    int32_t winding_lasting_mA, switch_lasting_mA;
} measured_t;

/* True if the bridge has switched since the last step. */
static inline bool measured_switching(const measured_t *now)
{
    return now->report->bridge == BRIDGE_PWM;
}

/* True if the battery management reports an open contactor. */
static inline bool measured_battery_open(const measured_t *now)
{
    return now->battery->contactor == CONTACTOR_OPEN;
}

#endif
