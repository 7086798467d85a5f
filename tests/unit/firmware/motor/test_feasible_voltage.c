/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Voltage bounds of a motor of powers of two: field weakening, caps and points at their limits, and
 * the steps along the voltage ellipse and its tangents in double precision.
 */
#include "plain_motor.h"
#include "random_values.h"
#include "unity.h"

enum { ROUNDS = 4000, MOST_b = 1 << 22, CIRCLE_b = 255 << 14 };

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
    motor.config.current_map.torque_points = 3;
    motor.config.current_map.speed_points = 2;
    motor.config.motor.derate_winding_temperature_cC = 10000;
    motor.config.motor.max_winding_temperature_cC = 15000;
}

void tearDown(void) {}

/* u_d = -4 2^20, u_q = 2^20: |u|^2 = 17 2^40, a 16th more than 2^44. */
void test_a_point_holds_up_to_a_sixteenth_more_of_the_squared_voltage(void)
{
    motor.model.reactance_q_b = SCALED_ONE;
    motor.model.voltage_q_b = 1 << 20;
    motor.set.voltage_squared = INT64_C(1) << 44;
    motor_point_t at = {.d_b = 0, .x_b = 4 << 20};
    TEST_ASSERT_TRUE(feasible_holds(&motor.set, at));
    at.x_b++;
    TEST_ASSERT_FALSE(feasible_holds(&motor.set, at));
    at.x_b = 0;
    motor.model.voltage_q_b = (4 << 20) + (1 << 18);
    TEST_ASSERT_FALSE(feasible_holds(&motor.set, at));
}

/* ---- the lowest i_d of field weakening ---- */

static int32_t weakest_b(int32_t phase_mV)
{
    return feasible_set_at(&motor.model, phase_mV).weakest_d_b;
}

void test_a_voltage_of_zero_or_less_is_none(void)
{
    motor.constants.voltage_shift = 4;
    TEST_ASSERT_TRUE(feasible_set_at(&motor.model, 1).voltage_squared == 256);
    TEST_ASSERT_TRUE(feasible_set_at(&motor.model, 0).voltage_squared == 0);
    TEST_ASSERT_TRUE(feasible_set_at(&motor.model, -1).voltage_squared == 0);
}

/* A flux that the circle cannot weaken to zero: down to the circle, hot only to the configured. */
void test_field_weakening_ends_at_the_circle_and_hot_at_the_configured_current(void)
{
    motor.model.inductance_d_b = SCALED_ONE;
    motor.constants.weakening_most_b = 1 << 20;
    motor.model.speed_b = 1 << 22;
    TEST_ASSERT_INT32_WITHIN(CIRCLE_b >> 14, -CIRCLE_b, weakest_b(1 << 20));
    motor.model.winding_temperature_cC = 15000;
    TEST_ASSERT_EQUAL_INT32(-(1 << 20), weakest_b(1 << 20));
    motor.constants.weakening_most_b = 1 << 23;
    TEST_ASSERT_EQUAL_INT32(-CIRCLE_b, weakest_b(1 << 20));
}

void test_field_does_not_rise_where_the_voltage_would_bear_a_higher_flux(void)
{
    motor.model.inductance_d_b = SCALED_ONE;
    motor.model.inductance_q_b = SCALED_ONE;
    motor.model.flux_b = 1 << 20;
    motor.model.slope_flux_b = motor.model.flux_b;
    motor.model.saliency_b = SCALED_ONE / 2;
    motor.model.slope_saliency_b = motor.model.saliency_b;
    const int32_t SPEEDS_b[] = {0, 1, 1 << 10};
    for (int k = 0; k < 3; k++) {
        motor.model.speed_b = SPEEDS_b[k];
        TEST_ASSERT_EQUAL_INT32(0, weakest_b(1 << 24));
    }
}

/* Without saliency, or with a flux of no voltage, the i_d that cancels the flux; a flux of four
 * units over an inductance of none is more than the circle. */
