/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Loss braking of a motor of powers of two: each condition at its limit, and the passes along the
 * current circle and over i_d in double precision. A unit of power is 2^16 of the binary scale.
 */
#include "motor/loss_braking.h"

#include <math.h>

#include "core/q15.h"
#include "plain_motor.h"
#include "random_values.h"
#include "unity.h"

enum { POWER_LOG2 = 16, ROUNDS = 3000, MOST_b = 1 << 22, WHOLE_b = 255 << 14 };

static plain_motor_t motor;
static const feasible_returned_t NO_POWER = {.power_b = 0, .margin_b = 0};

void setUp(void)
{
    plain_motor_init(&motor);
    motor.config.brake.loss_braking = 1;
    motor.config.motor.max_torque_mNm = 256 * 100; /* a band of 100 mN m beyond the map's torque */
    motor.config.motor.max_phase_current_mA = MOST_b / 2;
}

void tearDown(void) {}

/* ---- current ---- */

void test_losses_may_take_the_phase_current_less_a_256th_and_the_derating(void)
{
    TEST_ASSERT_EQUAL_INT32(WHOLE_b, loss_braking_at(&motor.model, NO_POWER, Q15_ONE).current_b);
    TEST_ASSERT_EQUAL_INT32(255 * 32766 / 2,
                            loss_braking_at(&motor.model, NO_POWER, 32766).current_b);
    TEST_ASSERT_EQUAL_INT32(WHOLE_b / 2,
                            loss_braking_at(&motor.model, NO_POWER, 1 << 14).current_b);
    motor.config.brake.loss_braking = 0;
    TEST_ASSERT_EQUAL_INT32(0, loss_braking_at(&motor.model, NO_POWER, Q15_ONE).current_b);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED,
                            loss_braking_at(&motor.model, NO_POWER, Q15_ONE).by_map_mNm);
}

/* ---- torque without a returned power ---- */

static int32_t torque_mNm(loss_braking_t *losses, int32_t by_map_mNm)
{
    const feasible_side_t side = plain_side(&motor, SIDE_BRAKING, MOST_b);
    return loss_braking_torque_mNm(&side, losses, by_map_mNm);
}

/* I = 2^22: R I^2 of 1/4 is 2^18, the bridge of 2^16 V 2^14 W. */
void test_the_circle_is_not_used_where_the_battery_takes_more_than_it_loses(void)
{
    motor.model.resistance_b = SCALED_ONE / 4;
    motor.model.emf_b = 1 << 23;
    motor.set.power = (feasible_power_t){.b = 1 << 23, .c_dd = SCALED_ONE / 4};
    motor.constants.loss_b = 1 << 16;
    const int32_t loss_b = (1 << 18) + (1 << 14);
    loss_braking_t losses = {.current_b = MOST_b, .returned = {.power_b = loss_b}};
    TEST_ASSERT_GREATER_THAN_INT32(1000, torque_mNm(&losses, 1000));
    TEST_ASSERT_GREATER_THAN_INT32(1000, losses.torque_mNm);
    losses.returned.power_b++;
    TEST_ASSERT_EQUAL_INT32(1000, torque_mNm(&losses, 1000));
    TEST_ASSERT_EQUAL_INT32(0, losses.torque_mNm);
    losses = (loss_braking_t){.current_b = MOST_b, .torque_mNm = 12345};
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, torque_mNm(&losses, FEASIBLE_UNBOUNDED));
    TEST_ASSERT_EQUAL_INT32(0, losses.torque_mNm);
}

/* The friction, 100 units, brakes at no current of torque. */
void test_a_circle_that_returns_power_at_zero_torque_leaves_the_friction(void)
{
    motor.model.friction_b = 100;
    motor.model.emf_b = 1 << 23;
    motor.set.power = (feasible_power_t){.c = -1000, .b = 1 << 23};
    loss_braking_t losses = {.current_b = MOST_b};
    TEST_ASSERT_EQUAL_INT32(100, torque_mNm(&losses, 0));
}

void test_losses_at_standstill_make_all_torque_that_the_current_makes(void)
{
    motor.set.power = (feasible_power_t){.c = 10};
    loss_braking_t losses = {.current_b = MOST_b};
    TEST_ASSERT_EQUAL_INT32(MOST_b, torque_mNm(&losses, 0));
}

