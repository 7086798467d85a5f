/* SPDX-License-Identifier: Apache-2.0 */
/* Where the voltage ellipse meets the current circle of a motor of any inductance, resistance and
 * iron loss, in double precision: start and steps along the circle, which of voltage and current
 * bounds, and the i_d of a torque beyond the map's point. */
#include "plain_drive.h"
#include "unity.h"

enum { ROUNDS = 4000 };

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
    motor.constants.torque_factor_q24 = 1 << 28;
    motor.constants.torque_inverse_q24 = 1 << 20;
}

void tearDown(void) {}

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

/* Where the derivative of (psi + s d) sqrt(I^2 - d^2) over d is zero. */
static double best_d(const plain_drive_t *d)
{
    const double per_flux = d->saliency * MOST;
    return 2.0 * per_flux * MOST / (sqrt(d->psi * d->psi + 8.0 * per_flux * per_flux) + d->psi);
}

static plain_point_t on_circle(const plain_drive_t *d, double sign, double i_d)
{
    return (plain_point_t){.d = i_d, .x = drive_x(d, i_d, sign * drive_beside(CIRCLE, i_d))};
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
    plain_unclear = fabs(under_root) < 0.02 || half < 0.02;
    const double best = best_d(d);
    start_t out = {.best = best, .lowest = fmax(fmin(d->lowest, best), -CIRCLE)};
    out.d = drive_clamped(-excess / (half + root), -CIRCLE * 63.0 / 64.0, CIRCLE * 63.0 / 64.0);
    const double at = drive_clamped(out.d, out.lowest, out.best);
    const double power = d->r * drive_beside(CIRCLE, at) * (d->emf + (d->x_d - d->x_q) * at);
    plain_unclear = plain_unclear || (under_root < 0.0 && fabs(power) < 1e-3);
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
        if (plain_unclear) {
            continue;
        }
        checked++;
        TEST_ASSERT_TRUE(circle.known);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, wanted.best, plain_value(circle.best_b));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, wanted.lowest, plain_value(circle.lowest_b));
        TEST_ASSERT_DOUBLE_WITHIN(3e-3, wanted.d, plain_value(circle.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(3e-3, wanted.by_side, plain_value(circle.by_side_b));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 2, checked);
}

/* ---- the steps ---- */

/* Towards more voltage, to where it is U; without such a point on the line to the least of it. */
static double angle(const plain_drive_t *d, plain_point_t at, double i_d_per_t, double i_q_per_t)
{
    const plain_square_t p = drive_square(d, at, i_d_per_t, i_q_per_t, d->u * d->u);
    const double under_root = p.half * p.half - p.squared * p.excess;
    const double root = sqrt(fmax(under_root, 0.0));
    plain_unclear = plain_unclear || fabs(under_root) < 0.02 || fabs(p.half) < 0.02;
    if (p.half > 0.0) {
        return drive_clamped(-p.excess / (p.half + root), -0.5, 0.5);
    }
    plain_unclear = plain_unclear || fabs(p.squared) < 0.02;
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
        if (plain_is_above(-fabs(q), at.d)) {
            const double q_to = sign * (q - t * sign * at.d - t * t / 2.0 * q);
            to = -drive_beside(CIRCLE, drive_clamped(q_to, 0.0, CIRCLE));
        }
        to = drive_clamped(to, from->lowest, from->best);
        if (fabs(to - at.d) < 1e-9) {
            break;
        }
        plain_unclear = plain_unclear || fabs(to - at.d) < 1e-4;
        at = on_circle(d, sign, to);
        const bool turned =
            (t < 0.0) != (before < 0.0) && plain_is_above(fabs(t), fabs(before) / 2.0);
        if (!plain_is_above(fabs(t), 0.125) || (before != 0.0 && turned)) {
            break;
        }
        before = t;
    }
    plain_unclear = plain_unclear || drive_beside(CIRCLE, at.d) < 0.1;
    return at;
}

static void compare_steps(uint64_t seed, plain_drive_t (*draw)(random_t *random))
{
    random_t random = random_seeded(seed);
    int ends = 0;
    for (int n = 0; n < 2 * ROUNDS; n++) {
        const plain_drive_t d = draw(&random);
        const bool drives = random_chance(&random, 0.5);
        const double sign = drives ? 1.0 : -1.0;
        const double best = random_real(&random, -1.0, 3.9);
        const start_t from = {.best = best,
                              .lowest = random_real(&random, -3.9, best),
                              .d = random_real(&random, -3.9, 3.9),
                              .by_side = random_real(&random, -0.4, 0.4)};
        drive_apply(&d, &motor);
        plain_unclear = false;
        const plain_point_t at = end_of_steps(&d, sign, &from);
        if (plain_unclear || sign * torque(&d, at) < 0.1) {
            continue;
        }
        ends++;
        feasible_side_t side = plain_side(&motor, drives ? SIDE_DRIVING : SIDE_BRAKING, 20 << 20);
        feasible_circle_t circle = {.known = true,
                                    .best_b = plain_units(from.best),
                                    .lowest_b = plain_units(from.lowest),
                                    .d_b = plain_units(from.d),
                                    .by_side_b = plain_units(from.by_side)};
        (void)feasible_by_current_mNm(&side, &circle);
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, at.d, plain_value(side.cap.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, at.x, plain_value(side.cap.x_b));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 2, ends);
}