void test_field_weakening_without_torque_of_saliency_cancels_the_flux(void)
{
    motor.model.inductance_d_b = SCALED_ONE / 4;
    motor.model.inductance_q_b = 1 << 10;
    motor.model.speed_b = 1 << 22;
    motor.model.flux_b = 4;
    motor.model.slope_flux_b = motor.model.flux_b;
    TEST_ASSERT_EQUAL_INT32(-16, weakest_b(0));
    motor.model.saliency_b = 1;
    motor.model.slope_saliency_b = motor.model.saliency_b;
    motor.model.inductance_d_b = 0;
    TEST_ASSERT_INT32_WITHIN(CIRCLE_b >> 14, -CIRCLE_b, weakest_b(0));
}

/* L_d = 1/2, L_q = 1, psi = L_d I/2: maximum torque per voltage lies on the circle, where
 * X = L_d I - psi = I/4, at the flux F^2 = 2 X^2 + psi L_q X/(L_q - L_d) = I^2/4. */
void test_the_circle_ends_field_weakening_from_the_flux_at_which_torque_per_voltage_does(void)
{
    motor.model.inductance_d_b = SCALED_ONE / 2;
    motor.model.inductance_q_b = SCALED_ONE;
    motor.model.saliency_b = -SCALED_ONE / 2;
    motor.model.slope_saliency_b = motor.model.saliency_b;
    motor.model.flux_b = CIRCLE_b / 4;
    motor.model.slope_flux_b = motor.model.flux_b;
    motor.model.speed_b = SCALED_ONE;
    motor.constants.weakening_most_b = CIRCLE_b;
    const int32_t flux_b = CIRCLE_b / 2;
    TEST_ASSERT_INT32_WITHIN(CIRCLE_b >> 12, -CIRCLE_b, weakest_b(flux_b));
    TEST_ASSERT_GREATER_THAN_INT32(-CIRCLE_b, weakest_b(flux_b - (flux_b >> 8)));
    TEST_ASSERT_EQUAL_INT32(-CIRCLE_b, weakest_b(flux_b + (flux_b >> 8)));
    TEST_ASSERT_EQUAL_INT32(-CIRCLE_b, weakest_b(4 * flux_b));
    /* L_d i_d = -F (psi/F + 2 s F/(psi L_q + sqrt((psi L_q)^2 + 8 s^2 F^2))), F = I/4: psi = F,
     * i_d = -2 F (1 + 1/(1 + sqrt(3))). */
    const double wanted_b = -0.5 * (1.0 + 1.0 / (1.0 + sqrt(3.0))) * CIRCLE_b;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * CIRCLE_b, wanted_b, weakest_b(CIRCLE_b / 4));
}

/* L_d above L_q takes the torque the other way: F_d = 2 F^2 s/(psi L_q + sqrt((psi L_q)^2 + 8 s^2
 * F^2)) with s = L_d - L_q; L_d = 1, L_q = 1/2. */
void test_field_weakening_of_a_larger_l_d_ends_at_maximum_torque_per_voltage(void)
{
    motor.model.inductance_d_b = SCALED_ONE;
    motor.model.inductance_q_b = SCALED_ONE / 2;
    motor.model.saliency_b = SCALED_ONE / 2;
    motor.model.slope_saliency_b = motor.model.saliency_b;
    motor.model.speed_b = SCALED_ONE;
    motor.constants.weakening_most_b = CIRCLE_b;
    for (int32_t share = 1; share < 16; share++) {
        const double psi = share / 16.0 * CIRCLE_b;
        motor.model.flux_b = (int32_t)psi;
        motor.model.slope_flux_b = motor.model.flux_b;
        for (int32_t voltage_b = CIRCLE_b / 16; voltage_b <= CIRCLE_b; voltage_b += CIRCLE_b / 16) {
            const double f = voltage_b;
            const double f_d =
                f * f / (0.5 * psi + sqrt(0.25 * psi * psi + 2.0 * f * f)); /* 2 s = 1 */
            const double wanted_b = fmax(fmin(f_d - psi, 0.0), -CIRCLE_b);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * CIRCLE_b, wanted_b, weakest_b(voltage_b));
        }
    }
}

