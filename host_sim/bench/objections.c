/* SPDX-License-Identifier: Apache-2.0 */
/* Which parameters are no vehicle, and which cannot change during a run. */
#include <math.h>
#include <stddef.h>

#include "bench/bench.h"

const char *bench_world_objection(const bench_params_t *params)
{
    if (params->sensors.sampling_delay_s * params->inverter.pwm_frequency_hz >= 0.5) {
        return "sensors.sampling_delay_s: accepted: less than half a period of "
               "inverter.pwm_frequency_hz";
    }
    const char *const objections[] = {pmsm_objection(&params->motor),
                                      anti_lock_objection(&params->anti_lock),
                                      motion_objection(params)};
    for (size_t k = 0; k < sizeof(objections) / sizeof(objections[0]); k++) {
        if (objections[k] != NULL) {
            return objections[k];
        }
    }
    return NULL;
}

const char *bench_rear_objection(const bench_params_t *front, const bench_params_t *rear)
{
    const double first_rear = floor(front->chassis.wheels_per_axle);
    if (first_rear < 1.0 || first_rear >= floor(front->vehicle.driven_wheels)) {
        return "rear drives: accepted: chassis.wheels_per_axle of 1 and more, and more "
               "vehicle.driven_wheels than that";
    }
    if (front->chassis.rear_driven > 0.5) {
        return "rear drives: accepted: chassis.rear_driven of 0";
    }
    if (rear->inverter.pwm_frequency_hz != front->inverter.pwm_frequency_hz) {
        return "rear drives: accepted: the same inverter.pwm_frequency_hz as in front";
    }
    if (rear->inverter.switching != front->inverter.switching) {
        return "rear drives: accepted: the same inverter.switching as in front";
    }
    return bench_world_objection(rear);
}

const char *bench_objection(const bench_t *bench, const bench_params_t *changed)
{
    if (changed->bus.capacitance_f != bench->params.bus.capacitance_f) {
        return "bus.capacitance_f: cannot be changed during a run";
    }
    if (changed->run.pieces != bench->params.run.pieces) {
        return "run.pieces: cannot be changed during a run";
    }
    if (changed->inverter.switching > 0.5 && bench->pieces > 1) {
        return "inverter.switching: accepted: 0 as long as run.pieces is more than 1";
    }
    if (changed->driver.uses_pedals > 0.5 && !pedals_wired(&bench->config)) {
        return "driver.uses_pedals: accepted: 0, because no pedal is wired in the configuration";
    }
    if (changed->bus.contactor_open > 0.0 && changed->bus.capacitance_f <= 0.0) {
        return "bus.contactor_open: accepted: 0 as long as bus.capacitance_f is 0";
    }
    if ((changed->road.friction > 0.0) != bench->road.slips) {
        return "road.friction: whether wheels slip is decided before the run, accepted: another "
               "value above 0, or 0 as "
               "it was";
    }
    return bench_world_objection(changed);
}
