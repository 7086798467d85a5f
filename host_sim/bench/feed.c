#include "bench/feed.h"

#include <math.h>
#include <stddef.h>

#include "plant/numbers.h"

static plant_abc_t duties(const wheel_t *wheel, const wheel_world_t *world)
{
    const plant_abc_t out = {.a = wheel->active.compare_counts[0] * world->duty_per_count,
                             .b = wheel->active.compare_counts[1] * world->duty_per_count,
                             .c = wheel->active.compare_counts[2] * world->duty_per_count};
    return out;
}

/* Edge by edge. */
static pmsm_flow_t switch_legs(const wheel_t *wheel, pmsm_state_t *rotor, const wheel_world_t *world,
                               double bus_voltage_v, const pmsm_step_t *step, const switching_watch_t *watch,
                               inverter_flow_t *bridge)
{
    switching_flow_t flow = {.bridge = {.dc_j = 0.0}};
    switch (wheel->active.bridge) {
    case BRIDGE_PWM:
        flow =
            switching_pwm(&wheel->switching, &wheel->machine, rotor, duties(wheel, world), bus_voltage_v, step, watch);
        break;
    case BRIDGE_SHORT:
        flow = switching_short(&wheel->switching, &wheel->machine, rotor, bus_voltage_v, step, watch);
        break;
    case BRIDGE_OFF:
        flow = switching_off(&wheel->switching, &wheel->machine, rotor, bus_voltage_v, step, watch);
        break;
    }
    *bridge = flow.bridge;
    return flow.machine;
}

static inverter_drive_t drive_of(const wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v,
                                 const pmsm_step_t *step)
{
    const plant_phasor_t half_turn = plant_small_phasor(0.5 * step->omega_rad_s * step->duration_s);
    const plant_ab_t now = wheel->rotor.terminal;
    const plant_ab_t middle = {.alpha = now.alpha * half_turn.cos - now.beta * half_turn.sin,
                               .beta = now.beta * half_turn.cos + now.alpha * half_turn.sin};
    return inverter_drive(&wheel->inverter, duties(wheel, world), bus_voltage_v, plant_inverse_clarke(middle),
                          wheel->zone_a);
}

static pmsm_flow_t switch_bridge(wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v, pmsm_step_t *step,
                                 inverter_flow_t *bridge)
{
    const inverter_t *inverter = &wheel->inverter;
    step->series_resistance_ohm = inverter->pwm_resistance_ohm;
    const inverter_drive_t drive = drive_of(wheel, world, bus_voltage_v, step);
    const pmsm_flow_t flow = pmsm_step(&wheel->machine, &wheel->rotor, drive.source, step);
    *bridge = inverter_pwm_flow(inverter, &drive, &flow);
    return flow;
}

pmsm_flow_t feed_motor(wheel_t *wheel, const wheel_world_t *world, double speed_rad_s, double bus_voltage_v,
                       inverter_flow_t *bridge)
{
    const inverter_t *inverter = &wheel->inverter;
    const plant_ab_t shorted = {0.0, 0.0};
    pmsm_step_t step = {.omega_rad_s = speed_rad_s * world->params->motor.pole_pairs, .duration_s = world->step_s};
    if (world->params->inverter.switching > 0.5) {
        const switching_watch_t watch = {.shunts = &wheel->shunts,
                                         .settling_s = world->params->sensors.shunt_settling_s};
        return switch_legs(wheel, &wheel->rotor, world, bus_voltage_v, &step, watch.settling_s > 0.0 ? &watch : NULL,
                           bridge);
    }
    pmsm_flow_t flow = {.source_j = 0.0};
    switch (wheel->active.bridge) {
    case BRIDGE_PWM:
        flow = switch_bridge(wheel, world, bus_voltage_v, &step, bridge);
        break;
    case BRIDGE_SHORT:
        step.series_resistance_ohm = inverter->short_resistance_ohm;
        flow = pmsm_step(&wheel->machine, &wheel->rotor, shorted, &step);
        *bridge = inverter_short_flow(&flow);
        break;
    case BRIDGE_OFF:
        step.series_resistance_ohm = inverter->diode_resistance_ohm;
        flow = pmsm_step_rectified(&wheel->machine, &wheel->rotor,
                                   inverter_rectifier_ceiling_v(inverter, bus_voltage_v), &step);
        *bridge = inverter_rectifier_flow(inverter, bus_voltage_v, &flow);
        break;
    }
    return flow;
}

/* The shunts' amplifiers over a time in which the averaged bridge did `active`. */
static void follow(const wheel_t *wheel, const wheel_world_t *world, shunts_t *shunts, plant_ab_t begin, plant_ab_t end,
                   double until_s)
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

/* The averaged bridge for a part of the period, on a copy. */
static void look_ahead(const wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v, double until_s,
                       pmsm_state_t *rotor)
{
    const plant_ab_t shorted = {0.0, 0.0};
    const double omega_rad_s = wheel->motion.speed_rad_s * world->params->motor.pole_pairs;
    pmsm_step_t step = {.omega_rad_s = omega_rad_s, .duration_s = world->step_s};
    const inverter_t *inverter = &wheel->inverter;
    switch (wheel->active.bridge) {
    case BRIDGE_PWM: {
        const inverter_drive_t drive = drive_of(wheel, world, bus_voltage_v, &step);
        step.series_resistance_ohm = inverter->pwm_resistance_ohm;
        step.duration_s = until_s;
        pmsm_step(&wheel->machine, rotor, drive.source, &step);
        break;
    }
    case BRIDGE_SHORT:
        step.series_resistance_ohm = inverter->short_resistance_ohm;
        step.duration_s = until_s;
        pmsm_step(&wheel->machine, rotor, shorted, &step);
        break;
    case BRIDGE_OFF:
        step.series_resistance_ohm = inverter->diode_resistance_ohm;
        step.duration_s = until_s;
        pmsm_step_rectified(&wheel->machine, rotor, inverter_rectifier_ceiling_v(inverter, bus_voltage_v), &step);
        break;
    }
}

plant_abc_t feed_seen(const wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v)
{
    const sensors_params_t *sensors = &world->params->sensors;
    const bool through_shunts = sensors->shunt_settling_s > 0.0;
    if (sensors->sampling_delay_s <= 0.0) {
        return through_shunts ? shunts_seen(&wheel->shunts) : plant_inverse_clarke(wheel->rotor.terminal);
    }
    pmsm_state_t rotor = wheel->rotor;
    shunts_t shunts = wheel->shunts;
    if (world->params->inverter.switching > 0.5) {
        const pmsm_step_t step = {.omega_rad_s = wheel->motion.speed_rad_s * world->params->motor.pole_pairs,
                                  .duration_s = world->step_s};
        const switching_watch_t watch = {.shunts = through_shunts ? &shunts : NULL,
                                         .settling_s = sensors->shunt_settling_s,
                                         .until_s = sensors->sampling_delay_s};
        inverter_flow_t nowhere;
        switch_legs(wheel, &rotor, world, bus_voltage_v, &step, &watch, &nowhere);
    } else {
        look_ahead(wheel, world, bus_voltage_v, sensors->sampling_delay_s, &rotor);
        if (through_shunts) {
            follow(wheel, world, &shunts, wheel->rotor.terminal, rotor.terminal, sensors->sampling_delay_s);
        }
    }
    return through_shunts ? shunts_seen(&shunts) : plant_inverse_clarke(rotor.terminal);
}