/* L_d I one unit above psi; a flux of two units: F^2 - 2 X^2 is none of 2^24. */
void test_a_flux_of_a_few_units_of_voltage_ends_field_weakening_near_the_cancelled_flux(void)
{
    motor.model.inductance_d_b = SCALED_ONE;
    motor.model.inductance_q_b = 2 * SCALED_ONE;
    motor.model.saliency_b = -SCALED_ONE;
    motor.model.slope_saliency_b = motor.model.saliency_b;
    motor.model.speed_b = SCALED_ONE;
    motor.model.flux_b = CIRCLE_b - 1;
    motor.constants.weakening_most_b = CIRCLE_b;
    for (int32_t voltage_b = 0; voltage_b <= 8; voltage_b++) {
        TEST_ASSERT_INT32_WITHIN(8, -CIRCLE_b, weakest_b(voltage_b));
    }
}

/* One unit of voltage at standstill is a flux of one: sum = 1 + sqrt(3), i_d = (1 / sum - 1) / 4.
 */
void test_standstill_counts_as_one_unit_of_speed(void)
{
    motor.model.inductance_d_b = 4 * SCALED_ONE;
    motor.model.inductance_q_b = SCALED_ONE;
    motor.model.saliency_b = SCALED_ONE / 2;
    motor.model.slope_saliency_b = motor.model.saliency_b;
    const double wanted_b = (1.0 / (1.0 + sqrt(3.0)) - 1.0) / 4.0 * SCALED_ONE;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * SCALED_ONE, wanted_b, weakest_b(1));
}

/* ---- caps ---- */

void test_a_cap_of_any_torque_is_a_point_on_its_side(void)
{
    motor.model.friction_b = 100;
    TEST_ASSERT_EQUAL_INT32(1100, feasible_side_at(&motor.set, SIDE_DRIVING, 1000).cap.x_b);
    TEST_ASSERT_EQUAL_INT32(-900, feasible_side_at(&motor.set, SIDE_BRAKING, 1000).cap.x_b);
    TEST_ASSERT_EQUAL_INT32((1 << 25) - 1,
                            feasible_side_at(&motor.set, SIDE_DRIVING, INT32_MAX).cap.x_b);
    TEST_ASSERT_EQUAL_INT32(-(1 << 25),
                            feasible_side_at(&motor.set, SIDE_BRAKING, INT32_MAX).cap.x_b);
}

/* |u|^2 = 0 with an EMF that the lowest i_d cancels: the end is zero torque, which friction brakes.
 */
void test_an_ellipse_of_one_point_exists(void)
{
    motor.model.friction_b = 100;
    motor.model.reactance_q_b = SCALED_ONE;
    motor.model.voltage_q_per_d = SCALED_ONE;
    motor.model.voltage_q_b = 1 << 12;
    motor.set.weakest_d_b = -(1 << 12);
    motor.set.voltage_squared = 0;
    feasible_side_t side = plain_side(&motor, SIDE_BRAKING, MOST_b);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(100, feasible_by_voltage_mNm(&side));
    /* 2^24 too much of |u|^2, which a reactance of 2^-12 shows as one unit. */
    motor.model.reactance_q_b = 1 << 12;
    motor.set.weakest_d_b = 0;
    side = plain_side(&motor, SIDE_BRAKING, MOST_b);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(0, feasible_by_voltage_mNm(&side));
}

/* 2^12 V over 2^-12 Ohm. */
void test_the_smallest_reactance_counts(void)
{
    motor.model.reactance_q_b = 1 << 12;
    motor.set.voltage_squared = 1 << 24;
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 1 << 25);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(1 << 24, feasible_by_voltage_mNm(&side));
}

/* ---- to the last unit ---- */

/* u_d = R d - x, u_q = 0, U = 2^24: the end of x with the i_d of a map that is flat. */
static feasible_side_t ellipse_of_one(int32_t map_lsb, int32_t cap_b)
{
    motor.constants.current_most_b = 1 << 25;
    motor.model.reactance_q_b = SCALED_ONE;
    motor.set.voltage_squared = INT64_C(1) << 48;
    for (int k = 0; k < 3; k++) {
        motor.map_lsb[k] = (int16_t)map_lsb;
    }
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, cap_b);
    side.cap_has_voltage = false;
    return side;
}

