/* SPDX-License-Identifier: Apache-2.0 */
#include "surrogate.h"

#include "controller/controller.h"
#include "numbers.h"

static const double STEP_S = 1e-3;
static const double Q15 = 32768.0;
enum { OFFSETS_ms = 8, ACQUIRED_ms = 4, MID_CODE_Q4 = 2048 * 16 };

static int32_t whole16(double x)
{
    return numbers_within(x, INT16_MIN, INT16_MAX);
}

surrogate_fault_t surrogate_healthy(void)
{
    const surrogate_fault_t out = {.current_gain = 1.0,
                                   .bus_gain = 1.0,
                                   .flux_share = 1.0,
                                   .sensor_speed = 1.0,
                                   .observer_speed = 1.0,
                                   .bus_share = 1.0,
                                   .brake_gain = 1.0};
    return out;
}

void surrogate_init(surrogate_t *wheel, const config_t *config, random_t *random)
{
    const surrogate_t empty = {.config = config};
    *wheel = empty;
    const double radius_m = config->vehicle.wheel_radius_um * 1e-6;
    const double lowest_v = config->battery.min_voltage_mV * 1e-3;
    const double highest_v = config->battery.max_voltage_mV * 1e-3;
    wheel->flux_wb = config->motor.flux_linkage_nWb * 1e-9;
    wheel->resistance_ohm =
        (config->motor.phase_resistance_uOhm + config->drive.loss_resistance_uOhm) * 1e-6;
    wheel->inductance_d_h = config->motor.d_inductance_nH * 1e-9;
    wheel->inductance_q_h = config->motor.q_inductance_nH * 1e-9;
    wheel->pole_pairs = config->motor.pole_pairs;
    wheel->current_base_a = config->drive.current_full_scale_mA * 1e-3;
    /* Of the EMF observer: foc/observer_design.h. */
    wheel->flux_base_wb =
        2.0 * wheel->flux_wb + 1.25 * wheel->inductance_q_h * wheel->current_base_a;
    wheel->circle_share = config->current_loop.modulation_limit_pu_q15 / Q15 / NUMBERS_SQRT3;
    wheel->battery_ohm = config->battery.resistance_uOhm * 1e-6;
    wheel->mass_share = random_chance(random, 700) ? 1.0 : random_real(random, 0.3, 2.0);
    wheel->inertia_kg_m2 =
        config->vehicle.mass_g * 1e-3 * radius_m * radius_m / config->battery.driven_wheels;
    wheel->battery_v = random_chance(random, 800)
                           ? random_real(random, lowest_v, highest_v)
                           : random_real(random, 0.9 * lowest_v, 1.1 * highest_v);
    wheel->bus_v = wheel->battery_v;
    wheel->response = random_chance(random, 800) ? 0.95 : random_real(random, 0.1, 1.0);
    wheel->noise_pu = random_chance(random, 800) ? 10.0 : random_real(random, 0.0, 100.0);
    wheel->angle_turn = random_real(random, 0.0, 1.0);
    for (int x = 0; x < SENSE_PHASES; x++) {
        wheel->report.offset_q4[x] = MID_CODE_Q4;
    }
}

/* ---- the motor ---- */

typedef struct {
    double d_a, q_a;
} current_t;

/* Terminals short-circuited, steady state. */
static current_t short_circuit(const surrogate_t *wheel, double flux_wb, double w_rad_s)
{
    const double x_d = w_rad_s * wheel->inductance_d_h;
    const double x_q = w_rad_s * wheel->inductance_q_h;
    const double r = wheel->resistance_ohm;
    const double square = r * r + x_d * x_q;
    const current_t out = {.d_a = -w_rad_s * flux_wb * x_q / square,
                           .q_a = -w_rad_s * flux_wb * r / square};
    return out;
}

/* Through the diodes of an open bridge: none below the EMF limit, nearly the short circuit's far
 * above it. */
static current_t freewheel(const surrogate_t *wheel, double flux_wb, double w_rad_s)
{
    const double emf_v = numbers_size(w_rad_s) * flux_wb * NUMBERS_SQRT3;
    const current_t most = short_circuit(wheel, flux_wb, w_rad_s);
    const double share = emf_v > wheel->bus_v ? 1.0 - wheel->bus_v / emf_v : 0.0;
    const current_t out = {.d_a = most.d_a * share, .q_a = most.q_a * share};
    return out;
}

