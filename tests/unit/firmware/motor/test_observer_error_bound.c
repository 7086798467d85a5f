/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The torque at whose currents an uncertain L_q turns the observer by 15 degrees, to the unit: the
 * inequality of DERIVATIONS.md, Uncertain L_q, in double precision with a motor of any inductance.
 */
#include "motor/observer_error.h"

#include "motor/flux_map.h"
#include "plain_motor.h"
#include "random_values.h"
#include "unity.h"

enum { ROUNDS = 4000, MOST_CURRENT_b = 1 << 25 };

static const double E = 15.0 * 3.14159265358979323846 / 180.0;

static plain_motor_t motor;

/* In units of 2^24 of the binary scales. */
typedef struct {
    double psi, saliency, l_q; /* L_d - L_q is the saliency */
    double tolerance;          /* of L_q: a half of a constant, a tenth of a flux map */
    double map_d, cap_d, cap; /* i_d of the map at any torque, of the end of the side; its torque */
} drive_t;

void setUp(void)
{
    plain_motor_init(&motor);
}

void tearDown(void) {}

static int32_t units(double x)
{
    return (int32_t)lround(ldexp(x, 24));
}

static void apply(const drive_t *d)
{
    motor.model.flux_b = units(d->psi);
    motor.model.slope_flux_b = motor.model.flux_b;
    motor.model.saliency_b = units(d->saliency);
    motor.model.slope_saliency_b = motor.model.saliency_b;
    motor.model.inductance_q_b = units(d->l_q);
    motor.model.inductance_d_b = units(d->l_q + d->saliency);
    motor.model.x_per_airgap_q23 = (int32_t)lround(ldexp(1.0 / d->psi, 23));
    motor.config.flux_map.d_points = d->tolerance < 0.3 ? 2 : 0;
    motor.constants.current_most_b = MOST_CURRENT_b;
    for (int k = 0; k < 3; k++) {
        motor.map_lsb[k] = plain_entry(&motor, 24, d->map_d);
    }
}

/* Largest |i_qt| beside an i_d. */
static double most_x(const drive_t *d, double i_d)
{
    const double wrong = d->tolerance * d->l_q;
    const double least = d->saliency + wrong; /* c- */
    const double most = d->saliency - wrong;  /* c+ */
    const double active = fmax(d->psi + cos(E) * (i_d < 0.0 ? least : most) * i_d, 0.0);
    const double turned = fmax(fmax(-least, most), 0.0);
    const double by_x = wrong + sin(E) * sin(E) * turned;
    return by_x > 0.0 ? fmin(sin(E) * active / by_x, 2.0) : 2.0;
}

static double torque(const drive_t *d, double i_d, double x)
{
    return (d->psi + d->saliency * i_d) * x;
}

static double bound(const drive_t *d, double sign)
{
    const double without_d = torque(d, 0.0, sign * most_x(d, 0.0));
    const double i_d = sign * without_d < d->cap ? d->map_d : d->cap_d;
    return fmax(sign * torque(d, i_d, sign * most_x(d, i_d)), 0.0);
}

static int32_t found_mNm(const drive_t *d, side_t sign)
{
    feasible_side_t side = plain_side(&motor, sign, units(d->cap));
    side.cap.d_b = units(d->cap_d);
    return observer_error_torque_mNm(&side);
}

static drive_t any(random_t *random)
{
    const drive_t out = {
        .psi = random_real(random, 0.2, 2.0),
        .saliency = random_chance(random, 0.2) ? 0.0 : random_real(random, -1.5, 1.5),
        .l_q = random_real(random, 0.0, 2.0),
        .tolerance = random_chance(random, 0.5) ? 0.5 : 3277.0 / 32768.0,
        .map_d = plain_entry_value(random_real(random, -0.6, 0.6)),
        .cap_d = random_real(random, -1.0, 1.0),
        .cap = random_real(random, 0.05, 1.0),
    };
    return out;
}

void test_the_bound_is_the_torque_at_which_an_uncertain_l_q_turns_the_angle_by_15_degrees(void)
{
    random_t random = random_seeded(15);
    int by_cap = 0;
    for (int n = 0; n < ROUNDS; n++) {
        const drive_t d = any(&random);
        const double sign = random_chance(&random, 0.5) ? 1.0 : -1.0;
        const double without_d = torque(&d, 0.0, most_x(&d, 0.0));
        const double wanted = bound(&d, sign);
        /* The map's i_d leaves most of the flux, and the point is inside the current circle. */
        const double flux = d.psi + d.saliency * d.map_d;
        if (fabs(without_d - d.cap) < 1e-4 || flux < 0.6 * d.psi ||
            hypot(d.map_d, without_d / flux) > 1.9 || wanted > 1.9) {
            continue;
        }
        by_cap += without_d > d.cap;
        apply(&d);
        /* A unit of each factor, the largest of which counts 1/by_x times. */
        const double by_x = fmax(d.tolerance * d.l_q, 1e-3);
        TEST_ASSERT_DOUBLE_WITHIN(8.0 + 4.0 / by_x, ldexp(wanted, 24),
                                  found_mNm(&d, sign > 0.0 ? SIDE_DRIVING : SIDE_BRAKING));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 10, by_cap);
}

