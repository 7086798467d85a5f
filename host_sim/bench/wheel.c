/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/wheel.h"

#include <math.h>
#include <stddef.h>

#include "bench/feed.h"
#include "config/bases.h"
#include "hal/analog_curve.h"
#include "plant/numbers.h"

enum { MILLI = 1000, CENTI = 100, PERCENT = 100 };
enum { BRAKE_SENSOR_STREAM = 2000 }; /* of random numbers, and on: bench.c */
static const double SLOW_STEP_S = 1.0 / CONTROLLER_SLOW_RATE_HZ;
static const double ON = 0.5; /* a switch given as a number */

wheel_world_t wheel_world(const bench_params_t *params, const config_t *config)
{
    const wheel_world_t out = {
        .params = params,
        .config = config,
        .sensors = sensors_init(&params->sensors),
        .step_s =
            1.0 / (params->inverter.pwm_frequency_hz * plant_max(floor(params->run.pieces), 1.0)),
        .duty_per_count = 1.0 / bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz),
    };
    return out;
}

static fast_output_t bridge_off(void)
{
    const fast_output_t out = {.compare_counts = {0, 0, 0}, .bridge = BRIDGE_OFF};
    return out;
}

void wheel_init(wheel_t *wheel, const wheel_world_t *world, int index)
{
    const bench_params_t *params = world->params;
    const wheel_t empty = {.first_fault = REASON_NONE};
    *wheel = empty;
    controller_init(&wheel->controller, world->config, BASES_MODEL_TIMER_Hz);
    wheel->to_fast = controller_initial_setpoint(world->config, BASES_MODEL_TIMER_Hz);
    wheel->active = bridge_off();
    wheel->next = bridge_off();
    wheel->rotor = pmsm_at_rest(params->run.rotor_turn + index * params->run.rotor_spread_turn);
    wheel->rotor.shaft_turn = wheel->rotor.theta_turn / params->motor.pole_pairs;
    wheel->shaft =
        encoder_begin(&params->encoder, params->motor.pole_pairs, wheel->rotor.theta_turn, 0);
    wheel->random = random_init((uint64_t)params->run.seed, (uint64_t)index);
    wheel->index = index;
    wheel_begin(wheel, world);
}

void wheel_begin(wheel_t *wheel, const wheel_world_t *world)
{
    const bench_params_t *params = world->params;
    const thermal_params_t *thermal = &params->thermal;
    const wheel_totals_t empty = {.copper_j = 0.0};
    wheel->totals = empty;
    wheel->peak_a2 = 0.0;
    wheel->heat_winding_j = 0.0;
    wheel->heat_iron_j = 0.0;
    wheel->heat_switches_j = 0.0;
    wheel->brake = hydraulic_brake_init(&params->brake, world->step_s);
    wheel->brake_sensor = brake_sensor_init(
        random_init((uint64_t)params->run.seed, BRAKE_SENSOR_STREAM + (uint64_t)wheel->index));
    const bool active = thermal->active > 0.5;
    const thermal_row_t motor = {
        .inner_j_per_k = active ? thermal->winding_heat_capacity_j_per_k : 0.0,
        .inner_k_per_w = thermal->winding_thermal_resistance_k_per_w,
        .outer_j_per_k = thermal->housing_heat_capacity_j_per_k,
        .outer_k_per_w = thermal->housing_thermal_resistance_k_per_w,
    };
    const thermal_row_t bridge = {
        .inner_j_per_k = active ? thermal->switch_heat_capacity_j_per_k : 0.0,
        .inner_k_per_w = thermal->switch_thermal_resistance_k_per_w,
        .outer_j_per_k = thermal->heatsink_heat_capacity_j_per_k,
        .outer_k_per_w = thermal->heatsink_thermal_resistance_k_per_w,
    };
    const double winding_c =
        thermal->winding_temperature_c + params->wheel[wheel->index].winding_rise_k;
    wheel->winding = thermal_init(&motor, winding_c, SLOW_STEP_S);
    wheel->winding_sensor = temperature_sensor_at(winding_c);
    wheel->switch_sensor = temperature_sensor_at(thermal->switch_temperature_c);
    wheel->switches = thermal_init(&bridge, thermal->switch_temperature_c, SLOW_STEP_S);
    wheel_refresh(wheel, world);
}

