/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor.h"
#include "config/bases.h"
#include "core/divide.h"
#include "core/q15.h"

enum {
    FLOW_TOLERANCE_SHARE = 4, /* fast steps in a slow step may differ by a quarter */
    SUM_AT_END_PU = 30720,    /* 15/16 of the range */
    OFFSET_SCALE = 16,        /* offsets are codes * 16 */
    OFFSET_MID_CODE = 2048
};

void monitor_init(monitor_state_t *state)
{
    const monitor_state_t zero = {.started = false};
    *state = zero;
}

/* Braking torque that no current within the limits may prevent: all of it where even the largest
 * demagnetising current may leave more voltage than the bus has. Coarse: it contains what the
 * torque limits count on (DERIVATIONS.md, Forced torque). */
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
static bool torque_unwanted(const config_t *config, const measured_t *now, const last_t *last)
{
    const int64_t tolerance_mNm =
        config->monitor.torque_tolerance_mNm; /* 64 bits: no input is trusted */
    const int64_t above_mNm =
        last->torque_estimate_mNm - (q_max(last->torque_command_mNm, 0) + tolerance_mNm);
    const int64_t below_mNm =
        q_min(last->torque_command_mNm, 0) - tolerance_mNm - last->torque_estimate_mNm;
    if (above_mNm <= 0 && below_mNm <= 0) {
        return false;
    }
    const int64_t braking_mNm = now->speed_mrad_s >= 0 ? below_mNm : above_mNm;
    return braking_mNm <= 0 ||
           braking_mNm > monitor_forced_torque_mNm(config, now->speed_mrad_s, now->bus_voltage_mV);
}

/* A slow step that comes twice finds every other count right; without PWM none has tripped yet. */
static bool flow_broken(monitor_state_t *state, const config_t *config, uint16_t fast_step_count)
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
static bool overcurrent_of_bus(const monitor_state_t *state, const measured_t *now)
{
    return now->trip == REASON_OVERCURRENT && state->return_steps > 0 && state->bus_was_low;
}

static bool fast_trip_of_bus(const measured_t *now)
{
    return now->trip == REASON_BUS_OVERVOLTAGE || now->trip == REASON_BUS_SENSOR;
}

/* A reading that rose faster than a bus can, or that is lower than a motor can make one. In the
 * step in which a bus falls below its trip its mean may still contain what was before. */
static void watch_bus_sensor(monitor_state_t *state, const config_t *config, const measured_t *now)
{
    const bool empty = (int64_t)now->bus_voltage_mV * MONITOR_BUS_EMPTY_SHARE <
                       config->drive.voltage_full_scale_mV;
    const bool wrong = now->trip == REASON_BUS_SENSOR ||
                       (empty && state->bus_was_low && !measured_battery_open(now));
    state->bus_sensor_wrong = state->return_steps > 0 && (wrong || state->bus_sensor_wrong);
}

/* A bus beyond a trip, or one that no battery holds, puts the bridge into its safe state at once,
 * here or by the fast trip. A contactor that opens does that, and the battery's message explains it
 * later. True where none has and the bus is not back either. */
static bool bus_unexplained(monitor_state_t *state, const config_t *config, const measured_t *now,
                            bool off)
{
    const config_battery_t *battery = &config->battery;
    const config_monitor_t *monitor = &config->monitor;
    const bool high = now->bus_voltage_mV > battery->overvoltage_trip_mV || fast_trip_of_bus(now);
    const bool overcurrent = now->trip == REASON_OVERCURRENT;
    const bool low = (measured_switching(now) || overcurrent || (off && state->bus_was_low)) &&
                     !measured_battery_open(now) &&
                     now->bus_voltage_mV < battery->undervoltage_trip_mV;
    const bool back =
        now->bus_voltage_mV < (battery->max_voltage_mV + battery->overvoltage_trip_mV) / 2 &&
        now->bus_voltage_mV >= battery->undervoltage_trip_mV && !overcurrent;
    const bool swings = monitor_bus_swings(&state->swing, battery, now->bus_voltage_mV,
                                           measured_switching(now) && !measured_battery_open(now));
    if (high || low || swings) {
        state->bus_was_low = low || (state->bus_was_low && state->return_steps > 0);
        state->return_steps = MONITOR_BUS_RETURN_STEPS;
    } else if (back && state->return_steps > 0) {
        state->return_steps--;
    }
    state->open_steps = (uint16_t)(measured_battery_open(now) ? MONITOR_BUS_RETURN_STEPS
                                                              : q_max(state->open_steps - 1, 0));
    watch_bus_sensor(state, config, now);
    state->release_trip = (back && fast_trip_of_bus(now)) ||
                          (measured_battery_open(now) && overcurrent_of_bus(state, now));
    const int32_t qualify_ms = monitor->battery_message_time_ms +
                               (state->bus_was_low ? monitor->voltage_fault_time_ms : 0);
    return debounce_step(&state->bus,
                         state->return_steps > 0 && !back && !measured_battery_open(now),
                         (uint32_t)qualify_ms, 1U);
}

