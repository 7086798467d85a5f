/* SPDX-License-Identifier: Apache-2.0 */
/* The thermal model to the unit: coefficients of a row beside h/(C R + h) in double precision,
 * starts, means and losses at the ends of their ranges. Courses of hours: test_thermal_model.c. */
#include <math.h>

#include "motor/thermal_model.h"
#include "random_values.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

enum { MOST_cC = 32700, ROUND_ms = THERMAL_MODEL_STEP_MS };

static config_t config;
static thermal_model_state_t state;

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

static void winding_of(int32_t inner_mJ_K, int32_t inner_mK_W, int32_t outer_mJ_K,
                       int32_t outer_mK_W)
{
    config.thermal.winding_heat_capacity_mJ_K = inner_mJ_K;
    config.thermal.winding_thermal_resistance_mK_W = inner_mK_W;
    config.thermal.housing_heat_capacity_mJ_K = outer_mJ_K;
    config.thermal.housing_thermal_resistance_mK_W = outer_mK_W;
}

static void switches_of(int32_t inner_mJ_K, int32_t inner_mK_W, int32_t outer_mJ_K,
                        int32_t outer_mK_W)
{
    config.thermal.switch_heat_capacity_mJ_K = inner_mJ_K;
    config.thermal.switch_thermal_resistance_mK_W = inner_mK_W;
    config.thermal.heatsink_heat_capacity_mJ_K = outer_mJ_K;
    config.thermal.heatsink_thermal_resistance_mK_W = outer_mK_W;
}

static void start(int32_t warmest_cC, int32_t ambient_cC)
{
    thermal_model_init(&state, &config);
    config.monitor.coldest_ambient_cC = -MOST_cC;
    config.monitor.warmest_ambient_cC = ambient_cC;
    thermal_model_start(&state, &config, warmest_cC);
}

/* A whole round with these currents, and the four steps that take its heat. */
static void advance(int32_t i_d_mA, int32_t i_q_mA, int32_t speed_mrad_s)
{
    for (int ms = 0; ms < ROUND_ms + 4; ms++) {
        thermal_model_step(&state, &config, i_d_mA, i_q_mA, speed_mrad_s);
    }
}

/* ---- coefficients ---- */

/* h = 64 ms, in us: C mJ/K times R mK/W is us as well. */
static double share_q30(double capacity, double resistance)
{
    return resistance > 0.0 ? 0x1p30 * 64e3 / (capacity * resistance + 64e3) : 0.0;
}

/* mW for each hundredth of a kelvin between the limit and the ambient, 2^16, where the heat has a
 * way out; at most 2^30. */
static double steady_mW_cK_q16(double r1, double c2, double r2)
{
    const bool insulated = c2 > 0.0 ? r1 <= 0.0 || r2 <= 0.0 : r1 + r2 <= 0.0;
    return insulated ? 0.0 : fmin(1e4 * 0x1p16 / (r1 + r2), 0x1p30);
}

/* 64 uJ over a capacity in mJ/K, in hundredths of a kelvin of 2^16 and 16 bits more; at most 2^30.
 */
static double per_mW_q16(double capacity)
{
    return fmin(6.4 * 0x1p32 / capacity, 0x1p30);
}

