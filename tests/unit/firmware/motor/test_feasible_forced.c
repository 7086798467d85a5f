/* SPDX-License-Identifier: Apache-2.0 */
/* Forced torque of a motor of powers of two, in double precision. */
#include "plain_drive.h"
#include "unity.h"

enum { ROUNDS = 4000 };

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
}

void tearDown(void) {}

typedef struct {
    plain_point_t at;
    bool is_root, is_least, is_limited, is_none, is_unclear;
} forced_t;

/* DERIVATIONS.md, Forced torque: from zero torque at the lowest i_d towards braking, to the root
 * nearest zero torque or the least voltage, at most half a radian; 17/16 of U^2 less 1/256 suffice.
 */
static forced_t forced(const plain_drive_t *d)
{
    const plain_point_t none = {.d = d->lowest, .x = 0.0};
    const double i_q = drive_i_q(d, none);
    const double within = d->u * d->u * (17.0 / 16.0 - 1.0 / 256.0);
    const plain_square_t p = drive_square(d, none, -i_q, d->lowest, within);
    const double under_root = p.half * p.half - p.squared * p.excess;
    const double root = sqrt(fmax(under_root, 0.0));
    forced_t out = {.is_unclear = fabs(under_root) < 0.02 || fabs(p.squared) < 0.02};
    double t = 0.0;
    if (p.squared > 0.0) {
        t = drive_clamped((-p.half - root) / p.squared, 0.0, 0.5);
    } else {
        /* Bends down from above what suffices: no t where it is. */
        out.is_unclear = out.is_unclear || root - fabs(p.half) < 1e-3;
    }
    const double most = fmin(CIRCLE, -d->lowest);
    const double q = drive_clamped(i_q + t * d->lowest, -most, most);
    out.at.d = -drive_beside(most, q);
    out.at.x = drive_x(d, out.at.d, q);
    out.is_none = t == 0.0;
    out.is_limited = t == 0.5;
    out.is_root = !out.is_none && !out.is_limited && under_root > 0.0;
    out.is_least = !out.is_none && !out.is_limited && under_root <= 0.0;
    return out;
}

static plain_drive_t any(random_t *random)
{
    plain_drive_t out = {
        .psi = 1.0,
        .r = random_real(random, 0.02, random_chance(random, 0.2) ? 1.2 : 0.4),
        .x_d = random_real(random, 0.3, 1.2),
        .iron = random_chance(random, 0.5) ? 0.0 : random_real(random, 0.0, 0.2),
        .emf = random_real(random, 0.5, 7.0),
        .lowest = random_real(random, -4.3, -1.0),
    };
    out.x_q = out.x_d * random_real(random, 0.8, 2.0);
    const plain_point_t none = {.d = out.lowest, .x = 0.0};
    out.u = hypot(drive_u_d(&out, none), drive_u_q(&out, none)) * random_real(random, 0.7, 0.968);
    return out;
}

void test_the_least_braking_torque_is_at_the_root_or_the_least_voltage_of_the_circle(void)
{
    random_t random = random_seeded(81);
    int roots = 0;
    int least = 0;
    int limited = 0;
    int none = 0;
    for (int n = 0; n < ROUNDS; n++) {
        const plain_drive_t d = any(&random);
        const forced_t wanted = forced(&d);
        /* Driving in the lower voltage of no i_d; not permitted either. */
        motor_point_t at = {.d_b = plain_units(1.0), .x_b = plain_units(8.0)};
        drive_apply(&d, &motor);
        if (wanted.is_unclear || feasible_holds(&motor.set, at)) {
            continue;
        }
        roots += wanted.is_root;
        least += wanted.is_least;
        limited += wanted.is_limited;
        none += wanted.is_none;
        TEST_ASSERT_TRUE(feasible_forced(&motor.set, &at));
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, wanted.at.d, plain_value(at.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, wanted.at.x, plain_value(at.x_b));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 10, roots);
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 20, least);
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 50, limited);
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 200, none);
}

/* u_q = 4 + d, u_d = -x with U = 1: zero torque suffices at i_d = -3, a torque of 4 nowhere. */
void test_voltage_for_the_point_or_for_zero_torque_forces_none(void)
{
    const plain_drive_t d = {
        .psi = 1.0, .x_d = 1.0, .x_q = 1.0, .emf = 4.0, .u = 1.0, .lowest = -3.0};
    drive_apply(&d, &motor);
    motor_point_t at = {.d_b = plain_units(-3.0), .x_b = plain_units(4.0)};
    TEST_ASSERT_FALSE(feasible_forced(&motor.set, &at));
    TEST_ASSERT_EQUAL_INT32(plain_units(-3.0), at.d_b);
    TEST_ASSERT_EQUAL_INT32(plain_units(4.0), at.x_b);
    /* At i_d = -1 zero torque takes 3, the point at i_d = -4 none. */
    motor.set.weakest_d_b = plain_units(-1.0);
    at = (motor_point_t){.d_b = plain_units(-4.0), .x_b = plain_units(0.5)};
    TEST_ASSERT_FALSE(feasible_forced(&motor.set, &at));
    TEST_ASSERT_EQUAL_INT32(plain_units(-4.0), at.d_b);
    TEST_ASSERT_EQUAL_INT32(plain_units(0.5), at.x_b);
}

/* Beyond the cancelled flux, u_q = -8 at i_d = -16, braking current takes more voltage: none. */
void test_where_braking_takes_more_voltage_the_torque_stays_zero_to_the_unit(void)
{
    const plain_drive_t d = {
        .psi = 1.0, .r = 0.5, .x_d = 1.0, .emf = 8.0, .u = 1.0, .lowest = -16.0};
    motor.constants.current_most_b = plain_units(18.0);
    drive_apply(&d, &motor);
    motor_point_t at = {.d_b = 0, .x_b = plain_units(4.0)};
    TEST_ASSERT_TRUE(feasible_forced(&motor.set, &at));
    TEST_ASSERT_EQUAL_INT32(0, at.x_b);
    TEST_ASSERT_INT32_WITHIN(plain_units(16.0) >> 14, plain_units(-16.0), at.d_b);
}

/* |u|^2 = 848 - 448 t + 56 t^2 from u_d = -8, u_q = 28: one at 3 rad. Half a radian of i_d = -16
 * is an i_q of -8. */
void test_the_angle_towards_braking_ends_at_half_a_radian_to_the_unit(void)
{
    const plain_drive_t d = {
        .psi = 1.0, .r = 0.5, .x_d = 0.125, .emf = 30.0, .u = 1.0, .lowest = -16.0};
    motor.constants.current_most_b = plain_units(18.0);
    drive_apply(&d, &motor);
    motor_point_t at = {.d_b = 0, .x_b = plain_units(4.0)};
    TEST_ASSERT_TRUE(feasible_forced(&motor.set, &at));
    TEST_ASSERT_EQUAL_INT32(plain_units(-8.0), at.x_b);
}

void test_without_impedance_no_current_is_better_than_another(void)
{
    const plain_drive_t d = {.psi = 1.0, .emf = 4.0, .u = 1.0, .lowest = -3.0};
    drive_apply(&d, &motor);
    motor_point_t at = {.d_b = 0, .x_b = plain_units(2.0)};
    TEST_ASSERT_TRUE(feasible_forced(&motor.set, &at));
    TEST_ASSERT_EQUAL_INT32(0, at.x_b);
}
