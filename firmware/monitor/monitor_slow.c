/* SPDX-License-Identifier: Apache-2.0 */
#include "config/bases.h"
#include "core/divide.h"
#include "core/q15.h"
#include "monitor/monitor.h"
#include "monitor/monitor_temperature.h"

enum {
    FLOW_TOLERANCE_SHARE = 4, /* fast steps in a slow step may differ by a quarter */
    SUM_AT_END_PU = 30720,    /* 15/16 of the range */
    OFFSET_SCALE = 16,        /* offsets are codes * 16 */
    OFFSET_MID_CODE = 2048
};

void monitor_slow_init(monitor_slow_state_t *state)
{
    const monitor_slow_state_t zero = {.started = false};
    *state = zero;
}

/* Debounce: true once a condition has lasted for `limit` consecutive steps. */
static bool qualified(uint16_t *steps, bool condition, int32_t limit)
{
    *steps = condition ? (uint16_t)q_min(*steps + 1, UINT16_MAX) : (uint16_t)0;
    return *steps >= limit;
}

/* Braking torque that no current within the limits may prevent: all of it where even the largest
 * demagnetising current may leave more voltage than the bus has. Coarse: it contains what the
 * torque limits count on (README, Natural torque). */
int32_t monitor_forced_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                                  int32_t bus_voltage_mV)
{
    const config_motor_t *motor = &config->motor;
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, q_abs(speed_mrad_s));
    const int64_t weakening_mA =
        bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15);
    const int64_t weakened_nWb =
        motor->flux_linkage_nWb - divide_by_thousand(weakening_mA * motor->d_inductance_nH);
    const int64_t left_mV = divide_by_billion(w_mrad_s * (weakened_nWb > 0 ? weakened_nWb : 0)) +
                            divide_by_million(weakening_mA * motor->phase_resistance_uOhm) * 3 / 2;
    const config_current_loop_t *loop = &config->current_loop;
    const int32_t share_q15 =
        q_scale(loop->modulation_limit_pu_q15,
                loop->modulation_target_pu_q15 - loop->modulation_reserve_pu_q15, 32768);
    const int64_t used_mV = q_scale(q_max(bus_voltage_mV, 0), share_q15, 32768);
    return left_mV * 1732 > used_mV * 1000 * 7 / 8 ? motor->max_torque_mNm : 0;
}

/* Torque beyond the command: more than commanded in its direction, or any in the other, apart from
 * the braking that the voltage forces. A torque below the command is no hazard: brake blending adds
 * it to the hydraulic command. */
static bool torque_unwanted(const config_t *config, const monitor_slow_input_t *in)
{
    const int64_t tolerance_mNm =
        config->monitor.torque_tolerance_mNm; /* 64 bits: no input is trusted */
    const int64_t above_mNm =
        in->torque_estimate_mNm - (q_max(in->torque_command_mNm, 0) + tolerance_mNm);
    const int64_t below_mNm =
        q_min(in->torque_command_mNm, 0) - tolerance_mNm - in->torque_estimate_mNm;
    if (above_mNm <= 0 && below_mNm <= 0) {
        return false;
    }
    const int64_t braking_mNm = in->speed_mrad_s >= 0 ? below_mNm : above_mNm;
    return braking_mNm <= 0 ||
           braking_mNm > monitor_forced_torque_mNm(config, in->speed_mrad_s, in->bus_voltage_mV);
}

/* Without a valid angle the torque leaves in its ramp, which must not be cut off in the middle. */
static int32_t rotor_qualify_steps(const config_t *config)
{
    return q_scale(config->motor.max_torque_mNm, 1000, config->brake.torque_rate_mNm_s) +
           config->monitor.rotor_fault_time_ms;
}