void test_the_end_of_an_ellipse_of_powers_of_two_is_one(void)
{
    for (int32_t r_b = 0; r_b <= 1 << 26; r_b += 1 << 26) {
        feasible_side_t side = ellipse_of_one(0, 1 << 25);
        motor.model.resistance_b = r_b;
        TEST_ASSERT_EQUAL_INT32(1 << 24, feasible_by_voltage_mNm(&side));
        TEST_ASSERT_EQUAL_INT32(0, side.cap.d_b);
        TEST_ASSERT_EQUAL_INT32(1 << 24, side.cap.x_b);
    }
}

/* Entries of 2^14 mA are 2^15 units, down to the largest current of 2^25. */
void test_the_end_of_the_ellipse_has_the_i_d_of_a_flat_map_to_the_unit(void)
{
    for (int32_t map_lsb = -(1 << 10); map_lsb < 0; map_lsb += 1 << 6) {
        motor.set.row.weights.shift = 15 - 14;
        feasible_side_t side = ellipse_of_one(map_lsb, 1 << 25);
        TEST_ASSERT_EQUAL_INT32(1 << 24, feasible_by_voltage_mNm(&side));
        TEST_ASSERT_EQUAL_INT32(map_lsb * (1 << 15), side.cap.d_b);
    }
}

/* u_q = 3 d, u_d = -x, U = 5: x is 5 at i_d = 0 and 4 at -1, the largest current; a map below it
 * makes i_d neither follow the torque, four times x, nor fall beyond it. */
void test_a_map_beyond_the_largest_current_leaves_i_d_at_that_to_the_unit(void)
{
    feasible_side_t side = ellipse_of_one(-(1 << 14), 1 << 28);
    motor.constants.current_most_b = MOST_b;
    motor.set.row.weights.shift = 15 - 9;
    motor.model.flux_b = 4 * SCALED_ONE - 4;
    motor.model.voltage_q_per_d = 3 * SCALED_ONE;
    motor.set.voltage_squared = INT64_C(25) << 44;
    TEST_ASSERT_INT32_WITHIN(8, 16 << 22, feasible_by_voltage_mNm(&side));
    TEST_ASSERT_EQUAL_INT32(-MOST_b, side.cap.d_b);
    TEST_ASSERT_EQUAL_INT32(4 << 22, side.cap.x_b);
}

/* Entries of a milliampere, two units: 256 are the first of consequence. */
void test_an_i_d_of_no_consequence_is_left(void)
{
    for (int32_t map_lsb = -130; map_lsb <= 0; map_lsb++) {
        feasible_side_t side = ellipse_of_one(map_lsb, 1 << 25);
        (void)feasible_by_voltage_mNm(&side);
        TEST_ASSERT_EQUAL_INT32(map_lsb <= -128 ? 2 * map_lsb : 0, side.cap.d_b);
    }
}

/* The same torque from the cap and from the end of the ellipse: nothing up to the cap is lost. */
void test_a_cap_at_the_end_of_the_ellipse_is_no_bound(void)
{
    feasible_side_t side = ellipse_of_one(0, 1 << 24);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, feasible_by_voltage_mNm(&side));
    side = ellipse_of_one(0, (1 << 24) + 1);
    TEST_ASSERT_EQUAL_INT32(1 << 24, feasible_by_voltage_mNm(&side));
}

/* ---- points on the ellipse and on the circle ---- */

