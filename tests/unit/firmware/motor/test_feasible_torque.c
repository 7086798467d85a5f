/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "config/bases.h"
#include "motor/feasible_torque.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_motor.h"
#include "torque_model.h"
#include "unity.h"

static config_t config;

void setUp(void) {}

void tearDown(void) {}

typedef struct {
    int32_t lowest_mNm, highest_mNm;
} range_t;

/* Shaft torques between the ends of the voltage ellipse, signed. */
static range_t voltage_range(const motor_model_t *model, int32_t phase_mV)
{
    const feasible_set_t set = feasible_set_at(model, phase_mV);
    const int32_t cap_mNm = 2 * config.motor.max_torque_mNm;
    feasible_side_t driving = feasible_side_at(&set, SIDE_DRIVING, cap_mNm);
    feasible_side_t braking = feasible_side_at(&set, SIDE_BRAKING, cap_mNm);
    const int32_t driving_mNm = feasible_by_voltage_mNm(&driving);
    const int32_t braking_mNm = feasible_by_voltage_mNm(&braking);
    const bool forward = model->speed_mrad_s >= 0;
    const range_t out = {.lowest_mNm = forward ? -braking_mNm : -driving_mNm,
                         .highest_mNm = forward ? driving_mNm : braking_mNm};
    return out;
}

/* The map's i_d at the bound's torque, where it is below that of field weakening. */
static double map_d_a;
static double weakening_d_a;

/* Maximum torque per voltage without losses: largest torque on the circle of flux U/w, by trial. */
static double voltage_best_d_a(const reference_motor_t *m, double phase_v)
{
    const double flux_wb = phase_v / fabs(m->w_rad_s);
    double best_a = 0.0;
    double most = 0.0;
    for (int n = 1; n < 20000; n++) {
        const double angle = n * 3.14159265358979 / 20000.0;
        const double d_a = (flux_wb * cos(angle) - m->psi_wb) / m->l_d_h;
        const double torque =
            (m->psi_wb + (m->l_d_h - m->l_q_h) * d_a) * flux_wb * sin(angle) / m->l_q_h;
        if (torque > most) {
            most = torque;
            best_a = d_a;
        }
    }
    return best_a;
}

/* Down to maximum torque per voltage, to the current circle less 0.4 %; above the derating
 * temperature the part beyond the configured field weakening fades out. */
static double end_of_weakening_a(const reference_motor_t *m, double phase_v, double winding_c)
{
    const config_motor_t *motor = &config.motor;
    const double always_a =
        bases_current_mA(&config, config.current_loop.field_weakening_current_pu_q15) * 1e-3;
    const double circle_a = 1e-3 * motor->max_phase_current_mA * (1.0 - 1.0 / 256.0);
    const double from_c = 0.01 * motor->derate_winding_temperature_cC;
    const double to_c = 0.01 * motor->max_winding_temperature_cC;
    const double share = fmin(fmax((to_c - winding_c) / (to_c - from_c), 0.0), 1.0);
    const double most_a = always_a + share * fmax(circle_a - always_a, 0.0);
    return fmax(-most_a, fmin(voltage_best_d_a(m, phase_v), 0.0));
}

static double weakest_d_a(void)
{
    return fmin(weakening_d_a, map_d_a);
}

/* Voltage of a torque current at the largest field weakening. */
static double volts(const reference_motor_t *m, double i_qt_a)
{
    const double i_dt_a = weakest_d_a() + m->w_rad_s * m->l_q_h * m->iron_siemens * i_qt_a;
    const reference_point_t at = reference_point(m, i_dt_a, i_qt_a);
    return hypot(m->resistance_ohm * at.i_d_a - m->w_rad_s * m->l_q_h * i_qt_a,
                 m->resistance_ohm * at.i_q_a + m->w_rad_s * (m->l_d_h * i_dt_a + m->psi_wb));
}

static double shaft_mNm(const reference_motor_t *m, const motor_model_t *model, double i_qt_a)
{
    const double i_dt_a = weakest_d_a() + m->w_rad_s * m->l_q_h * m->iron_siemens * i_qt_a;
    return reference_point(m, i_dt_a, i_qt_a).torque_nm * 1e3 - model_friction_mNm(model);
}

/* The torque current on one side at which the voltage is most_v: from the point of least voltage by
 * doubling, then by bisection. */
