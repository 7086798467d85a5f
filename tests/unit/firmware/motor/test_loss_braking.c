/* SPDX-License-Identifier: Apache-2.0 */
/* Braking with the motor's losses, against the circuit in double precision. */
#include "motor/loss_braking.h"

#include <math.h>

#include "paper_vehicle.h"
#include "random_values.h"
#include "torque_model.h"
#include "unity.h"

static const double TURN = 6.283185307179586;
static const int32_t NO_VOLTAGE_LIMIT_mV = 1000000;

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
    config.brake.loss_braking = 1;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE; /* no power of an uncertain angle */
    config.drive.loss_per_ampere_uW_A = 252000;
    config.drive.loss_resistance_uOhm = 3400;
}

void tearDown(void) {}

/* The motor's circuit at 25 degC; currents and voltages along the rotation. */
typedef struct {
    double w, r, l, psi, r_i, p;
} circuit_t;

static circuit_t circuit_at(int32_t speed_mrad_s)
{
    const config_motor_t *motor = &config.motor;
    const double w = 1e-3 * speed_mrad_s * motor->pole_pairs;
    const double rise_K = 0.01 * (2500 - motor->reference_temperature_cC);
    const circuit_t out = {
        .w = w,
        .r = 1e-6 * motor->phase_resistance_uOhm *
             (1.0 + 1e-6 * motor->resistance_coefficient_ppm_K * rise_K),
        .l = 1e-9 * motor->d_inductance_nH,
        .psi =
            1e-9 * motor->flux_linkage_nWb * (1.0 + 1e-6 * motor->flux_coefficient_ppm_K * rise_K),
        .r_i = 1e-3 * motor->iron_loss_resistance_mOhm +
               1e-9 * motor->iron_loss_resistance_slope_nOhm_s * w,
        .p = motor->pole_pairs,
    };
    return out;
}

/* DC power and terminal i_q of a terminal i_d and a torque current x. */
static double power_w(const circuit_t *c, double d, double x, double *i_q)
{
    const double g = c->w * c->l / c->r_i;
    *i_q = (1.0 + g * g) * x + c->w * c->psi / c->r_i + g * d;
    const double u_d = c->r * d - c->w * c->l * x;
    const double u_q = c->r * *i_q + c->w * c->psi + c->w * c->l * (d + g * x);
    return 1.5 * (u_d * d + u_q * *i_q);
}

/* Of currents, between motor and battery. */
static double bridge_w(double d, double i_q)
{
    const double current = hypot(d, i_q);
    return 0.252 * current + 1.5 * 0.0034 * current * current;
}

/* From the battery, of a current setpoint. */
static double dc_power_w(const circuit_t *c, double d, double i_q)
{
    const double g = c->w * c->l / c->r_i;
    const double x = (i_q - c->w * c->psi / c->r_i - g * d) / (1.0 + g * g);
    double same = 0.0;
    return power_w(c, d, x, &same) + bridge_w(d, i_q);
}

/* The braking torque that returns a power on the current circle, by bisection over x. */
static double returning_nm(const circuit_t *c, double current_a, double returned_w)
{
    double low = -current_a;
    double high = 0.0;
    for (int n = 0; n < 60; n++) {
        const double x = 0.5 * (low + high);
        double i_q = 0.0;
        double d = -current_a;
        for (int k = 0; k < 30; k++) { /* i_q depends a little on i_d */
            (void)power_w(c, d, x, &i_q);
            d = -sqrt(fmax(current_a * current_a - i_q * i_q, 0.0));
        }
        if (power_w(c, d, x, &i_q) + bridge_w(d, i_q) < -returned_w) {
            low = x;
        } else {
            high = x;
        }
    }
    return -1.5 * c->p * c->psi * low;
}

static double torque_nm(const circuit_t *c, double current_a)
{
    return returning_nm(c, current_a, 0.0);
}

static const feasible_returned_t NO_POWER = {.power_b = 0, .margin_b = 0};

