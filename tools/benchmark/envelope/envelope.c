/* SPDX-License-Identifier: Apache-2.0 */
/*
 * envelope.c: the slow step over the whole envelope. Every call of controller_slow_step() gets a
 * state drawn at random: speed up to 110 % of the highest one, bus voltage from half the smallest
 * to beyond the trip, demands, currents, voltages, temperatures (broken sensors included), limits
 * of the battery (zero included), anti-lock, switched off, faults; the three strategies and the
 * three rotor sensors. A quarter of the calls begins anew with a controller that has just come to
 * RUN, at one of every fourth of 64 steps, so that what the firmware does in rotation comes as
 * often as in a ride; the others walk on, half of them at an operating point near the one before.
 *
 * Options on the emulated command line: states=N (100 000), show=I prints the state with index I
 * in plain text and ends, reasons=1 prints the reason shown in every state.
 */
#include <math.h>
#include <stddef.h>

#include "config/bases.h"
#include "config_image.h"
#include "controller/controller.h"
#include "semihost.h"

enum { STATES = 100000, START_STEPS = 600, SENSORS = 3, STRATEGIES = 3, PHASES = 16, APART = 4 };

void begin_measuring(void);

/* The plugin waits for this address; the empty statement keeps the call from vanishing. */
__attribute__((noinline, noclone)) void begin_measuring(void)
{
    __asm volatile("");
}

/* One rotor sensor: its configuration, and a controller that has come to RUN with it. */
typedef struct {
    config_t config;
    controller_slow_t slow;
    fast_setpoint_t to_fast;
    fast_report_t to_slow;
    int32_t v_dc_pu; /* bus voltage of every period, Q15 of the voltage base */
    slow_input_t in;
} start_t;

static start_t starts[SENSORS][PHASES];
static start_t now;

/* ---- random numbers: xorshift32 (Marsaglia 2003) ---- */

static uint32_t random_state = 2463534242U;

static double share(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return (double)(random_state >> 8) / 16777216.0;
}

static double between(double lowest, double highest)
{
    return lowest + (highest - lowest) * share();
}

static int chance(double probability)
{
    return share() < probability;
}

/* ---- one state ---- */

static int32_t speed_q32(const config_t *config, double rad_s)
{
    return (int32_t)(rad_s * config->motor.pole_pairs / 6.283185307179586 /
                     config->drive.pwm_frequency_Hz * 4294967296.0);
}

static double bus_mV(const config_battery_t *battery)
{
    const double kind = share();
    const double span = battery->max_voltage_mV - battery->min_voltage_mV;
    if (kind < 0.6) {
        return between(battery->min_voltage_mV, battery->max_voltage_mV);
    }
    if (kind < 0.7) {
        return battery->max_voltage_mV + between(-0.1, 0.1) * span;
    }
    if (kind < 0.8) {
        return battery->min_voltage_mV + between(-0.1, 0.1) * span;
    }
    return between(0.5 * battery->min_voltage_mV, 1.05 * battery->overvoltage_trip_mV);
}

static int32_t temperature_cC(int32_t most_cC)
{
    const double kind = share();
    if (kind < 0.02) {
        return chance(0.5) ? -30000 : 100000;
    }
    return (int32_t)(kind < 0.3 ? most_cC + between(-3000.0, 1500.0) : between(-4000.0, most_cC));
}

static int32_t pack_mA(int32_t motor_mA, int32_t wheels)
{
    const double kind = share();
    const double whole = (double)motor_mA * wheels;
    return (int32_t)(kind < 0.4   ? whole
                     : kind < 0.6 ? 0.0
                     : kind < 0.7 ? between(-0.1, 0.1) * whole
                                  : between(0.0, 1.2) * whole);
}

static void draw_demand(slow_input_t *in, const config_t *config)
{
    const double kind = share();
    const double most = 1.2 * config->motor.max_torque_mNm;
    const double both = most + config->brake.max_hydraulic_torque_mNm;
    in->demand.drive_torque_mNm = kind < 0.45 ? (int32_t)between(-most, most) : 0;
    in->demand.brake_torque_mNm = kind > 0.55 ? (int32_t)between(0.0, kind < 0.8 ? most : both) : 0;
    in->demand_age_ms = chance(0.03) ? 1000U : (uint32_t)between(0.0, 10.0);
}

static void draw_slow(slow_input_t *in, const config_t *config)
{
    const config_battery_t *battery = &config->battery;
    draw_demand(in, config);
    in->bms.charge_current_mA = pack_mA(battery->max_charge_current_mA, battery->driven_wheels);
    in->bms.discharge_current_mA =
        pack_mA(battery->max_discharge_current_mA, battery->driven_wheels);
    in->temperature.winding_cC = temperature_cC(config->motor.max_winding_temperature_cC);
    in->temperature.switch_cC = temperature_cC(config->drive.max_switch_temperature_cC);
    in->demand.enable = !chance(0.03);
    in->demand.abs_active = chance(0.03);
}