static void carry_current(surrogate_t *wheel, const fast_setpoint_t *setpoint,
                          const surrogate_fault_t *fault, bridge_mode_t bridge, double w_rad_s)
{
    const double flux_wb = wheel->flux_wb * fault->flux_share;
    current_t target;
    if (bridge == BRIDGE_PWM) {
        target.d_a = (setpoint->i_reference_pu.d + wheel->weakening_pu) / Q15;
        target.q_a = setpoint->i_reference_pu.q / Q15 + fault->extra_torque;
        /* The sensors' gain is in the loop. */
        target.d_a *= wheel->current_base_a / fault->current_gain;
        target.q_a *= wheel->current_base_a / fault->current_gain;
    } else if (bridge == BRIDGE_OFF) {
        target = freewheel(wheel, flux_wb, w_rad_s);
    } else {
        target = short_circuit(wheel, flux_wb, w_rad_s);
    }
    if (fault->no_current) {
        target.d_a = 0.0;
        target.q_a = 0.0;
    }
    wheel->i_d_a += wheel->response * (target.d_a - wheel->i_d_a);
    wheel->i_q_a += wheel->response * (target.q_a - wheel->i_q_a);
}

static double torque_nm(const surrogate_t *wheel, double flux_wb)
{
    const double reluctance_h = wheel->inductance_d_h - wheel->inductance_q_h;
    return 1.5 * wheel->pole_pairs * wheel->i_q_a * (flux_wb + reluctance_h * wheel->i_d_a);
}

/* ---- the vehicle ---- */

static void brake(surrogate_t *wheel, const slow_output_t *commands, const surrogate_fault_t *fault)
{
    const config_brake_t *brake = &wheel->config->brake;
    wheel->commanded_nm[wheel->commanded_next] =
        commands->hydraulic_valid ? commands->hydraulic_torque_mNm * 1e-3 : 0.0;
    int32_t delay_ms = brake->hydraulic_dead_time_ms + fault->brake_delay_ms;
    delay_ms = delay_ms < SURROGATE_DELAY_MOST_ms ? delay_ms : SURROGATE_DELAY_MOST_ms - 1;
    const int32_t at =
        (wheel->commanded_next + SURROGATE_DELAY_MOST_ms - delay_ms) % SURROGATE_DELAY_MOST_ms;
    wheel->commanded_next = (wheel->commanded_next + 1) % SURROGATE_DELAY_MOST_ms;
    if (!fault->brake_stuck) {
        const double wanted_nm = wheel->commanded_nm[at] * fault->brake_gain;
        const double change_nm =
            (wanted_nm - wheel->brake_nm) / (brake->hydraulic_time_constant_ms + 1);
        wheel->brake_nm += numbers_limited(change_nm, brake->hydraulic_rate_mNm_s * 1e-6);
    }
}

static void move(surrogate_t *wheel, const surrogate_fault_t *fault)
{
    const double motor_nm = torque_nm(wheel, wheel->flux_wb * fault->flux_share);
    const double inertia_kg_m2 = wheel->inertia_kg_m2 * wheel->mass_share;
    const double change = (motor_nm / inertia_kg_m2 + wheel->road_rad_s2) * STEP_S;
    const double stop = wheel->brake_nm / inertia_kg_m2 * STEP_S;
    const double free_rad_s = wheel->speed_rad_s + change;
    wheel->speed_rad_s = numbers_size(free_rad_s) <= stop ? 0.0
                         : free_rad_s > 0.0               ? free_rad_s - stop
                                                          : free_rad_s + stop;
    const double top_rad_s = 1.5e-3 * wheel->config->motor.max_speed_mrad_s;
    wheel->speed_rad_s = numbers_limited(wheel->speed_rad_s, top_rad_s);
}

static void supply(surrogate_t *wheel, const surrogate_fault_t *fault, double power_w)
{
    wheel->bus_a = wheel->bus_v > 1.0 ? power_w / wheel->bus_v : 0.0;
    const double settled_v = wheel->battery_v - wheel->battery_ohm * wheel->bus_a;
    if (fault->battery_open) { /* the capacitors alone */
        wheel->bus_v -=
            numbers_limited(20.0 * wheel->bus_a * STEP_S / 1e-2, 0.1 * wheel->bus_v + 0.1);
        wheel->bus_v = wheel->bus_v < 0.0 ? 0.0 : wheel->bus_v;
    } else {
        wheel->bus_v += 0.5 * (settled_v * fault->bus_share - wheel->bus_v);
    }
    wheel->bus_v = numbers_limited(wheel->bus_v, wheel->config->drive.voltage_full_scale_mV * 1e-3);
}

/* ---- the report ---- */

typedef struct {
    double d_pu, q_pu, limit; /* of the voltage circle; the share that is applied */
} voltage_t;