static void at_temperature(wheel_t *wheel, const wheel_world_t *world)
{
    wheel->machine = pmsm_at_temperature(&world->params->motor, wheel->winding.temperature_c);
    if (wheel->is_faulty) {
        wheel->machine.flux_wb *= 1.0 - world->params->fault.magnet_loss;
    }
    wheel->inverter = inverter_model(&world->params->inverter, wheel->switches.temperature_c);
    wheel->switching = switching_model(&world->params->inverter, wheel->switches.temperature_c);
}

static bool is_concerned(const wheel_t *wheel, const fault_params_t *fault)
{
    const unsigned wheels = (unsigned)fault->wheels;
    return wheels == 0U || (wheels >> (unsigned)wheel->index & 1U) != 0U;
}

void wheel_refresh(wheel_t *wheel, const wheel_world_t *world)
{
    const bench_params_t *params = world->params;
    const one_wheel_params_t *own = &params->wheel[wheel->index];
    if (wheel->winding.fixed) {
        wheel->winding.temperature_c = params->thermal.winding_temperature_c + own->winding_rise_k;
    }
    if (wheel->switches.fixed) {
        wheel->switches.temperature_c = params->thermal.switch_temperature_c;
    }
    wheel->friction = own->road_friction > 0.0 ? own->road_friction : params->road.friction;
    wheel->is_faulty = is_concerned(wheel, &params->fault);
    wheel->has_broken_bridge = wheel->is_faulty && broken_bridge_present(&params->fault);
    wheel->has_broken_program = wheel->is_faulty && injection_present(&params->fault);
    if (!wheel->has_broken_program) {
        wheel->injection.has_restarted = false;
    }
    if (!wheel->has_broken_bridge) {
        wheel->bridge.desaturated = false;
    }
    wheel->has_broken_link = wheel->is_faulty && link_fault_present(&params->fault);
    if (!wheel->has_broken_link) {
        link_reset(&wheel->link);
    }
    at_temperature(wheel, world);
    hydraulic_brake_refresh(&params->brake, &wheel->brake, own->brake_torque_loss, world->step_s);
    const bool had_broken_sensors = wheel->has_broken_sensors;
    wheel->has_broken_sensors = wheel->is_faulty && sensor_fault_present(&params->fault);
    if (!had_broken_sensors) {
        const sensor_fault_t healthy = {.has_codes = false};
        wheel->broken_sensors = healthy;
    }
    wheel->fault.hall_stuck_low =
        (uint8_t)((unsigned)params->sensors.hall_stuck_low | (unsigned)own->hall_stuck_low);
    wheel->fault.hall_stuck_high =
        (uint8_t)((unsigned)params->sensors.hall_stuck_high | (unsigned)own->hall_stuck_high);
}

static int32_t rounded(double x, int32_t scale)
{
    return (int32_t)lround(x * scale);
}

static void warm(wheel_t *wheel, const wheel_world_t *world)
{
    const double ambient_c = world->params->thermal.ambient_temperature_c;
    thermal_step(&wheel->winding, wheel->heat_winding_j, wheel->heat_iron_j, ambient_c);
    thermal_step(&wheel->switches, wheel->heat_switches_j, 0.0, ambient_c);
    wheel->heat_winding_j = 0.0;
    wheel->heat_iron_j = 0.0;
    wheel->heat_switches_j = 0.0;
    if (!wheel->winding.fixed || !wheel->switches.fixed) {
        at_temperature(wheel, world);
    }
}

/* What a port makes of a sensor's code by the configuration's curve; of a sensor that is no
 * resistance what it reports. */