static int32_t bound_mNm(int32_t speed_mrad_s, int32_t share_q15, feasible_returned_t returned,
                         loss_braking_t *losses)
{
    static motor_model_t model;
    static feasible_set_t set;
    model = model_at(&config, speed_mrad_s, 2500);
    set = feasible_set_at(&model, NO_VOLTAGE_LIMIT_mV);
    const feasible_side_t side = feasible_side_at(&set, SIDE_BRAKING, 200000);
    *losses = loss_braking_at(set.model, returned, share_q15);
    return loss_braking_torque_mNm(&side, losses, feasible_by_returned_mNm(&side, returned));
}

static double friction_nm(int32_t speed_mrad_s)
{
    const motor_model_t model = model_at(&config, speed_mrad_s, 2500);
    return 1e-3 * model_friction_mNm(&model);
}

void test_losses_on_the_current_circle_brake_with_the_torque_of_the_circuit(void)
{
    const double current_a = 1e-3 * config.motor.max_phase_current_mA * 255.0 / 256.0;
    for (int rpm = 80; rpm <= 640; rpm += 40) {
        const int32_t speed_mrad_s = (int32_t)lround(rpm * 1e3 * TURN / 60.0);
        const circuit_t circuit = circuit_at(speed_mrad_s);
        loss_braking_t losses;
        const double expected_nm = torque_nm(&circuit, current_a) + friction_nm(speed_mrad_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * expected_nm + 0.05, expected_nm,
                                  1e-3 * bound_mNm(speed_mrad_s, Q15_ONE, NO_POWER, &losses));
    }
}

/* 74.7 A at 40 km/h (44.4 rad/s, w = 1022 rad/s) and 25 degC:
 *     copper  3/2 31 mOhm I^2                        259.5 W
 *     bridge  0.252 V I + 3/2 3.4 mOhm I^2            47.3 W
 *     iron    3/2 (w (psi + L i_d))^2 / 7.63 Ohm      44.6 W
 * 351 W / 44.4 rad/s = 7.9 N m, with friction 0.1 N m more. */
void test_forty_km_h_are_braked_with_the_losses_of_motor_and_bridge(void)
{
    loss_braking_t losses;
    const double expected_nm = 7.91 + friction_nm(44444);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, expected_nm,
                              1e-3 * bound_mNm(44444, Q15_ONE, NO_POWER, &losses));
}

/* A motor that returns or draws 80 W beyond its model: the torque is that at which it returns
 * nothing. */
void test_what_a_motor_returns_or_draws_beyond_its_model_moves_the_torque_on_the_circle(void)
{
    const double current_a = 1e-3 * config.motor.max_phase_current_mA * 255.0 / 256.0;
    for (int rpm = 80; rpm <= 640; rpm += 40) {
        const int32_t speed_mrad_s = (int32_t)lround(rpm * 1e3 * TURN / 60.0);
        const circuit_t circuit = circuit_at(speed_mrad_s);
        const motor_model_t model = model_at(&config, speed_mrad_s, 2500);
        const int32_t power_b = feasible_power_b(&model, 1600, 50000);
        const feasible_returned_t returns = {.power_b = -power_b};
        const feasible_returned_t draws = {.drawn_b = power_b};
        loss_braking_t losses;
        const double less_nm = returning_nm(&circuit, current_a, -80.0) + friction_nm(speed_mrad_s);
        const double more_nm = returning_nm(&circuit, current_a, 80.0) + friction_nm(speed_mrad_s);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * less_nm + 0.05, less_nm,
                                  1e-3 * bound_mNm(speed_mrad_s, Q15_ONE, returns, &losses));
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * more_nm + 0.05, more_nm,
                                  1e-3 * bound_mNm(speed_mrad_s, Q15_ONE, draws, &losses));
    }
}

/* A random state in which the torque exceeds what the i_d of the map returns at most. */
typedef struct {
    int32_t speed_mrad_s, torque_mNm;
    feasible_returned_t returned;
    double returned_w;
    motor_model_t model;
    feasible_set_t set;
    current_setpoint_t map, out;
} state_t;