/* A slow step that comes twice finds every other count right; without PWM none has tripped yet. */
static bool flow_broken(monitor_slow_state_t *state, const config_t *config,
                        uint16_t fast_step_count)
{
    const int32_t expected = config->drive.pwm_frequency_Hz / 1000;
    const int32_t counted = (uint16_t)(fast_step_count - state->last_fast_step);
    state->last_fast_step = fast_step_count;
    if (!state->started) {
        state->started = true;
        return false;
    }
    const int32_t tolerance = expected / FLOW_TOLERANCE_SHARE;
    const int32_t weight = counted > MONITOR_STALE_STEPS * expected    ? MONITOR_FLOW_FAULT
                           : counted - expected > expected - tolerance ? MONITOR_FLOW_TWICE
                           : q_abs(counted - expected) > tolerance     ? MONITOR_FLOW_WRONG
                                                                       : MONITOR_FLOW_RIGHT;
    state->flow_level = (uint16_t)q_clamp(state->flow_level + weight, 0, MONITOR_FLOW_FAULT);
    return state->flow_level >= MONITOR_FLOW_FAULT;
}

/* A bus that collapses under a motor takes the control of its current away. */
static bool overcurrent_of_bus(const monitor_slow_state_t *state, const monitor_slow_input_t *in)
{
    return in->fast_trip == REASON_OVERCURRENT && state->return_steps > 0 && state->bus_was_low;
}

static bool fast_trip_of_bus(const monitor_slow_input_t *in)
{
    return in->fast_trip == REASON_BUS_OVERVOLTAGE || in->fast_trip == REASON_BUS_SENSOR;
}

/* A reading that rose faster than a bus can, or that is lower than a motor can make one. In the
 * step in which a bus falls below its trip its mean may still contain what was before. */
static void watch_bus_sensor(monitor_slow_state_t *state, const config_t *config,
                             const monitor_slow_input_t *in)
{
    const bool empty =
        (int64_t)in->bus_voltage_mV * MONITOR_BUS_EMPTY_SHARE < config->drive.voltage_full_scale_mV;
    const bool wrong =
        in->fast_trip == REASON_BUS_SENSOR || (empty && state->bus_was_low && !in->battery_open);
    state->bus_sensor_wrong = state->return_steps > 0 && (wrong || state->bus_sensor_wrong);
}

/* A bus beyond a trip, or one that no battery holds, puts the bridge into its safe state at once,
 * here or by the fast trip. A contactor that opens does that, and the battery's message explains it
 * later. True where none has and the bus is not back either. */
static bool bus_unexplained(monitor_slow_state_t *state, const config_t *config,
                            const monitor_slow_input_t *in)
{
    const config_battery_t *battery = &config->battery;
    const config_monitor_t *monitor = &config->monitor;
    const bool high = in->bus_voltage_mV > battery->overvoltage_trip_mV || fast_trip_of_bus(in);
    const bool overcurrent = in->fast_trip == REASON_OVERCURRENT;
    const bool low = (in->bridge == BRIDGE_PWM || overcurrent) && !in->battery_open &&
                     in->bus_voltage_mV < battery->undervoltage_trip_mV;
    const bool back =
        in->bus_voltage_mV < (battery->max_voltage_mV + battery->overvoltage_trip_mV) / 2 &&
        in->bus_voltage_mV >= battery->undervoltage_trip_mV && !overcurrent;
    const bool swings = monitor_bus_swings(&state->swing, battery, in->bus_voltage_mV,
                                           in->bridge == BRIDGE_PWM && !in->battery_open);
    if (high || low || swings) {
        state->bus_was_low = low || (state->bus_was_low && state->return_steps > 0);
        state->return_steps = MONITOR_BUS_RETURN_STEPS;
    } else if (back && state->return_steps > 0) {
        state->return_steps--;
    }
    state->open_steps =
        (uint16_t)(in->battery_open ? MONITOR_BUS_RETURN_STEPS : q_max(state->open_steps - 1, 0));
    watch_bus_sensor(state, config, in);
    state->release_trip =
        (back && fast_trip_of_bus(in)) || (in->battery_open && overcurrent_of_bus(state, in));
    return qualified(&state->bus_steps, state->return_steps > 0 && !back && !in->battery_open,
                     monitor->battery_message_time_ms +
                         (state->bus_was_low ? monitor->voltage_fault_time_ms : 0));
}

