/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/signals.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "exchange/variables.h"

enum { NAME_LENGTH = 80 };

typedef enum { VALUE, RATE } kind_t;

/* Texts of the controller's outputs: those of exchange/variables.h. */
#define TEXT_MEMBER(label, raw, member, type, scale, lowest, highest, start, unit, meaning)        \
    char label[sizeof(meaning)];
#define TEXT_VALUE(label, raw, member, type, scale, lowest, highest, start, unit, meaning)         \
    .label = (meaning),
static const struct {
    SIGNALS_FAST_OUTPUTS(TEXT_MEMBER)
    SIGNALS_SLOW_OUTPUTS(TEXT_MEMBER)
} OUTPUT_TEXT = {SIGNALS_FAST_OUTPUTS(TEXT_VALUE) SIGNALS_SLOW_OUTPUTS(TEXT_VALUE)};
#undef TEXT_MEMBER
#undef TEXT_VALUE

/* clang-format off */
/* X(name, kind, unit, meaning, expression of the bench b) */
#define BENCH_SIGNALS(X) \
    X("time_s", VALUE, "s", "since the run began", b->time_s) \
    X("driver.reference_m_per_s", VALUE, "m/s", \
      "speed the driver is to follow", b->demand.reference_m_per_s) \
    X("driver.drive_nm", VALUE, "N.m", \
      "drive pedal, at each driven wheel, positive forward", b->demand.drive_nm) \
    X("driver.brake_nm", VALUE, "N.m", \
      "brake pedal, at each driven wheel, magnitude", b->demand.brake_nm) \
    X("vehicle.speed_m_per_s", VALUE, "m/s", \
      "over ground, positive forward", b->vehicle.speed_m_per_s) \
    X("vehicle.acceleration_m_per_s2", RATE, "m/s2", \
      "mean over the row", b->vehicle.speed_m_per_s) \
    X("vehicle.distance_m", VALUE, "m", "since the run began", b->vehicle.distance_m) \
    X("vehicle.height_m", VALUE, "m", "climbed since the run began", b->vehicle.height_m) \
    X("battery.voltage_v", VALUE, "V", "at the terminals", b->battery.terminal_v) \
    X("battery.current_a", VALUE, "A", "positive out of the battery", b->battery.current_a) \
    X("battery.soc", VALUE, "1", "state of charge", b->battery.soc) \
    X("battery.polarisation_v", VALUE, "V", "over the RC branch", b->battery.polarisation_v) \
    X("battery.collapsed", VALUE, "", \
      "1: more power was drawn than the battery can give", b->battery.collapsed ? 1.0 : 0.0) \
    X("bus.voltage_v", VALUE, "V", "at the bridges", b->bus.voltage_v) \
    X("bus.peak_v", VALUE, "V", "highest voltage at the bridges since the run began", \
      b->bus_peak_v) \
    X("driver.message_age_s", VALUE, "s", \
      "age of the demand the controllers have", b->demand_age_s) \
    X("bms.charge_a", VALUE, "A", "charge limit sent to the controllers", b->limits.sent.charge_a) \
    X("bms.contactor", VALUE, "", \
      "contactor as sent to the controllers: 0 not reported, 1 closed, 2 open", \
      (double)b->limits.contactor) \
    X("bms.discharge_a", VALUE, "A", \
      "discharge limit sent to the controllers", b->limits.sent.discharge_a) \
    X("bms.charge_peak_a", VALUE, "A", \
      "short-time charge limit sent to the controllers, 0: none", b->limits.sent.peak_charge_a) \
    X("anti_lock.at_work", VALUE, "", \
      "1: the anti-lock system has raised its flag", b->abs_unit.anti_lock.at_work ? 1.0 : 0.0) \
    X("anti_lock.failed", VALUE, "", \
      "1: switched itself off, a wheel's sensor shows zero", \
      b->abs_unit.anti_lock.failed ? 1.0 : 0.0) \
    X("anti_lock.reference_m_per_s", VALUE, "m/s", \
      "of the vehicle, as the system takes it", b->abs_unit.anti_lock.reference_m_per_s) \
    X("battery.chemical_w", RATE, "W", \
      "power drawn from the cells, mean over the row", b->booked.chemical_j) \
    X("battery.loss_w", RATE, "W", \
      "heat in the battery, mean over the row", b->booked.battery_j)