static voltage_t voltage_of(const surrogate_t *wheel, const surrogate_fault_t *fault,
                            double w_rad_s)
{
    const double flux_wb = wheel->flux_wb * fault->flux_share;
    const double d_v =
        wheel->resistance_ohm * wheel->i_d_a - w_rad_s * wheel->inductance_q_h * wheel->i_q_a;
    const double q_v = wheel->resistance_ohm * wheel->i_q_a +
                       w_rad_s * (wheel->inductance_d_h * wheel->i_d_a + flux_wb);
    const double radius_v = wheel->bus_v * wheel->circle_share + 1e-3;
    const double size = numbers_root(d_v * d_v + q_v * q_v) / radius_v;
    const voltage_t out = {.d_pu = numbers_limited(d_v / radius_v, 1.99),
                           .q_pu = numbers_limited(q_v / radius_v, 1.99),
                           .limit = size > 1.0 ? 1.0 / size : 1.0};
    return out;
}

static void weaken(surrogate_t *wheel, const voltage_t *voltage)
{
    const config_current_loop_t *loop = &wheel->config->current_loop;
    const bool high = voltage->limit < 1.0 || numbers_size(voltage->q_pu) > 0.97;
    const int32_t most_pu =
        loop->field_weakening_gain_pu_q15 > 0 ? loop->field_weakening_current_pu_q15 : 0;
    wheel->weakening_pu += high ? -most_pu / 32 - 1 : most_pu / 32 + 1;
    wheel->weakening_pu = wheel->weakening_pu > 0          ? 0
                          : wheel->weakening_pu < -most_pu ? -most_pu
                                                           : wheel->weakening_pu;
}

/* Phase x of 0 .. 2 of a current vector; and the vector without what flows in that phase. */
static current_t without_phase(current_t i, double angle_turn, int32_t phase, double share)
{
    const double axis_turn = (phase - 1) / 3.0 - angle_turn;
    const double c = numbers_cosine(axis_turn);
    const double s = numbers_sine(axis_turn);
    const double in_phase = share * (i.d_a * c + i.q_a * s);
    const current_t out = {.d_a = i.d_a - in_phase * c, .q_a = i.q_a - in_phase * s};
    return out;
}

static void report_rotor(surrogate_t *wheel, const fast_setpoint_t *setpoint,
                         const surrogate_fault_t *fault, double w_rad_s, bool switching)
{
    fast_report_t *report = &wheel->report;
    const double turns_q32 =
        w_rad_s / (2.0 * NUMBERS_PI * wheel->config->drive.pwm_frequency_Hz) * 4294967296.0;
    report->speed_q32 = numbers_whole(turns_q32 * fault->sensor_speed);
    report->sensor_valid = !fault->rotor_invalid;
    report->rotor_faults = (uint16_t)(report->rotor_faults + (fault->rotor_faults ? 1 : 0));
    wheel->switching_ms = switching ? wheel->switching_ms + 1 : 0;
    observer_report_t *observer = &report->observer;
    observer->acquired = wheel->switching_ms >= ACQUIRED_ms && !fault->observer_lost;
    observer->speed_q32 = switching ? numbers_whole(turns_q32 * fault->observer_speed) : 0;
    const double lead_turn = (int16_t)setpoint->observer.lead_turn / 65536.0;
    const double active_wb = wheel->flux_wb * fault->flux_share +
                             (wheel->inductance_d_h - wheel->inductance_q_h) * wheel->i_d_a;
    const double flux_q14 =
        switching ? active_wb / wheel->flux_base_wb * Q15 / 2.0 * numbers_cosine(lead_turn) : 0.0;
    const double theta_turn = wheel->angle_turn + lead_turn;
    observer->theta_turn = numbers_turn16(theta_turn);
    observer->sensor_turn = numbers_turn16(wheel->angle_turn + fault->sensor_turn);
    report->sample.flux_q14.v = q_pair(whole16(flux_q14 * numbers_cosine(theta_turn)),
                                       whole16(flux_q14 * numbers_sine(theta_turn)));
    report->sample.theta_turn = numbers_turn16(wheel->angle_turn + fault->sensor_turn);
}