/* Up to a current of 2^25, beside a power of one unit at standstill. */
void test_losses_of_one_unit_at_standstill_make_all_torque_that_a_large_current_makes(void)
{
    motor.set.power = (feasible_power_t){.c = 1};
    loss_braking_t losses = {.current_b = 1 << 25};
    TEST_ASSERT_EQUAL_INT32(1 << 25, torque_mNm(&losses, 0));
}

/* A power of 100 units at any current and an EMF of 2^16: two steps of 100 2^24 / 2^16. */
void test_the_power_to_be_returned_or_drawn_counts_to_the_unit(void)
{
    motor.model.emf_b = 1 << 16;
    motor.model.resistance_b = SCALED_ONE; /* of which the circle loses more */
    motor.set.power = (feasible_power_t){.c = 100};
    /* What the battery takes is not returned on the circle. */
    for (int32_t power_b = 0; power_b <= 1000; power_b += 500) {
        loss_braking_t losses = {.current_b = MOST_b, .returned = {.power_b = power_b}};
        TEST_ASSERT_EQUAL_INT32(2 * 100 * 256, torque_mNm(&losses, 0));
    }
    loss_braking_t draws = {.current_b = MOST_b, .returned = {.power_b = -20}};
    TEST_ASSERT_EQUAL_INT32(2 * 80 * 256, torque_mNm(&draws, 0));
    /* What the motor draws beyond its model has been measured, with any angle. */
    motor.constants.hall_angle_b = SCALED_ONE;
    motor.model.speed_b = 1 << 20;
    loss_braking_t more = {.current_b = MOST_b, .returned = {.drawn_b = 30}};
    TEST_ASSERT_EQUAL_INT32(2 * 130 * 256, torque_mNm(&more, 0));
    TEST_ASSERT_EQUAL_INT32(-2 * 130 * 256, more.at.x_b);
    TEST_ASSERT_INT32_WITHIN(MOST_b >> 13, -MOST_b, more.at.d_b);
}

/* The header's magnitude of a current, at most 3 % too large. */
static double magnitude(double i_d, double i_q)
{
    const double large = fmax(fabs(i_d), fabs(i_q));
    const double small = fmin(fabs(i_d), fabs(i_q));
    return fmax(large, 0.875 * large + 0.5 * small);
}

typedef struct {
    double a, b, b_d, c, c_d, c_dd, loss; /* power of x and i_d; of an ampere */
    double emf, x_d, x_q, iron, cross;    /* w psi, w L_d, w L_q; i_q = x + iron + cross i_d */
    double current, taken;
    double uncertain; /* i_d an i_q that an uncertain angle allows; 0: certain */
} drive_t;

static double excess(const drive_t *d, double i_d, double x, double taken)
{
    const double i_q = x + d->iron + d->cross * i_d;
    return d->a * x * x + (d->b + d->b_d * i_d) * x + d->c + d->c_d * i_d + d->c_dd * i_d * i_d +
           d->loss * magnitude(i_d, i_q) + taken;
}

static double on_circle(const drive_t *d, double i_d, double x)
{
    const double i_q = x + d->iron + d->cross * i_d;
    return -sqrt(fmax(d->current * d->current - i_q * i_q, 0.0));
}

static double lowest(const drive_t *d, double i_d, double x)
{
    const double i_q = x + d->iron + d->cross * i_d;
    const double circle = on_circle(d, i_d, x);
    return d->uncertain > 0.0 ? fmax(circle, d->uncertain * fmin(i_q, 0.0)) : circle;
}

static int32_t powers(double x)
{
    return (int32_t)lround(ldexp(x, POWER_LOG2));
}

static void apply(const drive_t *d)
{
    motor.set.power = (feasible_power_t){.a = plain_ratio(d->a),
                                         .b = plain_units(d->b),
                                         .b_d = plain_ratio(d->b_d),
                                         .c = powers(d->c),
                                         .c_d = plain_units(d->c_d),
                                         .c_dd = plain_ratio(d->c_dd)};
    motor.constants.loss_b = plain_units(d->loss);
    motor.model.emf_b = plain_units(d->emf);
    motor.model.reactance_d_b = plain_ratio(d->x_d);
    motor.model.reactance_q_b = plain_ratio(d->x_q);
    motor.model.iron_current_b = plain_units(d->iron);
    motor.model.cross_d = plain_ratio(d->cross);
}