static bool too_hot(const config_t *config, int32_t temperature_cC, int32_t limit_cC)
{
    return limit_cC < MONITOR_TEMPERATURE_OFF_cC &&
           !monitor_temperature_outside(config, temperature_cC) &&
           temperature_cC > limit_cC + config->monitor.overtemperature_margin_cC;
}

/* An estimate in place of a broken sensor derates, but is no fault. */
static reason_t temperature_fault(const config_t *config, const monitor_slow_input_t *in)
{
    if (!in->winding_sensor_broken &&
        too_hot(config, in->winding_temperature_cC, config->motor.max_winding_temperature_cC)) {
        return REASON_WINDING_OVERTEMPERATURE;
    }
    return !in->switch_sensor_broken && too_hot(config, in->switch_temperature_cC,
                                                config->drive.max_switch_temperature_cC)
               ? REASON_SWITCH_OVERTEMPERATURE
               : REASON_NONE;
}

static reason_t sensor_warning(const monitor_slow_input_t *in)
{
    return in->winding_sensor_broken  ? REASON_WINDING_SENSOR
           : in->switch_sensor_broken ? REASON_SWITCH_SENSOR
                                      : REASON_NONE;
}

/* A skipped sector is a warning for a while: one may be dirt, a dead sensor makes one every
 * electrical turn. So is a sensor that stops faster than a tyre can stop the vehicle. */
static bool rotor_warning(monitor_slow_state_t *state, const config_t *config,
                          uint16_t rotor_faults)
{
    if (rotor_faults != state->last_rotor_faults) {
        state->warning_steps = (uint16_t)config->monitor.rotor_warning_time_ms;
    } else if (state->warning_steps > 0) {
        state->warning_steps--;
    }
    state->last_rotor_faults = rotor_faults;
    return state->warning_steps > 0;
}

static bool offsets_plausible(const config_t *config, const int32_t offset_q4[3])
{
    const int32_t tolerance_q4 = config->monitor.offset_tolerance_codes * OFFSET_SCALE;
    bool plausible = true;
    for (int x = 0; x < 3; x++) {
        const int32_t beside_q4 = q_max(offset_q4[x], 0) - OFFSET_MID_CODE * OFFSET_SCALE;
        plausible = plausible && q_abs(beside_q4) <= tolerance_q4;
    }
    return plausible;
}

/* The fast loop continues with the other two sensors. */
static reason_t current_sensor_warning(const monitor_slow_input_t *in)
{
    switch (in->wrong_current_sensor) {
    case 1:
        return REASON_CURRENT_SENSOR_A;
    case 2:
        return REASON_CURRENT_SENSOR_B;
    case 3:
        return REASON_CURRENT_SENSOR_C;
    default:
        return REASON_NONE;
    }
}

/* While switching, the fast loop has qualified it; this is for sums with the bridge off. */
static bool current_sum_wrong(monitor_slow_state_t *state, const config_t *config,
                              const monitor_slow_input_t *in)
{
    const bool named = current_sensor_warning(in) != REASON_NONE;
    const bool beyond = q_abs(in->current_sum_pu) > config->monitor.current_sum_pu_q15;
    const bool lasts = qualified(&state->sum_steps, in->offsets_known && beyond && !named,
                                 config->monitor.sensor_fault_time_ms);
    return lasts || (in->current_undetermined && !named);
}

/* Without PWM no current is expected, so one sensor at its rail makes a sum as large. */
static bool sum_at_end(const monitor_slow_input_t *in)
{
    return in->offsets_known && q_abs(in->current_sum_pu) > SUM_AT_END_PU;
}

