/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The current loop of a motor whose iron saturates, in closed loop: the fast step every period, a
 * setpoint every millisecond, and a motor in double whose currents follow from its fluxes by one
 * energy, with cross-saturation. The configuration has that motor's fluxes as its map.
 */
#include "winding.h"

#include <math.h>

#include "config/bases.h"
#include "foc/foc.h"
#include "foc/observer_design.h"
#include "unity.h"

extern const config_t CONFIG_IPM400V;

static const double PI = 3.14159265358979323846;
static const double T = 1e-4;
static const double BUS_V = 380.0;
static const double W_RAD_S = 500.0; /* electrical */
static const double I_BASE_A = 280.0;
static const double R_OHM = 0.018 + 0.004;

/* Inductances of IPM400V without current; 120 A halve L_q, 300 A L_d. */
static const double PSI_WB = 0.066, L_D_H = 0.37e-3, L_Q_H = 1.2e-3;
static const double D_SATURATION_A = 300.0, Q_SATURATION_A = 120.0, CROSS = 0.5;

typedef struct {
    double d, q;
} vector_t;

/* Of fluxes, the magnets' taken off. */
static vector_t current_of(vector_t x)
{
    const double a_d = 4.0 / (pow(L_D_H, 3.0) * D_SATURATION_A * D_SATURATION_A);
    const double a_q = 4.0 / (pow(L_Q_H, 3.0) * Q_SATURATION_A * Q_SATURATION_A);
    const double a_c = CROSS * sqrt(a_d * a_q);
    const vector_t out = {
        .d = x.d / L_D_H + a_d * pow(x.d, 3.0) + a_c * x.d * x.q * x.q,
        .q = x.q / L_Q_H + a_q * pow(x.q, 3.0) + a_c * x.d * x.d * x.q,
    };
    return out;
}

/* d psi over d i of one axis at fluxes, the other flux being free: of the inverse of the matrix of
 * d i over d psi. */
static vector_t inductance_of(vector_t x)
{
    const double h = 1e-6;
    const vector_t i = current_of(x);
    const vector_t by_d = current_of((vector_t){x.d + h, x.q});
    const vector_t by_q = current_of((vector_t){x.d, x.q + h});
    const double dd = (by_d.d - i.d) / h;
    const double dq = (by_q.d - i.d) / h;
    const double qq = (by_q.q - i.q) / h;
    const double determinant = dd * qq - dq * dq;
    const vector_t out = {.d = qq / determinant, .q = dd / determinant};
    return out;
}

/* By relaxation: each flux in turn with the other one held. */
static vector_t flux_of(vector_t i)
{
    vector_t x = {.d = L_D_H * i.d, .q = L_Q_H * i.q};
    for (int n = 0; n < 400; n++) {
        const vector_t error = {.d = i.d - current_of(x).d, .q = i.q - current_of(x).q};
        const vector_t l = inductance_of(x);
        x.d += 0.3 * l.d * error.d;
        x.q += 0.3 * l.q * error.q;
    }
    const vector_t found = current_of(x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, i.d, found.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, i.q, found.q);
    return x;
}

enum { ROWS = 13, BELOW = 10, COLUMNS = 17, D_STEP_mA = 20000, Q_STEP_mA = 12500, LSB_LOG2 = 13 };

static config_t config, constant;

static int16_t entry(double flux_wb)
{
    return (int16_t)lround(flux_wb * 1e9 / (1 << LSB_LOG2));
}

static void make_map(config_flux_map_t *map)
{
    map->d_points = ROWS;
    map->d_negative_points = BELOW;
    map->d_step_mA = D_STEP_mA;
    map->q_points = COLUMNS;
    map->q_step_mA = Q_STEP_mA;
    map->lsb_log2 = LSB_LOG2;
    for (int d = 0; d < ROWS; d++) {
        for (int q = 0; q < COLUMNS; q++) {
            const vector_t i = {.d = 1e-3 * (d - BELOW) * D_STEP_mA, .q = 1e-3 * q * Q_STEP_mA};
            const vector_t x = flux_of(i);
            map->psi_d_lsb[d * COLUMNS + q] = entry(PSI_WB + x.d);
            map->psi_q_lsb[d * COLUMNS + q] = entry(x.q);
        }
    }
}

void setUp(void)
{
    constant = CONFIG_IPM400V;
    constant.drive.dead_time_ns = 0;
    config = constant;
    make_map(&config.flux_map);
}

void tearDown(void) {}

/* ---- the record ---- */

