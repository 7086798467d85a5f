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
        thermal_model_start(&state, config, 2500, false, 3100, false);
        lumps_t winding = {25.0, 25.0};
        lumps_t switches = {31.0, 31.0};
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
    thermal_model_start(&state, &config, 2000, false, 2000, false);
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
    thermal_model_start(&state, &config, 1000, false, 1000, false);
    for (int ms = 0; ms < 120000; ms++) {
        thermal_model_step(&state, &config, -30000, 40000, 0);
    }
    TEST_ASSERT_INT_WITHIN(25, 1000 + 7500 * 3 / 10, thermal_model_outer_cC(&state.winding));
    TEST_ASSERT_INT_WITHIN(40, 1000 + 7500 / 2, thermal_model_inner_cC(&state.winding));
    /* The same without a housing: both resistances in a row. */
    config.thermal.housing_heat_capacity_mJ_K = 0;
    thermal_model_init(&state, &config);
    thermal_model_start(&state, &config, 1000, false, 1000, false);
    for (int ms = 0; ms < 120000; ms++) {
        thermal_model_step(&state, &config, -30000, 40000, 0);
    }
    TEST_ASSERT_INT_WITHIN(40, 1000 + 7500 / 2, thermal_model_inner_cC(&state.winding));
}

void test_the_ambient_is_the_colder_sensor_at_the_start_and_never_a_hot_motor(void)
{
    const config_t *config = &CONFIG_LU2013;
    thermal_model_state_t state;
    thermal_model_init(&state, config);
    thermal_model_start(&state, config, 9000, false, 3000, false);
    TEST_ASSERT_EQUAL_INT(9000, thermal_model_inner_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT(9000, thermal_model_outer_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT(3000, state.winding.ambient_q16 >> 16);
    thermal_model_start(&state, config, 9000, false, 8000, false);
    TEST_ASSERT_EQUAL_INT(config->monitor.warmest_ambient_cC, state.winding.ambient_q16 >> 16);
    thermal_model_start(&state, config, 29999, true, 1500, false);
    TEST_ASSERT_EQUAL_INT(1500, thermal_model_inner_cC(&state.winding));
    thermal_model_start(&state, config, 29999, true, 29999, true);
    TEST_ASSERT_EQUAL_INT(4000, thermal_model_inner_cC(&state.winding));
    TEST_ASSERT_EQUAL_INT(4000, thermal_model_inner_cC(&state.switches));
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
        thermal_model_start(&state, &config, random_wild(&random), false, random_wild(&random),
                            false);
        for (int ms = 0; ms < 5 * THERMAL_MODEL_STEP_MS; ms++) {
            thermal_model_step(&state, &config, random_wild(&random), random_wild(&random),
                               random_wild(&random));
        }
        TEST_ASSERT_INT_WITHIN(32700, 0, thermal_model_inner_cC(&state.winding));
        TEST_ASSERT_INT_WITHIN(32700, 0, thermal_model_outer_cC(&state.switches));
    }
}
