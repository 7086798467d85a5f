/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/feed.h"

#include <math.h>
#include <stddef.h>

#include "plant/numbers.h"

/* Two wires may have changed places between bridge and motor. */
static plant_abc_t as_wired(const wheel_t *wheel, const wheel_world_t *world, plant_abc_t x)
{
    const plant_abc_t swapped = {.a = x.a, .b = x.c, .c = x.b};
    return wheel->is_faulty && world->params->fault.wires_swapped > 0.5 ? swapped : x;
}

static plant_abc_t duties(const wheel_t *wheel, const wheel_world_t *world)
{
    const plant_abc_t out = {.a = wheel->active.compare_counts[0] * world->duty_per_count,
                             .b = wheel->active.compare_counts[1] * world->duty_per_count,
                             .c = wheel->active.compare_counts[2] * world->duty_per_count};
    return as_wired(wheel, world, out);
}

/* With faults. The averaged bridge also where the others are switched edge by edge. */
static void break_legs(wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v,
                       const pmsm_step_t *step, feed_flow_t *out)
{
    broken_bridge_command_t command = {
        .mode = BROKEN_BRIDGE_OFF, .duty = duties(wheel, world), .bus_voltage_v = bus_voltage_v};
    switch (wheel->active.bridge) {
    case BRIDGE_PWM:
        command.mode = BROKEN_BRIDGE_PWM;
        break;
    case BRIDGE_SHORT:
        command.mode = BROKEN_BRIDGE_SHORT_LOW;
        break;
    case BRIDGE_SHORT_HIGH:
        command.mode = BROKEN_BRIDGE_SHORT_HIGH;
        break;
    case BRIDGE_OFF:
        break;
    }
    const broken_bridge_flow_t flow =
        broken_bridge_step(&world->params->fault, &wheel->bridge, &wheel->inverter, &wheel->machine,
                           &wheel->rotor, &command, step);
    out->motor = flow.machine;
    out->bridge = flow.bridge;
}

/* Edge by edge. */
static void switch_legs(const wheel_t *wheel, pmsm_state_t *rotor, const wheel_world_t *world,
                        double bus_voltage_v, const pmsm_step_t *step,
                        const switching_watch_t *watch, feed_flow_t *out)
{
    switching_flow_t flow = {.bridge = {.dc_j = 0.0}};
    switch (wheel->active.bridge) {
    case BRIDGE_PWM:
        flow = switching_pwm(&wheel->switching, &wheel->machine, rotor, duties(wheel, world),
                             bus_voltage_v, step, watch);
        break;
    case BRIDGE_SHORT:
    case BRIDGE_SHORT_HIGH: /* equal in the motor */
        flow =
            switching_short(&wheel->switching, &wheel->machine, rotor, bus_voltage_v, step, watch);
        break;
    case BRIDGE_OFF:
        flow = switching_off(&wheel->switching, &wheel->machine, rotor, bus_voltage_v, step, watch);
        break;
    }
    out->motor = flow.machine;
    out->bridge = flow.bridge;
}

/* The averaged bridge, for duration_s. Switching or shorted it puts a voltage in front of the
 * motor; one call for both, so that the motor's step becomes part of this function. */
static void average_legs(const wheel_t *wheel, pmsm_state_t *rotor, const wheel_world_t *world,
                         double bus_voltage_v, double omega_rad_s, double duration_s,
                         feed_flow_t *out)
{
    const inverter_t *inverter = &wheel->inverter;
    pmsm_step_t step = {.omega_rad_s = omega_rad_s, .duration_s = duration_s};
    if (wheel->active.bridge == BRIDGE_OFF) {
        step.series_resistance_ohm = inverter->diode_resistance_ohm;
        out->motor = pmsm_step_rectified(
            &wheel->machine, rotor, inverter_rectifier_ceiling_v(inverter, bus_voltage_v), &step);
        out->bridge = inverter_rectifier_flow(inverter, bus_voltage_v, &out->motor);
        return;
    }
    const bool switches = wheel->active.bridge == BRIDGE_PWM;
    inverter_drive_t drive = {.legs = {0.0, 0.0}};
    step.series_resistance_ohm = inverter->short_resistance_ohm;
    if (switches) {
        drive = inverter_drive(inverter, duties(wheel, world), bus_voltage_v, wheel->zone_a);
        step.series_resistance_ohm = inverter->pwm_resistance_ohm;
        step.opposition = drive.opposition;
    }
    out->motor = pmsm_step(&wheel->machine, rotor, drive.legs, &step);
    out->bridge = switches ? inverter_pwm_flow(inverter, &drive, &out->motor)
                           : inverter_short_flow(&out->motor);
}