static void random_state(random_t *random, state_t *s)
{
    const int32_t magnitude_mrad_s = random_between(random, 8000, 67000);
    s->speed_mrad_s = random_chance(random, 0.5) ? magnitude_mrad_s : -magnitude_mrad_s;
    s->model = model_at(&config, s->speed_mrad_s, 2500);
    s->set = feasible_set_at(&s->model, NO_VOLTAGE_LIMIT_mV);
    const int32_t returned_mA = random_chance(random, 0.3) ? 0 : random_between(random, 0, 6000);
    s->returned.power_b = feasible_power_b(&s->model, returned_mA, 53000);
    s->returned_w = 53e-3 * returned_mA;
    loss_braking_t losses;
    const int32_t most_mNm =
        q_min(bound_mNm(s->speed_mrad_s, Q15_ONE, s->returned, &losses), 45000);
    const int32_t braking_mNm = random_between(random, 0, most_mNm);
    s->torque_mNm = s->speed_mrad_s > 0 ? -braking_mNm : braking_mNm;
    s->map = current_setpoint_step(&s->set, s->torque_mNm, 0);
    s->out = loss_braking_setpoint(&s->set, &losses, s->torque_mNm, s->map);
}

/* What the battery takes comes first: with i_d below the map's exactly that is returned, and the
 * rest of the torque is made by losses; never a draw for it. */
void test_a_setpoint_up_to_the_bound_returns_what_the_battery_takes_and_keeps_its_torque(void)
{
    random_t random = random_seeded(41);
    int beyond = 0;
    for (int n = 0; n < 5000; n++) {
        static state_t s;
        s.returned.margin_b = 0;
        random_state(&random, &s);
        const motor_current_t i = {.d_mA = s.out.i_d_mA, .q_mA = s.out.i_q_mA};
        const motor_point_t at = motor_model_point(&s.model, i);
        TEST_ASSERT_INT32_WITHIN(100, s.torque_mNm, motor_model_torque_mNm(&s.model, at));
        TEST_ASSERT_LESS_OR_EQUAL_INT32(s.map.i_d_mA, s.out.i_d_mA);
        const circuit_t circuit = circuit_at(q_abs(s.speed_mrad_s));
        const double along_a = 1e-3 * (s.speed_mrad_s > 0 ? s.out.i_q_mA : -s.out.i_q_mA);
        const double power_w = dc_power_w(&circuit, 1e-3 * s.out.i_d_mA, along_a);
        TEST_ASSERT_TRUE(power_w > -s.returned_w - 6.0);
        if (s.out.i_d_mA < s.map.i_d_mA) {
            beyond++;
            TEST_ASSERT_DOUBLE_WITHIN(6.0, -s.returned_w, power_w);
        }
        const double squared =
            (double)s.out.i_d_mA * s.out.i_d_mA + (double)s.out.i_q_mA * s.out.i_q_mA;
        TEST_ASSERT_TRUE(sqrt(squared) <= 1.001 * config.motor.max_phase_current_mA);
    }
    TEST_ASSERT_GREATER_THAN_INT(1000, beyond);
}

/* Hall sensors: half a period of rotation, w^2 T / 2, times 3/2 psi |i_d| may be returned more. It
 * is kept back from the management's limit, as far as that goes, and not from the fold-back's. */
void test_the_uncertain_angle_reduces_only_what_the_management_permits(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    random_t random = random_seeded(42);
    int kept_back = 0;
    for (int n = 0; n < 3000; n++) {
        static state_t s;
        s.returned.margin_b = random_chance(&random, 0.5) ? INT32_MAX : 0;
        random_state(&random, &s);
        if (s.out.i_d_mA >= s.map.i_d_mA) {
            continue;
        }
        const circuit_t circuit = circuit_at(q_abs(s.speed_mrad_s));
        const double along_a = 1e-3 * (s.speed_mrad_s > 0 ? s.out.i_q_mA : -s.out.i_q_mA);
        const double d_a = 1e-3 * s.out.i_d_mA;
        const double angle = circuit.w / (2.0 * config.drive.pwm_frequency_Hz);
        const double more_w = 1.5 * circuit.w * circuit.psi * -d_a * angle;
        const double kept_w = s.returned.margin_b == 0 ? fmin(more_w, s.returned_w) : 0.0;
        kept_back += kept_w > 20.0;
        TEST_ASSERT_DOUBLE_WITHIN(6.0 + 0.1 * kept_w, kept_w - s.returned_w,
                                  dc_power_w(&circuit, d_a, along_a));
    }
    TEST_ASSERT_GREATER_THAN_INT(100, kept_back);
}