void test_the_end_of_the_circle_is_four_steps_from_any_start(void)
{
    compare_steps(92, any);
}

/* A resistance about as large as the reactances: the least voltage is on the side of braking, and
 * steps towards a U that is nowhere go to and fro. */
static plain_drive_t resistive(random_t *random)
{
    plain_drive_t out = {
        .psi = random_real(random, 0.5, 2.0),
        .r = random_real(random, 0.15, 0.3),
        .x_d = random_real(random, 0.1, 0.2),
        .emf = random_real(random, 1.8, 2.9),
        .u = random_real(random, 0.2, 1.5),
    };
    out.x_q = out.x_d * random_real(random, 1.0, 1.5);
    return out;
}

void test_steps_that_turn_by_more_than_half_of_the_step_before_end(void)
{
    compare_steps(93, resistive);
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
                                    .best_b = plain_units(3.0),
                                    .lowest_b = plain_units(-3.9),
                                    .d_b = plain_units(-2.0)};
        (void)feasible_by_current_mNm(&side, &circle);
        if (emf_b == 0) {
            TEST_ASSERT_EQUAL_INT32(plain_units(-2.0), side.cap.d_b);
        } else {
            TEST_ASSERT_LESS_THAN_INT32(plain_units(-3.0), side.cap.d_b);
        }
    }
}

/* No i_q is left at an i_d of the whole circle: one unit of it, on the side's own. */
void test_the_end_of_the_circle_at_its_lowest_i_d_has_the_sign_of_its_side(void)
{
    const int32_t circle_b = (4 << 20) - (4 << 12);
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        feasible_circle_t circle = {
            .known = true, .best_b = -circle_b, .lowest_b = -circle_b, .d_b = -circle_b};
        feasible_side_t side = plain_side(&motor, (side_t)sign, 20 << 20);
        motor.constants.torque_factor_q24 = SCALED_ONE;
        (void)feasible_by_current_mNm(&side, &circle);
        TEST_ASSERT_EQUAL_INT32(-circle_b, side.cap.d_b);
        TEST_ASSERT_EQUAL_INT32(sign, side.cap.x_b);
    }
}

/* u_q = 5 + d, u_d = -x: on the circle never as little as U = 1/2. The step from an i_d of -3.9
 * goes beyond i_q = 0, and ends before it. */
void test_a_step_beyond_the_end_of_the_circle_ends_on_the_side_where_it_began(void)
{
    const plain_drive_t d = {
        .psi = 1.0, .x_d = 1.0, .x_q = 1.0, .emf = 5.0, .u = 0.5, .lowest = -4.0};
    drive_apply(&d, &motor);
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        feasible_circle_t circle = {.known = true,
                                    .best_b = plain_units(3.0),
                                    .lowest_b = plain_units(-4.0),
                                    .d_b = plain_units(-3.9)};
        feasible_side_t side = plain_side(&motor, (side_t)sign, 20 << 20);
        (void)feasible_by_current_mNm(&side, &circle);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, -CIRCLE, plain_value(side.cap.d_b));
        TEST_ASSERT_EQUAL_INT32(sign, side.cap.x_b);
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

/* With an i_d of one unit the cap is outside the circle, whose end makes the same torque. */
void test_a_cap_of_the_torque_of_the_circle_s_end_keeps_its_point(void)
{
    const int32_t circle_b = (4 << 20) - (4 << 12);
    motor.constants.torque_factor_q24 = SCALED_ONE;
    feasible_circle_t circle = {.known = true};
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, circle_b);
    side.cap.d_b = -1;
    TEST_ASSERT_EQUAL_INT32(circle_b, feasible_by_current_mNm(&side, &circle));
    TEST_ASSERT_EQUAL_INT32(-1, side.cap.d_b);
    circle = (feasible_circle_t){.known = true};
    side = plain_side(&motor, SIDE_DRIVING, circle_b + 1);
    side.cap.d_b = -1;
    TEST_ASSERT_EQUAL_INT32(circle_b, feasible_by_current_mNm(&side, &circle));
    TEST_ASSERT_EQUAL_INT32(0, side.cap.d_b);
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
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, sqrt(3.0) - 2.0, plain_value(side.cap.d_b));
    TEST_ASSERT_EQUAL_INT32(1 << 20, side.cap_mNm);
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
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, drive_beside(CIRCLE, d_end), plain_value(ends.current_mNm));
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
    motor.constants.torque_shift = PLAIN_UNIT_LOG2;
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