/* X(name, kind, unit, meaning, expression of the wheel w) */
#define WHEEL_SIGNALS(X) \
    X("motor_torque_nm", RATE, "N.m", \
      "airgap torque, positive driving forward, mean over the row", \
      w->totals.torque_impulse_nms) \
    X("hydraulic_torque_nm", RATE, "N.m", \
      "positive against forward motion, mean over the row", w->totals.hydraulic_impulse_nms) \
    X("braking_torque_nm", RATE, "N.m", \
      "hydraulic brake less airgap torque, positive against forward motion, mean over the row", \
      w->totals.hydraulic_impulse_nms - w->totals.torque_impulse_nms) \
    X("hydraulic_reported_nm", VALUE, "N.m", \
      "hydraulic torque as its sensor reports it", w->brake_sensor.report.torque_nm) \
    X("dc_w", RATE, "W", "power taken from the bus, mean over the row", w->totals.dc_j) \
    X("shaft_w", RATE, "W", \
      "power of the motor at the wheel, positive driving, mean over the row", w->totals.shaft_j) \
    X("copper_w", RATE, "W", "heat in the winding, mean over the row", w->totals.copper_j) \
    X("iron_w", RATE, "W", "heat in the iron, mean over the row", w->totals.iron_j) \
    X("inverter_w", RATE, "W", \
      "heat, mean over the row", \
      w->totals.conduction_j + w->totals.diode_j + w->totals.switching_j) \
    X("phase_a_a", VALUE, "A", "current into phase a", plant_inverse_clarke(w->rotor.terminal).a) \
    X("phase_b_a", VALUE, "A", "current into phase b", plant_inverse_clarke(w->rotor.terminal).b) \
    X("phase_c_a", VALUE, "A", "current into phase c", plant_inverse_clarke(w->rotor.terminal).c) \
    X("current_d_a", VALUE, "A", \
      "direct-axis current, peak phase value", plant_park(w->rotor.terminal, w->rotor.axis).d) \
    X("current_q_a", VALUE, "A", \
      "quadrature-axis current, peak phase value", \
      plant_park(w->rotor.terminal, w->rotor.axis).q) \
    X("phase_a_sampled_a", VALUE, "A", \
      "current of phase a at the input of its converter, last sample", w->sampled_a.a) \
    X("phase_b_sampled_a", VALUE, "A", "likewise, phase b", w->sampled_a.b) \
    X("phase_c_sampled_a", VALUE, "A", "likewise, phase c", w->sampled_a.c) \
    X("speed_measured_rad_per_s", VALUE, "rad/s", \
      "of the wheel by its speed sensor, magnitude", w->ring.speed_rad_s) \
    X("valve", VALUE, "", \
      "anti-lock system: 0 open, 1 pressure rises, 2 is kept, 3 is let go", \
      (double)w->brake.valve) \
    X("winding_sensor_c", VALUE, "degC", \
      "of the winding by its sensor", w->winding_sensor.reported_c) \
    X("peak_current_a", VALUE, "A", \
      "longest current vector since the run began, active short circuits apart", \
      sqrt(w->peak_a2)) \
    X("speed_rad_per_s", VALUE, "rad/s", "of the wheel", w->motion.speed_rad_s) \
    X("load_n", VALUE, "N", "of the wheel on the road", w->motion.load_n) \
    X("tyre_n", VALUE, "N", \
      "force of the tyre, positive forward; 0 where wheels cannot slip", w->motion.force_n) \
    X("hydraulic_reason", VALUE, "", \
      OUTPUT_TEXT.hydraulic_reason, (double)w->slow.hydraulic_reason) \
    X("housing_temperature_c", VALUE, "degC", "of the motor's housing", w->winding.outer_c) \
    X("heatsink_temperature_c", VALUE, "degC", "of the inverter's heat sink", w->switches.outer_c) \
    X("theta_turn", VALUE, "turn", "electrical angle of the rotor", w->rotor.theta_turn) \
    X("winding_temperature_c", VALUE, "degC", "of the winding", w->winding.temperature_c) \
    X("switch_temperature_c", VALUE, "degC", "of the switches", w->switches.temperature_c) \
    X("winding_used_c", VALUE, "degC", \
      "of the winding as the controller uses it: sensor, or estimate", \
      1e-2 * controller_temperatures(&w->controller.slow).winding_cC) \
    X("switch_used_c", VALUE, "degC", "likewise, of the switches", \
      1e-2 * controller_temperatures(&w->controller.slow).switch_cC) \
    X("bridge", VALUE, "", \
      OUTPUT_TEXT.bridge, \
      (double)w->active.bridge) \
    X("command_nm", VALUE, "N.m", \
      OUTPUT_TEXT.motor_torque_command_nm, \
      1e-3 * w->slow.motor_torque_command_mNm) \
    X("estimate_nm", VALUE, "N.m", \
      OUTPUT_TEXT.motor_torque_estimate_nm, \
      1e-3 * w->slow.motor_torque_estimate_mNm) \
    X("estimate_uncertainty_nm", VALUE, "N.m", \
      OUTPUT_TEXT.motor_torque_uncertainty_nm, \
      1e-3 * w->slow.motor_torque_uncertainty_mNm) \
    X("hydraulic_command_nm", VALUE, "N.m", \
      OUTPUT_TEXT.hydraulic_torque_nm, \
      1e-3 * w->slow.hydraulic_torque_mNm) \
    X("available_nm", VALUE, "N.m", \
      OUTPUT_TEXT.electric_brake_available_nm, \
      1e-3 * w->slow.electric_brake_available_mNm) \
    X("available_ahead_nm", VALUE, "N.m", \
      OUTPUT_TEXT.electric_brake_ahead_nm, \
      1e-3 * w->slow.electric_brake_ahead_mNm) \
    X("drive_available_nm", VALUE, "N.m", \
      OUTPUT_TEXT.drive_available_nm, 1e-3 * w->slow.drive_available_mNm) \
    X("drive_ahead_nm", VALUE, "N.m", \
      OUTPUT_TEXT.drive_ahead_nm, 1e-3 * w->slow.drive_ahead_mNm) \
    X("speed_estimate_rad_per_s", VALUE, "rad/s", \
      OUTPUT_TEXT.speed_rad_per_s, 1e-3 * w->slow.speed_mrad_s) \
    X("theta_estimate_turn", VALUE, "turn", \
      "estimated electrical angle of the controller", \
      (double)foc_latest(&w->controller.fast.foc)->rotor.theta_turn / 65536.0) \
    X("current_d_estimate_a", VALUE, "A", \
      OUTPUT_TEXT.current_d_a, 1e-3 * w->slow.i_d_mA) \
    X("current_q_estimate_a", VALUE, "A", \
      OUTPUT_TEXT.current_q_a, 1e-3 * w->slow.i_q_mA) \
    X("voltage_estimate_v", VALUE, "V", OUTPUT_TEXT.bus_voltage_v, 1e-3 * w->slow.bus_voltage_mV) \
    X("bus_current_estimate_a", VALUE, "A", \
      OUTPUT_TEXT.bus_current_a, 1e-3 * w->slow.bus_current_mA) \
    X("reason", VALUE, "", \
      OUTPUT_TEXT.torque_reason, (double)w->slow.torque_reason) \
    X("available_reason", VALUE, "", \
      OUTPUT_TEXT.available_reason, (double)w->slow.available_reason) \
    X("ahead_reason", VALUE, "", \
      OUTPUT_TEXT.ahead_reason, (double)w->slow.ahead_reason) \
    X("drive_available_reason", VALUE, "", \
      OUTPUT_TEXT.drive_available_reason, (double)w->slow.drive_available_reason) \
    X("drive_ahead_reason", VALUE, "", \
      OUTPUT_TEXT.drive_ahead_reason, (double)w->slow.drive_ahead_reason) \
    X("waits_for", VALUE, "", OUTPUT_TEXT.waits_for, (double)w->slow.waits_for) \
    X("fault_reason", VALUE, "", \
      OUTPUT_TEXT.fault_reason, (double)w->slow.fault_reason) \
    X("first_fault_reason", VALUE, "", \
      "the first fault of the run, 0 none", (double)w->first_fault) \
    X("first_fault_s", VALUE, "s", "time of the first fault", w->first_fault_s) \
    X("warning_reason", VALUE, "", \
      OUTPUT_TEXT.warning_reason, (double)w->slow.warning_reason) \
    X("direction", VALUE, "", OUTPUT_TEXT.direction, (double)w->slow.direction) \
    X("hydraulic_valid", VALUE, "", \
      OUTPUT_TEXT.hydraulic_valid, w->slow.hydraulic_valid ? 1.0 : 0.0) \
    X("mode", VALUE, "", \
      OUTPUT_TEXT.mode, (double)w->slow.mode) \
    X("stop_lamp", VALUE, "", OUTPUT_TEXT.stop_lamp, w->slow.stop_lamp ? 1.0 : 0.0)