/* Without saliency, and L_q 9/32: 64/9 sin E times the flux of one. */
void test_the_sine_of_the_angle_counts_to_its_last_digit(void)
{
    const drive_t d = {.psi = 1.0, .l_q = 9.0 / 32.0, .tolerance = 0.5, .cap = 1.0};
    apply(&d);
    TEST_ASSERT_DOUBLE_WITHIN(3.0, ldexp(sin(E) * 64.0 / 9.0, 24), found_mNm(&d, SIDE_DRIVING));
}

/* ---- ends ---- */

void test_an_i_d_that_takes_the_active_flux_leaves_no_torque(void)
{
    const drive_t d = {.psi = 0.5, .l_q = 1.0, .tolerance = 0.5, .cap_d = 1.9, .cap = 0.1};
    apply(&d);
    TEST_ASSERT_EQUAL_INT32(0, found_mNm(&d, SIDE_DRIVING));
    TEST_ASSERT_EQUAL_INT32(0, found_mNm(&d, SIDE_BRAKING));
}

/* An L_q of zero turns nothing: all that the scale of currents holds. */
void test_without_an_l_q_only_the_scale_of_currents_bounds(void)
{
    const drive_t d = {.psi = 1.0, .tolerance = 0.5, .cap = 4.0, .cap_d = 0.5};
    apply(&d);
    TEST_ASSERT_EQUAL_INT32(MOST_CURRENT_b, found_mNm(&d, SIDE_DRIVING));
    TEST_ASSERT_EQUAL_INT32(MOST_CURRENT_b, found_mNm(&d, SIDE_BRAKING));
}

/* Half of an L_q of two units, or of none, beside a flux of four, the least there is, of which the
 * sine leaves one: a current of 2^24 makes four units of torque. */
void test_the_least_error_of_an_inductance_is_one_unit(void)
{
    const drive_t d = {.psi = 1.0, .tolerance = 0.5, .cap = 4.0};
    apply(&d);
    motor.model.flux_b = 4;
    motor.model.x_per_airgap_q23 = 1 << 30;
    for (int32_t l_q_b = 0; l_q_b <= 2; l_q_b++) {
        motor.model.inductance_q_b = l_q_b;
        TEST_ASSERT_EQUAL_INT32(4, found_mNm(&d, SIDE_DRIVING));
    }
}

/* sin E psi/(L_q/2) is four times the sine; beside an i_d of the map of -1/4 less by half of L_q
 * times that. To the unit the torque without i_d decides which of the two points is taken. */
void test_the_end_s_i_d_counts_from_a_cap_of_the_torque_without_i_d_on(void)
{
    drive_t d = {.psi = 1.0, .l_q = 0.5, .tolerance = 0.5, .map_d = -0.25, .cap_d = 0.5};
    const int32_t without_d_b = 4 * units(sin(E));
    const double by_map = sin(E) * (1.0 - cos(E) * 0.25 * 0.25) / 0.25;
    const double by_end = sin(E) * (1.0 - cos(E) * 0.25 * 0.5) / 0.25;
    d.cap = ldexp(without_d_b, -24);
    apply(&d);
    TEST_ASSERT_DOUBLE_WITHIN(32.0, ldexp(by_end, 24), found_mNm(&d, SIDE_DRIVING));
    TEST_ASSERT_DOUBLE_WITHIN(32.0, ldexp(by_end, 24), found_mNm(&d, SIDE_BRAKING));
    d.cap = ldexp(without_d_b + 1, -24);
    TEST_ASSERT_DOUBLE_WITHIN(32.0, ldexp(by_map, 24), found_mNm(&d, SIDE_DRIVING));
    TEST_ASSERT_DOUBLE_WITHIN(32.0, ldexp(by_map, 24), found_mNm(&d, SIDE_BRAKING));
}

/* Currents that cancel the flux along the rotor but for a nanoweber, and make none across it. */
void test_without_active_flux_and_current_across_l_q_explains_no_angle(void)
{
    config_t config = {
        .motor = {.flux_linkage_nWb = 1001, .d_inductance_nH = 100, .q_inductance_nH = 100}};
    for (int32_t i_q_mA = -1; i_q_mA <= 1; i_q_mA++) {
        const motor_current_t i = {.d_mA = -10000, .q_mA = i_q_mA};
        for (int32_t angle_turn = 0; angle_turn < 30600; angle_turn += 1000) {
            TEST_ASSERT_FALSE(observer_error_explains(&config, i, angle_turn));
        }
    }
}
