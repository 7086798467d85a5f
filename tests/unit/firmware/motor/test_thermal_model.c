/* SPDX-License-Identifier: Apache-2.0 */
/* The estimate of temperatures beside the same lumps in double precision, integrated in steps of a
 * millisecond from the loss equations. All shipped configurations, an hour of random manoeuvres. */
#include <math.h>
#include <string.h>

#include "motor/thermal_model.h"
#include "random_values.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;
static const config_t *const CONFIGS[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                          &CONFIG_IPM400V};

enum { DRIVES = 4, MANOEUVRES = 120, MANOEUVRE_MS = 4096 };

typedef struct {
    double inner_c, outer_c;
} lumps_t;

void setUp(void) {}

void tearDown(void) {}

/* A millisecond of the equations in thermal_model.h. */
static void warm(lumps_t *lumps, double inner_w, double outer_w, double c1, double r1, double c2,
                 double r2, double ambient_c)
{
    const double across_w = r1 > 0.0 ? (lumps->inner_c - lumps->outer_c) / r1 : 0.0;
    const double away_w = r2 > 0.0 ? (lumps->outer_c - ambient_c) / r2 : 0.0;
    lumps->inner_c += 1e-3 * (inner_w - across_w) / c1;
    lumps->outer_c += 1e-3 * (outer_w + across_w - away_w) / c2;
}

static double copper_w(const config_t *c, double square, double winding_c)
{
    const config_motor_t *m = &c->motor;
    const double share = 1.0 + 1e-6 * m->resistance_coefficient_ppm_K *
                                   (winding_c - 1e-2 * m->reference_temperature_cC);
    return 1.5 * 1e-6 * m->phase_resistance_uOhm * share * square;
}

static double iron_w(const config_t *c, double d_a, double q_a, double w)
{
    const config_motor_t *m = &c->motor;
    const double r =
        1e-3 * m->iron_loss_resistance_mOhm + 1e-9 * m->iron_loss_resistance_slope_nOhm_s * w;
    const double v_q = w * (1e-9 * m->flux_linkage_nWb + 1e-9 * m->d_inductance_nH * d_a);
    const double v_d = w * 1e-9 * m->q_inductance_nH * q_a;
    return 1.5 * (v_q * v_q + v_d * v_d) / r;
}

static double bridge_w(const config_t *c, double square)
{
    return 1e-6 * c->drive.loss_per_ampere_uW_A * sqrt(square) +
           1.5e-6 * c->drive.loss_resistance_uOhm * square;
}

/* Manoeuvres of 4 s with any current up to the rated torque's and any speed. */
void test_an_hour_of_any_driving_is_followed_within_two_per_cent_of_the_rise(void)
{
    for (int k = 0; k < DRIVES; k++) {
        const config_t *config = CONFIGS[k];
        const config_thermal_t *t = &config->thermal;
        random_t random = random_seeded(7U + (uint32_t)k);
        thermal_model_state_t state;
        thermal_model_init(&state, config);
        TEST_ASSERT_TRUE(state.winding.known && state.switches.known);
        thermal_model_start(&state, config, 2500);
        lumps_t winding = {25.0, 25.0};
        lumps_t switches = {25.0, 25.0};
        double hottest_c = 25.0;
        double off_winding_k = 0.0;
        double off_switch_k = 0.0;
        for (int n = 0; n < MANOEUVRES; n++) {
            const int32_t most_mA = config->motor.max_phase_current_mA;
            const int32_t i_q_mA = random_between(&random, -most_mA, most_mA);
            const int32_t i_d_mA = random_between(&random, -most_mA / 2, 0);
            const int32_t top_mrad_s = config->motor.max_speed_mrad_s;
            const int32_t speed_mrad_s = random_between(&random, -top_mrad_s / 2, top_mrad_s);
            const double d_a = 1e-3 * i_d_mA;
            const double q_a = 1e-3 * i_q_mA;
            const double square = d_a * d_a + q_a * q_a;
            const double w = 1e-3 * fabs((double)speed_mrad_s) * config->motor.pole_pairs;
            for (int ms = 0; ms < MANOEUVRE_MS; ms++) {
                thermal_model_step(&state, config, i_d_mA, i_q_mA, speed_mrad_s);
                warm(&winding, copper_w(config, square, winding.inner_c),
                     iron_w(config, d_a, q_a, w), 1e-3 * t->winding_heat_capacity_mJ_K,
                     1e-3 * t->winding_thermal_resistance_mK_W,
                     1e-3 * t->housing_heat_capacity_mJ_K,
                     1e-3 * t->housing_thermal_resistance_mK_W, 25.0);
                warm(&switches, bridge_w(config, square), 0.0, 1e-3 * t->switch_heat_capacity_mJ_K,
                     1e-3 * t->switch_thermal_resistance_mK_W,
                     1e-3 * t->heatsink_heat_capacity_mJ_K,
                     1e-3 * t->heatsink_thermal_resistance_mK_W, 25.0);
            }
            hottest_c = fmax(hottest_c, winding.inner_c);
            off_winding_k = fmax(off_winding_k, fabs(1e-2 * thermal_model_inner_cC(&state.winding) -
                                                     winding.inner_c));
            off_switch_k = fmax(off_switch_k, fabs(1e-2 * thermal_model_inner_cC(&state.switches) -
                                                   switches.inner_c));
        }
        TEST_ASSERT_TRUE_MESSAGE(hottest_c > 45.0, config->name);
        TEST_ASSERT_TRUE_MESSAGE(off_winding_k < 0.02 * (hottest_c - 25.0), config->name);
        TEST_ASSERT_TRUE_MESSAGE(off_switch_k < 1.5, config->name);
    }
}