/* While the battery's voltage contradicts the sensor, the EMF measured with it shows no flux. */
static reason_t flux_warning(monitor_slow_state_t *state, const monitor_slow_input_t *in)
{
    const bool comparable = !in->battery_open && state->return_steps == 0;
    if (monitor_bus_step(&state->bus, in->bus_voltage_mV,
                         comparable ? in->battery_voltage_mV : 0)) {
        return REASON_BUS_SENSOR;
    }
    const monitor_emf_state_t *emf = &state->emf;
    return state->bus.level > 0                   ? REASON_NONE
           : emf->flux == MONITOR_EMF_FLUX_WEAK   ? REASON_FLUX_WEAK
           : emf->flux == MONITOR_EMF_FLUX_STRONG ? REASON_BUS_SENSOR
                                                  : REASON_NONE;
}

static monitor_emf_input_t emf_input(const monitor_slow_input_t *in)
{
    const monitor_emf_input_t out = {
        .u_d_mV = in->u_d_mV,
        .u_q_mV = in->u_q_mV,
        .i_d_mA = in->i_d_mA,
        .i_q_mA = in->i_q_mA,
        .bus_voltage_mV = in->bus_voltage_mV,
        .winding_temperature_cC = in->winding_temperature_cC,
        .speed_mrad_s = in->speed_mrad_s,
        .switching = in->bridge == BRIDGE_PWM,
        .voltage_limited = in->voltage_limited,
        .rotor_valid = in->rotor_valid,
    };
    return out;
}

static bool no_current(monitor_slow_state_t *state, const monitor_slow_input_t *in,
                       const config_t *config)
{
    const monitor_current_input_t current = {
        .sampled_pu = in->sampled_pu,
        .reference_pu = in->reference_pu,
        .switching = in->bridge == BRIDGE_PWM,
        .voltage_limited = in->voltage_limited,
    };
    return monitor_current_step(&state->current, config, &current);
}

static bool gain_wrong(monitor_slow_state_t *state, const monitor_slow_input_t *in,
                       const config_t *config)
{
    const monitor_gain_input_t gain = {
        .bus_current_mA = in->bus_current_mA,
        .battery_current_mA = in->battery_open ? MONITOR_GAIN_NOT_GIVEN : in->battery_current_mA,
        .bus_voltage_mV = in->bus_voltage_mV,
        .switching = in->bridge == BRIDGE_PWM,
    };
    return monitor_gain_step(&state->gain, config, &gain);
}

static bool open_phase(monitor_slow_state_t *state, const monitor_slow_input_t *in)
{
    const monitor_open_input_t open = {
        .sampled_pu = in->latest_pu,
        .reference_pu = in->reference_pu,
        .theta_turn = in->theta_turn,
        .switching = in->bridge == BRIDGE_PWM,
    };
    return monitor_open_step(&state->open, &open);
}

static monitor_speed_input_t speed_input(const monitor_slow_input_t *in)
{
    const monitor_speed_input_t out = {
        .speed_mrad_s = in->speed_mrad_s,
        .rotor_valid = in->rotor_valid,
        .bridge = in->bridge,
        .i_d_mA = in->i_d_mA,
        .i_q_mA = in->i_q_mA,
        .offsets_known = in->offsets_known,
        .current_quarters = in->current_quarters,
        .quarter_step = in->quarter_step,
        .fast_step_count = in->fast_step_count,
        .bus_voltage_mV = in->bus_voltage_mV,
    };
    return out;
}

static monitor_stuck_input_t stuck_input(const config_t *config, const monitor_slow_input_t *in,
                                         bool standstill)
{
    const monitor_stuck_input_t out = {
        .tripped = in->fast_trip != REASON_NONE,
        .turning = !standstill,
        .bridge = in->bridge,
        .currents_known = in->offsets_known && current_sensor_warning(in) == REASON_NONE &&
                          in->fast_trip != REASON_CURRENT_SENSOR,
        .sum_good = q_abs(in->current_sum_pu) <= config->monitor.current_sum_pu_q15,
        .rotor_valid = in->rotor_valid,
        .speed_mrad_s = in->speed_mrad_s,
        .alpha_pu = in->idle_alpha_pu,
        .beta_pu = in->idle_beta_pu,
        .fast_step_count = in->fast_step_count,
    };
    return out;
}