static drive_t any(random_t *random)
{
    const drive_t out = {
        .a = random_real(random, 0.1, 0.4),
        .b = random_real(random, 0.5, 2.0),
        .b_d = random_real(random, -0.1, 0.1),
        .c = random_real(random, -0.1, 0.3),
        .c_d = random_real(random, -0.2, 0.2),
        .c_dd = random_real(random, 0.05, 0.4),
        .loss = random_real(random, 0.0, 0.3),
        .emf = random_real(random, 0.5, 2.0),
        .x_d = random_real(random, 0.1, 0.3),
        .x_q = random_real(random, 0.1, 0.3),
        .iron = random_real(random, 0.0, 0.2),
        .cross = random_real(random, 0.0, 0.2),
        .current = random_real(random, 0.5, 3.9),
        .taken = random_real(random, 0.0, 0.5),
    };
    return out;
}

/* Two steps of Newton's method with the slope of the EMF, i_d on the circle beside the last x. */
void test_the_torque_on_the_circle_is_that_of_two_steps_of_newton_s_method(void)
{
    random_t random = random_seeded(51);
    for (int n = 0; n < ROUNDS; n++) {
        const drive_t d = any(&random);
        apply(&d);
        double i_d = -d.current;
        double x = 0.0;
        for (int pass = 0; pass < 2; pass++) {
            i_d = on_circle(&d, i_d, x);
            const double slope = d.emf + (d.x_d - d.x_q) * i_d;
            x = fmin(fmax(x - excess(&d, i_d, x, 0.0) / slope, -d.current), 0.0);
        }
        loss_braking_t losses = {.current_b = plain_units(d.current)};
        const int32_t found_mNm = torque_mNm(&losses, 0);
        TEST_ASSERT_DOUBLE_WITHIN(3e-3, -x, plain_value(found_mNm));
    }
}

/* ---- setpoint ---- */

static const current_setpoint_t GIVEN = {.i_d_mA = -100, .i_q_mA = -7};

static current_setpoint_t setpoint(const loss_braking_t *losses, int32_t shaft_mNm)
{
    return loss_braking_setpoint(&motor.set, losses, shaft_mNm, GIVEN);
}

static bool stays(const loss_braking_t *losses, int32_t shaft_mNm)
{
    const current_setpoint_t out = setpoint(losses, shaft_mNm);
    return out.i_d_mA == GIVEN.i_d_mA && out.i_q_mA == GIVEN.i_q_mA;
}

/* Power is i_d^2 / 4 less a constant: always more than the battery takes. */
static void return_too_much(void)
{
    motor.set.power = (feasible_power_t){.c = -(1 << 12), .c_dd = SCALED_ONE / 4};
}

/* At a high speed a small torque is a large power. */
void test_a_setpoint_stays_up_to_the_torque_of_the_map(void)
{
    return_too_much();
    const loss_braking_t losses = {.current_b = MOST_b, .by_map_mNm = 1000};
    TEST_ASSERT_TRUE(stays(&losses, -1000));
    TEST_ASSERT_FALSE(stays(&losses, -1001));
}

void test_a_setpoint_stays_without_a_current_for_losses(void)
{
    return_too_much();
    loss_braking_t losses = {.current_b = 0, .by_map_mNm = 0};
    TEST_ASSERT_TRUE(stays(&losses, -1000));
    losses.current_b = 1;
    TEST_ASSERT_FALSE(stays(&losses, -1000));
}

void test_a_setpoint_stays_where_friction_makes_the_torque(void)
{
    return_too_much();
    motor.model.friction_b = 1000;
    const loss_braking_t losses = {.current_b = MOST_b, .by_map_mNm = 0};
    TEST_ASSERT_TRUE(stays(&losses, -999));
    TEST_ASSERT_TRUE(stays(&losses, -1000));
    TEST_ASSERT_FALSE(stays(&losses, -1001));
}

/* i_q -7 mA are 14 units; u i of 2^20 a unit 14 2^-4, rounded down -1. */
void test_a_setpoint_stays_where_it_returns_no_more_than_the_battery_takes(void)
{
    motor.set.power = (feasible_power_t){.c = -1};
    loss_braking_t losses = {.current_b = MOST_b, .returned = {.power_b = 1}};
    TEST_ASSERT_TRUE(stays(&losses, -1000));
    losses.returned.power_b = 0;
    TEST_ASSERT_FALSE(stays(&losses, -1000));
}

