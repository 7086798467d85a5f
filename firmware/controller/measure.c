/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/measure.h"

#include "core/fault.h"

void measure_init(measure_t *state, const config_t *config, int32_t timer_Hz)
{
    operating_point_init(&state->operating_point, config, timer_Hz);
    angle_choice_init(&state->angle);
    temperatures_init(&state->temperatures, config);
}

/* The fast part's trip. Each can be acknowledged, but for that of the bus sensor, which heals; any
 * other number is a word in memory that was damaged. */
static reason_t trip_of(const fast_report_t *report)
{
    const reason_t trip = report->trip;
    const bool given = trip == REASON_NONE || trip == REASON_BUS_SENSOR ||
                       fault_clearing(trip) == FAULT_CLEARING_ACKNOWLEDGED;
    return given ? trip : REASON_MEMORY;
}

/* A wrong sensor has no name at first; as a cause it counts from the beginning. */
static void report_angle(findings_t *findings, const angle_choice_t *angle, bool switching)
{
    const bool observed = angle->by == ANGLE_BY_OBSERVER;
    findings_set_named(findings, FINDING_ROTOR_SLIPS, FINDING_ROTOR_UNNAMED, angle->name);
    findings_suspect(findings, FINDING_ROTOR_UNNAMED, angle->sensor_wrong);
    findings_set(findings, FINDING_OBSERVER_IN_USE, observed && switching && !angle->sensor_wrong);
}

measured_t measure_step(measure_t *state, const config_t *config, const fast_report_t *report,
                        const slow_input_t *in, const last_t *last, findings_t *findings)
{
    measured_t now = {
        .report = report,
        .in = in,
        .battery = &in->bms,
        .trip = trip_of(report),
    };
    const rotor_view_t rotor = operating_point_rotor(&state->operating_point, config, report);
    const angle_choice_t angle =
        angle_choice_step(&state->angle, config, &rotor, in->demand.fault_reset && last->at_rest);
    const bool observed = angle.by == ANGLE_BY_OBSERVER;
    const rotor_speed_t speed = {
        .turn_q32 = observed ? report->observer.speed_q32 : report->speed_q32,
        .wheel_mrad_s = observed ? rotor.observer_mrad_s : rotor.sensor_mrad_s,
    };
    now.angle_valid = angle.valid;
    now.angle_by = angle.by;
    now.sensor_wrong = angle.sensor_wrong;
    now.rotor_observed = angle.observed;
    now.sensor_mrad_s = rotor.sensor_mrad_s;
    report_angle(findings, &angle, report->bridge == BRIDGE_PWM);
    operating_point_of(&state->operating_point, config, speed, last->temperature.winding_cC, &now);
    temperatures_step(&state->temperatures, config, last, &now, findings);
    return now;
}

void measure_setpoint(const measure_t *state, const config_t *config, int32_t i_d_mA,
                      int32_t i_q_mA, fast_setpoint_t *setpoint)
{
    operating_point_setpoint(&state->operating_point, config, i_d_mA, i_q_mA, setpoint);
}