static winding_t around(double i_d_a, double i_q_a)
{
    const winding_t constants = winding_constants(&config);
    const dq_t i = {.d = (int32_t)lround(32768.0 * i_d_a / I_BASE_A),
                    .q = (int32_t)lround(32768.0 * i_q_a / I_BASE_A)};
    const winding_path_t path = {.from_pu = i, .to_pu = i};
    winding_t out;
    TEST_ASSERT_EQUAL_PTR(
        &out, winding_at(&config, &constants, path, config.motor.reference_temperature_cC, &out));
    return out;
}

/* Incremental inductances of the law within what a cell averages over; fluxes and the chord within
 * an entry and the bow of a cell. */
void test_winding_has_the_slopes_and_fluxes_of_the_map_at_the_currents(void)
{
    static const double I_D_A[] = {-150.0, -77.0, -10.0, 0.0};
    static const double I_Q_A[] = {-128.0, -60.0, -1.0, 33.0, 90.0};
    const config_current_loop_t *loop = &config.current_loop;
    for (int k = 0; k < 20; k++) {
        const vector_t i = {.d = I_D_A[k / 5], .q = I_Q_A[k % 5]};
        const winding_t at = around(i.d, i.q);
        const vector_t x = flux_of(i);
        const vector_t l = inductance_of(x);
        TEST_ASSERT_DOUBLE_WITHIN(0.04, l.d / L_D_H,
                                  (double)at.d.inductance_pu_q16 / loop->inductance_d_pu_q16);
        TEST_ASSERT_DOUBLE_WITHIN(0.04, l.q / L_Q_H,
                                  (double)at.q.inductance_pu_q16 / loop->inductance_q_pu_q16);
        /* a (1 - a) R / (1 - exp(-R T/L)) */
        const double gain_d = (1.0 - exp(-R_OHM * T / L_D_H)) / (1.0 - exp(-R_OHM * T / l.d));
        const double gain_q = (1.0 - exp(-R_OHM * T / L_Q_H)) / (1.0 - exp(-R_OHM * T / l.q));
        TEST_ASSERT_DOUBLE_WITHIN(0.04, gain_d,
                                  (double)at.d.proportional_pu_q16 / loop->proportional_d_pu_q16);
        TEST_ASSERT_DOUBLE_WITHIN(0.04, gain_q,
                                  (double)at.q.proportional_pu_q16 / loop->proportional_q_pu_q16);
        const double wb_per_flux = PSI_WB / loop->flux_pu_q16;
        const double psi_d = at.d.flux_pu_q16 * wb_per_flux + (double)at.d.inductance_pu_q16 /
                                                                  loop->inductance_d_pu_q16 *
                                                                  L_D_H * i.d;
        const double psi_q = at.q.flux_pu_q16 * wb_per_flux + (double)at.q.inductance_pu_q16 /
                                                                  loop->inductance_q_pu_q16 *
                                                                  L_Q_H * i.q;
        TEST_ASSERT_DOUBLE_WITHIN(0.001, PSI_WB + x.d, psi_d);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, x.q, psi_q);
        const double chord = (double)at.chord_q_q15 / observer_design_inductance_q15(&config);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, x.q / i.q / L_Q_H, chord);
    }
}

/* Constants as a map: the configuration's own, but for an entry of 2^13 nWb over a cell of 12.5 A,
 * 0.3 % of L_q and 1.1 % of L_d. */
void test_a_map_of_constant_inductances_gives_the_constants(void)
{
    config_flux_map_t *map = &config.flux_map;
    for (int k = 0; k < ROWS * COLUMNS; k++) {
        const double i_d_a = 1e-3 * (k / COLUMNS - BELOW) * D_STEP_mA;
        const double i_q_a = 1e-3 * (k % COLUMNS) * Q_STEP_mA;
        map->psi_d_lsb[k] = entry(PSI_WB + L_D_H * i_d_a);
        map->psi_q_lsb[k] = entry(L_Q_H * i_q_a);
    }
    const winding_t plain = winding_constants(&constant);
    const winding_t at = around(-63.0, 81.0);
    TEST_ASSERT_INT32_WITHIN(plain.d.proportional_pu_q16 / 80, plain.d.proportional_pu_q16,
                             at.d.proportional_pu_q16);
    TEST_ASSERT_INT32_WITHIN(plain.q.proportional_pu_q16 / 250, plain.q.proportional_pu_q16,
                             at.q.proportional_pu_q16);
    TEST_ASSERT_INT32_WITHIN(plain.d.inductance_pu_q16 / 80, plain.d.inductance_pu_q16,
                             at.d.inductance_pu_q16);
    TEST_ASSERT_INT32_WITHIN(plain.q.inductance_pu_q16 / 250, plain.q.inductance_pu_q16,
                             at.q.inductance_pu_q16);
    TEST_ASSERT_INT32_WITHIN(plain.d.flux_pu_q16 / 100, plain.d.flux_pu_q16, at.d.flux_pu_q16);
    TEST_ASSERT_INT32_WITHIN(plain.d.flux_pu_q16 / 100, 0, at.q.flux_pu_q16);
    TEST_ASSERT_INT32_WITHIN(plain.chord_q_q15 / 250, plain.chord_q_q15, at.chord_q_q15);
}