/* x 3, u_q = 6 + i_d, |u| up to 5: i_d -2. */
void test_a_cap_inside_the_end_of_the_ellipse_is_no_bound(void)
{
    motor.model.reactance_q_b = SCALED_ONE;
    motor.model.voltage_q_per_d = SCALED_ONE;
    motor.model.voltage_q_b = 6 << 20;
    motor.set.voltage_squared = INT64_C(25) << 40;
    motor.set.weakest_d_b = -(4 << 20);
    feasible_side_t side = plain_side(&motor, SIDE_DRIVING, 3 << 20);
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, feasible_by_voltage_mNm(&side));
    TEST_ASSERT_EQUAL_INT32(0, side.cap.d_b);
    side.cap_has_voltage = false;
    TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, feasible_by_voltage_mNm(&side));
    TEST_ASSERT_EQUAL_INT32(-(2 << 20), side.cap.d_b);
    TEST_ASSERT_EQUAL_INT32(3 << 20, side.cap_mNm);
    TEST_ASSERT_TRUE(side.cap_has_voltage);
}

/* Phase current 5, the map's i_d -3, i_q 4; one unit more is beyond the circle. */
void test_a_point_on_the_circle_keeps_the_i_d_of_the_map(void)
{
    motor.constants.current_most_b = 5 << 18;
    for (int k = 0; k < 3; k++) {
        motor.map_lsb[k] = plain_entry(&motor, 18, -3.0);
    }
    TEST_ASSERT_EQUAL_INT32(-(3 << 18), feasible_point(&motor.set, 4 << 18).d_b);
    TEST_ASSERT_GREATER_THAN_INT32(-(3 << 18), feasible_point(&motor.set, (4 << 18) + 1).d_b);
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
    motor.set.row.step_log2 = PLAIN_UNIT_LOG2 - torque_shift;
    motor.model.flux_b = plain_units(d->psi);
    motor.model.slope_flux_b = motor.model.flux_b;
    motor.constants.torque_factor_q24 = 1 << 28;
    motor.constants.torque_inverse_q24 = 1 << 20;
    motor.model.x_per_airgap_q23 = (int32_t)lround(ldexp(1.0 / d->psi, 23));
    motor.model.saliency_b = plain_ratio(d->saliency);
    motor.model.slope_saliency_b = motor.model.saliency_b;
    motor.model.resistance_b = plain_ratio(d->r);
    motor.model.reactance_q_b = plain_ratio(d->x_q);
    motor.model.voltage_q_b = plain_units(d->emf);
    motor.model.voltage_q_per_x = plain_ratio(d->per_x);
    motor.model.voltage_q_per_d = plain_ratio(d->per_d);
    motor.set.voltage_squared = (int64_t)ldexp(d->u * d->u, 2 * PLAIN_UNIT_LOG2);
    motor.set.weakest_d_b = plain_units(d->lowest);
    motor.set.row.points = 9;
    motor.set.row.zero_mNm = plain_units(LAST) >> torque_shift;
    for (int k = 1; k <= 4; k++) {
        motor.map_lsb[4 - k] = plain_entry(&motor, PLAIN_UNIT_LOG2, -d->fall[0] * k);
        motor.map_lsb[4 + k] = plain_entry(&motor, PLAIN_UNIT_LOG2, -d->fall[1] * k);
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
    plain_unclear = plain_unclear || fabs(under_root) < 0.03 || squared < 0.03 || squared > 31.0;
    *t = (sign * sqrt(fmax(under_root, 0.0)) - half) / squared;
    return under_root >= 0.0;
}

static double map_d(const drive_t *d, double torque_now)
{
    return -d->fall[torque_now > 0.0] * fmin(fabs(torque_now), LAST);
}

static double map_slope(const drive_t *d, double torque_now)
{
    plain_unclear =
        plain_unclear || fabs(torque_now) < 0.01 || fabs(fabs(torque_now) - LAST) < 0.01;
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
        if (missing == 0.0 || !plain_is_above(fabs(missing), plain_value(256.0))) {
            break;
        }
        (void)plain_is_above(map_d(d, now), d->lowest);
        (void)plain_is_above(map_d(d, now), -MOST);
        const double slope = wanted == map_d(d, now) ? map_slope(d, now) : 0.0;
        const double inverse = 1.0 / fmax(1.0 - slope * d->saliency * at->x, 0.25);
        const double per_x = up_to_four(inverse * up_to_four(slope * flux(d, at->d)));
        plain_unclear = plain_unclear || flux(d, at->d) < 0.3;
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
    plain_unclear = plain_unclear || fabs(at->d) > 20.0 || fabs(at->x) > 20.0;
    return exists;
}

static drive_t any(random_t *random, double lowest_saliency, double highest_saliency)
{
    const drive_t out = {
        .psi = random_real(random, 0.5, 2.0),
        .saliency = random_chance(random, 0.3)
                        ? 0.0
                        : random_real(random, lowest_saliency, highest_saliency),
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

static void compare_ends(uint64_t seed, int rounds, double lowest_saliency, double highest_saliency)
{
    random_t random = random_seeded(seed);
    int ends = 0;
    int none = 0;
    for (int n = 0; n < rounds; n++) {
        const drive_t d = any(&random, lowest_saliency, highest_saliency);
        const bool drives = random_chance(&random, 0.5);
        const double sign = drives ? 1.0 : -1.0;
        const int torque_shift = n % 2;
        apply(&d, torque_shift);
        plain_unclear = false;
        point_t at;
        const bool exists = end_of_ellipse(&d, sign, &at);
        if (plain_unclear) {
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
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, wanted, ldexp(found_mNm, torque_shift - PLAIN_UNIT_LOG2));
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, at.d, plain_value(side.cap.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(5e-3, at.x, plain_value(side.cap.x_b));
        TEST_ASSERT_EQUAL_INT32(found_mNm, side.cap_mNm);
        TEST_ASSERT_TRUE(side.cap_has_voltage);
    }
    TEST_ASSERT_GREATER_THAN_INT(rounds / 10, ends);
    TEST_ASSERT_GREATER_THAN_INT(rounds / 100, none);
}

void test_the_end_of_the_ellipse_is_reached_in_two_steps_of_newton_s_method(void)
{
    compare_ends(62, 2 * ROUNDS, -0.3, 0.3);
}

/* The flux of a salient motor may bend the map's line past the ellipse: then the end at its i_d. */
void test_where_the_line_of_the_map_misses_the_ellipse_the_end_is_that_at_the_map_s_i_d(void)
{
    compare_ends(63, 8 * ROUNDS, -1.5, -0.9);
}

/* A tangent to the hyperbola of a torque, then back to the torque. */
static point_t along_tangent(const drive_t *d, double airgap, point_t at)
{
    const double lowest = fmin(d->lowest, at.d);
    const point_t along = {.d = 1.0, .x = -d->saliency * at.x / flux(d, at.d)};
    double t = 0.0;
    (void)root(d, at, along, 1.0, &t);
    at.d = fmin(fmax(at.d + t, lowest), at.d);
    plain_unclear = plain_unclear || flux(d, at.d) < 0.3 * d->psi;
    at.x = airgap / flux(d, at.d);
    return at;
}

static double volts(const drive_t *d, point_t at)
{
    return hypot(d->r * at.d - d->x_q * at.x, d->emf + d->per_x * at.x + d->per_d * at.d);
}

/* A cap inside the end of the ellipse moves along one tangent, and bounds where the voltage does
 * not suffice there. */
void test_a_cap_inside_the_end_of_the_ellipse_is_weakened_by_one_tangent(void)
{
    random_t random = random_seeded(64);
    int weakened = 0;
    for (int n = 0; n < 2 * ROUNDS; n++) {
        const drive_t d = any(&random, -0.3, 0.3);
        apply(&d, 0);
        plain_unclear = false;
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
        const point_t wanted = along_tangent(&d, cap, on_map);
        const double missing = volts(&d, wanted) - d.u;
        if (plain_unclear || fabs(missing) < 2e-3) {
            continue;
        }
        feasible_side_t side = feasible_side_at(&motor.set, SIDE_DRIVING, plain_units(cap));
        const int32_t found_mNm = feasible_by_voltage_mNm(&side);
        weakened++;
        TEST_ASSERT_TRUE((missing < 0.0) == (found_mNm == FEASIBLE_UNBOUNDED));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, wanted.d, plain_value(side.cap.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, wanted.x, plain_value(side.cap.x_b));
        TEST_ASSERT_TRUE(side.cap_has_voltage);
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 40, weakened);
}