static double measured_c(const winding_sensor_params_t *params, temperature_sensor_t *sensor,
                         double temperature_c, bool broken, const analog_curve_t *curve)
{
    const double before_c = sensor->reported_c;
    double seen_c = temperature_sensor_step(params, sensor, temperature_c, broken, SLOW_STEP_S);
    if (params->kind > 0.5) {
        const int32_t code = temperature_sensor_code(params, sensor, broken);
        seen_c = params->stuck > 0.5 ? before_c : 0.01 * analog_curve_cC(curve, code);
        sensor->reported_c = seen_c;
    }
    return seen_c;
}

/* The winding's temperature by its sensor. */
static double measured_winding_c(wheel_t *wheel, const bench_params_t *params,
                                 const config_temperature_t *believed)
{
    const one_wheel_params_t *own = &params->wheel[wheel->index];
    const bool broken = own->winding_sensor_open > 0.5 || own->winding_sensor_shorted > 0.5;
    const analog_curve_t curve = {believed->winding_cC, believed->winding_lowest_code,
                                  believed->winding_highest_code};
    return measured_c(&params->winding_sensor, &wheel->winding_sensor, wheel->winding.temperature_c,
                      broken, &curve);
}

static double measured_switches_c(wheel_t *wheel, const bench_params_t *params,
                                  const config_temperature_t *believed)
{
    const analog_curve_t curve = {believed->switch_cC, believed->switch_lowest_code,
                                  believed->switch_highest_code};
    return measured_c(&params->switch_sensor, &wheel->switch_sensor, wheel->switches.temperature_c,
                      false, &curve);
}

static injection_target_t target_of(wheel_t *wheel, const wheel_world_t *world)
{
    const injection_target_t out = {
        .controller = &wheel->controller, .config = world->config, .to_fast = &wheel->to_fast};
    return out;
}

static slow_output_t coupled_millisecond(wheel_t *wheel, const wheel_world_t *world,
                                         const slow_input_t *in)
{
    const wheel_coupling_t *coupling = wheel->coupling;
    if (coupling->break_down != NULL) {
        coupling->break_down(coupling->context, wheel->is_faulty ? &world->params->fault : NULL);
    }
    return coupling->millisecond(coupling->context, in);
}

/* For another processor. */
static const fault_params_t *program_fault(const wheel_t *wheel, const wheel_world_t *world)
{
    return wheel->has_broken_program ? &world->params->fault : NULL;
}

/* Of the hydraulic brake's torque sensor; what is wrong with it shows in new messages only. */
static brake_sensor_report_t brake_report(wheel_t *wheel, const bench_params_t *params)
{
    brake_sensor_report_t *report = &wheel->brake_sensor.report;
    injection_brake_step(&params->fault, &wheel->injection);
    brake_sensor_step(&params->brake_sensor, &wheel->brake_sensor, wheel->brake_capacity_nm);
    if (wheel->is_faulty && report->age_ms == 0) {
        report->torque_nm =
            injection_report_nm(&params->fault, &wheel->injection, report->torque_nm,
                                params->brake.max_hydraulic_torque_nm);
    }
    return *report;
}

