/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The constants of a motor with a flux map around a pair of currents, to the unit: the tangent
 * along i_d and the chord along i_q of a map in double precision (DERIVATIONS.md, Saturated iron),
 * and the ends of their ranges. Steps of the map are powers of two, so that every second
 * milliampere is an exact position.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "motor/motor_model.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "reference_flux_map.h"
#include "unity.h"

enum {
    MOST_b = 1 << 26,
    LEAST_b = 4, /* of a flux, which divides */
    STEP_mA = 1 << 14,
    D_POINTS = 9,
    D_NEGATIVE_POINTS = 6,
    Q_POINTS = 6,
    MOST_mA = 50000,
    REFERENCE_cC = 2500
};

static config_t config;
static motor_constants_t constants;

/* Scales as motor_constants_init() makes them: a flux is an inductance times a current. */
static void use_scales(int32_t current_shift, int32_t flux_unit_shift)
{
    constants.current_shift = current_shift;
    constants.flux_unit_shift = flux_unit_shift;
    constants.inductance_unit_shift = flux_unit_shift + current_shift - 14;
}

void setUp(void)
{
    config = paper_vehicle();
    config.motor.pole_pairs = 1;
    config.motor.max_phase_current_mA = MOST_mA;
    config.motor.reference_temperature_cC = REFERENCE_cC;
    config.motor.flux_coefficient_ppm_K = 0;
    memset(&config.flux_map, 0, sizeof config.flux_map);
    memset(&constants, 0, sizeof constants);
    constants.torque_factor_q24 = SCALED_ONE;
    constants.torque_inverse_q24 = SCALED_ONE;
    use_scales(8, 36);
}

void tearDown(void) {}

static void use_points(int32_t step_mA, int32_t lsb_log2)
{
    config_flux_map_t *map = &config.flux_map;
    map->d_points = D_POINTS;
    map->d_negative_points = D_NEGATIVE_POINTS;
    map->d_step_mA = step_mA;
    map->q_points = Q_POINTS;
    map->q_step_mA = step_mA;
    map->lsb_log2 = lsb_log2;
}

/* psi_d rises along i_d, psi_q along i_q; along the other axis either changes by random steps of
 * either sign. psi_q is zero without i_q. */
static void random_map(uint64_t seed, int32_t step_mA, int32_t lsb_log2)
{
    config_flux_map_t *map = &config.flux_map;
    random_t random = random_seeded(seed);
    use_points(step_mA, lsb_log2);
    for (int d = 0; d < D_POINTS; d++) {
        for (int q = 0; q < Q_POINTS; q++) {
            const int32_t below = d > 0 ? map->psi_d_lsb[(d - 1) * Q_POINTS + q] : 4000;
            const int32_t before = q > 0 ? map->psi_q_lsb[d * Q_POINTS + q - 1] : 0;
            map->psi_d_lsb[d * Q_POINTS + q] =
                (int16_t)(below + random_between(&random, 1000, 3000));
            map->psi_q_lsb[d * Q_POINTS + q] =
                (int16_t)(q > 0 ? before + random_between(&random, 2000, 3500) : 0);
        }
    }
}

/* Of currents at rest, in the scales of the model. */
typedef struct {
    double flux, l_d, l_q, slope_flux, slope_saliency;
} model_of_map_t;

/* With s = L_d - (psi_q + L_dq i_d)/i_q: psi_d + L_dq i_q - L_q' i_d - s i_d. Below a quarter of
 * the first step of i_q the model is that of a quarter; zero counts as positive. */
static model_of_map_t of_map(double i_d_mA, double i_q_mA)
{
    const double least_mA = fmax(floor(config.flux_map.q_step_mA / 4.0), 1.0);
    const double q_mA = copysign(fmax(fabs(i_q_mA), least_mA), i_q_mA < 0.0 ? -1.0 : 1.0);
    const reference_flux_t at = reference_flux(&config.flux_map, i_d_mA, q_mA);
    const double flux = ldexp(1e-9, 58 - constants.flux_unit_shift);
    const double inductance = ldexp(1e-12, 68 - constants.inductance_unit_shift);
    /* a nH is a nWb of a kA */
    const double saliency_nH = at.d_nH - (1e3 * at.q_nWb + at.cross_nH * i_d_mA) / q_mA;
    const double active_nWb = at.d_nWb + 1e-3 * (at.cross_nH * q_mA - at.q_nH * i_d_mA);
    const model_of_map_t out = {
        .flux = reference_clamp(flux * (at.d_nWb - 1e-3 * at.d_nH * i_d_mA), LEAST_b, MOST_b),
        .l_d = inductance * at.d_nH,
        .l_q = inductance * 1e3 * at.q_nWb / q_mA,
        .slope_flux =
            reference_clamp(flux * (active_nWb - 1e-3 * saliency_nH * i_d_mA), LEAST_b, MOST_b),
        .slope_saliency = inductance * saliency_nH,
    };
    return out;
}

