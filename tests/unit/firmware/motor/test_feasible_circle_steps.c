/* SPDX-License-Identifier: Apache-2.0 */
/* Start and steps along the current circle, with iron loss and from any point of it, against a
 * motor in double precision; and which of voltage and current bounds. */
#include "plain_drive.h"
#include "unity.h"

enum { ROUNDS = 4000, SIXTY_FOURTHS = 64 };

static plain_motor_t motor;
static bool unclear;

void setUp(void)
{
    plain_motor_init(&motor);
    motor.constants.torque_factor_q24 = 1 << 28;
    motor.constants.torque_inverse_q24 = 1 << 20;
    unclear = false;
}

void tearDown(void) {}

static double value(int32_t x)
{
    return ldexp(x, -DRIVE_UNIT_LOG2);
}

static bool is_above(double a, double b)
{
    unclear = unclear || fabs(a - b) < 4e-3;
    return a > b;
}

static plain_drive_t any(random_t *random)
{
    plain_drive_t out = {
        .psi = random_real(random, 0.5, 2.0),
        .saliency = random_chance(random, 0.3) ? 0.0 : random_real(random, -0.4, 0.1),
        .r = random_real(random, 0.0, 0.3),
        .x_d = random_real(random, 0.1, 0.8),
        .iron = random_chance(random, 0.3) ? 0.0 : random_real(random, 0.0, 0.3),
        .emf = random_real(random, 0.0, 3.0),
        .u = random_real(random, 0.2, 3.0),
        .lowest = random_real(random, -4.2, 0.0),
    };
    out.x_q = out.x_d * random_real(random, 1.0, 2.0);
    return out;
}

static double torque(const plain_drive_t *d, plain_point_t at)
{
    return (d->psi + d->saliency * (at.d + d->x_q * d->iron * at.x)) * at.x;
}

/* ---- the start ---- */

typedef struct {
    double best, lowest, d, by_side;
} start_t;

/* DERIVATIONS.md, Phase current: the root of the quadratic, less R P over half the derivative
 * there. */
static start_t start(const plain_drive_t *d)
{
    const double w2 = d->x_d * d->x_d - d->x_q * d->x_q;
    const double excess =
        d->emf * d->emf + CIRCLE * CIRCLE * (d->x_q * d->x_q + d->r * d->r) - d->u * d->u;
    const double half = d->x_d * d->emf;
    const double under_root = half * half - w2 * excess;
    const double root = sqrt(fmax(under_root, 0.0));
    unclear = fabs(under_root) < 0.02 || half < 0.02;
    const double per_flux = d->saliency * MOST;
    const double best =
        2.0 * per_flux * MOST / (sqrt(d->psi * d->psi + 8.0 * per_flux * per_flux) + d->psi);
    start_t out = {.best = best, .lowest = fmax(fmin(d->lowest, best), -CIRCLE)};
    out.d = drive_clamped(-excess / (half + root), -CIRCLE * 63.0 / 64.0, CIRCLE * 63.0 / 64.0);
    const double at = drive_clamped(out.d, out.lowest, out.best);
    const double power = d->r * drive_beside(CIRCLE, at) * (d->emf + (d->x_d - d->x_q) * at);
    unclear = unclear || (under_root < 0.0 && fabs(power) < 1e-3);
    out.by_side = under_root > 0.0 ? drive_clamped(power / root, -CIRCLE / 8.0, CIRCLE / 8.0)
                                   : copysign(CIRCLE / 8.0, power);
    return out;
}

