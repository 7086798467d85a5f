/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Voltage bounds of a motor of powers of two: the steps along the voltage ellipse, and the tangents
 * to it, in double precision. A unit is 2^20 of the binary scale.
 */
#include <math.h>

#include "plain_motor.h"
#include "random_values.h"
#include "unity.h"

enum { UNIT_LOG2 = 20, ROUNDS = 4000 };

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
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

/* ---- the end of the ellipse ---- */

typedef struct {
    double psi, saliency;                /* flux psi + s d */
    double r, x_q, emf, per_x, per_d, u; /* u_d = R d - X x, u_q = E + C x + D d */
    double fall[2], lowest;              /* of the map's i_d, over braking and driving torque */
} drive_t;

typedef struct {
    double d, x;
} point_t;

/* Torque of the map's last points. */
static const double LAST = 4.0;
static const double MOST = 4.0;

static void apply(const drive_t *d, int torque_shift)
{
    motor.constants.torque_shift = torque_shift;
    motor.set.row.step_log2 = UNIT_LOG2 - torque_shift;
    motor.model.flux_b = units(d->psi);
    motor.constants.torque_factor_q24 = 1 << 28;
    motor.constants.torque_inverse_q24 = 1 << 20;
    motor.model.x_per_airgap_q23 = (int32_t)lround(ldexp(1.0 / d->psi, 23));
    motor.model.saliency_b = ratio(d->saliency);
    motor.model.resistance_b = ratio(d->r);
    motor.model.reactance_q_b = ratio(d->x_q);
    motor.model.voltage_q_b = units(d->emf);
    motor.model.voltage_q_per_x = ratio(d->per_x);
    motor.model.voltage_q_per_d = ratio(d->per_d);
    motor.set.voltage_squared = (int64_t)ldexp(d->u * d->u, 2 * UNIT_LOG2);
    motor.set.weakest_d_b = units(d->lowest);
    motor.set.row.points = 9;
    motor.set.row.zero_mNm = units(LAST) >> torque_shift;
    for (int k = 1; k <= 4; k++) {
        motor.map_lsb[4 - k] = plain_entry(&motor, UNIT_LOG2, -d->fall[0] * k);
        motor.map_lsb[4 + k] = plain_entry(&motor, UNIT_LOG2, -d->fall[1] * k);
    }
}

static double flux(const drive_t *d, double i_d)
{
    return d->psi + d->saliency * i_d;
}

static double torque(const drive_t *d, point_t at)
{
    return flux(d, at.d) * at.x;
}

/* Where slopes end. */
static double up_to_four(double x)
{
    return fmin(fmax(x, -4.0), 4.0);
}

static bool unclear;

static bool is_above(double a, double b)
{
    unclear = unclear || fabs(a - b) < 4e-3;
    return a > b;
}

/* From a point along a direction to |u| = U; false without an intersection. */
static bool root(const drive_t *d, point_t at, point_t along, double sign, double *t)
{
    const double u_d = d->r * at.d - d->x_q * at.x;
    const double u_q = d->emf + d->per_x * at.x + d->per_d * at.d;
    const double s_d = d->r * along.d - d->x_q * along.x;
    const double s_q = d->per_x * along.x + d->per_d * along.d;
    const double half = s_d * u_d + s_q * u_q;
    const double squared = s_d * s_d + s_q * s_q;
    const double under_root = half * half - squared * (u_d * u_d + u_q * u_q - d->u * d->u);
    unclear = unclear || fabs(under_root) < 0.03 || squared < 0.03 || squared > 31.0;
    *t = (sign * sqrt(fmax(under_root, 0.0)) - half) / squared;
    return under_root >= 0.0;
}

static double map_d(const drive_t *d, double torque_now)
{
    return -d->fall[torque_now > 0.0] * fmin(fabs(torque_now), LAST);
}

static double map_slope(const drive_t *d, double torque_now)
{
    unclear = unclear || fabs(torque_now) < 0.01 || fabs(fabs(torque_now) - LAST) < 0.01;
    if (fabs(torque_now) > LAST) {
        return 0.0;
    }
    return torque_now > 0.0 ? -d->fall[1] : d->fall[0];
}

