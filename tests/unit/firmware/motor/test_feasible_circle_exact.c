/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The phase current circle of a motor of powers of two, in double precision: start and steps to the
 * voltage ellipse, and the i_d of a torque. A unit is 2^20 of the binary scale.
 */
#include <math.h>

#include "plain_motor.h"
#include "random_values.h"
#include "unity.h"

enum { UNIT_LOG2 = 20, ROUNDS = 4000 };

static const double MOST = 4.0;
static const double CIRCLE = 4.0 * 255.0 / 256.0;

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
    motor.constants.torque_factor_q24 = 1 << 28;
    motor.constants.torque_inverse_q24 = 1 << 20;
}

void tearDown(void) {}

static int32_t units(double x)
{
    return (int32_t)lround(ldexp(x, UNIT_LOG2));
}

static int32_t ratio(double x)
{
    return (int32_t)lround(ldexp(x, 24));
}

typedef struct {
    double psi, saliency;    /* flux psi + s d */
    double r, x_d, x_q, emf; /* u_d = R d - X_q x, u_q = E + R x + X_d d */
    double u, lowest, map;   /* i_d of the map */
} drive_t;

typedef struct {
    double d, x;
} point_t;

static void apply(const drive_t *d)
{
    motor.model.flux_b = units(d->psi);
    motor.model.saliency_b = ratio(d->saliency);
    motor.model.x_per_airgap_q23 = (int32_t)lround(ldexp(1.0 / d->psi, 23));
    motor.model.resistance_b = ratio(d->r);
    motor.model.reactance_d_b = ratio(d->x_d);
    motor.model.reactance_q_b = ratio(d->x_q);
    motor.model.emf_b = units(d->emf);
    motor.model.voltage_q_b = units(d->emf);
    motor.model.voltage_q_per_x = ratio(d->r);
    motor.model.voltage_q_per_d = ratio(d->x_d);
    motor.set.voltage_squared = (int64_t)ldexp(d->u * d->u, 2 * UNIT_LOG2);
    motor.set.weakest_d_b = units(d->lowest);
    for (int k = 0; k < 3; k++) {
        motor.map_lsb[k] = plain_entry(&motor, UNIT_LOG2, d->map);
    }
}

static drive_t any(random_t *random)
{
    drive_t out = {
        .psi = random_real(random, 0.5, 2.0),
        .saliency = random_chance(random, 0.3) ? 0.0 : random_real(random, -0.4, 0.1),
        .r = random_real(random, 0.0, 0.2),
        .x_d = random_real(random, 0.1, 0.8),
        .emf = random_real(random, 0.5, 3.0),
        .u = random_real(random, 0.5, 3.0),
        .lowest = random_real(random, -3.9, 0.0),
        .map = plain_entry_value(random_real(random, -2.0, 0.0)),
    };
    out.x_q = out.x_d * random_real(random, 1.0, 2.0);
    return out;
}

static double torque(const drive_t *d, point_t at)
{
    return (d->psi + d->saliency * at.d) * at.x;
}

static double beside(double d)
{
    return sqrt(fmax(CIRCLE * CIRCLE - d * d, 0.0));
}

static point_t on_circle(double sign, double d)
{
    return (point_t){.d = d, .x = sign * beside(d)};
}

static double clamped(double x, double lowest, double highest)
{
    return fmin(fmax(x, lowest), highest);
}

/* Where the derivative of (psi + s d) sqrt(I^2 - d^2) over d is zero. */
static double best_d(const drive_t *d)
{
    const double per_flux = fabs(d->saliency) * MOST;
    if (d->saliency == 0.0) {
        return 0.0;
    }
    const double share =
        (sqrt(d->psi * d->psi + 8.0 * per_flux * per_flux) - d->psi) / (4.0 * per_flux);
    return d->saliency < 0.0 ? -share * MOST : share * MOST;
}

static bool unclear;

static bool is_above(double a, double b)
{
    unclear = unclear || fabs(a - b) < 4e-3;
    return a > b;
}

/* ---- the i_d of a torque ---- */