void test_steps_along_the_circle_start_at_the_root_without_resistive_power(void)
{
    random_t random = random_seeded(91);
    int checked = 0;
    for (int n = 0; n < ROUNDS; n++) {
        plain_drive_t d = any(&random);
        d.iron = 0.0;
        drive_apply(&d, &motor);
        const start_t wanted = start(&d);
        feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 20 << 20);
        feasible_circle_t circle = {.known = false};
        (void)feasible_by_current_mNm(&side, &circle);
        if (unclear) {
            continue;
        }
        checked++;
        TEST_ASSERT_TRUE(circle.known);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, wanted.best, value(circle.best_b));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, wanted.lowest, value(circle.lowest_b));
        TEST_ASSERT_DOUBLE_WITHIN(3e-3, wanted.d, value(circle.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(3e-3, wanted.by_side, value(circle.by_side_b));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 2, checked);
}

/* Any voltage, or none with a high EMF: both ends of a 64th less than the circle, to the unit. */
void test_steps_start_a_sixty_fourth_of_the_circle_inside_its_ends(void)
{
    const int32_t circle_b = (4 << 20) - (4 << 12);
    const int32_t wanted_b = circle_b - circle_b / SIXTY_FOURTHS;
    for (int sign = -1; sign <= 1; sign += 2) {
        const plain_drive_t d = {.psi = 1.0,
                                 .x_d = 0.25,
                                 .x_q = 0.25,
                                 .emf = sign < 0 ? 8.0 : 1.0,
                                 .u = sign < 0 ? 0.0 : 16.0,
                                 .lowest = -4.0};
        drive_apply(&d, &motor);
        feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 20 << 20);
        feasible_circle_t circle = {.known = false};
        (void)feasible_by_current_mNm(&side, &circle);
        TEST_ASSERT_EQUAL_INT32(sign * wanted_b, circle.d_b);
    }
}

/* ---- the steps ---- */

static plain_point_t on_circle(const plain_drive_t *d, double sign, double i_d)
{
    return (plain_point_t){.d = i_d, .x = drive_x(d, i_d, sign * drive_beside(CIRCLE, i_d))};
}

/* Towards more voltage, to where it is U; without such a point on the line to the least of it. */
static double angle(const plain_drive_t *d, plain_point_t at, double i_d_per_t, double i_q_per_t)
{
    const plain_square_t p = drive_square(d, at, i_d_per_t, i_q_per_t, d->u * d->u);
    const double under_root = p.half * p.half - p.squared * p.excess;
    const double root = sqrt(fmax(under_root, 0.0));
    unclear = unclear || fabs(under_root) < 0.02 || fabs(p.half) < 0.02;
    if (p.half > 0.0) {
        return drive_clamped(-p.excess / (p.half + root), -0.5, 0.5);
    }
    unclear = unclear || fabs(p.squared) < 0.02;
    return p.squared > 0.0 ? drive_clamped((root - p.half) / p.squared, -0.5, 0.5) : 0.5;
}

static plain_point_t end_of_steps(const plain_drive_t *d, double sign, const start_t *from)
{
    plain_point_t at =
        on_circle(d, sign, drive_clamped(from->d - sign * from->by_side, from->lowest, from->best));
    double before = 0.0;
    for (int step = 0; step < 4; step++) {
        const double q = sign * drive_beside(CIRCLE, at.d);
        const double t = angle(d, at, fabs(q), -sign * at.d);
        double to = at.d + t * fabs(q) - t * t / 2.0 * at.d;
        if (is_above(-fabs(q), at.d)) {
            const double q_to = sign * (q - t * sign * at.d - t * t / 2.0 * q);
            to = -drive_beside(CIRCLE, drive_clamped(q_to, 0.0, CIRCLE));
        }
        to = drive_clamped(to, from->lowest, from->best);
        if (fabs(to - at.d) < 1e-9) {
            break;
        }
        unclear = unclear || fabs(to - at.d) < 1e-4;
        at = on_circle(d, sign, to);
        const bool turned = (t < 0.0) != (before < 0.0) && is_above(fabs(t), fabs(before) / 2.0);
        if (!is_above(fabs(t), 0.125) || (before != 0.0 && turned)) {
            break;
        }
        before = t;
    }
    unclear = unclear || drive_beside(CIRCLE, at.d) < 0.1;
    return at;
}