static motor_model_t around(int32_t i_d_mA, int32_t i_q_mA)
{
    const motor_current_t at = {.d_mA = i_d_mA, .q_mA = i_q_mA};
    return motor_model_around(&constants, &config, 0, REFERENCE_cC, at);
}

/* A unit of flux is one of inductance times 2^24 units of current, and a nanohenry a quarter of
 * one; of the cross inductance i_d/i_q times as much. */
static void assert_model_of_map(int32_t i_d_mA, int32_t i_q_mA)
{
    const model_of_map_t want = of_map(i_d_mA, i_q_mA);
    const motor_model_t m = around(i_d_mA, i_q_mA);
    const double q_mA = fmax(abs(i_q_mA), config.flux_map.q_step_mA / 4);
    const double chord = 3.0 + ldexp(2.0 / q_mA, 24 - constants.current_shift);
    const double turned = 3.0 * fabs((double)i_d_mA) / q_mA;
    TEST_ASSERT_DOUBLE_WITHIN(2.0, want.l_d, m.inductance_d_b);
    TEST_ASSERT_DOUBLE_WITHIN(chord, want.l_q, m.inductance_q_b);
    TEST_ASSERT_DOUBLE_WITHIN(2.0 + chord, want.l_d - want.l_q, m.saliency_b);
    TEST_ASSERT_DOUBLE_WITHIN(4.0, want.flux, m.flux_b);
    TEST_ASSERT_DOUBLE_WITHIN(8.0 + 2.0 * turned, want.slope_flux, m.slope_flux_b);
    TEST_ASSERT_DOUBLE_WITHIN(chord + turned, want.slope_saliency, m.slope_saliency_b);
}

void test_flux_and_inductances_are_the_tangent_and_the_chord_of_the_map(void)
{
    random_t random = random_seeded(5);
    for (uint64_t seed = 0; seed < 100; seed++) {
        random_map(seed, STEP_mA, 13);
        for (int n = 0; n < 30; n++) {
            const int32_t i_d_mA = 2 * random_between(&random, -45000, 20000);
            const int32_t i_q_mA = 2 * random_between(&random, -45000, 45000);
            assert_model_of_map(i_d_mA, i_q_mA);
        }
    }
}

/* Where the chord has no current to divide by, that of a quarter of the first step stands for it,
 * on the side of i_q; the model has no step there. */
void test_around_small_i_q_the_model_is_that_of_a_quarter_of_the_first_step(void)
{
    static const int32_t NEAR_mA[] = {-STEP_mA / 4 - 8, -STEP_mA / 4, -STEP_mA / 8,   -1, 0, 1,
                                      STEP_mA / 8,      STEP_mA / 4,  STEP_mA / 4 + 8};
    for (uint64_t seed = 0; seed < 30; seed++) {
        random_map(seed, STEP_mA, 13);
        for (int n = 0; n < 9; n++) {
            assert_model_of_map(-3 * STEP_mA + 2048, NEAR_mA[n]);
        }
    }
}

/* The largest currents that count are twice the phase current limit, of either sign. */
void test_currents_beyond_twice_the_limit_count_as_twice_the_limit(void)
{
    random_map(1, STEP_mA, 13);
    config.motor.max_phase_current_mA = 8 * 1024;
    for (int sign = -1; sign <= 1; sign += 2) {
        const int32_t limit_mA = 2 * config.motor.max_phase_current_mA;
        const model_of_map_t along_d = of_map(sign * limit_mA, 8192.0);
        const model_of_map_t along_q = of_map(-2048.0, sign * limit_mA);
        for (int32_t beyond_mA = 0; beyond_mA <= 4096; beyond_mA += 2048) {
            const int32_t i_mA = sign * (limit_mA + beyond_mA);
            TEST_ASSERT_DOUBLE_WITHIN(4.0, along_d.flux, around(i_mA, 8192).flux_b);
            TEST_ASSERT_DOUBLE_WITHIN(8.0, along_q.flux, around(-2048, i_mA).flux_b);
            TEST_ASSERT_DOUBLE_WITHIN(8.0, along_q.l_q, around(-2048, i_mA).inductance_q_b);
        }
    }
}

/* Steps of so few milliamperes that one of them is a large part of a step. A nanoweber is a unit.
 */
void test_without_currents_a_model_is_exact_at_none(void)
{
    for (uint64_t seed = 0; seed < 20; seed++) {
        random_map(seed, 8, 0);
        use_scales(8, 28);
        const motor_model_t m = motor_model_at(&constants, &config, 0, REFERENCE_cC);
        const model_of_map_t want = of_map(0.0, 0.0);
        TEST_ASSERT_DOUBLE_WITHIN(4.0, want.flux, m.flux_b);
        TEST_ASSERT_DOUBLE_WITHIN(8.0, want.slope_flux, m.slope_flux_b);
    }
}