static double end_a(const reference_motor_t *m, double from_a, double most_v, double sign)
{
    double inside_a = from_a;
    double beyond_a = from_a;
    for (double step_a = 1.0; volts(m, beyond_a) <= most_v; step_a *= 2.0) {
        inside_a = beyond_a;
        beyond_a += sign * step_a;
    }
    for (int n = 0; n < 30; n++) {
        const double middle_a = 0.5 * (inside_a + beyond_a);
        if (volts(m, middle_a) <= most_v) {
            inside_a = middle_a;
        } else {
            beyond_a = middle_a;
        }
    }
    return inside_a;
}

static double least_volts_at_a(const reference_motor_t *m)
{
    double low_a = -3000.0;
    double high_a = 3000.0;
    for (int n = 0; n < 40; n++) { /* the square is convex */
        const double a = low_a + (high_a - low_a) / 3.0;
        const double b = high_a - (high_a - low_a) / 3.0;
        if (volts(m, a) <= volts(m, b)) {
            high_a = b;
        } else {
            low_a = a;
        }
    }
    return 0.5 * (low_a + high_a);
}

/* The bound lies between those of a voltage 15 mV smaller and 15 mV larger (the model's roundings
 * are below 3 mV each), within the rounding of a torque, 0.2 % of rated. */
static void assert_end(const reference_motor_t *m, const motor_model_t *model, double most_v,
                       double sign, int32_t found_mNm)
{
    const int32_t airgap_mNm = found_mNm + (int32_t)lround(model_friction_mNm(model));
    map_d_a =
        1e-3 * map_d_mA(&config, model->speed_mrad_s, model->winding_temperature_cC, airgap_mNm);
    map_d_a = fmax(map_d_a, -1e-3 * config.motor.max_phase_current_mA);
    const double middle_a = least_volts_at_a(m);
    const double inner_mNm = shaft_mNm(m, model, end_a(m, middle_a, most_v - 0.015, sign)) * sign;
    const double outer_mNm = shaft_mNm(m, model, end_a(m, middle_a, most_v + 0.015, sign)) * sign;
    /* A bound on the other side of zero counts as zero. Where the current would cancel the flux of
     * the magnet, it is clamped far beyond any limit. */
    const double most_mNm = 2.0 * config.motor.max_torque_mNm;
    const double rounding_mNm = 2e-3 * config.motor.rated_torque_mNm;
    TEST_ASSERT_TRUE(found_mNm * sign >= fmin(inner_mNm - rounding_mNm, most_mNm));
    map_d_a = 0.0;
    TEST_ASSERT_TRUE(found_mNm * sign <= fmax(outer_mNm + rounding_mNm, rounding_mNm) ||
                     found_mNm * sign > most_mNm);
}

static void compare(double least_speed_mrad_s, double most_speed_mrad_s, int cases,
                    int least_without_torque)
{
    random_t random = random_seeded(3);
    int bounded = 0;
    int without_torque = 0;
    for (int n = 0; n < cases; n++) {
        const int32_t sign = random_chance(&random, 0.5) ? 1 : -1;
        const int32_t speed_mrad_s =
            sign * (int32_t)random_real(&random, least_speed_mrad_s, most_speed_mrad_s);
        const int32_t temperature_cC = random_between(&random, -2000, 14000);
        const int32_t phase_mV = random_between(&random, 15000, 40000);
        const motor_model_t model = model_at(&config, speed_mrad_s, temperature_cC);
        const reference_motor_t m = reference_motor(&config, speed_mrad_s, temperature_cC);
        const range_t limit = voltage_range(&model, phase_mV);
        map_d_a = 0.0;
        weakening_d_a = end_of_weakening_a(&m, phase_mV * 1e-3, temperature_cC * 1e-2);
        const double middle_a = least_volts_at_a(&m);
        if (volts(&m, middle_a) > phase_mV * 1e-3) {
            without_torque++;
            TEST_ASSERT_TRUE((limit.lowest_mNm == 0 && limit.highest_mNm == 0) ||
                             volts(&m, middle_a) < phase_mV * 1e-3 + 0.02);
            continue;
        }
        bounded++;
        assert_end(&m, &model, phase_mV * 1e-3, -1.0, limit.lowest_mNm);
        assert_end(&m, &model, phase_mV * 1e-3, 1.0, limit.highest_mNm);
    }
    TEST_ASSERT_GREATER_THAN_INT(cases / 3, bounded);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(least_without_torque, without_torque);
}

void test_voltage_bounds_of_a_surface_magnet_motor_match_the_circuit_in_double_precision(void)
{
    config = paper_vehicle();
    compare(30000.0, 90000.0, 150, 4);
}