/* clang-format on */

typedef struct {
    const char *name;
    kind_t kind;
    const char *unit, *text;
} line_t;

#define LINE(name, kind, unit, text, expression) {name, kind, unit, text},
#define LEDGER_LINE(name, text) {"energy." #name, VALUE, "J", text},
#define BRAKING_LINE(name, text) {"braking." #name, VALUE, "J", "while the driver brakes: " text},
static const line_t VEHICLE_LINES[] = {BENCH_SIGNALS(LINE)};
static const line_t ACCOUNT_LINES[] = {LEDGER_LIST(LEDGER_LINE) LEDGER_LIST(BRAKING_LINE)};
static const line_t WHEEL_LINES[] = {WHEEL_SIGNALS(LINE)};
/* Of the table of torque limits: the tightest bound of each side, and both bounds of each line,
 * whose names begin with "limit_" and the line's. */
static const line_t TIGHTEST_LINES[] = {
    {"limit_driving_nm", VALUE, "N.m", "controller: tightest bound of the driving torque"},
    {"limit_driving_reason", VALUE, "", "controller: reason of the tightest driving bound"},
    {"limit_braking_nm", VALUE, "N.m", "controller: tightest bound of the motor's braking torque"},
    {"limit_braking_reason", VALUE, "", "controller: reason of the tightest braking bound"}};