/* A reading at an end of the sensor's range is none. */
static bool too_hot(const config_t *config, int32_t shown_cC, int32_t limit_cC)
{
    const config_monitor_t *monitor = &config->monitor;
    return limit_cC < CONFIG_TEMPERATURE_OFF_cC && shown_cC <= monitor->highest_temperature_cC &&
           shown_cC > limit_cC + monitor->overtemperature_margin_cC;
}

/* By the sensors alone: an estimate is no fault. The limits have taken the torque before. */
static void check_temperatures(const config_t *config, const measured_t *now, findings_t *findings)
{
    findings_set(
        findings, FINDING_WINDING_HOT,
        too_hot(config, now->in->temperature.winding_cC, config->motor.max_winding_temperature_cC));
    findings_set(
        findings, FINDING_SWITCH_HOT,
        too_hot(config, now->in->temperature.switch_cC, config->drive.max_switch_temperature_cC));
}

/* A skipped sector: one may be dirt, a dead sensor makes one every electrical turn. As long as the
 * observer sees the rotor that is only shown; without it, less is driven for a while. So is a
 * sensor that stops faster than a tyre can stop the vehicle: an unloaded wheel can. */
static void check_rotor_reading(monitor_state_t *state, const measured_t *now, findings_t *findings)
{
    const bool wrong = now->report->rotor_faults != state->last_rotor_faults;
    findings_set(findings, FINDING_ROTOR_READING, wrong && !now->rotor_observed);
    findings_set(findings, FINDING_ROTOR_GLITCH, wrong && now->rotor_observed);
    findings_set(findings, FINDING_ROTOR_STOPS,
                 state->speed.sudden_stops != state->last_sudden_stops);
    state->last_rotor_faults = now->report->rotor_faults;
    state->reading_steps =
        (uint16_t)(wrong ? MONITOR_READING_STEPS : q_max(state->reading_steps - 1, 0));
    state->last_sudden_stops = state->speed.sudden_stops;
    const bool read = findings_qualified(findings, FINDING_ROTOR_READING) ||
                      findings_qualified(findings, FINDING_ROTOR_GLITCH);
    findings_set(findings, FINDING_READING_BY_STEPS,
                 read && state->flow_level > 0 && !findings_off(findings));
}

/* The tolerance is less than the middle: a negative offset wraps to a large number. */
static bool offsets_plausible(const config_t *config, const int32_t offset_q4[3])
{
    const int32_t tolerance_q4 = config->monitor.offset_tolerance_codes * OFFSET_SCALE;
    const uint32_t least_q4 = (uint32_t)(OFFSET_MID_CODE * OFFSET_SCALE - tolerance_q4);
    const uint32_t span_q4 = 2U * (uint32_t)tolerance_q4;
    return (uint32_t)offset_q4[0] - least_q4 <= span_q4 &&
           (uint32_t)offset_q4[1] - least_q4 <= span_q4 &&
           (uint32_t)offset_q4[2] - least_q4 <= span_q4;
}

/* Without PWM no current is expected, so one sensor at its rail makes a sum as large. */
static bool sum_at_end(const fast_report_t *report)
{
    return report->offsets_done && q_abs(report->current_sum_pu) > SUM_AT_END_PU;
}

/* One sensor that the fast loop has named: it continues with the other two. While switching, the
 * fast loop has qualified a wrong sum; here it is for sums with the bridge off. */