/* ---- in closed loop ---- */

static foc_state_t foc;
static operating_point_state_t slow;
static fast_setpoint_t setpoint;
static fast_report_t report;
static vector_t flux;     /* stator frame, magnets included */
static vector_t acting_v; /* acts from the next sample on */
static double theta;

static vector_t turned(vector_t v, double angle)
{
    const vector_t out = {.d = v.d * cos(angle) - v.q * sin(angle),
                          .q = v.d * sin(angle) + v.q * cos(angle)};
    return out;
}

static vector_t machine_current(void)
{
    const vector_t rotor = turned(flux, -theta);
    return current_of((vector_t){rotor.d - PSI_WB, rotor.q});
}

/* Between two samples, the voltage held in the stator frame. */
static void machine_period(vector_t u_v)
{
    enum { PIECES = 10 };
    for (int n = 0; n < PIECES; n++) {
        const vector_t i = turned(machine_current(), theta);
        flux.d += (u_v.d - R_OHM * i.d) * T / PIECES;
        flux.q += (u_v.q - R_OHM * i.q) * T / PIECES;
        theta += W_RAD_S * T / PIECES;
    }
}

static uint16_t code_of(double i_a)
{
    return (uint16_t)lround(2048.0 + 2048.0 * i_a / I_BASE_A);
}

static vector_t fast_period(const config_t *of)
{
    const vector_t i = machine_current();
    const vector_t i_ab = turned(i, theta);
    const foc_input_t in = {
        .phase_current_code = {code_of(i_ab.d), code_of(-0.5 * i_ab.d + sqrt(0.75) * i_ab.q),
                               code_of(-0.5 * i_ab.d - sqrt(0.75) * i_ab.q)},
        .bus_voltage_code = (uint16_t)lround(4096.0 * BUS_V / 500.0),
        .rotor_angle_turn = (uint16_t)lround(65536.0 * fmod(theta / (2.0 * PI), 1.0)),
    };
    (void)foc_step(&foc, of, &setpoint, &in);
    machine_period(acting_v);
    const int32_t *on_q16 = foc_on_times_q16(&foc);
    double leg_v[3];
    for (int x = 0; x < 3; x++) {
        leg_v[x] = BUS_V * on_q16[x] / 65536.0 / bases_pwm_period_counts(of, BASES_MODEL_TIMER_Hz);
    }
    acting_v.d = (2.0 * leg_v[0] - leg_v[1] - leg_v[2]) / 3.0;
    acting_v.q = (leg_v[1] - leg_v[2]) / sqrt(3.0);
    return i;
}

static void slow_step(const config_t *of, vector_t reference)
{
    foc_report_copy(&foc, &report);
    foc_report_complete(&report);
    report.bridge = BRIDGE_PWM;
    measured_t now = {.report = &report};
    (void)operating_point_rotor(&slow, of, &report);
    const rotor_speed_t speed = {.turn_q32 =
                                     (int32_t)lround(W_RAD_S * T / (2.0 * PI) * 4294967296.0)};
    operating_point_of(&slow, of, speed, of->motor.reference_temperature_cC, &now);
    operating_point_setpoint(&slow, of, (int32_t)lround(1000.0 * reference.d),
                             (int32_t)lround(1000.0 * reference.q), &setpoint);
    setpoint.sequence++;
}

/* L_q/R is 55 ms, the pole that the regulator's zero cancels: a start decays with it. */
enum { SETTLE_ms = 300, PERIODS_IN_ms = 10, ANSWER_ms = 4 };

/* The current settled at one reference, then stepped to another; response: samples from the step
 * on, share of the step along it and across. */
typedef struct {
    double periods_to_63, overshoot, across;
} answer_t;