static void report_currents(surrogate_t *wheel, const surrogate_fault_t *fault,
                            const voltage_t *voltage, bool switching, int32_t periods,
                            random_t *random)
{
    fast_report_t *report = &wheel->report;
    current_t i = {.d_a = wheel->i_d_a, .q_a = wheel->i_q_a};
    if (fault->open_phase != 0 && switching) {
        i = without_phase(i, wheel->angle_turn, fault->open_phase, fault->open_share);
    }
    const double scale = fault->current_gain / wheel->current_base_a * Q15;
    const int32_t d_pu = whole16(i.d_a * scale + random_real(random, -1.0, 1.0) * wheel->noise_pu);
    const int32_t q_pu = whole16(i.q_a * scale + random_real(random, -1.0, 1.0) * wheel->noise_pu);
    const int32_t u_d = switching ? whole16(voltage->d_pu * voltage->limit * 32767.0) : 0;
    const int32_t u_q = switching ? whole16(voltage->q_pu * voltage->limit * 32767.0) : 0;
    const bool limits = voltage->limit < 1.0;
    report->i_pu.v = q_pair(d_pu, q_pu);
    report->u_pu.v = q_pair(u_d, u_q);
    report->sample.unsaturated_d_q25 =
        switching && limits ? numbers_whole(voltage->d_pu * 33554432.0) : u_d * 1024;
    report->sample.unsaturated_q_q25 =
        switching && limits ? numbers_whole(voltage->q_pu * 33554432.0) : u_q * 1024;
    const double bus_pu =
        wheel->bus_v * fault->bus_gain * 1e3 / wheel->config->drive.voltage_full_scale_mV * Q15;
    const int32_t shown_pu = numbers_whole(bus_pu > 32767.0 ? 32767.0 : bus_pu);
    const uint32_t count = (uint32_t)periods;
    report->sums.i_d_pu += count * (uint32_t)d_pu;
    report->sums.i_q_pu += count * (uint32_t)q_pu;
    report->sums.power_pu +=
        count * (uint32_t)numbers_whole(((double)u_d * d_pu + (double)u_q * q_pu) / Q15);
    report->sums.v_dc_pu += count * (uint32_t)shown_pu;
    report->i_d_weakening_pu = switching ? wheel->weakening_pu : 0;
    report->current_sum_pu =
        numbers_whole(random_real(random, -1.0, 1.0) * wheel->noise_pu) + fault->current_sum_pu;
    report->wrong_current_sensor = (uint8_t)fault->wrong_sensor;
    report->current_undetermined = fault->undetermined;
    if (!switching) {
        const double alpha =
            i.d_a * numbers_cosine(wheel->angle_turn) - i.q_a * numbers_sine(wheel->angle_turn);
        const double beta =
            i.d_a * numbers_sine(wheel->angle_turn) + i.q_a * numbers_cosine(wheel->angle_turn);
        report->idle_alpha_pu += count * (uint32_t)whole16(alpha * scale);
        report->idle_beta_pu += count * (uint32_t)whole16(beta * scale);
    }
}

static void report_offsets(surrogate_t *wheel, const fast_setpoint_t *setpoint,
                           const surrogate_fault_t *fault, bool switching, random_t *random)
{
    fast_report_t *report = &wheel->report;
    const bool measures = setpoint->calibrate_offsets && !switching;
    wheel->calibrating_ms = measures ? wheel->calibrating_ms + 1 : 0;
    if (wheel->calibrating_ms == 1) {
        report->offsets_done = false;
    }
    if (wheel->calibrating_ms == OFFSETS_ms) {
        for (int x = 0; x < SENSE_PHASES; x++) {
            const int32_t codes_q4 = random_between(random, -64, 64) + 16 * fault->offset_codes;
            report->offset_q4[x] = MID_CODE_Q4 + codes_q4;
        }
        report->offsets_done = true;
    }
}

/* Quarter turns of the current in the stator frame, while it is large enough to be seen. */
static void report_quarters(surrogate_t *wheel, double turned, bool switching, int32_t periods)
{
    fast_report_t *report = &wheel->report;
    const double size_a = numbers_size(wheel->i_d_a) + numbers_size(wheel->i_q_a);
    const double before = wheel->angle_turn;
    const int32_t crossed =
        (int32_t)((before + turned + 8.0) * 4.0) - (int32_t)((before + 8.0) * 4.0);
    if (!switching && size_a > 0.01 * wheel->current_base_a && crossed != 0) {
        report->quadrant_transitions = (uint16_t)(report->quadrant_transitions + crossed);
        report->quadrant_step = (uint16_t)(report->sequence - periods / 2);
    }
}

/* So many periods with a mean from low to high. */
static uint32_t any_sum(uint32_t count, int32_t low, int32_t high, random_t *random)
{
    return count * (uint32_t)random_between(random, low, high);
}