/* A wheel's speed and the bus voltage, as the fast loop reports them. */
static void draw_point(start_t *at)
{
    const config_t *config = &at->config;
    const double most_rad_s = 1.1e-3 * config->motor.max_speed_mrad_s;
    const double speed = chance(0.05) ? 0.0 : between(-most_rad_s, most_rad_s);
    const double bus_pu = bus_mV(&config->battery) / config->drive.voltage_full_scale_mV;
    at->to_slow.speed_q32 = speed_q32(config, speed);
    at->v_dc_pu = (int32_t)(32768.0 * (bus_pu < 1.0 ? bus_pu : 1.0));
}

/* Currents and voltages: half of the time what was asked for, else anything inside the circles. */
static void draw_electrical(fast_report_t *report, const config_t *config, dq_t asked)
{
    const double most_pu = 1.05 * config->current_loop.max_current_pu_q15;
    const double length = most_pu * share();
    const double angle = between(-3.141592653589793, 3.141592653589793);
    const dq_t any = {.d = (int32_t)(length * cos(angle)), .q = (int32_t)(length * sin(angle))};
    const dq_t i = chance(0.5) ? asked : any;
    const double used = 32767.0 * (chance(0.3) ? 1.0 : share());
    const double at = between(-3.141592653589793, 3.141592653589793);
    const dq_t u = {.d = (int32_t)(used * cos(at)), .q = (int32_t)(used * sin(at))};
    const int32_t unsaturated_q = chance(0.2) ? 2 * u.q : u.q;
    report->i_pu = dq16_of(i);
    report->u_pu = dq16_of(u);
    const int32_t q = q_saturate16(unsaturated_q);
    report->voltage_use_q15 = (int32_t)(((uint32_t)(u.d * u.d) + (uint32_t)(q * q)) >> 15);
    report->voltage_limited = unsaturated_q != u.q;
    report->current_sum_pu = (int32_t)between(-100.0, 100.0);
    report->i_d_weakening_pu =
        chance(0.5) ? 0 : (int32_t)(-share() * config->current_loop.field_weakening_current_pu_q15);
    report->sensor_valid = !chance(0.02);
    report->rotor_faults = (uint16_t)(report->rotor_faults + (chance(0.002) ? 1 : 0));
}

/* A millisecond of periods with the report's present values. */
static void add_periods(start_t *at)
{
    fast_report_t *report = &at->to_slow;
    const uint32_t periods =
        (uint32_t)(at->config.drive.pwm_frequency_Hz / 1000) + (uint32_t)(chance(0.1) ? 1 : 0);
    const dq_t i = dq_of(report->i_pu);
    const dq_t u = dq_of(report->u_pu);
    report->sequence = (uint16_t)(report->sequence + periods);
    report->sums.i_d_pu += periods * (uint32_t)i.d;
    report->sums.i_q_pu += periods * (uint32_t)i.q;
    report->sums.power_pu += periods * (uint32_t)((u.d * i.d + u.q * i.q) >> 15);
    report->sums.v_dc_pu += periods * (uint32_t)at->v_dc_pu;
}

static slow_output_t step(start_t *at)
{
    const slow_output_t out =
        controller_slow_step(&at->slow, &at->config, &at->to_slow, &at->in, &at->to_fast);
    at->to_slow.bridge = at->to_fast.torque_enabled ? BRIDGE_PWM : at->to_fast.safe_bridge;
    return out;
}

static operating_mode_t run_calmly(start_t *start, int steps)
{
    slow_output_t out = {.mode = MODE_BOOT};
    for (int ms = 0; ms < steps; ms++) {
        add_periods(start);
        out = step(start);
    }
    return out.mode;
}

/* Calm at the battery's middle, switched on: through self-test and calibration into RUN. */
static operating_mode_t start_with(start_t *start, int32_t sensor)
{
    static controller_t whole;
    start->config = CONFIG_IMAGE;
    config_t *config = &start->config;
    config->rotor.sensor = sensor;
    controller_init(&whole, config, BASES_MODEL_TIMER_Hz);
    start->slow = whole.slow;
    start->to_fast = controller_initial_setpoint(config, BASES_MODEL_TIMER_Hz);
    controller_fast_report(&whole.fast, &start->to_slow);
    start->to_slow.offsets_done = true;
    start->to_slow.sensor_valid = true;
    start->v_dc_pu =
        (int32_t)(16384.0 * (config->battery.min_voltage_mV + config->battery.max_voltage_mV) /
                  config->drive.voltage_full_scale_mV);
    const slow_input_t calm = {
        .bms.charge_current_mA = INT32_MAX,
        .bms.discharge_current_mA = INT32_MAX,
        .temperature.winding_cC = 2500,
        .temperature.switch_cC = 2500,
        .demand.enable = true,
        .demand.direction = DRIVE_DIRECTION_FORWARD,
        .selftest_passed = true,
        .config_accepted = true,
    };
    start->in = calm;
    return run_calmly(start, START_STEPS);
}