static answer_t stepped(const config_t *of, vector_t from, vector_t to)
{
    foc_init(&foc, of, BASES_MODEL_TIMER_Hz);
    operating_point_init(&slow, of, BASES_MODEL_TIMER_Hz);
    operating_point_initial_setpoint(of, BASES_MODEL_TIMER_Hz, &setpoint);
    theta = 0.3;
    flux = turned((vector_t){PSI_WB, 0.0}, theta);
    acting_v = (vector_t){0.0, 0.0};
    for (int n = 0; n < SETTLE_ms * PERIODS_IN_ms; n++) {
        if (n % PERIODS_IN_ms == 0) {
            slow_step(of, from);
        }
        (void)fast_period(of);
    }
    const vector_t before = {.d = I_BASE_A * setpoint.i_reference_pu.d / 32768.0,
                             .q = I_BASE_A * setpoint.i_reference_pu.q / 32768.0};
    answer_t out = {.periods_to_63 = 1e3};
    double last = 0.0;
    vector_t after = before;
    for (int n = 0; n < ANSWER_ms * PERIODS_IN_ms; n++) {
        if (n % PERIODS_IN_ms == 0) {
            slow_step(of, to);
            after = (vector_t){.d = I_BASE_A * setpoint.i_reference_pu.d / 32768.0,
                               .q = I_BASE_A * setpoint.i_reference_pu.q / 32768.0};
        }
        const vector_t i = fast_period(of);
        const vector_t step = {.d = after.d - before.d, .q = after.q - before.q};
        const double square = step.d * step.d + step.q * step.q;
        const double along = ((i.d - before.d) * step.d + (i.q - before.q) * step.q) / square;
        const double across = fabs((i.d - before.d) * step.q - (i.q - before.q) * step.d) / square;
        const double level = 1.0 - exp(-1.0);
        if (along >= level && out.periods_to_63 > 999.0) {
            out.periods_to_63 = n - (along - level) / (along - last);
        }
        last = along;
        out.overshoot = fmax(out.overshoot, along - 1.0);
        out.across = fmax(out.across, across);
    }
    return out;
}

static double bandwidth_share(const config_t *of, const answer_t *answer)
{
    const double designed = 1.0 / (2.0 * PI * of->current_loop.bandwidth_Hz * T);
    return designed / (answer->periods_to_63 - 1.5);
}

static const vector_t BEGIN_A[] = {{0.0, 0.0},     {0.0, 60.0},     {-40.0, 120.0}, {-40.0, -120.0},
                                   {-120.0, 40.0}, {-120.0, 130.0}, {-150.0, 0.0},  {-90.0, -90.0}};
enum { BEGINNINGS = 8 };

typedef struct {
    double slowest, fastest, overshoot, across; /* of the designed bandwidth; of the step */
} range_t;

static range_t over_the_plane(const config_t *of, const vector_t *step_a, int steps)
{
    range_t out = {.slowest = 1e9};
    for (int k = 0; k < BEGINNINGS * steps; k++) {
        const vector_t from = BEGIN_A[k / steps];
        const vector_t step = step_a[k % steps];
        const answer_t answer =
            stepped(of, from, (vector_t){.d = from.d + step.d, .q = from.q + step.q});
        const double share = bandwidth_share(of, &answer);
        out.slowest = fmin(out.slowest, share);
        out.fastest = fmax(out.fastest, share);
        out.overshoot = fmax(out.overshoot, answer.overshoot);
        out.across = fmax(out.across, answer.across);
    }
    return out;
}

static const vector_t ONE_AXIS_A[] = {{0.0, 20.0}, {0.0, -20.0}, {-20.0, 0.0}};

void test_a_step_of_one_axis_has_the_designed_response_anywhere_with_the_map(void)
{
    const range_t found = over_the_plane(&config, ONE_AXIS_A, 3);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0, found.slowest);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1.0, found.fastest);
    TEST_ASSERT_TRUE(found.overshoot < 0.03 && found.across < 0.18);
}

/* The flux of one axis falls or rises with the current of the other, which no gain of one axis
 * counts. */
void test_a_step_of_both_axes_is_a_third_faster_or_a_quarter_slower_at_most(void)
{
    static const vector_t BOTH_A[] = {{15.0, -15.0}, {-15.0, -15.0}, {15.0, 15.0}, {-15.0, 15.0}};
    const range_t found = over_the_plane(&config, BOTH_A, 4);
    TEST_ASSERT_TRUE(found.slowest > 0.75 && found.fastest < 1.35);
    TEST_ASSERT_TRUE(found.overshoot < 0.05 && found.across < 0.18);
}

/* That the map makes the difference: 120 A leave a quarter of L_q. */
void test_with_constants_the_same_loop_is_several_times_too_fast_and_overshoots(void)
{
    const range_t found = over_the_plane(&constant, ONE_AXIS_A, 3);
    TEST_ASSERT_TRUE(found.fastest > 3.0 && found.overshoot > 0.5 && found.across > 0.5);
}