void wheel_slow(wheel_t *wheel, const wheel_world_t *world, const wheel_order_t *order)
{
    warm(wheel, world);
    pmsm_rest(&wheel->rotor);
    wheel->fault.offset_a =
        world->params->wheel[wheel->index].current_offset_a + order->current_drift_a;
    const brake_sensor_report_t brake = brake_report(wheel, world->params);
    slow_input_t in = {
        .demand = {.drive_torque_mNm = rounded(order->drive_nm, MILLI),
                   .brake_torque_mNm = rounded(order->brake_nm, MILLI),
                   .direction = order->direction,
                   .enable = order->enable,
                   .abs_active = order->abs_active,
                   .fault_reset = order->fault_reset,
                   .abs_motor_share_percent = (uint8_t)rounded(order->abs_motor_share, PERCENT),
                   .reason = order->demand_reason},
        .demand_age_ms = (uint32_t)rounded(order->demand_age_s, MILLI),
        .bms = {.charge_current_mA = rounded(order->charge_limit_a, MILLI),
                .discharge_current_mA = rounded(order->discharge_limit_a, MILLI),
                .charge_peak_current_mA = rounded(order->peak_charge_a, MILLI),
                .voltage_mV = rounded(order->pack_voltage_v, MILLI),
                .current_mA = rounded(order->pack_current_a, MILLI),
                .current_given = order->pack_current_given,
                .contactor = (contactor_t)order->contactor},
        .hydraulic = {.torque_mNm = rounded(brake.torque_nm, MILLI),
                      .age_ms = (uint32_t)brake.age_ms,
                      .valid = brake.valid},
        .temperature = {.winding_cC = rounded(
                            measured_winding_c(wheel, world->params, &world->config->temperature),
                            CENTI),
                        .switch_cC = rounded(
                            measured_switches_c(wheel, world->params, &world->config->temperature),
                            CENTI)},
        .selftest_passed = true,
        .config_accepted = !world->config_damaged,
    };
    if (wheel->has_broken_link) {
        link_step(&world->params->fault, &wheel->link, world->config, &in);
    }
    if (wheel->coupling != NULL) {
        wheel->slow = coupled_millisecond(wheel, world, &in);
    } else if (wheel->processor != NULL) {
        wheel->slow = wheel->processor->slow(wheel->processor->context, wheel->index,
                                             program_fault(wheel, world), &in, &wheel->controller);
    } else if (wheel->has_broken_program) {
        const injection_target_t target = target_of(wheel, world);
        wheel->slow =
            injection_slow(&world->params->fault, &wheel->injection, &target, &in, &wheel->slow);
    } else {
        fast_report_t report;
        controller_fast_report(&wheel->controller.fast, &report);
        wheel->slow = controller_slow_step(&wheel->controller.slow, world->config, &report, &in,
                                           &wheel->to_fast);
    }
    const double commanded_nm = wheel->slow.hydraulic_valid
                                    ? (double)wheel->slow.hydraulic_torque_mNm / MILLI
                                    : order->pedal_nm;
    const double late_nm =
        injection_hydraulic_nm(&world->params->fault, &wheel->injection, commanded_nm);
    hydraulic_brake_command(&world->params->brake, &wheel->brake,
                            wheel->is_faulty ? late_nm : commanded_nm);
    const pmsm_step_t period = {.omega_rad_s =
                                    wheel->motion.speed_rad_s * world->params->motor.pole_pairs,
                                .duration_s = wheel->inverter.period_s,
                                .series_resistance_ohm = wheel->inverter.pwm_resistance_ohm};
    wheel->zone_a = inverter_zone_a(&wheel->inverter, order->bus_voltage_v,
                                    pmsm_amperes_per_volt(&wheel->machine, &wheel->rotor, &period));
    if (wheel->first_fault == REASON_NONE && wheel->slow.fault_reason != REASON_NONE) {
        wheel->first_fault = wheel->slow.fault_reason;
        wheel->first_fault_s = order->time_s;
    }
}

void wheel_sample(wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v)
{
    const bench_params_t *params = world->params;
    feed_end_period(wheel, world);
    if (wheel->coupling == NULL) {
        wheel->active = wheel->next;
    }
    const bool drivers_off = wheel->is_faulty && params->fault.gate_driver > ON;
    if (drivers_off) {
        wheel->active.bridge = BRIDGE_OFF;
    }
    wheel->sampled_a = feed_sampled(wheel, world, bus_voltage_v);
    sensor_view_t view = {.current_a = wheel->sampled_a,
                          .bus_voltage_v = bus_voltage_v,
                          .theta_turn = wheel->rotor.theta_turn};
    if (wheel->has_broken_sensors) {
        view = sensor_fault_before(&params->fault, &wheel->broken_sensors, &view,
                                   params->sensors.current_full_scale_a,
                                   1.0 / params->inverter.pwm_frequency_hz);
    }
    sensors_sample_t sample = sensors_sample(&world->sensors, &wheel->fault, &wheel->random,
                                             view.current_a, view.bus_voltage_v, view.theta_turn);
    if (wheel->has_broken_sensors) {
        sensor_fault_after(&params->fault, &wheel->broken_sensors, &wheel->random, &sample);
    }
    const encoder_sample_t counted =
        encoder_read(&params->encoder, params->motor.pole_pairs, &wheel->shaft, view.theta_turn);
    const fast_input_t in = {
        .phase_current_code = {sample.phase_current_code[0], sample.phase_current_code[1],
                               sample.phase_current_code[2]},
        .bus_voltage_code = sample.bus_voltage_code,
        .rotor_angle_turn = sample.rotor_angle_turn,
        .encoder = {.count = counted.count,
                    .index_count = counted.index_count,
                    .index = counted.index && !(wheel->is_faulty && params->fault.index_lost > ON)},
        .hall_state = sample.hall_state,
        .power_stage_fault = drivers_off || wheel->bridge.desaturated,
    };
    if (wheel->coupling != NULL) {
        wheel->active = wheel->coupling->period(wheel->coupling->context, &in);
        return;
    }
    if (wheel->processor != NULL) {
        wheel->processor->fast(wheel->processor->context, wheel->index, program_fault(wheel, world),
                               &in);
        return;
    }
    if (wheel->has_broken_program) {
        const injection_target_t target = target_of(wheel, world);
        injection_fast(&params->fault, &wheel->injection, &target, &in, &wheel->next);
        return;
    }
    wheel->next =
        *controller_fast_step(&wheel->controller.fast, world->config, &wheel->to_fast, &in);
}