void test_voltage_bounds_of_a_salient_motor_match_the_circuit_in_double_precision(void)
{
    config = salient_vehicle();
    /* At maximum torque per voltage there is always some torque, but for the losses. */
    compare(40000.0, 400000.0, 150, 1);
}

void test_voltage_bound_is_above_max_torque_at_standstill(void)
{
    config = paper_vehicle();
    const motor_model_t model = model_at(&config, 0, 2500);
    const range_t limit = voltage_range(&model, 25000);
    TEST_ASSERT_LESS_THAN_INT32(-config.motor.max_torque_mNm, limit.lowest_mNm);
    TEST_ASSERT_GREATER_THAN_INT32(config.motor.max_torque_mNm, limit.highest_mNm);
}

void test_voltage_bounds_are_symmetric_in_the_direction_of_rotation(void)
{
    config = salient_vehicle();
    const motor_model_t forward = model_at(&config, 70000, 2500);
    const motor_model_t backward = model_at(&config, -70000, 2500);
    const range_t a = voltage_range(&forward, 28000);
    const range_t b = voltage_range(&backward, 28000);
    TEST_ASSERT_INT32_WITHIN(30, a.highest_mNm, -b.lowest_mNm);
    TEST_ASSERT_INT32_WITHIN(30, a.lowest_mNm, -b.highest_mNm);
    TEST_ASSERT_LESS_THAN_INT32(0, a.lowest_mNm);
    TEST_ASSERT_GREATER_THAN_INT32(0, a.highest_mNm);
}

void test_voltage_bounds_are_zero_at_zero_voltage_and_high_speed(void)
{
    config = paper_vehicle();
    const motor_model_t model = model_at(&config, 60000, 2500);
    const int32_t NONE_mV[] = {0, -1, INT32_MIN};
    for (int k = 0; k < 3; k++) {
        const range_t limit = voltage_range(&model, NONE_mV[k]);
        TEST_ASSERT_EQUAL_INT32(0, limit.lowest_mNm);
        TEST_ASSERT_EQUAL_INT32(0, limit.highest_mNm);
    }
}

/* Inductances of nearly a henry: reactances and the iron loss' share reach the ends of their
 * ranges, and products of the quadratic equations the ends of 64 bits (the sanitizers see it). */
void test_bounds_of_an_extreme_reactance_are_magnitudes(void)
{
    config = salient_vehicle();
    config.motor.d_inductance_nH = 294967752;
    config.motor.q_inductance_nH = 828192455;
    config.motor.iron_loss_resistance_mOhm = 15000;
    config.motor.iron_loss_resistance_slope_nOhm_s = 20000000;
    config.motor.flux_linkage_nWb = 66000000;
    config.motor.flux_coefficient_ppm_K = -10000;
    config.current_loop.field_weakening_current_pu_q15 = 19895;
    config.motor.pole_pairs = 3;
    config.motor.max_phase_current_mA = 200000;
    config.motor.max_speed_mrad_s = 1151917;
    config.battery.max_voltage_mV = 403000;
    config.current_map.lsb_log2 = 6; /* the most negative i_d that a map can have */
    for (int k = 0; k < CONFIG_CURRENT_MAP_POINTS_MAX; k++) {
        config.current_map.current_d_lsb[k] = -32767;
    }
    random_t random = random_seeded(7);
    for (int n = 0; n < 20000; n++) {
        const motor_model_t model = model_at(&config, random_wild(&random), random_wild(&random));
        const feasible_set_t set = feasible_set_at(&model, random_between(&random, 0, 400000));
        const int32_t cap_mNm = random_between(&random, 0, 10 * config.motor.max_torque_mNm);
        feasible_side_t driving = feasible_side_at(&set, SIDE_DRIVING, cap_mNm);
        feasible_side_t braking = feasible_side_at(&set, SIDE_BRAKING, cap_mNm);
        const int32_t power_b =
            feasible_power_b(&model, random_between(&random, 0, 500000), 400000);
        feasible_circle_t circle = {.known = false};
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, feasible_by_voltage_mNm(&driving));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, feasible_by_current_mNm(&driving, &circle));
        const feasible_bounds_t ends = feasible_by_voltage_and_current(&braking, &circle);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, ends.voltage_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, ends.current_mNm);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, feasible_by_drawn_mNm(&driving, power_b));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, feasible_by_drawn_mNm(&braking, power_b));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(
            0, feasible_by_returned_mNm(&braking, (feasible_returned_t){.power_b = power_b}));
    }
}