/* The end at the lowest i_d, then two steps of Newton's method towards the i_d of the map. */
static bool end_of_ellipse(const drive_t *d, double sign, point_t *at)
{
    const point_t over_x = {.d = 0.0, .x = 1.0};
    *at = (point_t){.d = d->lowest, .x = 0.0};
    bool exists = root(d, *at, over_x, sign, &at->x);
    for (int step = 0; exists && step < 2; step++) {
        const double now = torque(d, *at);
        const double wanted = fmin(fmax(map_d(d, now), -MOST), d->lowest);
        const double missing = wanted - at->d;
        if (missing == 0.0 || !is_above(fabs(missing), ldexp(256.0, -UNIT_LOG2))) {
            break;
        }
        (void)is_above(map_d(d, now), d->lowest);
        (void)is_above(map_d(d, now), -MOST);
        const double slope = wanted == map_d(d, now) ? map_slope(d, now) : 0.0;
        const double inverse = 1.0 / fmax(1.0 - slope * d->saliency * at->x, 0.25);
        const double per_x = up_to_four(inverse * up_to_four(slope * flux(d, at->d)));
        unclear = unclear || flux(d, at->d) < 0.3;
        at->d += inverse * missing;
        double t = 0.0;
        const bool meets = root(d, *at, (point_t){.d = per_x, .x = 1.0}, sign, &t);
        at->d += per_x * t;
        at->x += t;
        if (!meets) {
            *at = (point_t){.d = wanted, .x = 0.0};
            exists = root(d, *at, over_x, sign, &at->x);
        }
    }
    unclear = unclear || fabs(at->d) > 20.0 || fabs(at->x) > 20.0;
    return exists;
}

static drive_t any(random_t *random)
{
    const drive_t out = {
        .psi = random_real(random, 0.5, 2.0),
        .saliency = random_chance(random, 0.3) ? 0.0 : random_real(random, -0.3, 0.3),
        .r = random_real(random, 0.0, 0.3),
        .x_q = random_real(random, 0.3, 1.5),
        .emf = random_real(random, 0.5, 3.0),
        .per_x = random_real(random, 0.0, 0.5),
        .per_d = random_real(random, 0.3, 1.5),
        .u = random_real(random, 0.5, 2.0),
        .fall = {plain_entry_value(random_real(random, 0.0, 1.5)),
                 plain_entry_value(random_real(random, 0.0, 1.5))},
        .lowest = random_real(random, -3.0, 0.0),
    };
    return out;
}

void test_the_end_of_the_ellipse_is_reached_in_two_steps_of_newton_s_method(void)
{
    random_t random = random_seeded(62);
    int ends = 0;
    int none = 0;
    for (int n = 0; n < 2 * ROUNDS; n++) {
        const drive_t d = any(&random);
        const bool drives = random_chance(&random, 0.5);
        const double sign = drives ? 1.0 : -1.0;
        const int torque_shift = n % 2;
        apply(&d, torque_shift);
        unclear = false;
        point_t at;
        const bool exists = end_of_ellipse(&d, sign, &at);
        if (unclear) {
            continue;
        }
        const int32_t cap_b = (15 << 20) >> torque_shift;
        feasible_side_t side = plain_side(&motor, drives ? SIDE_DRIVING : SIDE_BRAKING, cap_b);
        side.cap_has_voltage = false;
        const int32_t found_mNm = feasible_by_voltage_mNm(&side);
        if (!exists) {
            none++;
            TEST_ASSERT_EQUAL_INT32(0, found_mNm);
            TEST_ASSERT_EQUAL_INT32(0, side.cap.x_b);
            TEST_ASSERT_EQUAL_INT32(0, side.cap_mNm);
            continue;
        }
        const double wanted = fmax(sign * torque(&d, at), 0.0);
        if (wanted > 14.0) {
            continue;
        }
        ends++;
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, wanted, ldexp(found_mNm, torque_shift - UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, at.d, ldexp(side.cap.d_b, -UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, at.x, ldexp(side.cap.x_b, -UNIT_LOG2));
        TEST_ASSERT_EQUAL_INT32(found_mNm, side.cap_mNm);
        TEST_ASSERT_TRUE(side.cap_has_voltage);
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 5, ends);
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 50, none);
}

/* The map's line does not meet the ellipse, which at the i_d of the torque before it has an end. */
void test_where_the_map_s_line_misses_the_ellipse_its_end_at_the_last_i_d_counts(void)
{
    const drive_t drives[] = {
        {.psi = 1.3393,
         .r = 0.17267,
         .x_q = 0.3445,
         .emf = 2.744,
         .per_x = 0.4537,
         .per_d = 0.8855,
         .u = 1.7034,
         .fall = {plain_entry_value(1.45), plain_entry_value(0.5335)},
         .lowest = -0.2455},
        {.psi = 1.47718,
         .saliency = 0.01535,
         .x_q = 0.30263,
         .emf = 2.5904,
         .per_x = 0.43432,
         .per_d = 1.27632,
         .u = 1.4777,
         .fall = {plain_entry_value(0.8396), plain_entry_value(0.4451)},
         .lowest = -0.05873},
    };
    for (int k = 0; k < 2; k++) {
        const double sign = k == 0 ? 1.0 : -1.0;
        apply(&drives[k], 0);
        point_t at;
        unclear = false;
        TEST_ASSERT_TRUE(end_of_ellipse(&drives[k], sign, &at));
        TEST_ASSERT_FALSE(unclear);
        feasible_side_t side = plain_side(&motor, k == 0 ? SIDE_DRIVING : SIDE_BRAKING, 15 << 20);
        side.cap_has_voltage = false;
        const int32_t found_mNm = feasible_by_voltage_mNm(&side);
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, sign * torque(&drives[k], at),
                                  ldexp(found_mNm, -UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, at.d, ldexp(side.cap.d_b, -UNIT_LOG2));
    }
}