/* Near its maximum the torque is a parabola over i_d: three steps. */
static double d_of_torque(const drive_t *d, double airgap)
{
    const double sign = airgap >= 0.0 ? 1.0 : -1.0;
    const double best = best_d(d);
    const double lowest = fmin(d->map, best);
    const double most = sign * torque(d, on_circle(sign, best));
    const double missing = fmax(most - sign * airgap, 0.0);
    double i_d = d->map;
    for (int pass = 0; pass < 3; pass++) {
        const double span = most - sign * torque(d, on_circle(sign, i_d));
        unclear = unclear || (pass == 0 && span < 0.02);
        if (span < ldexp(256.0, -UNIT_LOG2)) {
            break;
        }
        unclear = unclear || span < 0.02 || (missing > 0.0 && missing * span < 0.05);
        const double share = fmin(sqrt(missing / span), 2.0);
        i_d = clamped(best + share * (i_d - best), lowest, best);
    }
    return i_d;
}

void test_the_point_of_a_torque_beyond_the_map_s_circle_makes_it_with_the_i_d_of_three_steps(void)
{
    random_t random = random_seeded(71);
    int beyond = 0;
    for (int n = 0; n < ROUNDS; n++) {
        const drive_t d = any(&random);
        apply(&d);
        motor.set.voltage_squared = INT64_C(1) << 60;
        unclear = false;
        const double airgap = random_real(&random, -10.0, 10.0);
        const double x = airgap / (d.psi + d.saliency * d.map);
        const bool outside = is_above(hypot(d.map, x), MOST);
        const double wanted = outside ? d_of_torque(&d, airgap) : d.map;
        const double flux = d.psi + d.saliency * wanted;
        if (unclear || fabs(airgap / flux) > 20.0) {
            continue;
        }
        beyond += outside && wanted > d.map;
        const motor_point_t found = feasible_point(&motor.set, units(airgap));
        TEST_ASSERT_DOUBLE_WITHIN(6e-3, wanted, ldexp(found.d_b, -UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(2e-2, airgap / flux, ldexp(found.x_b, -UNIT_LOG2));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 20, beyond);
}

/* From an i_d near the circle's end, where the torque is far from a parabola: without saliency the
 * third step of a torque of 2 leaves it at 2.16. */
void test_the_i_d_of_a_torque_from_the_end_of_the_circle_is_that_of_the_third_step(void)
{
    random_t random = random_seeded(73);
    int far = 0;
    for (int n = 0; n < ROUNDS; n++) {
        drive_t d = any(&random);
        d.map = plain_entry_value(random_real(&random, -3.95, -3.0));
        apply(&d);
        motor.set.voltage_squared = INT64_C(1) << 60;
        unclear = false;
        const double airgap = random_real(&random, 0.5, 4.0);
        const double x = airgap / (d.psi + d.saliency * d.map);
        const bool outside = is_above(hypot(d.map, x), MOST);
        const double wanted = d_of_torque(&d, airgap);
        if (unclear || !outside || airgap / (d.psi + d.saliency * wanted) > 20.0) {
            continue;
        }
        far++;
        const motor_point_t found = feasible_point(&motor.set, units(airgap));
        TEST_ASSERT_DOUBLE_WITHIN(6e-3, wanted, ldexp(found.d_b, -UNIT_LOG2));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 4, far);
}

/* A saliency of 2^-12 of the flux on the circle, whose square is lost in that of the flux. */
void test_a_small_saliency_moves_the_best_i_d_by_as_little(void)
{
    drive_t d = {.psi = 1.0, .x_d = 0.1, .x_q = 0.1, .u = 3.0, .lowest = -3.0};
    for (int k = -1; k <= 1; k++) {
        d.saliency = ldexp(k, -14);
        apply(&d);
        feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 20 << 20);
        feasible_circle_t circle = {.known = false};
        (void)feasible_by_current_mNm(&side, &circle);
        /* s I^2 / psi */
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, d.saliency * MOST * MOST, ldexp(circle.best_b, -UNIT_LOG2));
    }
}

/* ---- along the circle to the ellipse ---- */

typedef struct {
    double best, lowest, d, by_side;
} start_t;

/* DERIVATIONS.md, Phase current: the quadratic of both sides, and its change by the resistive
 * power. */