/* Winding and housing insulated from each other and from the ambient: every joule stays. 300 W for
 * 64 s are 19.2 kJ: 3/2 R i^2 with R at the reference temperature, no rise of resistance. */
void test_insulated_lumps_keep_every_joule(void)
{
    config_t config = CONFIG_LU2013;
    config.motor.resistance_coefficient_ppm_K = 0;
    config.motor.phase_resistance_uOhm = 20000;
    config.thermal.winding_heat_capacity_mJ_K = 600000;
    config.thermal.winding_thermal_resistance_mK_W = 0;
    thermal_model_state_t state;
    thermal_model_init(&state, &config);
    thermal_model_start(&state, &config, 2000);
    for (int ms = 0; ms < 64000; ms++) {
        thermal_model_step(&state, &config, 0, 100000, 0);
    }
    TEST_ASSERT_INT_WITHIN(20, 2000 + 3200, thermal_model_inner_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT(2000, thermal_model_outer_cC(&state.winding));
}

/* In the end P R1 above the housing, and the sum of both resistances above the ambient. */
void test_a_constant_loss_settles_at_its_thermal_resistances(void)
{
    config_t config = CONFIG_LU2013;
    config.motor.resistance_coefficient_ppm_K = 0;
    config.motor.phase_resistance_uOhm = 20000; /* 3/2 0.02 ohm (50 A)^2 = 75 W */
    config.thermal.winding_heat_capacity_mJ_K = 5000;
    config.thermal.housing_heat_capacity_mJ_K = 20000;
    config.thermal.winding_thermal_resistance_mK_W = 200;
    config.thermal.housing_thermal_resistance_mK_W = 300;
    thermal_model_state_t state;
    thermal_model_init(&state, &config);
    config.monitor.coldest_ambient_cC = 1000;
    thermal_model_start(&state, &config, 1000);
    for (int ms = 0; ms < 120000; ms++) {
        thermal_model_step(&state, &config, -30000, 40000, 0);
    }
    TEST_ASSERT_INT_WITHIN(25, 1000 + 7500 * 3 / 10, thermal_model_outer_cC(&state.winding));
    TEST_ASSERT_INT_WITHIN(40, 1000 + 7500 / 2, thermal_model_inner_cC(&state.winding));
    /* The same without a housing: both resistances in a row. */
    config.thermal.housing_heat_capacity_mJ_K = 0;
    thermal_model_init(&state, &config);
    thermal_model_start(&state, &config, 1000);
    for (int ms = 0; ms < 120000; ms++) {
        thermal_model_step(&state, &config, -30000, 40000, 0);
    }
    TEST_ASSERT_INT_WITHIN(40, 1000 + 7500 / 2, thermal_model_inner_cC(&state.winding));
}

void test_it_starts_warm_within_the_ambients_that_are_configured(void)
{
    const config_t *config = &CONFIG_LU2013;
    thermal_model_state_t state;
    thermal_model_init(&state, config);
    thermal_model_start(&state, config, 9000);
    TEST_ASSERT_EQUAL_INT(9000, thermal_model_inner_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT(9000, thermal_model_outer_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT(9000, thermal_model_inner_cC(&state.switches));
    TEST_ASSERT_EQUAL_INT(config->monitor.warmest_ambient_cC, state.winding.ambient_q16 >> 16);
    thermal_model_start(&state, config, 3000);
    TEST_ASSERT_EQUAL_INT(3000, state.winding.ambient_q16 >> 16);
    thermal_model_start(&state, config, -32700);
    TEST_ASSERT_EQUAL_INT(config->monitor.coldest_ambient_cC,
                          thermal_model_inner_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT(config->monitor.coldest_ambient_cC, state.switches.ambient_q16 >> 16);
}

/* What a current that flows for ever makes of the winding, beside its limit: its copper loss by
 * both resistances, and the iron loss by the housing's. */
static double settled_c(const config_t *c, double current_a, double iron)
{
    const config_thermal_t *t = &c->thermal;
    const double limit_c = 1e-2 * c->motor.max_winding_temperature_cC;
    const double copper = copper_w(c, current_a * current_a, limit_c);
    const double inner = 1e-3 * t->winding_thermal_resistance_mK_W;
    const double outer = 1e-3 * t->housing_thermal_resistance_mK_W;
    return 1e-2 * c->monitor.warmest_ambient_cC + copper * (inner + outer) + iron * outer;
}

void test_the_lasting_current_of_the_winding_settles_at_its_limit(void)
{
    static const int32_t SPEEDS_mrad_s[] = {0, 20000};
    for (int k = 0; k < DRIVES; k++) {
        for (int n = 0; n < 2; n++) {
            const config_t *config = CONFIGS[k];
            thermal_model_state_t state;
            thermal_model_init(&state, config);
            thermal_model_start(&state, config, 9000);
            const int32_t i_q_mA = config->motor.max_phase_current_mA / 4;
            for (int ms = 0; ms < 2 * THERMAL_MODEL_STEP_MS + 4; ms++) {
                thermal_model_step(&state, config, 0, i_q_mA, SPEEDS_mrad_s[n]);
            }
            const double w = 1e-3 * SPEEDS_mrad_s[n] * config->motor.pole_pairs;
            const double iron = n == 0 ? 0.0 : iron_w(config, 0.0, 1e-3 * i_q_mA, w);
            const double limit_c = 1e-2 * config->motor.max_winding_temperature_cC;
            TEST_ASSERT_DOUBLE_WITHIN(0.5, limit_c,
                                      settled_c(config, 1e-3 * state.winding_lasting_mA, iron));
        }
    }
}

/* Of the switches with the bridge's loss, from the warmest ambient. */
void test_the_lasting_current_of_the_switches_settles_at_their_limit(void)
{
    for (int k = 0; k < DRIVES; k++) {
        const config_t *config = CONFIGS[k];
        const config_thermal_t *t = &config->thermal;
        thermal_model_state_t state;
        thermal_model_init(&state, config);
        const double current_a = 1e-3 * state.switch_lasting_mA;
        const double k_per_w =
            1e-3 * t->switch_thermal_resistance_mK_W + 1e-3 * t->heatsink_thermal_resistance_mK_W;
        const double settled = 1e-2 * config->monitor.warmest_ambient_cC +
                               k_per_w * bridge_w(config, current_a * current_a);
        TEST_ASSERT_DOUBLE_WITHIN(0.5, 1e-2 * config->drive.max_switch_temperature_cC, settled);
    }
}

/* Without a way out for the heat, or with more iron loss than it takes: an eighth, never zero. */
void test_a_lasting_current_is_never_zero(void)
{
    config_t config = CONFIG_LU2013;
    config.thermal.housing_thermal_resistance_mK_W = 0;
    config.thermal.switch_thermal_resistance_mK_W = 0;
    thermal_model_state_t state;
    thermal_model_init(&state, &config);
    thermal_model_start(&state, &config, 9000);
    for (int ms = 0; ms < 2 * THERMAL_MODEL_STEP_MS; ms++) {
        thermal_model_step(&state, &config, 0, 50000, 20000);
    }
    TEST_ASSERT_EQUAL_INT(config.motor.max_phase_current_mA / 8, state.winding_lasting_mA);
    TEST_ASSERT_EQUAL_INT(config.motor.max_phase_current_mA / 8, state.switch_lasting_mA);
}

/* Any configured number, any current: finite, within the range of the format, no overflow (the
 * sanitizers look on). */
void test_any_numbers_stay_within_the_range(void)
{
    random_t random = random_seeded(3);
    for (int n = 0; n < 300; n++) {
        config_t config = *CONFIGS[n % DRIVES];
        int32_t *const fields = &config.thermal.winding_heat_capacity_mJ_K;
        for (int f = 0; f < 8; f++) {
            const int32_t most = f % 2 == 0 ? 2000000000 : 1000000;
            fields[f] = random_between(&random, 0, most) >> random_between(&random, 0, 31);
        }
        config.motor.phase_resistance_uOhm = n % 3 == 0 ? 100000000 : 10;
        config.drive.loss_per_ampere_uW_A = n % 2 == 0 ? 2000000000 : 0;
        config.motor.iron_loss_resistance_mOhm = n % 5 == 0 ? 1 : 0;
        thermal_model_state_t state;
        thermal_model_init(&state, &config);
        thermal_model_start(&state, &config, random_wild(&random));
        for (int ms = 0; ms < 5 * THERMAL_MODEL_STEP_MS; ms++) {
            thermal_model_step(&state, &config, random_wild(&random), random_wild(&random),
                               random_wild(&random));
        }
        TEST_ASSERT_INT_WITHIN(32700, 0, thermal_model_inner_cC(&state.winding));
        TEST_ASSERT_INT_WITHIN(32700, 0, thermal_model_outer_cC(&state.switches));
    }
}