/* A quarter of less than four milliamperes is one. A nanoweber is a quarter of a unit. */
void test_the_least_current_of_the_chord_is_a_milliampere(void)
{
    for (int32_t step_mA = 1; step_mA <= 8; step_mA *= 2) {
        for (uint64_t seed = 0; seed < 20; seed++) {
            random_map(seed, step_mA, 0);
            config.flux_map.d_step_mA = 1 << 10;
            use_scales(8, 30);
            const model_of_map_t want = of_map(0.0, 0.0);
            const motor_model_t m = around(0, 0);
            TEST_ASSERT_DOUBLE_WITHIN(4.0, want.slope_flux, m.slope_flux_b);
            TEST_ASSERT_DOUBLE_WITHIN(1 << 17, want.l_q, m.inductance_q_b);
        }
    }
}

/* psi_d falls by a nanoweber a step of 1.024 A along i_q: rounded down a nanohenry. */
void test_a_cross_inductance_of_a_nanohenry_counts_with_its_sign(void)
{
    use_scales(8, 28); /* a nanohenry is 70 units */
    use_points(1 << 10, 0);
    for (int k = 0; k < D_POINTS * Q_POINTS; k++) {
        config.flux_map.psi_d_lsb[k] = (int16_t)(20000 + k / Q_POINTS * 100 - k % Q_POINTS);
        config.flux_map.psi_q_lsb[k] = (int16_t)(k % Q_POINTS * 100);
    }
    for (int32_t i_q_mA = -1000; i_q_mA <= 1000; i_q_mA += 2000) {
        const model_of_map_t want = of_map(-5000.0, i_q_mA);
        const motor_model_t m = around(-5000, i_q_mA);
        TEST_ASSERT_DOUBLE_WITHIN(150.0, want.slope_saliency, m.slope_saliency_b); /* 343 by it */
        const model_of_map_t far = of_map(0.0, 80 * i_q_mA);
        TEST_ASSERT_DOUBLE_WITHIN(4.0, far.slope_flux, around(0, 80 * i_q_mA).slope_flux_b);
    }
}

/* ---- moving a model ---- */

static void assert_same_model(const motor_model_t *want, const motor_model_t *m)
{
    TEST_ASSERT_EQUAL_INT32(want->inductance_d_b, m->inductance_d_b);
    TEST_ASSERT_EQUAL_INT32(want->inductance_q_b, m->inductance_q_b);
    TEST_ASSERT_EQUAL_INT32(want->flux_b, m->flux_b);
    TEST_ASSERT_EQUAL_INT32(want->saliency_b, m->saliency_b);
    TEST_ASSERT_EQUAL_INT32(want->slope_flux_b, m->slope_flux_b);
    TEST_ASSERT_EQUAL_INT32(want->slope_saliency_b, m->slope_saliency_b);
    TEST_ASSERT_EQUAL_INT32(want->emf_b, m->emf_b);
    TEST_ASSERT_EQUAL_INT32(want->reactance_d_b, m->reactance_d_b);
    TEST_ASSERT_EQUAL_INT32(want->reactance_q_b, m->reactance_q_b);
    TEST_ASSERT_EQUAL_INT32(want->cross_d, m->cross_d);
    TEST_ASSERT_EQUAL_INT32(want->cross_q, m->cross_q);
    TEST_ASSERT_EQUAL_INT32(want->iron_current_b, m->iron_current_b);
    TEST_ASSERT_EQUAL_INT32(want->one_plus_a2, m->one_plus_a2);
    TEST_ASSERT_EQUAL_INT32(want->voltage_q_b, m->voltage_q_b);
    TEST_ASSERT_EQUAL_INT32(want->voltage_q_per_x, m->voltage_q_per_x);
    TEST_ASSERT_EQUAL_INT32(want->voltage_q_per_d, m->voltage_q_per_d);
    TEST_ASSERT_EQUAL_INT32(want->resistance_b, m->resistance_b);
    TEST_ASSERT_EQUAL_INT32(want->friction_b, m->friction_b);
}