void test_the_end_of_the_circle_is_four_steps_from_any_start(void)
{
    random_t random = random_seeded(92);
    int ends = 0;
    for (int n = 0; n < 2 * ROUNDS; n++) {
        const plain_drive_t d = any(&random);
        const bool drives = random_chance(&random, 0.5);
        const double sign = drives ? 1.0 : -1.0;
        const double best = random_real(&random, -1.0, 3.9);
        const start_t from = {.best = best,
                              .lowest = random_real(&random, -3.9, best),
                              .d = random_real(&random, -3.9, 3.9),
                              .by_side = random_real(&random, -0.4, 0.4)};
        drive_apply(&d, &motor);
        unclear = false;
        const plain_point_t at = end_of_steps(&d, sign, &from);
        if (unclear || sign * torque(&d, at) < 0.1) {
            continue;
        }
        ends++;
        feasible_side_t side = plain_side(&motor, drives ? SIDE_DRIVING : SIDE_BRAKING, 20 << 20);
        feasible_circle_t circle = {.known = true,
                                    .best_b = drive_units(from.best),
                                    .lowest_b = drive_units(from.lowest),
                                    .d_b = drive_units(from.d),
                                    .by_side_b = drive_units(from.by_side)};
        (void)feasible_by_current_mNm(&side, &circle);
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, at.d, value(side.cap.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, at.x, value(side.cap.x_b));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 2, ends);
}

/* Without resistance, saliency and EMF |u| is the same all along the circle; an EMF of five units
 * lets it fall with i_d by one unit an angle. */
void test_where_the_circle_does_not_meet_the_ellipse_it_is_left_only_towards_less_voltage(void)
{
    plain_drive_t d = {.psi = 1.0, .x_d = 1.0, .x_q = 1.0, .u = 1.0, .lowest = -3.9};
    for (int emf_b = 0; emf_b <= 5; emf_b += 5) {
        drive_apply(&d, &motor);
        motor.model.emf_b = emf_b;
        motor.model.voltage_q_b = emf_b;
        feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 20 << 20);
        feasible_circle_t circle = {.known = true,
                                    .best_b = drive_units(3.0),
                                    .lowest_b = drive_units(-3.9),
                                    .d_b = drive_units(-2.0)};
        (void)feasible_by_current_mNm(&side, &circle);
        if (emf_b == 0) {
            TEST_ASSERT_EQUAL_INT32(drive_units(-2.0), side.cap.d_b);
        } else {
            TEST_ASSERT_LESS_THAN_INT32(drive_units(-3.0), side.cap.d_b);
        }
    }
}

/* ---- which of them bounds ---- */

void test_a_cap_with_voltage_up_to_the_circle_itself_has_no_bound_by_current(void)
{
    const int32_t circle_b = (4 << 20) - (4 << 12);
    feasible_circle_t circle = {.known = false};
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, circle_b);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, feasible_by_current_mNm(&side, &circle));
    TEST_ASSERT_FALSE(circle.known);
    side = plain_side(&motor, SIDE_DRIVING, circle_b + 1);
    TEST_ASSERT_LESS_THAN_INT32(FEASIBLE_UNBOUNDED, feasible_by_current_mNm(&side, &circle));
    TEST_ASSERT_TRUE(circle.known);
}

/* u_q = 2 + d, u_d = -x, U = 2: a torque of 1 takes i_d = sqrt(3) - 2; the circle leaves 2.6. */
void test_a_cap_below_the_end_of_the_circle_goes_to_the_ellipse(void)
{
    const plain_drive_t d = {
        .psi = 1.0, .x_d = 1.0, .x_q = 1.0, .emf = 2.0, .u = 2.0, .lowest = -3.0};
    drive_apply(&d, &motor);
    feasible_circle_t circle = {.known = false};
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 1 << 20);
    side.cap_has_voltage = false;
    TEST_ASSERT_GREATER_THAN_INT32(1 << 20, feasible_by_current_mNm(&side, &circle));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, sqrt(3.0) - 2.0, value(side.cap.d_b));
    TEST_ASSERT_EQUAL_INT32(1 << 20, side.cap_mNm);
}