wheel_flow_t wheel_step(wheel_t *wheel, const wheel_world_t *world, double speed_rad_s,
                        double bus_voltage_v)
{
    feed_flow_t fed;
    feed_motor(wheel, world, speed_rad_s, bus_voltage_v, &fed);
    const pmsm_flow_t *flow = &fed.motor;
    const inverter_flow_t *bridge = &fed.bridge;
    wheel->brake_capacity_nm = hydraulic_brake_step(&wheel->brake);
    if (wheel->is_faulty) {
        wheel->brake_capacity_nm *= injection_brake_share(&world->params->fault, &wheel->injection);
        wheel->brake_capacity_nm +=
            world->params->fault.hydraulic_drag * world->params->brake.max_hydraulic_torque_nm;
    }

    if (!bridge_is_short(wheel->active.bridge)) {
        const plant_ab_t i = wheel->rotor.terminal;
        wheel->peak_a2 = plant_max(wheel->peak_a2, i.alpha * i.alpha + i.beta * i.beta);
    }
    wheel_totals_t *totals = &wheel->totals;
    const double bridge_heat_j = bridge->conduction_j + bridge->diode_j + bridge->switching_j;
    totals->copper_j += flow->copper_j;
    totals->iron_j += flow->iron_j;
    totals->conduction_j += bridge->conduction_j;
    totals->diode_j += bridge->diode_j;
    totals->switching_j += bridge->switching_j;
    totals->dc_j += bridge->dc_j;
    totals->torque_impulse_nms += flow->torque_nms;
    wheel->heat_winding_j += flow->copper_j;
    wheel->heat_iron_j += flow->iron_j;
    wheel->heat_switches_j += bridge_heat_j;
    const wheel_flow_t out = {
        .dc_j = bridge->dc_j,
        .airgap_nms = flow->torque_nms,
        .viscous_nms = world->params->motor.viscous_friction_nm_s * speed_rad_s * world->step_s,
        .friction_capacity_nm = wheel->brake_capacity_nm + world->params->motor.friction_torque_nm,
    };
    return out;
}

void wheel_settle(wheel_t *wheel, const wheel_world_t *world, const wheel_flow_t *flow,
                  double speed_rad_s, double friction_used)
{
    wheel_totals_t *totals = &wheel->totals;
    const double used_s = friction_used * world->step_s;
    const double bearing_nms = flow->viscous_nms + world->params->motor.friction_torque_nm * used_s;
    const double hydraulic_nms = wheel->brake_capacity_nm * used_s;
    totals->shaft_j += (flow->airgap_nms - bearing_nms) * speed_rad_s;
    totals->bearing_j += bearing_nms * speed_rad_s;
    totals->hydraulic_impulse_nms += hydraulic_nms;
    totals->hydraulic_j += hydraulic_nms * speed_rad_s;
}