/* The name of a low bus comes a step after the torque has gone: watch_bus_sensor(). */
static reason_t bus_warning(const monitor_slow_state_t *state, const monitor_slow_input_t *in)
{
    const bool known = in->battery_open || !state->bus_was_low ||
                       state->return_steps < MONITOR_BUS_RETURN_STEPS || state->bus_steps > 1 ||
                       fast_trip_of_bus(in);
    return !in->battery_open && state->bus_sensor_wrong ? REASON_BUS_SENSOR
           : known                                      ? REASON_BATTERY_DISCONNECTED
                                                        : REASON_NONE;
}

static safe_state_input_t safe_state_input(const monitor_slow_state_t *state,
                                           const monitor_slow_input_t *in, int32_t speed_mrad_s)
{
    const safe_state_input_t out = {
        .speed_mrad_s = speed_mrad_s,
        .winding_temperature_cC = in->winding_temperature_cC,
        .bus_voltage_mV = in->bus_voltage_mV,
        .battery_open = in->battery_open || state->return_steps > 0,
        .charge_current_mA = in->charge_current_mA,
        .i_d_mA = in->i_d_mA,
        .i_q_mA = in->i_q_mA,
        .turning_mrad_s = in->frame_known ? in->speed_mrad_s : 0,
        .bridge = state->safe_bridge,
    };
    return out;
}

/* The short circuit of an open bridge begins with up to twice its settled current. A controller
 * that boots at speed waits for PWM instead, which takes the current over within the limit. */
static safe_state_t without_surge(monitor_slow_state_t *state, const config_t *config,
                                  const safe_state_input_t *in, bridge_mode_t actual,
                                  safe_state_t chosen)
{
    if (!bridge_is_short(chosen.bridge)) {
        state->short_steps = 0;
        return chosen;
    }
    const bool begins = actual == BRIDGE_OFF && in->bridge == BRIDGE_OFF;
    if (begins && state->short_steps < MONITOR_SHORT_WAIT_STEPS &&
        safe_state_short_surges(config, in, &chosen.freewheel)) {
        state->short_steps++;
        chosen.bridge = BRIDGE_OFF;
        chosen.torque_mNm = chosen.freewheel.torque_mNm;
    }
    return chosen;
}