static void check_current_sensors(const config_t *config, const measured_t *now,
                                  findings_t *findings)
{
    const fast_report_t *report = now->report;
    const uint8_t wrong = report->wrong_current_sensor;
    const bool named = wrong >= 1U && wrong <= 3U;
    const bool beyond = q_abs(report->current_sum_pu) > config->monitor.current_sum_pu_q15;
    findings_set(findings, FINDING_CURRENT_RAIL,
                 measured_switching(now) ? report->adc_saturated : sum_at_end(report));
    findings_set(findings, FINDING_SUM, report->offsets_done && beyond && !named);
    findings_set(findings, FINDING_SUM_UNDETERMINED, report->current_undetermined);
    findings_set_named(findings, FINDING_CURRENT_A, FINDING_CURRENT_C,
                       named ? (reason_t)(REASON_CURRENT_SENSOR_A + wrong - 1U) : REASON_NONE);
}

/* What the battery's message and the back-EMF say of flux and bus voltage. */
static void check_voltages(monitor_state_t *state, const measured_t *now, findings_t *findings)
{
    const bool comparable = !measured_battery_open(now) && state->return_steps == 0;
    const int32_t battery_mV = comparable ? now->battery->voltage_mV : 0;
    findings_set(findings, FINDING_BUS_CONTRADICTED,
                 monitor_bus_step(&state->contradiction, now->bus_voltage_mV, battery_mV));
    findings_suspect(findings, FINDING_BUS_CONTRADICTED, state->contradiction.level > 0);
    findings_set(findings, FINDING_FLUX_LOW, state->emf.flux == MONITOR_EMF_FLUX_WEAK);
    findings_set(findings, FINDING_FLUX_HIGH, state->emf.flux == MONITOR_EMF_FLUX_STRONG);
}

/* A bus beyond its trips, and one without a battery. The name of a low bus comes a step after the
 * torque has gone: watch_bus_sensor(). */
static void check_bus(monitor_state_t *state, const config_t *config, const measured_t *now,
                      findings_t *findings)
{
    /* What has ended the torque is not over while the bus is low again. */
    const bool off = findings_qualified(findings, FINDING_BUS_JUMPED) ||
                     findings_qualified(findings, FINDING_BATTERY_LEFT);
    const bool unexplained = bus_unexplained(state, config, now, off);
    const bool open = measured_battery_open(now);
    const bool lost = state->open_steps > 0 || state->return_steps > 0;
    const bool known = open || !state->bus_was_low ||
                       state->return_steps < MONITOR_BUS_RETURN_STEPS || state->bus.count > 1 ||
                       fast_trip_of_bus(now);
    const bool jumped = !open && state->bus_sensor_wrong;
    findings_set_named(findings, FINDING_BUS_LOW, FINDING_BUS_HIGH,
                       !unexplained         ? REASON_NONE
                       : state->bus_was_low ? REASON_BUS_UNDERVOLTAGE
                                            : REASON_BUS_OVERVOLTAGE);
    findings_set(findings, FINDING_BUS_JUMPED, lost && jumped);
    findings_set(findings, FINDING_BATTERY_LEFT, lost && !jumped && known);
    findings_set(findings, FINDING_BATTERY_UNKNOWN, lost && !jumped && !known);
}

/* What the fast monitor has latched. Trips of the bus heal (check_bus()). The current loop that
 * finds no path in one phase drives too much through the others. */
static void check_trip(const monitor_state_t *state, const measured_t *now, findings_t *findings)
{
    const bool counts = !fast_trip_of_bus(now) && !overcurrent_of_bus(state, now);
    const bool by_open_phase = now->trip == REASON_OVERCURRENT && state->open.suspected;
    findings_set(findings, FINDING_TRIP_PHASE_OPEN, counts && by_open_phase);
    findings_trip(findings, counts && !by_open_phase ? now->trip : REASON_NONE);
}

/* The short circuit of an open bridge begins with up to twice its settled current. A controller
 * that boots at speed waits for PWM instead, which takes the current over within the limit. */
static safe_state_t without_surge(monitor_state_t *state, const config_t *config,
                                  const measured_t *now, bridge_mode_t before, int32_t bound_mrad_s,
                                  safe_state_t chosen)
{
    if (!bridge_is_short(chosen.bridge)) {
        state->short_steps = 0;
        return chosen;
    }
    const bool begins = now->report->bridge == BRIDGE_OFF && before == BRIDGE_OFF;
    if (begins && state->short_steps < MONITOR_SHORT_WAIT_STEPS &&
        safe_state_short_surges(config, now, bound_mrad_s, &chosen.freewheel)) {
        state->short_steps++;
        chosen.bridge = BRIDGE_OFF;
        chosen.torque_mNm = chosen.freewheel.torque_mNm;
    }
    return chosen;
}