/* The arguments of a call are computed in any order, so these two come before it. */
static q_pair_t any_pair(int32_t most, random_t *random)
{
    const int32_t x = random_between(random, -most, most);
    const int32_t y = random_between(random, -most, most);
    return q_pair(x, y);
}

/* Any numbers that the fields may hold, whatever they were before. */
static void make_wild(fast_report_t *report, random_t *random)
{
    const uint32_t count =
        (uint32_t)random_between(random, 0, random_chance(random, 700) ? 50 : 60000);
    report->sequence = (uint16_t)(report->sequence + count);
    report->sums.i_d_pu += any_sum(count, -32768, 32767, random);
    report->sums.i_q_pu += any_sum(count, -32768, 32767, random);
    report->sums.power_pu += any_sum(count, -32768, 32767, random);
    report->sums.v_dc_pu += any_sum(count, 0, 32767, random);
    report->sample.unsaturated_d_q25 = random_wild(random);
    report->sample.unsaturated_q_q25 = random_wild(random);
    report->sample.theta_turn = (uint16_t)random_wild(random);
    report->i_pu.v = any_pair(32767, random);
    report->u_pu.v = any_pair(23000, random);
    report->current_sum_pu = random_between(random, -98304, 98304);
    report->wrong_current_sensor = (uint8_t)random_between(random, 0, 4);
    report->current_undetermined = random_chance(random, 300);
    report->i_d_weakening_pu = random_between(random, -32768, 0);
    for (int x = 0; x < SENSE_PHASES; x++) {
        report->offset_q4[x] = random_between(random, 0, 65520);
    }
    report->offsets_done = random_chance(random, 700);
    report->speed_q32 = random_between(random, -(1 << 30), 1 << 30);
    report->sensor_valid = random_chance(random, 700);
    report->observer.speed_q32 = random_between(random, -(1 << 30), 1 << 30);
    report->observer.theta_turn = (uint16_t)random_wild(random);
    report->observer.sensor_turn = (uint16_t)random_wild(random);
    report->observer.acquired = random_chance(random, 500);
    report->sample.flux_q14.v = any_pair(20000, random);
    report->rotor_faults = (uint16_t)random_wild(random);
    report->quadrant_transitions = (uint16_t)random_wild(random);
    report->quadrant_step = (uint16_t)random_wild(random);
    report->idle_alpha_pu = (uint32_t)random_wild(random);
    report->idle_beta_pu = (uint32_t)random_wild(random);
    report->bridge = (bridge_mode_t)random_between(random, 0, 3);
}

void surrogate_step(surrogate_t *wheel, const fast_setpoint_t *setpoint,
                    const slow_output_t *commands, const surrogate_fault_t *fault, random_t *random)
{
    fast_report_t *report = &wheel->report;
    if (setpoint->clear_trip) {
        wheel->trip = REASON_NONE;
    }
    if (wheel->trip == REASON_NONE) {
        wheel->trip = fault->trip;
    }
    const bool switching = setpoint->torque_enabled && wheel->trip == REASON_NONE;
    const bridge_mode_t bridge = switching ? BRIDGE_PWM : setpoint->safe_bridge;
    const double w_rad_s = wheel->speed_rad_s * wheel->pole_pairs;
    const double turned = w_rad_s * STEP_S / (2.0 * NUMBERS_PI);
    int32_t periods = wheel->config->drive.pwm_frequency_Hz / 1000 + fault->periods;
    periods = periods > 0 ? periods : 0;

    carry_current(wheel, setpoint, fault, bridge, w_rad_s);
    brake(wheel, commands, fault);
    move(wheel, fault);
    const voltage_t voltage = voltage_of(wheel, fault, w_rad_s);
    weaken(wheel, &voltage);
    const double shaft_w =
        torque_nm(wheel, wheel->flux_wb * fault->flux_share) * wheel->speed_rad_s;
    const double copper_w =
        1.5 * wheel->resistance_ohm * (wheel->i_d_a * wheel->i_d_a + wheel->i_q_a * wheel->i_q_a);
    supply(wheel, fault, switching ? shaft_w + copper_w : 0.0);

    report->sequence = (uint16_t)(report->sequence + periods);
    report_quarters(wheel, turned, switching, periods);
    wheel->angle_turn = numbers_fraction(wheel->angle_turn + turned);
    report_rotor(wheel, setpoint, fault, w_rad_s, switching);
    report_currents(wheel, fault, &voltage, switching, periods, random);
    report_offsets(wheel, setpoint, fault, switching, random);
    report->trip = wheel->trip;
    report->bridge = bridge;
    if (fault->wild) {
        make_wild(report, random);
    }
    controller_fast_report_complete(report);
}