/* Tangents to the hyperbola of a torque, each then back to the torque. */
static point_t tangents(const drive_t *d, double airgap, point_t at, int count)
{
    const double highest = at.d;
    const double lowest = fmin(d->lowest, highest);
    for (int n = 0; n < (d->saliency != 0.0 ? count : 1); n++) {
        unclear = unclear || flux(d, at.d) < 0.3 * d->psi;
        const point_t along = {.d = 1.0, .x = -d->saliency * at.x / flux(d, at.d)};
        double t = 0.0;
        (void)root(d, at, along, 1.0, &t);
        at.d = fmin(fmax(at.d + t, lowest), highest);
        unclear = unclear || flux(d, at.d) < 0.3 * d->psi;
        at.x = airgap / flux(d, at.d);
    }
    return at;
}

static double volts(const drive_t *d, point_t at)
{
    return hypot(d->r * at.d - d->x_q * at.x, d->emf + d->per_x * at.x + d->per_d * at.d);
}

void test_the_point_on_the_ellipse_is_found_by_two_tangents(void)
{
    motor.constants.current_most_b = 1 << 25;
    random_t random = random_seeded(63);
    int weakened = 0;
    for (int n = 0; n < ROUNDS; n++) {
        const drive_t d = any(&random);
        apply(&d, 0);
        unclear = false;
        const double airgap = random_real(&random, -3.0, 3.0);
        const double i_d = map_d(&d, airgap);
        const point_t on_map = {.d = i_d, .x = airgap / flux(&d, i_d)};
        unclear = unclear || flux(&d, i_d) < 0.3 * d.psi || fabs(volts(&d, on_map) - d.u) < 0.01;
        point_t wanted = on_map;
        if (volts(&d, on_map) > d.u) {
            wanted = tangents(&d, airgap, on_map, 2);
            weakened++;
        }
        if (unclear) {
            continue;
        }
        const motor_point_t found = feasible_point(&motor.set, units(airgap));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, wanted.d, ldexp(found.d_b, -UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, wanted.x, ldexp(found.x_b, -UNIT_LOG2));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 4, weakened);
}

/* A cap inside the end of the ellipse moves along one tangent, and bounds where the voltage does
 * not suffice there. */
void test_a_cap_inside_the_end_of_the_ellipse_is_weakened_by_one_tangent(void)
{
    random_t random = random_seeded(64);
    int weakened = 0;
    for (int n = 0; n < 2 * ROUNDS; n++) {
        const drive_t d = any(&random);
        apply(&d, 0);
        unclear = false;
        point_t end;
        const bool exists = end_of_ellipse(&d, 1.0, &end);
        const double end_torque = exists ? torque(&d, end) : 0.0;
        const double cap = random_real(&random, 0.1, 3.0);
        const double i_d = map_d(&d, cap);
        const point_t on_map = {.d = i_d, .x = cap / flux(&d, i_d)};
        if (flux(&d, i_d) < 0.3 * d.psi || end_torque < cap + 0.02 ||
            volts(&d, on_map) < d.u + 0.01) {
            continue;
        }
        const point_t wanted = tangents(&d, cap, on_map, 1);
        const double missing = volts(&d, wanted) - d.u;
        if (unclear || fabs(missing) < 2e-3) {
            continue;
        }
        feasible_side_t side = feasible_side_at(&motor.set, SIDE_DRIVING, units(cap));
        const int32_t found_mNm = feasible_by_voltage_mNm(&side);
        weakened++;
        TEST_ASSERT_TRUE((missing < 0.0) == (found_mNm == FEASIBLE_UNBOUNDED));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, wanted.d, ldexp(side.cap.d_b, -UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, wanted.x, ldexp(side.cap.x_b, -UNIT_LOG2));
        TEST_ASSERT_TRUE(side.cap_has_voltage);
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 40, weakened);
}