/* ---- a state in plain text ---- */

static void print_number(const char *name, int32_t value)
{
    char digits[12];
    char *at = &digits[sizeof digits - 1];
    *at = '\0';
    uint32_t rest = value < 0 ? 0U - (uint32_t)value : (uint32_t)value;
    do {
        *--at = (char)('0' + (char)(rest % 10U));
        rest /= 10U;
    } while (rest > 0U);
    if (value < 0) {
        *--at = '-';
    }
    semihost_print(name);
    semihost_print("=");
    semihost_print(at);
    semihost_print("\n");
}

static void show(const slow_output_t *out)
{
    const slow_input_t *in = &now.in;
    const fast_report_t *report = &now.to_slow;
    print_number("speed_mrad_s", out->speed_mrad_s);
    print_number("bus_voltage_mV", out->bus_voltage_mV);
    print_number("drive_torque_mNm", in->demand.drive_torque_mNm);
    print_number("brake_torque_mNm", in->demand.brake_torque_mNm);
    print_number("demand_age_ms", (int32_t)in->demand_age_ms);
    print_number("bms_charge_current_mA", in->bms.charge_current_mA);
    print_number("bms_discharge_current_mA", in->bms.discharge_current_mA);
    print_number("winding_temperature_cC", in->temperature.winding_cC);
    print_number("switch_temperature_cC", in->temperature.switch_cC);
    print_number("enable", in->demand.enable);
    print_number("abs_active", in->demand.abs_active);
    print_number("sensor_valid", report->sensor_valid);
    print_number("i_d_mA", out->i_d_mA);
    print_number("i_q_mA", out->i_q_mA);
    print_number("i_d_weakening_pu", report->i_d_weakening_pu);
    print_number("strategy", now.config.brake.strategy);
    print_number("sensor", now.config.rotor.sensor);
    print_number("mode", (int32_t)out->mode);
    print_number("motor_torque_command_mNm", out->motor_torque_command_mNm);
    print_number("torque_reason", (int32_t)out->torque_reason);
}

static void begin_anew(void)
{
    const start_t *start =
        &starts[(int)(share() * SENSORS) % SENSORS][(int)(share() * PHASES) % PHASES];
    const int32_t strategy = (int32_t)(share() * STRATEGIES) % STRATEGIES;
    now = *start;
    now.config.brake.strategy = strategy;
    /* What takes turns: at any step of its round. */
    static uint32_t step;
    now.slow.torque.ahead.step = step % AVAILABLE_AHEAD_ROUND_steps;
    step++;
}

int main(void)
{
    for (int32_t sensor = 0; sensor < SENSORS; sensor++) {
        operating_mode_t mode = start_with(&starts[sensor][0], sensor);
        for (int k = 1; k < PHASES; k++) {
            starts[sensor][k] = starts[sensor][k - 1];
            mode = run_calmly(&starts[sensor][k], APART);
        }
        if (mode != MODE_RUN) {
            semihost_print("envelope: start-up ended in ");
            semihost_print(operating_mode_text(mode));
            semihost_print("\n");
            return 1;
        }
    }
    const uint32_t states = semihost_option("states", STATES);
    const uint32_t shown = semihost_option("show", UINT32_MAX);
    const bool reasons = semihost_option("reasons", 0) != 0;
    slow_output_t out = {.mode = MODE_FAULT};
    uint32_t running = 0;
    begin_measuring();
    for (uint32_t n = 0; n < states; n++) {
        const int anew = n == 0 || out.mode == MODE_FAULT || chance(0.25);
        if (anew) {
            begin_anew();
        }
        if (anew || chance(0.5)) {
            draw_point(&now);
            draw_slow(&now.in, &now.config);
        }
        draw_electrical(&now.to_slow, &now.config, now.to_fast.i_reference_pu);
        add_periods(&now);
        out = step(&now);
        running += out.mode == MODE_RUN || out.mode == MODE_LIMP ? 1U : 0U;
        if (reasons) {
            print_number("reason", (int32_t)out.torque_reason);
        }
        if (n == shown) {
            show(&out);
            return 0;
        }
    }
    /* A program whose states are nearly all switched off would count the wrong thing. */
    print_number("running", (int32_t)running);
    print_number("states", (int32_t)states);
    return running > states / 10U * 8U ? 0 : 1;
}