/* The angle of slow halls, a sector in 32 ms or more, is off by up to 30 degrees; extrapolated, by
 * what a deceleration turns in a sector's time: less with the square of the speed. Beside such an
 * error the currents of a motor without saliency drive at no time, but for 2 % of i_q and 0.1 A,
 * which iron losses add to it as i_d falls. */
void test_with_hall_sensors_the_error_of_their_angle_drives_at_no_time(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    random_t random = random_seeded(43);
    const double sector_rad_s = TURN / 6.0 / 0.032;
    int lowered = 0;
    for (int n = 0; n < 5000; n++) {
        const int32_t speed_mrad_s = random_between(&random, 200, 5600);
        static motor_model_t model;
        model = model_at(&config, speed_mrad_s, 2500);
        const feasible_set_t set = feasible_set_at(&model, NO_VOLTAGE_LIMIT_mV);
        const feasible_returned_t returned = {.power_b = -feasible_power_b(&model, 200, 53000)};
        loss_braking_t losses = loss_braking_at(&model, returned, Q15_ONE);
        losses.by_map_mNm = 0;
        const int32_t torque_mNm = -random_between(&random, 0, 20000);
        const current_setpoint_t map = current_setpoint_step(&set, torque_mNm, 0);
        const current_setpoint_t out = loss_braking_setpoint(&set, &losses, torque_mNm, map);
        const double ratio = 1e-3 * speed_mrad_s * config.motor.pole_pairs / sector_rad_s;
        const double error_rad = atan(1.0 / (sqrt(3.0) * fmax(1.0, ratio * ratio)));
        const double i_d_a = 1e-3 * out.i_d_mA;
        const double i_q_a = 1e-3 * out.i_q_mA;
        if (i_q_a < 0.0) {
            lowered += i_d_a < map.i_d_mA * 1e-3;
            TEST_ASSERT_TRUE(fabs(i_d_a) * sin(error_rad) <= -1.02 * i_q_a * cos(error_rad) + 0.1);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(2000, lowered);
}

void test_derating_takes_loss_braking_away(void)
{
    const int32_t speed_mrad_s = 44444;
    loss_braking_t losses;
    const int32_t whole_mNm = bound_mNm(speed_mrad_s, Q15_ONE, NO_POWER, &losses);
    const int32_t half_mNm = bound_mNm(speed_mrad_s, 16384, NO_POWER, &losses);
    const int32_t none_mNm = bound_mNm(speed_mrad_s, 0, NO_POWER, &losses);
    config.brake.loss_braking = 0;
    TEST_ASSERT_INT32_WITHIN(20, bound_mNm(speed_mrad_s, Q15_ONE, NO_POWER, &losses), none_mNm);
    /* A quarter of the copper loss. */
    TEST_ASSERT_INT32_WITHIN((whole_mNm - none_mNm) / 10, none_mNm + (whole_mNm - none_mNm) / 4,
                             half_mNm);
}

void test_driving_setpoints_and_those_of_a_battery_that_takes_the_power_stay_as_they_are(void)
{
    const motor_model_t model = model_at(&config, 44444, 2500);
    const feasible_set_t set = feasible_set_at(&model, NO_VOLTAGE_LIMIT_mV);
    for (int32_t torque_mNm = -40000; torque_mNm <= 40000; torque_mNm += 5000) {
        const int32_t power_b = feasible_power_b(&model, torque_mNm > 0 ? 0 : 200000, 53000);
        const feasible_returned_t returned = {.power_b = power_b, .margin_b = 0};
        const loss_braking_t losses = loss_braking_at(set.model, returned, Q15_ONE);
        const current_setpoint_t map = current_setpoint_step(&set, torque_mNm, 0);
        const current_setpoint_t out = loss_braking_setpoint(&set, &losses, torque_mNm, map);
        TEST_ASSERT_EQUAL_INT32(map.i_d_mA, out.i_d_mA);
        TEST_ASSERT_EQUAL_INT32(map.i_q_mA, out.i_q_mA);
    }
}