void feed_motor(wheel_t *wheel, const wheel_world_t *world, double speed_rad_s,
                double bus_voltage_v, feed_flow_t *out)
{
    const double omega_rad_s = speed_rad_s * world->params->motor.pole_pairs;
    if (wheel->has_broken_bridge) {
        const pmsm_step_t step = {.omega_rad_s = omega_rad_s, .duration_s = world->step_s};
        break_legs(wheel, world, bus_voltage_v, &step, out);
    } else if (world->params->inverter.switching > 0.5) {
        const pmsm_step_t step = {.omega_rad_s = omega_rad_s, .duration_s = world->step_s};
        const switching_watch_t watch = {.shunts = &wheel->shunts,
                                         .settling_s = world->params->sensors.shunt_settling_s};
        switch_legs(wheel, &wheel->rotor, world, bus_voltage_v, &step,
                    watch.settling_s > 0.0 ? &watch : NULL, out);
    } else {
        average_legs(wheel, &wheel->rotor, world, bus_voltage_v, omega_rad_s, world->step_s, out);
    }
}

/* The shunts' amplifiers over a time in which the averaged bridge did `active`. */
static void follow(const wheel_t *wheel, const wheel_world_t *world, shunts_t *shunts,
                   plant_ab_t begin, plant_ab_t end, double until_s)
{
    const bench_params_t *params = world->params;
    const shunts_period_t period = {
        .duty = duties(wheel, world),
        .begin_a = plant_inverse_clarke(begin),
        .end_a = plant_inverse_clarke(end),
        .period_s = 1.0 / params->inverter.pwm_frequency_hz,
        .dead_s = params->inverter.dead_time_s,
    };
    switch (wheel->active.bridge) {
    case BRIDGE_PWM:
        shunts_pwm(shunts, &period, until_s, params->sensors.shunt_settling_s);
        break;
    case BRIDGE_SHORT:
        shunts_short(shunts, &period, until_s, params->sensors.shunt_settling_s);
        break;
    case BRIDGE_SHORT_HIGH: /* no current in the low sides */
    case BRIDGE_OFF:
        shunts_off(shunts, &period, until_s, params->sensors.shunt_settling_s);
        break;
    }
}

void feed_end_period(wheel_t *wheel, const wheel_world_t *world)
{
    const bench_params_t *params = world->params;
    if (params->sensors.shunt_settling_s > 0.0 && params->inverter.switching < 0.5) {
        follow(wheel, world, &wheel->shunts, wheel->at_top, wheel->rotor.terminal,
               1.0 / params->inverter.pwm_frequency_hz);
    }
    wheel->at_top = wheel->rotor.terminal;
}

/* In the motor's wires. */
static plant_abc_t motor_sampled(const wheel_t *wheel, const wheel_world_t *world,
                                 double bus_voltage_v)
{
    const sensors_params_t *sensors = &world->params->sensors;
    const bool through_shunts = sensors->shunt_settling_s > 0.0;
    if (sensors->sampling_delay_s <= 0.0) {
        return through_shunts ? shunts_output(&wheel->shunts)
                              : plant_inverse_clarke(wheel->rotor.terminal);
    }
    pmsm_state_t rotor = wheel->rotor;
    shunts_t shunts = wheel->shunts;
    const double delay_s = sensors->sampling_delay_s;
    const double omega_rad_s = wheel->motion.speed_rad_s * world->params->motor.pole_pairs;
    feed_flow_t nowhere;
    if (world->params->inverter.switching > 0.5) {
        const pmsm_step_t step = {.omega_rad_s = omega_rad_s, .duration_s = world->step_s};
        const switching_watch_t watch = {.shunts = through_shunts ? &shunts : NULL,
                                         .settling_s = sensors->shunt_settling_s,
                                         .until_s = delay_s};
        switch_legs(wheel, &rotor, world, bus_voltage_v, &step, &watch, &nowhere);
    } else {
        average_legs(wheel, &rotor, world, bus_voltage_v, omega_rad_s, delay_s, &nowhere);
        if (through_shunts) {
            follow(wheel, world, &shunts, wheel->rotor.terminal, rotor.terminal, delay_s);
        }
    }
    return through_shunts ? shunts_output(&shunts) : plant_inverse_clarke(rotor.terminal);
}

plant_abc_t feed_sampled(const wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v)
{
    return as_wired(wheel, world, motor_sampled(wheel, world, bus_voltage_v));
}