/* i_d 3/5 of the phase current leaves 4/5 of it. */
void test_i_q_is_what_i_d_leaves_of_the_phase_current(void)
{
    motor.config.motor.max_phase_current_mA = 100000;
    motor.set.power = (feasible_power_t){.c = -1000000};
    const loss_braking_t losses = {.current_b = 120000};
    motor.model.iron_current_b = 1000000; /* of a torque of 10^6 no i_q is left */
    const current_setpoint_t out = setpoint(&losses, -1000000 - 200000);
    TEST_ASSERT_EQUAL_INT32(-100, out.i_d_mA);
    motor.model.iron_current_b = 0;
    const current_setpoint_t more = loss_braking_setpoint(
        &motor.set, &losses, -400000, (current_setpoint_t){.i_d_mA = -60000, .i_q_mA = -80000});
    TEST_ASSERT_EQUAL_INT32(-60000, more.i_d_mA);
    TEST_ASSERT_INT32_WITHIN(8, -80000, more.i_q_mA);
}

/* Of what the battery takes, and of what the motor draws beyond its model, only the sum counts. */
void test_a_setpoint_may_return_what_the_motor_draws_beyond_its_model(void)
{
    motor.set.power = (feasible_power_t){.c = -(1 << 18), .c_dd = SCALED_ONE / 4};
    const current_setpoint_t map = {.i_d_mA = 0, .i_q_mA = -1000};
    for (int32_t share = 0; share <= 4; share++) {
        const loss_braking_t losses = {
            .current_b = MOST_b,
            .returned = {.power_b = share << 12, .drawn_b = (4 - share) << 12}};
        /* i_d^2 / 4 of 2^18 - 2^14 */
        const current_setpoint_t out = loss_braking_setpoint(&motor.set, &losses, -2000, map);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * MOST_b, -sqrt(15.0 / 16.0) * MOST_b, 2.0 * out.i_d_mA);
    }
}

/* Currents of i_q -2^14: an i_d of 7/4 of it up to a speed of 2^15 mrad/s, and of 64 times that
 * from 2^18 on. */
void test_the_i_d_beside_an_uncertain_angle_is_a_multiple_of_i_q_to_the_last_digit(void)
{
    return_too_much();
    motor.set.power.c = -(1 << 20); /* more than any i_d loses */
    motor.constants.hall_angle_b = 1;
    const loss_braking_t losses = {.current_b = MOST_b};
    static const int32_t SPEEDS_mrad_s[] = {0, 1 << 15, 1 << 18, 1 << 22};
    for (int n = 0; n < 4; n++) {
        motor.model.speed_b = SPEEDS_mrad_s[n];
        const int32_t i_d_b = n < 2 ? 7 << 12 : 64 * (7 << 12);
        const current_setpoint_t map = {.i_d_mA = 0, .i_q_mA = -(1 << 13)};
        const current_setpoint_t out = loss_braking_setpoint(&motor.set, &losses, -(1 << 14), map);
        TEST_ASSERT_EQUAL_INT32(-i_d_b / 2, out.i_d_mA);
    }
}

/* 112 times an i_q of 3/4 2^25 is beyond 32 bits: the circle of 2^25 is the limit. */
void test_the_i_d_beside_a_large_i_q_ends_at_the_circle(void)
{
    motor.set.power = (feasible_power_t){.c = -(1 << 26), .c_dd = 1};
    motor.constants.hall_angle_b = 1;
    motor.model.speed_b = 1 << 22;
    motor.config.motor.max_phase_current_mA = 1 << 24;
    const loss_braking_t losses = {.current_b = 1 << 25};
    const current_setpoint_t map = {.i_d_mA = 0, .i_q_mA = -(3 << 22)};
    const current_setpoint_t out = loss_braking_setpoint(&motor.set, &losses, -(3 << 23), map);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * (1 << 24), -sqrt(7.0 / 16.0) * (1 << 24), out.i_d_mA);
}

/* The iron's current is as large as that of the torque: beside no i_q no i_d. */
void test_beside_no_i_q_an_uncertain_angle_leaves_no_i_d(void)
{
    return_too_much();
    motor.constants.hall_angle_b = 1;
    motor.model.iron_current_b = 1000;
    const loss_braking_t losses = {.current_b = MOST_b};
    const current_setpoint_t map = {.i_d_mA = 0, .i_q_mA = 0};
    const current_setpoint_t out = loss_braking_setpoint(&motor.set, &losses, -1000, map);
    TEST_ASSERT_EQUAL_INT32(0, out.i_d_mA);
    TEST_ASSERT_EQUAL_INT32(0, out.i_q_mA);
}