static void assert_row(const thermal_lumps_t *row, double c1, double r1, double c2, double r2)
{
    const double share = share_q30(c1, c2 > 0.0 ? r1 : r1 + r2);
    const double per_mW = per_mW_q16(c1) * (1.0 - share * 0x1p-30);
    TEST_ASSERT_TRUE(row->known);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, share, row->inner_share_q30);
    TEST_ASSERT_TRUE((row->inner_share_q30 != 0) == (share > 0.0));
    /* 6.4 2^16 is taken as 419430, 1e-6 less. */
    TEST_ASSERT_DOUBLE_WITHIN(2.0 + 1.1e-6 * per_mW, per_mW, row->inner_per_mW_q16);
    TEST_ASSERT_EQUAL_INT32((int32_t)steady_mW_cK_q16(r1, c2, r2), row->steady_mW_cK_q16);
    const bool shares = c2 > 0.0 && row->steady_mW_cK_q16 != 0;
    TEST_ASSERT_EQUAL_INT32(shares ? (int32_t)(0x1p15 * r2 / (r1 + r2)) : 0, row->outer_share_q15);
    if (c2 > 0.0) {
        const double gain = r1 > 0.0 ? fmin(0x1p30 * 64e3 / (c2 * r1), 0x1p30) : 0.0;
        TEST_ASSERT_DOUBLE_WITHIN(1.0, gain, row->outer_gain_q30);
        TEST_ASSERT_TRUE((row->outer_gain_q30 != 0) == (gain > 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(1.0, share_q30(c2, r2), row->ambient_share_q30);
        TEST_ASSERT_DOUBLE_WITHIN(1.0 + 1.1e-6 * per_mW_q16(c2), per_mW_q16(c2),
                                  row->outer_per_mW_q16);
    } else {
        TEST_ASSERT_EQUAL_INT32(0, row->outer_gain_q30);
        TEST_ASSERT_EQUAL_INT32(0, row->ambient_share_q30);
        TEST_ASSERT_EQUAL_INT32(0, row->outer_per_mW_q16);
    }
}

void test_coefficients_are_those_of_an_implicit_step_of_64_ms(void)
{
    static const int32_t ROWS[][4] = {
        {1000, 100, 30000, 20}, {30, 2000, 40, 1600}, {1, 1, 1, 1},      {5000, 0, 7000, 0},
        {64000, 1, 64000, 1},   {100, 1, 0, 1},       {2000, 0, 0, 30},  {100, 2, 900, 1},
        {700, 40, 0, 0},        {700, 0, 0, 0},       {900, 0, 800, 50}, {900, 50, 800, 0}};
    for (int n = 0; n < 12; n++) {
        const int32_t *row = ROWS[n];
        winding_of(row[0], row[1], row[2], row[3]);
        switches_of(row[0], row[1], row[2], row[3]);
        thermal_model_init(&state, &config);
        assert_row(&state.winding, row[0], row[1], row[2], row[3]);
        assert_row(&state.switches, row[0], row[1], row[2], row[3]);
    }
    winding_of(0, 100, 100, 100);
    switches_of(0, 100, 100, 100);
    thermal_model_init(&state, &config);
    TEST_ASSERT_FALSE(state.winding.known || state.switches.known || state.started);
}

/* ---- start ---- */

void test_a_start_takes_temperatures_up_to_327_degrees(void)
{
    static const int32_t GIVEN_cC[] = {-32700, -1, 20000, 32700, 32701, 60000};
    for (int n = 0; n < 6; n++) {
        start(GIVEN_cC[n], 0);
        const double within_cC = fmin(GIVEN_cC[n], MOST_cC);
        TEST_ASSERT_EQUAL_INT32((int32_t)(65536.0 * within_cC), state.winding.inner_q16);
        TEST_ASSERT_EQUAL_INT32(state.winding.inner_q16, state.winding.outer_q16);
        TEST_ASSERT_TRUE(state.started);
    }
}

void test_a_row_without_an_outer_lump_ends_at_the_ambient_and_stays_there(void)
{
    winding_of(10, 1, 0, 1);
    start(9000, 3000);
    TEST_ASSERT_EQUAL_INT32(9000 << 16, state.winding.inner_q16);
    TEST_ASSERT_EQUAL_INT32(3000 << 16, state.winding.outer_q16);
    for (int n = 0; n < 10; n++) {
        advance(0, 0, 0);
    }
    TEST_ASSERT_EQUAL_INT32(3000, thermal_model_inner_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT32(3000 << 16, state.winding.outer_q16);
}

/* ---- means of 64 ms ---- */

static void round_of(const int32_t *currents_mA, int given)
{
    for (int ms = 0; ms < ROUND_ms; ms++) {
        thermal_model_step(&state, &config, 0, ms < given ? currents_mA[ms] : 0, 0);
    }
}

/* Of 2^12 mA^2, 64 of them: 511^2 + 31^2 + 6^2 + 5^2 is 2^18 - 1. */
void test_means_of_a_round_contain_no_other_round(void)
{
    static const int32_t BELOW_mA[] = {511, 31, 6, 5};
    static const int32_t EXACT_mA[] = {512};
    static const int32_t LONG_mA[] = {63};
    static const int32_t LONGER_mA[] = {64};
    start(2500, 2500);
    round_of(BELOW_mA, 4);
    TEST_ASSERT_EQUAL_INT(0, state.square);
    round_of(EXACT_mA, 1);
    TEST_ASSERT_EQUAL_INT(1, state.square);
    TEST_ASSERT_EQUAL_INT32(512 / 64, state.mean_mA);
    round_of(BELOW_mA, 4);
    TEST_ASSERT_EQUAL_INT(0, state.square);
    round_of(LONG_mA, 1);
    TEST_ASSERT_EQUAL_INT32(0, state.mean_mA);
    round_of(LONGER_mA, 1);
    TEST_ASSERT_EQUAL_INT32(1, state.mean_mA);
}

/* Larger plus half the smaller less an eighth: 1.0078 at most (7/8 by 1/2), and the larger alone
 * 0.9701 where both are the same (1 by 1/4). */
void test_the_length_of_the_current_is_within_3_per_cent_in_every_direction(void)
{
    start(2500, 2500);
    for (int degrees = 0; degrees < 360; degrees++) {
        const double angle = degrees * 3.14159265358979 / 180.0;
        const int32_t d_mA = (int32_t)lround(1e6 * cos(angle));
        const int32_t q_mA = (int32_t)lround(1e6 * sin(angle));
        for (int ms = 0; ms < ROUND_ms; ms++) {
            thermal_model_step(&state, &config, d_mA, q_mA, 0);
        }
        TEST_ASSERT_TRUE(state.mean_mA > 0.9700 * 1e6 && state.mean_mA < 1.0079 * 1e6);
    }
}

/* ---- iron loss ---- */

/* One component of the EMF alone: v = w (psi + L i) with w in rad/s; 3/2 v^2/R. */
static int32_t iron_mW(int32_t flux_nWb, int32_t i_d_mA, int32_t i_q_mA, int32_t speed_mrad_s)
{
    config.motor.pole_pairs = 1;
    config.motor.flux_linkage_nWb = flux_nWb;
    config.motor.d_inductance_nH = 1000000000;
    config.motor.q_inductance_nH = 1000000000;
    start(2500, 2500);
    advance(i_d_mA, i_q_mA, speed_mrad_s);
    return state.iron_mW;
}

void test_without_iron_loss_or_winding_its_heat_is_zero(void)
{
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    TEST_ASSERT_EQUAL_INT32(0, iron_mW(100000000, 0, 0, 100000));
    config.motor.iron_loss_resistance_mOhm = 1;
    config.thermal.winding_heat_capacity_mJ_K = 0;
    TEST_ASSERT_EQUAL_INT32(0, iron_mW(100000000, 0, 0, 100000));
}

/* 2^31 nWb at 1 rad/s are 2.147 V: 3/2 (2.147 V)^2 / 1 ohm = 6.918 W; 256ths of 2.147 A are 0.2 %.
 */
void test_flux_linkages_of_the_iron_loss_end_at_2147_mWb(void)
{
    config.motor.iron_loss_resistance_mOhm = 1000;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    TEST_ASSERT_DOUBLE_WITHIN(20.0, 6918.0, iron_mW(1000, 4000000, 0, 1000));
    TEST_ASSERT_DOUBLE_WITHIN(20.0, 6918.0, iron_mW(1000, 0, -4000000, 1000));
}

void test_a_resistance_beyond_the_range_is_the_largest(void)
{
    config.motor.iron_loss_resistance_mOhm = 2000000000;
    config.motor.iron_loss_resistance_slope_nOhm_s = 2000000000;
    /* 2^31 mV/256 over 2^31 - 1 mOhm is one 256th of an ampere, at 2^23 mV */
    TEST_ASSERT_EQUAL_INT32((1 << 23) / 256 * 3 / 2, iron_mW(2000000000, 0, 0, 1000000000));
}

void test_losses_beyond_the_range_are_the_largest(void)
{
    config.motor.iron_loss_resistance_mOhm = 1;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, iron_mW(2000000000, 0, 0, 5000000));
}

/* ---- heat at the ends of the range ---- */

void test_a_bridge_loss_beyond_the_range_is_heat(void)
{
    config.drive.loss_per_ampere_uW_A = 2000000000;
    config.drive.loss_resistance_uOhm = 0;
    switches_of(100000, 0, 0, 0);
    start(2000, 2000);
    advance(4000000, 4000000, 0);
    TEST_ASSERT_EQUAL_INT32(MOST_cC, thermal_model_inner_cC(&state.switches));
    TEST_ASSERT_EQUAL_INT32(MOST_cC << 16, state.switches.inner_q16);
}

/* Hot outside, cold inside and around it, without capacity: it gives to both at once. */
void test_temperatures_end_at_minus_327_degrees(void)
{
    winding_of(2000000000, 1, 1, 1);
    start(2000, 2000);
    state.winding.inner_q16 = -MOST_cC * 65536;
    state.winding.ambient_q16 = -MOST_cC * 65536;
    state.winding.outer_q16 = MOST_cC * 65536;
    advance(0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(-MOST_cC * 65536, state.winding.outer_q16);
}

/* 1 mW would warm 10 mJ/K by a hundredth of a kelvin in 64 ms. */
void test_a_heat_sink_takes_no_heat_of_its_own(void)
{
    switches_of(1000, 1, 10, 0);
    start(2000, 2000);
    for (int n = 0; n < 10; n++) {
        advance(0, 0, 0);
    }
    TEST_ASSERT_EQUAL_INT32(2000 << 16, state.switches.outer_q16);
}

/* Squares of up to 8 kA beside 100 ohm are 2^43 of a unit of heat. */
void test_a_loss_of_a_resistance_beyond_the_range_is_heat(void)
{
    config.drive.loss_per_ampere_uW_A = 0;
    config.drive.loss_resistance_uOhm = 100000000;
    switches_of(100000, 0, 0, 0);
    for (int32_t i_q_mA = -4000000; i_q_mA <= 4000000; i_q_mA += 250000) {
        start(2000, 2000);
        advance(4000000, i_q_mA, 0);
        TEST_ASSERT_EQUAL_INT32(MOST_cC, thermal_model_inner_cC(&state.switches));
    }
}

/* ---- lasting currents ---- */

/* The switches lead away 10 W over the resistance for each hundredth of a kelvin below their limit.
 */
static int32_t switch_lasting_mA(int32_t below_cK, int32_t mK_W, int32_t loss_per_ampere_uW_A,
                                 int32_t loss_resistance_uOhm)
{
    switches_of(1000, mK_W, 0, 0);
    config.monitor.warmest_ambient_cC = 2500;
    config.drive.max_switch_temperature_cC = 2500 + below_cK;
    config.drive.loss_per_ampere_uW_A = loss_per_ampere_uW_A;
    config.drive.loss_resistance_uOhm = loss_resistance_uOhm;
    config.motor.max_phase_current_mA = 100;
    thermal_model_init(&state, &config);
    return state.switch_lasting_mA;
}

/* 250 kW by 2 kV are 125 A, and by 3/2 100 ohm i^2 40.825 A. */
void test_the_lasting_current_of_the_switches_is_right_to_ten_parts_in_a_million(void)
{
    TEST_ASSERT_INT32_WITHIN(1, 125000, switch_lasting_mA(25000, 1, 2000000000, 0));
    TEST_ASSERT_INT32_WITHIN(1, 40825, switch_lasting_mA(25000, 1, 0, 100000000));
}

/* 10 mW by a drop of some 16 uV, which is its unit: one more is too much, but none is too little.
 */
void test_the_lasting_current_of_the_switches_is_never_above_that_of_their_loss(void)
{
    for (int32_t units = 1; units < 40; units++) {
        const double most_mA = 10e3 / (16e-3 * units);
        const double less_mA = 10e3 / (16e-3 * (units + 1));
        const int32_t lasting_mA = switch_lasting_mA(1, 1000, 16 * units, 0);
        TEST_ASSERT_TRUE(lasting_mA < most_mA && lasting_mA > less_mA);
    }
}

void test_a_bridge_without_loss_lasts_with_any_current(void)
{
    TEST_ASSERT_EQUAL_INT32(4000000, switch_lasting_mA(1, 1, 0, 0));
}

/* An eighth of 100 mA, whatever a milliwatt would bear. */
void test_limits_at_or_below_the_ambient_leave_an_eighth_of_the_largest_current(void)
{
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    config.motor.phase_resistance_uOhm = 10;
    winding_of(1000, 10, 1000, 10);
    for (int32_t below_cK = -2; below_cK <= 0; below_cK++) {
        TEST_ASSERT_EQUAL_INT32(100 / 8, switch_lasting_mA(below_cK, 10000, 16, 0));
        switches_of(1000, 10, 1000, 10);
        thermal_model_init(&state, &config);
        TEST_ASSERT_EQUAL_INT32(100 / 8, state.switch_lasting_mA);
        TEST_ASSERT_EQUAL_INT32(100 / 8, state.winding_lasting_mA); /* before the first round */
        config.motor.max_winding_temperature_cC = 2500 + below_cK;
        start(2500, 2500);
        advance(0, 0, 0);
        TEST_ASSERT_EQUAL_INT32(100 / 8, state.winding_lasting_mA);
        config.motor.max_winding_temperature_cC = 2501;
        start(2500, 2500);
        advance(0, 0, 0);
        TEST_ASSERT_GREATER_THAN_INT32(10000, state.winding_lasting_mA);
    }
}

/* What is made in the housing alone is more than it leads away. */
void test_iron_loss_beyond_what_the_housing_takes_leaves_an_eighth_of_the_largest_current(void)
{
    config.motor.iron_loss_resistance_mOhm = 1;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    winding_of(1000, 10, 1000, 10);
    start(2500, 2500);
    advance(0, 0, config.motor.max_speed_mrad_s);
    TEST_ASSERT_GREATER_THAN_INT32(1000000, state.iron_mW);
    TEST_ASSERT_EQUAL_INT32(config.motor.max_phase_current_mA / 8, state.winding_lasting_mA);
}

/* 2/3 10^9 mA^2 of a milliwatt in a microohm: 3 875 968.99 in 172. A resistance of 10 uOhm that
 * falls to a tenth, or a bit less, counts as one. */
void test_the_square_of_a_milliwatt_is_two_thirds_of_it_over_the_resistance(void)
{
    config.motor.resistance_coefficient_ppm_K = 0;
    config.motor.phase_resistance_uOhm = 172;
    thermal_model_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(3875968, state.square_per_mW);
    config.motor.resistance_coefficient_ppm_K = 10000;
    config.motor.reference_temperature_cC = 15000;
    config.motor.max_winding_temperature_cC = 1000;
    config.motor.phase_resistance_uOhm = 10;
    thermal_model_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(666666667, state.square_per_mW);
}

void test_the_heat_of_a_round_is_taken_in_the_first_four_steps_of_the_next(void)
{
    start(2500, 2500);
    for (int ms = 0; ms < 3 * ROUND_ms; ms++) {
        thermal_model_step(&state, &config, 10000, 20000, 30000);
        const int in_round = (ms + 1) % ROUND_ms;
        TEST_ASSERT_EQUAL(ms + 1 >= ROUND_ms && in_round < 4, state.heat_due);
    }
}