/* Beyond the circle by its i_d alone: the torque itself is below that of the circle. */
void test_a_cap_with_voltage_below_the_end_of_the_circle_remains(void)
{
    const plain_drive_t d = {.psi = 1.0, .u = 16.0, .lowest = -3.0};
    drive_apply(&d, &motor);
    feasible_circle_t circle = {.known = false};
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 1 << 20);
    side.cap.d_b = drive_units(-4.0);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, CIRCLE, value(feasible_by_current_mNm(&side, &circle)));
    TEST_ASSERT_EQUAL_INT32(drive_units(-4.0), side.cap.d_b);
    TEST_ASSERT_EQUAL_INT32(1 << 20, side.cap_mNm);
    TEST_ASSERT_TRUE(side.cap_has_voltage);
}

/* u_q = 3 + d, u_d = -x, U = 3: at the lowest i_d of -3 an x of 3 is beyond the circle, sqrt(7). */
void test_where_the_ellipse_ends_beyond_the_circle_only_the_current_bounds(void)
{
    const plain_drive_t d = {
        .psi = 1.0, .x_d = 1.0, .x_q = 1.0, .emf = 3.0, .u = 3.0, .lowest = -3.0};
    drive_apply(&d, &motor);
    feasible_circle_t circle = {.known = false};
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 20 << 20);
    side.cap_has_voltage = false;
    const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, &circle);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, ends.voltage_mNm);
    /* (3 + d)^2 + I^2 - d^2 = 9 at d = -I^2 / 6 */
    const double d_end = -CIRCLE * CIRCLE / 6.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, drive_beside(CIRCLE, d_end), value(ends.current_mNm));
}

void test_where_the_voltage_suffices_for_no_torque_the_current_bounds_none(void)
{
    const plain_drive_t d = {
        .psi = 1.0, .x_d = 1.0, .x_q = 1.0, .emf = 5.0, .u = 1.0, .lowest = -3.0};
    drive_apply(&d, &motor);
    feasible_circle_t circle = {.known = false};
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 20 << 20);
    side.cap_has_voltage = false;
    const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, &circle);
    TEST_ASSERT_EQUAL_INT32(0, ends.voltage_mNm);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, ends.current_mNm);
}

/* Braking lowers the voltage: the ellipse lies between an x of -1.22 and -0.52, beyond the circle,
 * whose x is -0.30 there for the iron loss. Up to 1 mN m by voltage, or none: the ellipse is below
 * a U of 2.80. */
void test_the_end_of_an_ellipse_outside_the_circle_is_bounded_by_current_too(void)
{
    plain_drive_t d = {.psi = 1.0,
                       .r = 0.3,
                       .x_d = 0.5,
                       .x_q = 2.0,
                       .emf = 5.0,
                       .iron = 0.1,
                       .u = 2.8905,
                       .lowest = -CIRCLE};
    motor.constants.torque_shift = DRIVE_UNIT_LOG2;
    for (int voltage_mNm = 1; voltage_mNm >= 0; voltage_mNm--) {
        drive_apply(&d, &motor);
        feasible_circle_t circle = {.known = false};
        feasible_side_t side = plain_side(&motor, SIDE_BRAKING, 20);
        side.cap_has_voltage = false;
        const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, &circle);
        TEST_ASSERT_EQUAL_INT32(voltage_mNm, ends.voltage_mNm);
        TEST_ASSERT_EQUAL(voltage_mNm == 0, ends.current_mNm == FEASIBLE_UNBOUNDED);
        d.u = 2.7;
    }
}