/* The iron's current is larger than that of the torque, i_q driving: the positive i_d of a map goes
 * to zero and no lower. */
void test_beside_a_driving_i_q_an_uncertain_angle_takes_i_d_to_zero(void)
{
    return_too_much();
    motor.set.power.c = -(1 << 20);
    motor.constants.hall_angle_b = 1;
    motor.model.iron_current_b = 2000;
    motor.model.speed_b = 1 << 22;
    const loss_braking_t losses = {.current_b = MOST_b};
    for (int32_t i_q_b = 0; i_q_b <= 1000; i_q_b += 1000) {
        const current_setpoint_t map = {.i_d_mA = 1000, .i_q_mA = i_q_b / 2};
        const current_setpoint_t out =
            loss_braking_setpoint(&motor.set, &losses, i_q_b - 2000, map);
        TEST_ASSERT_EQUAL_INT32(0, out.i_d_mA);
        TEST_ASSERT_EQUAL_INT32(i_q_b / 2, out.i_q_mA);
    }
}

void test_i_q_counts_forward_in_either_direction_of_rotation(void)
{
    return_too_much();
    const loss_braking_t losses = {.current_b = MOST_b};
    TEST_ASSERT_EQUAL_INT32(-500, setpoint(&losses, -1000).i_q_mA);
    motor.model.speed_mrad_s = -1;
    TEST_ASSERT_EQUAL_INT32(500, setpoint(&losses, 1000).i_q_mA);
}

/* Two passes, three with an uncertain angle: the root of q d^2 + e d + excess from the last i_d,
 * down to the circle and to i_q over the tangent of that angle's error. */
static void compare_setpoints(int passes, uint64_t seed)
{
    random_t random = random_seeded(seed);
    int changed = 0;
    for (int n = 0; n < ROUNDS; n++) {
        drive_t d = any(&random);
        const double times = random_real(&random, 0.0, 9.0); /* as fast as a sector in 32 ms */
        d.uncertain = passes == 3 ? 1.75 * fmin(fmax(1.0, times * times), 64.0) : 0.0;
        motor.model.speed_b = (int32_t)lround(32768.0 * times);
        apply(&d);
        const double x = random_real(&random, -1.5, -0.1);
        const double highest = random_real(&random, -0.3, 0.0);
        const current_setpoint_t map = {
            .i_d_mA = plain_units(highest) / 2,
            .i_q_mA = plain_units(x + d.iron + d.cross * highest) / 2,
        };
        double i_d = highest;
        bool clear = fabs(excess(&d, i_d, x, d.taken)) > 0.02;
        for (int pass = 0; pass < passes; pass++) {
            const double more = excess(&d, i_d, x, d.taken);
            if (pass == 0 && more >= 0.0) {
                break;
            }
            const double e = d.c_d + d.b_d * x + 2.0 * d.c_dd * i_d;
            const double under_root = e * e - 4.0 * d.c_dd * more;
            clear = clear && under_root > 0.01;
            i_d -= (e + sqrt(fmax(under_root, 0.0))) / (2.0 * d.c_dd);
            i_d = fmin(fmax(i_d, fmin(lowest(&d, i_d, x), highest)), highest);
        }
        if (!clear) {
            continue;
        }
        const loss_braking_t losses = {
            .current_b = plain_units(d.current),
            .returned = {.power_b = powers(d.taken), .margin_b = INT32_MAX},
        };
        const current_setpoint_t out =
            loss_braking_setpoint(&motor.set, &losses, plain_units(x), map);
        changed += i_d < highest;
        const double speed_is_rounded = d.uncertain > 0.0 ? 4e-3 * fabs(i_d) : 0.0;
        TEST_ASSERT_DOUBLE_WITHIN(4e-3 + speed_is_rounded, i_d,
                                  ldexp(out.i_d_mA, 1 - PLAIN_UNIT_LOG2));
        if (hypot(i_d, x + d.iron + d.cross * i_d) < 3.9) {
            TEST_ASSERT_DOUBLE_WITHIN(4e-3, x + d.iron + d.cross * i_d,
                                      ldexp(out.i_q_mA, 1 - PLAIN_UNIT_LOG2));
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 10, changed);
}

void test_the_setpoint_that_returns_what_the_battery_takes_is_found_in_two_passes(void)
{
    compare_setpoints(2, 52);
}

void test_an_uncertain_angle_takes_a_third_pass(void)
{
    motor.constants.hall_angle_b = 1;
    compare_setpoints(3, 53);
}