monitor_output_t monitor_slow_step(monitor_slow_state_t *state, const config_t *config,
                                   const monitor_slow_input_t *in)
{
    const bool switching = in->bridge == BRIDGE_PWM;
    const int32_t sensor_time_ms = config->monitor.sensor_fault_time_ms;
    const reason_t current_warning = current_sensor_warning(in);
    const reason_t sensor_warns = sensor_warning(in);
    const bool sum_wrong = current_sum_wrong(state, config, in);
    const bool sensor_wrong = qualified(
        &state->sensor_steps, switching ? in->current_saturated : sum_at_end(in), sensor_time_ms);
    const bool rotor_missing = switching && !in->rotor_valid;
    const bool rotor_wrong = qualified(&state->rotor_steps, rotor_missing,
                                       rotor_missing ? rotor_qualify_steps(config) : 1);
    const monitor_emf_input_t emf = emf_input(in);
    const bool angle_wrong = monitor_emf_step(&state->emf, config, &emf);
    const bool current_missing = no_current(state, in, config);
    const bool torque_wrong =
        qualified(&state->torque_steps, switching && torque_unwanted(config, in),
                  config->monitor.torque_fault_time_ms);
    const bool gain_is_wrong = gain_wrong(state, in, config);
    const bool flow_wrong = flow_broken(state, config, in->fast_step_count);
    const bool phase_open = open_phase(state, in);
    const bool bus_wrong = bus_unexplained(state, config, in);
    const bool battery_lost = state->open_steps > 0 || state->return_steps > 0;
    const reason_t temperature = temperature_fault(config, in);
    const bool temperature_wrong =
        qualified(&state->temperature_steps, temperature != REASON_NONE, sensor_time_ms);
    const monitor_speed_input_t turning = speed_input(in);
    const int32_t speed_mrad_s = monitor_speed_step(&state->speed, config, &turning);
    const bool standstill = speed_mrad_s < config->monitor.standstill_mrad_s;
    const safe_state_input_t letting_go = safe_state_input(state, in, speed_mrad_s);
    const monitor_stuck_input_t tripped = stuck_input(config, in, standstill);
    const monitor_stuck_output_t stuck = monitor_stuck_step(&state->stuck, config, &tripped);
    const safe_state_t safe = stuck.side == BRIDGE_OFF
                                  ? without_surge(state, config, &letting_go, in->bridge,
                                                  safe_state_step(config, &letting_go))
                                  : safe_state_shorted(config, &letting_go, stuck.side);
    const bool rotor_warns =
        rotor_warning(state, config, (uint16_t)(in->rotor_faults + state->speed.sudden_stops));

    monitor_output_t out = {
        .fault = stuck.fault,
        .warning = battery_lost                     ? bus_warning(state, in)
                   : current_warning != REASON_NONE ? current_warning
                   : sensor_warns != REASON_NONE    ? sensor_warns
                   : rotor_warns                    ? REASON_ROTOR_UNCERTAIN
                                                    : REASON_NONE,
        .flux_warning = flux_warning(state, in),
        .safe_bridge = safe.bridge,
        .emf_conducts = safe.bridge != BRIDGE_OFF || safe.freewheel.current_mA > 0,
        .charging_mA = safe.bridge == BRIDGE_OFF ? safe.freewheel.charging_mA : 0,
        .emf_mV = safe.emf_mV,
        .safe_torque_mNm = safe.torque_mNm,
        .battery_lost = battery_lost,
        .release_trip = state->release_trip,
        .release_break = stuck.release_break,
        .offsets_plausible = offsets_plausible(config, in->offset_q4),
        .standstill = standstill,
        .at_rest = state->speed.rest_urad_s < INT64_C(1000) * config->monitor.standstill_mrad_s,
        .speed_bound_mrad_s = speed_mrad_s,
    };
    if (out.flux_warning == REASON_FLUX_WEAK && in->battery_voltage_mV > 0) {
        out.flux_missing_q15 = state->emf.missing_q20 / 32;
    }
    state->safe_bridge = out.safe_bridge;
    state->steps++;
    /* The first line that applies names the fault: causes before consequences. */
    if (in->fast_trip != REASON_NONE && !fast_trip_of_bus(in) && !overcurrent_of_bus(state, in)) {
        /* The current loop that finds no path in one phase drives too much through the others. */
        out.fault = in->fast_trip == REASON_OVERCURRENT && state->open.suspected ? REASON_PHASE_OPEN
                                                                                 : in->fast_trip;
    } else if (flow_wrong) {
        out.fault = REASON_PROGRAM_FLOW;
    } else if (phase_open) {
        out.fault = monitor_open_reason(in->latest_pu, in->current_sum_pu);
    } else if (sensor_wrong || current_missing) {
        out.fault = REASON_CURRENT_SENSOR;
    } else if (sum_wrong) {
        out.fault = REASON_CURRENT_SUM;
    } else if (bus_wrong) {
        out.fault = state->bus_was_low ? REASON_BUS_UNDERVOLTAGE : REASON_BUS_OVERVOLTAGE;
    } else if (rotor_wrong) {
        out.fault = REASON_ROTOR_LOST;
    } else if (angle_wrong) {
        out.fault = REASON_ROTOR_IMPLAUSIBLE;
    } else if (torque_wrong) {
        out.fault = REASON_TORQUE_IMPLAUSIBLE;
    } else if (gain_is_wrong) {
        out.fault = REASON_CURRENT_GAIN;
    } else if (temperature_wrong) {
        out.fault = temperature;
    }
    return out;
}