static safe_state_t safe_state_of(monitor_state_t *state, const config_t *config,
                                  const measured_t *now, bridge_mode_t before, int32_t bound_mrad_s,
                                  bridge_mode_t stuck_side)
{
    if (stuck_side != BRIDGE_OFF) {
        return safe_state_shorted(config, now, bound_mrad_s, stuck_side);
    }
    const bool battery_gone = measured_battery_open(now) || state->return_steps > 0;
    return without_surge(state, config, now, before, bound_mrad_s,
                         safe_state_step(config, now, before, bound_mrad_s, battery_gone));
}

/* The current into the bus: measured, or zero without PWM, unless diodes conduct. */
static bool bus_current_known(const measured_t *now, const safe_state_t *safe)
{
    return measured_switching(now) || bridge_is_short(now->report->bridge) ||
           (safe->bridge == BRIDGE_OFF && safe->freewheel.current_mA == 0);
}

monitored_t monitor_step(monitor_state_t *state, const config_t *config, const measured_t *now,
                         const last_t *last, findings_t *findings)
{
    const fast_report_t *report = now->report;
    const bool switching = measured_switching(now);
    const dq_t reference_pu = {.d = last->reference_pu.d + report->i_d_weakening_pu,
                               .q = last->reference_pu.q};
    check_current_sensors(config, now, findings);
    findings_set(findings, FINDING_ANGLE_MISSING, switching && !now->angle_valid);
    findings_set(findings, FINDING_ANGLE, monitor_emf_step(&state->emf, config, now));
    findings_set(findings, FINDING_CURRENT_MISSING,
                 monitor_current_step(&state->current, config, now, reference_pu));
    findings_set(findings, FINDING_TORQUE, switching && torque_unwanted(config, now, last));
    findings_set(findings, FINDING_STEPS, flow_broken(state, config, report->sequence));
    findings_suspect(findings, FINDING_STEPS, state->flow_level > 0);
    const reason_t no_current =
        monitor_open_step(&state->open, now, reference_pu, monitor_open_edge_pu(config, now));
    findings_set_named(findings, FINDING_NO_CURRENT_SUM, FINDING_NO_CURRENT_PHASE, no_current);
    check_bus(state, config, now, findings);
    check_trip(state, now, findings);
    check_temperatures(config, now, findings);
    check_voltages(state, now, findings);

    const int32_t bound_mrad_s = monitor_speed_step(&state->speed, config, now);
    const bool standstill = bound_mrad_s < config->monitor.standstill_mrad_s;
    check_rotor_reading(state, now, findings);
    const monitor_stuck_output_t stuck =
        monitor_stuck_step(&state->stuck, config, now, !standstill);
    findings_set(findings, FINDING_SWITCH_STUCK, stuck.side != BRIDGE_OFF);
    const safe_state_t safe =
        safe_state_of(state, config, now, last->safe_bridge, bound_mrad_s, stuck.side);
    findings_set(findings, FINDING_GAIN,
                 monitor_gain_step(&state->gain, config, now, bus_current_known(now, &safe)));
    state->steps++;
    const bool weak = findings_present(findings, FINDING_FLUX_LOW) && now->battery->voltage_mV > 0;
    const monitored_t out = {
        .safe = safe,
        .bound_mrad_s = bound_mrad_s,
        .standstill = standstill,
        .at_rest = state->reading_steps == 0 &&
                   state->speed.rest_urad_s < INT64_C(1000) * config->monitor.standstill_mrad_s,
        .emf_conducts = safe.bridge != BRIDGE_OFF || safe.freewheel.current_mA > 0,
        .offsets_plausible = offsets_plausible(config, report->offset_q4),
        .release_trip = state->release_trip,
        .release_break = stuck.release_break,
        .flux_missing_q15 = weak ? state->emf.missing_q20 / 32 : 0,
        .current_missing_q15 = state->gain.missing_q15,
    };
    return out;
}