void test_a_moved_model_is_the_one_made_around_its_new_currents(void)
{
    random_t random = random_seeded(6);
    random_map(3, STEP_mA, 13);
    config.motor.flux_coefficient_ppm_K = -1000;
    constants.iron_q16_b = 1 << 18;
    constants.resistance_b = SCALED_ONE / 8;
    for (int n = 0; n < 200; n++) {
        const int32_t speed_mrad_s = random_between(&random, -(1 << 22), 1 << 22);
        const int32_t winding_cC = random_between(&random, -2000, 14000);
        const motor_current_t at = {.d_mA = random_between(&random, -90000, 40000),
                                    .q_mA = random_between(&random, -90000, 90000)};
        motor_model_t m = motor_model_at(&constants, &config, speed_mrad_s, winding_cC);
        const motor_model_t want =
            motor_model_around(&constants, &config, speed_mrad_s, winding_cC, at);
        motor_model_move(&m, at);
        assert_same_model(&want, &m);
    }
}

void test_a_motor_of_constants_is_the_same_around_any_currents(void)
{
    constants.flux_b = SCALED_ONE;
    constants.inductance_d_b = SCALED_ONE / 2;
    constants.inductance_q_b = SCALED_ONE / 4;
    const motor_current_t at = {.d_mA = -20000, .q_mA = 30000};
    const motor_model_t want = motor_model_at(&constants, &config, 1 << 20, REFERENCE_cC);
    motor_model_t m = want;
    motor_model_move(&m, at);
    assert_same_model(&want, &m);
}

/* ---- the ends of the ranges ---- */

/* 2^58 / 10^9 of a nanoweber and 2^68 / 10^12 of a nanohenry, rounded down: never more than the
 * quantity itself, nor a whole unit and a thirtieth less. */
void test_fluxes_and_inductances_of_26_bits_are_rounded_down_by_a_unit(void)
{
    random_t random = random_seeded(9);
    use_points(STEP_mA, 16);
    for (int n = 0; n < 2000; n++) {
        const int32_t magnets_lsb = random_between(&random, 16000, 30000);
        const int32_t rise_lsb = random_between(&random, 90, 115);
        for (int k = 0; k < D_POINTS * Q_POINTS; k++) {
            const int d = k / Q_POINTS - D_NEGATIVE_POINTS;
            config.flux_map.psi_d_lsb[k] = (int16_t)(magnets_lsb + d * rise_lsb);
            config.flux_map.psi_q_lsb[k] = (int16_t)(k % Q_POINTS);
        }
        use_scales(8, 33);
        const double flux = ldexp(magnets_lsb * 65536e-9, 58 - 33);
        const int32_t flux_b = around(0, 0).flux_b;
        TEST_ASSERT_TRUE(flux_b <= flux && flux_b > flux - 1.033);
        /* 2^16 nWb over 2^14 mA are 4000 nH. */
        constants.inductance_unit_shift = 21;
        const double inductance = ldexp(rise_lsb * 4000e-12, 68 - 21);
        const int32_t inductance_b = around(0, 0).inductance_d_b;
        TEST_ASSERT_TRUE(inductance_b <= inductance && inductance_b > inductance - 1.033);
    }
}

/* A map whose fluxes are the same everywhere, as far as a unit, and one of the largest. */
void test_a_flat_map_leaves_inductances_that_divide(void)
{
    use_points(STEP_mA, 13);
    const motor_model_t m = around(-STEP_mA, STEP_mA);
    TEST_ASSERT_EQUAL_INT32(1, m.inductance_d_b);
    TEST_ASSERT_EQUAL_INT32(1, m.inductance_q_b);
    TEST_ASSERT_EQUAL_INT32(LEAST_b, m.flux_b);
    TEST_ASSERT_EQUAL_INT32(LEAST_b, m.slope_flux_b);
}

void test_fluxes_and_inductances_beyond_26_bits_are_the_largest(void)
{
    use_points(STEP_mA, 16);
    for (int k = 0; k < D_POINTS * Q_POINTS; k++) {
        const int d = k / Q_POINTS - D_NEGATIVE_POINTS;
        config.flux_map.psi_d_lsb[k] = (int16_t)(20000 + d * 2000);
        config.flux_map.psi_q_lsb[k] = (int16_t)(k % Q_POINTS * 5000);
    }
    /* From 2^34 units up to 2^61. */
    for (int32_t shift = 10; shift <= 26; shift += 4) {
        use_scales(8, shift);
        const motor_model_t m = around(0, STEP_mA);
        TEST_ASSERT_EQUAL_INT32(MOST_b - 1, m.flux_b);
        TEST_ASSERT_EQUAL_INT32(MOST_b - 1, m.slope_flux_b);
        TEST_ASSERT_EQUAL_INT32(MOST_b, m.inductance_d_b);
    }
    /* The tangent at a current that weakens: psi_d - L_d i_d. */
    use_scales(8, 32);
    constants.inductance_unit_shift = 20;
    TEST_ASSERT_EQUAL_INT32(MOST_b, around(-MOST_mA, STEP_mA).flux_b);
    TEST_ASSERT_EQUAL_INT32(LEAST_b, around(2 * MOST_mA, STEP_mA).flux_b);
}