static const line_t BOUND_LINES[] = {
    {"driving_nm", VALUE, "N.m",
     "controller: driving bound of this line of the limits, 2147483.6: none"},
    {"braking_nm", VALUE, "N.m",
     "controller: braking bound of this line of the limits, 2147483.6: none"}};

enum {
    VEHICLE_COUNT = sizeof(VEHICLE_LINES) / sizeof(VEHICLE_LINES[0]),
    ACCOUNT_COUNT = sizeof(ACCOUNT_LINES) / sizeof(ACCOUNT_LINES[0]),
    OWN_COUNT = sizeof(WHEEL_LINES) / sizeof(WHEEL_LINES[0]),
    TIGHTEST_COUNT = sizeof(TIGHTEST_LINES) / sizeof(TIGHTEST_LINES[0]),
    SIDES = sizeof(BOUND_LINES) / sizeof(BOUND_LINES[0]),
    FIRST_BOUND = OWN_COUNT + TIGHTEST_COUNT,
    WHEEL_COUNT = FIRST_BOUND + SIDES * TORQUE_LINE_COUNT,
    FIRST_OF_WHEELS = VEHICLE_COUNT + ACCOUNT_COUNT
};
_Static_assert(FIRST_OF_WHEELS + BENCH_WHEELS_MAX * WHEEL_COUNT <= SIGNALS_MAX,
               "SIGNALS_MAX is less than the signals of BENCH_WHEELS_MAX wheels");

int signals_count(const bench_t *bench)
{
    return (int)FIRST_OF_WHEELS + bench->wheels * (int)WHEEL_COUNT;
}

/* Of a wheel's signal, its place among them. */
static int of_wheel(int index)
{
    return (index - (int)FIRST_OF_WHEELS) % (int)WHEEL_COUNT;
}

static const line_t *line_at(int index)
{
    if (index < (int)VEHICLE_COUNT) {
        return &VEHICLE_LINES[index];
    }
    if (index < (int)FIRST_OF_WHEELS) {
        return &ACCOUNT_LINES[index - (int)VEHICLE_COUNT];
    }
    const int place = of_wheel(index);
    if (place < (int)OWN_COUNT) {
        return &WHEEL_LINES[place];
    }
    return place < (int)FIRST_BOUND ? &TIGHTEST_LINES[place - (int)OWN_COUNT]
                                    : &BOUND_LINES[(place - (int)FIRST_BOUND) % (int)SIDES];
}

/* "limit_max_torque_", the line's name in small letters; "" for other signals. */
static void prefix_of(int index, char prefix[NAME_LENGTH])
{
    prefix[0] = '\0';
    const int bound = of_wheel(index) - (int)FIRST_BOUND;
    if (bound >= 0) {
        snprintf(prefix, NAME_LENGTH, "limit_%s_",
                 torque_limits_line_text((torque_line_t)(bound / (int)SIDES)));
        for (char *at = prefix; *at != '\0'; at++) {
            *at = (char)tolower((unsigned char)*at);
        }
    }
}