/* ---- the i_d of a torque ---- */

/* Near its maximum the torque is a parabola over i_d: three steps. */
static double d_of_torque(const plain_drive_t *d, double map, double airgap)
{
    const double sign = airgap >= 0.0 ? 1.0 : -1.0;
    const double best = best_d(d);
    const double lowest = fmin(map, best);
    const double most = sign * torque(d, on_circle(d, sign, best));
    const double missing = fmax(most - sign * airgap, 0.0);
    double i_d = map;
    for (int pass = 0; pass < 3; pass++) {
        const double span = most - sign * torque(d, on_circle(d, sign, i_d));
        if (pass > 0 && span < 256.0 / (1 << 20)) {
            break; /* at the best */
        }
        plain_unclear = plain_unclear || span < 0.02 || (missing > 0.0 && missing * span < 0.05);
        const double share = fmin(sqrt(missing / span), 2.0);
        i_d = drive_clamped(best + share * (i_d - best), lowest, best);
    }
    return i_d;
}

/* Of torques whose point with the map's i_d is beyond the circle; at any voltage. */
static void compare_d_of_torque(uint64_t seed, double lowest_map, double highest_map,
                                double most_airgap)
{
    random_t random = random_seeded(seed);
    int beyond = 0;
    for (int n = 0; n < ROUNDS; n++) {
        plain_drive_t d = any(&random);
        d.iron = 0.0;
        drive_apply(&d, &motor);
        motor.set.voltage_squared = INT64_C(1) << 60;
        const double map = plain_entry_value(random_real(&random, lowest_map, highest_map));
        for (int k = 0; k < 3; k++) {
            motor.map_lsb[k] = plain_entry(&motor, PLAIN_UNIT_LOG2, map);
        }
        plain_unclear = false;
        const double airgap = random_real(&random, -most_airgap, most_airgap);
        const double wanted = d_of_torque(&d, map, airgap);
        const double x = airgap / (d.psi + d.saliency * wanted);
        const bool outside = plain_is_above(hypot(map, airgap / (d.psi + d.saliency * map)), MOST);
        if (plain_unclear || !outside || fabs(x) > 20.0) {
            continue;
        }
        beyond++;
        const motor_point_t found = feasible_point(&motor.set, plain_units(airgap));
        TEST_ASSERT_DOUBLE_WITHIN(6e-3, wanted, plain_value(found.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(2e-2, x, plain_value(found.x_b));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 20, beyond);
}

void test_a_torque_beyond_the_circle_of_the_map_s_point_has_the_i_d_of_three_steps(void)
{
    compare_d_of_torque(71, -2.0, 0.0, 10.0);
}

/* More torque than the circle makes: maximum torque per ampere, whatever the map has. */
void test_a_torque_beyond_the_largest_of_the_circle_has_the_i_d_of_that(void)
{
    random_t random = random_seeded(74);
    for (int n = 0; n < ROUNDS / 4; n++) {
        plain_drive_t d = any(&random);
        d.iron = 0.0;
        d.saliency = random_real(&random, -0.4, -0.05);
        drive_apply(&d, &motor);
        motor.set.voltage_squared = INT64_C(1) << 60;
        const double map = plain_entry_value(random_real(&random, -3.9, 0.0));
        for (int k = 0; k < 3; k++) {
            motor.map_lsb[k] = plain_entry(&motor, PLAIN_UNIT_LOG2, map);
        }
        if (fabs(map - best_d(&d)) < 0.1) {
            continue; /* as much torque within the scale's coarseness */
        }
        const double most = torque(&d, on_circle(&d, 1.0, best_d(&d)));
        const double sign = n % 2 == 0 ? 1.0 : -1.0;
        const motor_point_t found =
            feasible_point(&motor.set, plain_units(sign * random_real(&random, 1.01, 2.0) * most));
        TEST_ASSERT_DOUBLE_WITHIN(4e-4, best_d(&d), plain_value(found.d_b));
    }
}

/* The iron takes twice the phase current: no torque along the rotation is left on the circle. */
void test_an_iron_current_beyond_the_circle_leaves_the_i_d_of_most_torque(void)
{
    motor.model.iron_current_b = plain_units(8.0);
    for (int32_t sign = -1; sign <= 1; sign++) {
        const motor_point_t found = feasible_point(&motor.set, plain_units(sign));
        TEST_ASSERT_EQUAL_INT32(0, found.d_b);
    }
}

/* From an i_d near the circle's end, where the torque is far from a parabola: without saliency the
 * third step of a torque of 2 leaves it at 2.16. */
void test_the_third_step_counts_from_the_end_of_the_circle(void)
{
    compare_d_of_torque(73, -3.95, -3.0, 4.0);
}