static start_t start(const drive_t *d)
{
    const double excess =
        d->emf * d->emf + CIRCLE * CIRCLE * (d->x_q * d->x_q + d->r * d->r) - d->u * d->u;
    const double half = d->x_d * d->emf;
    const double squared = d->x_d * d->x_d - d->x_q * d->x_q;
    const double under_root = half * half - squared * excess;
    const double root = sqrt(fmax(under_root, 0.0));
    unclear = unclear || under_root < 0.02;
    const double best = best_d(d);
    const double lowest = fmax(fmin(d->lowest, best), -CIRCLE);
    const double i_d =
        clamped(-excess / (half + root), -CIRCLE * 63.0 / 64.0, CIRCLE * 63.0 / 64.0);
    const double at = clamped(i_d, lowest, best);
    const double power = d->r * beside(at) * (d->emf + (d->x_d - d->x_q) * at);
    const start_t out = {.best = best,
                         .lowest = lowest,
                         .d = i_d,
                         .by_side = clamped(power / root, -CIRCLE / 8.0, CIRCLE / 8.0)};
    return out;
}

/* Along the tangent |u|^2 to the second order, the circle bending towards the voltage of no
 * current. */
static double angle(const drive_t *d, point_t at, point_t along)
{
    const double u_d = d->r * at.d - d->x_q * at.x;
    const double u_q = d->emf + d->r * at.x + d->x_d * at.d;
    const double s_d = d->r * along.d - d->x_q * along.x;
    const double s_q = d->r * along.x + d->x_d * along.d;
    const double half = s_d * u_d + s_q * u_q;
    const double excess = u_d * u_d + u_q * u_q - d->u * d->u;
    const double squared = s_d * s_d + s_q * s_q - u_d * u_d - u_q * (u_q - d->emf);
    const double under_root = half * half - squared * excess;
    const double root = sqrt(fmax(under_root, 0.0));
    unclear = unclear || fabs(under_root) < 0.02 || fabs(half) < 0.02;
    if (half > 0.0) {
        return clamped(-excess / (half + root), -0.5, 0.5);
    }
    unclear = unclear || fabs(squared) < 0.02;
    return squared > 0.0 ? clamped((root - half) / squared, -0.5, 0.5) : 0.5;
}

static point_t end_of_circle(const drive_t *d, double sign)
{
    const start_t from = start(d);
    point_t at = on_circle(sign, clamped(from.d - sign * from.by_side, from.lowest, from.best));
    double before = 0.0;
    for (int step = 0; step < 4; step++) {
        const point_t along = {.d = fabs(at.x), .x = -sign * at.d};
        const double t = angle(d, at, along);
        double to = at.d + t * along.d - t * t / 2.0 * at.d;
        if (is_above(-along.d, at.d)) {
            const double x = sign * (at.x + t * along.x - t * t / 2.0 * at.x);
            to = -beside(clamped(x, 0.0, CIRCLE));
        }
        to = clamped(to, from.lowest, from.best);
        if (fabs(to - at.d) < 1e-9) {
            break;
        }
        unclear = unclear || fabs(to - at.d) < 1e-4;
        at = on_circle(sign, to);
        const bool turned = (t < 0.0) != (before < 0.0) && is_above(fabs(t), fabs(before) / 2.0);
        if (!is_above(fabs(t), 0.125) || (before != 0.0 && turned)) {
            break;
        }
        before = t;
    }
    return at;
}

void test_the_end_of_the_circle_is_reached_in_four_steps_along_it(void)
{
    random_t random = random_seeded(72);
    int ends = 0;
    for (int n = 0; n < 2 * ROUNDS; n++) {
        const drive_t d = any(&random);
        const bool drives = random_chance(&random, 0.5);
        const double sign = drives ? 1.0 : -1.0;
        apply(&d);
        unclear = false;
        const point_t at = end_of_circle(&d, sign);
        if (unclear || fabs(at.x) < 0.1) {
            continue;
        }
        ends++;
        feasible_side_t side = plain_side(&motor, drives ? SIDE_DRIVING : SIDE_BRAKING, 20 << 20);
        feasible_circle_t circle = {.known = false};
        const int32_t found_mNm = feasible_by_current_mNm(&side, &circle);
        const double wanted = fmax(sign * torque(&d, at), 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, wanted, ldexp(found_mNm, -UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, at.d, ldexp(side.cap.d_b, -UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, at.x, ldexp(side.cap.x_b, -UNIT_LOG2));
        TEST_ASSERT_EQUAL_INT32(found_mNm, side.cap_mNm);
        TEST_ASSERT_TRUE(circle.known);
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 2, ends);
}