void signals_name(const bench_t *bench, int index, char *name, size_t size)
{
    (void)bench;
    if (index < (int)FIRST_OF_WHEELS) {
        snprintf(name, size, "%s", line_at(index)->name);
    } else {
        char prefix[NAME_LENGTH];
        prefix_of(index, prefix);
        snprintf(name, size, "wheel%d.%s%s", (index - (int)FIRST_OF_WHEELS) / (int)WHEEL_COUNT,
                 prefix, line_at(index)->name);
    }
}

int signals_find(const bench_t *bench, const char *name)
{
    char known[NAME_LENGTH];
    for (int k = 0; k < signals_count(bench); k++) {
        signals_name(bench, k, known, sizeof(known));
        if (strcmp(known, name) == 0) {
            return k;
        }
    }
    return -1;
}

const char *signals_unit(const bench_t *bench, int index)
{
    (void)bench;
    return line_at(index)->unit;
}

const char *signals_text(const bench_t *bench, int index)
{
    (void)bench;
    return line_at(index)->text;
}

bool signals_is_rate(const bench_t *bench, int index)
{
    (void)bench;
    return line_at(index)->kind == RATE;
}

int signals_group(int index)
{
    if (index < (int)FIRST_OF_WHEELS) {
        return index < (int)VEHICLE_COUNT ? SIGNALS_OF_VEHICLE : SIGNALS_OF_ACCOUNTS;
    }
    const int first =
        of_wheel(index) < (int)OWN_COUNT ? SIGNALS_OF_FIRST_WHEEL : SIGNALS_OF_FIRST_LIMITS;
    return first + (index - (int)FIRST_OF_WHEELS) / (int)WHEEL_COUNT;
}

/* The values of one group in the order of its lines; written one after the other, so that the
 * compiler generates stores without a table. */
#define READ(name, kind, unit, text, expression) *to++ = (expression);
#define READ_RUN(name, text) *to++ = run.name;
#define READ_BRAKING(name, text) *to++ = braking.name;

static void read_vehicle(const bench_t *b, double *to)
{
    BENCH_SIGNALS(READ)
}

static void read_accounts(const bench_t *bench, double *to)
{
    const ledger_t run = bench_ledger(bench);
    const ledger_t braking = bench_braking_ledger(bench, &run);
    LEDGER_LIST(READ_RUN)
    LEDGER_LIST(READ_BRAKING)
}

static void read_wheel(const wheel_t *w, double *to)
{
    WHEEL_SIGNALS(READ)
}

static double *read_tightest(const limit_t lines[TORQUE_LINE_COUNT], double *to)
{
    const torque_line_t tightest = torque_limits_tightest_line(lines);
    *to++ = 1e-3 * lines[tightest].torque_mNm;
    *to++ = (double)lines[tightest].reason;
    return to;
}

static void read_limits(const wheel_t *w, double *to)
{
    const torque_limits_t *table = controller_limits(&w->controller.slow);
    to = read_tightest(table->driving, to);
    to = read_tightest(table->braking, to);
    for (int line = 0; line < (int)TORQUE_LINE_COUNT; line++) {
        *to++ = 1e-3 * table->driving[line].torque_mNm;
        *to++ = 1e-3 * table->braking[line].torque_mNm;
    }
}

void signals_read_group(const bench_t *bench, int group, double values[SIGNALS_MAX])
{
    switch (group) {
    case SIGNALS_OF_VEHICLE:
        read_vehicle(bench, values);
        break;
    case SIGNALS_OF_ACCOUNTS:
        read_accounts(bench, values + VEHICLE_COUNT);
        break;
    default: {
        const bool own = group < (int)SIGNALS_OF_FIRST_LIMITS;
        const int wheel = group - (int)(own ? SIGNALS_OF_FIRST_WHEEL : SIGNALS_OF_FIRST_LIMITS);
        double *to = values + FIRST_OF_WHEELS + wheel * (int)WHEEL_COUNT;
        if (own) {
            read_wheel(&bench->wheel[wheel], to);
        } else {
            read_limits(&bench->wheel[wheel], to + OWN_COUNT);
        }
        break;
    }
    }
}

double signals_read(const bench_t *bench, int index)
{
    double values[SIGNALS_MAX];
    signals_read_group(bench, signals_group(index), values);
    return values[index];
}
