/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The EMF observer by itself. Its input is an exact machine in double: the flux that the voltage
 * integrates to, and the current that follows from it and the rotor's angle.
 */
#include <math.h>
#include <stdlib.h>

#include "config/bases.h"
#include "emf_observer.h"
#include "foc/foc.h"
#include "observer_tuning.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "unity.h"
#include "winding.h"

static const double PI = 3.14159265358979323846;
static const double T = 50e-6;
static const double PSI_WB = 0.0204;
static const double L_H = 76e-6;
static const double I_BASE_A = 165.0;
static const int32_t V_DC_PU = 32000; /* holds the EMF at 60 km/h */

static config_t config;
static emf_observer_t observer;
static observer_constants_t constants;
static winding_t winding;
static double r_ohm, volt_per_pu;
static uint32_t period_count;

void setUp(void)
{
    config = CONFIG_LU2013;
    emf_observer_init(&observer, &config);
    constants =
        observer_constants(&config, foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz));
    winding = winding_constants(&config);
    r_ohm = 1e-6 * (config.motor.phase_resistance_uOhm + config.drive.loss_resistance_uOhm);
    volt_per_pu = 1e-3 * config.drive.voltage_full_scale_mV * V_DC_PU / 32768.0 / sqrt(3.0) *
                  foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz) / 32768.0;
}

void tearDown(void) {}

static q_pair_t both(int32_t x)
{
    return q_pair(x, x);
}

static int32_t pu(double x)
{
    return (int32_t)lround(32768.0 * x);
}

/* Rotor frame current at a speed in electrical rad/s. */
typedef struct {
    double theta, w, d_a, q_a;
} machine_t;

/* Stator flux, re and im. */
static void flux_of(const machine_t *m, double theta, double flux[2])
{
    const double d = PSI_WB + L_H * m->d_a;
    const double q = L_H * m->q_a;
    flux[0] = d * cos(theta) - q * sin(theta);
    flux[1] = d * sin(theta) + q * cos(theta);
}

/* One period: voltage is what the change of flux and the current's drop need. */
static void period(machine_t *m, double with_r_ohm)
{
    const double i[2] = {m->d_a * cos(m->theta) - m->q_a * sin(m->theta),
                         m->d_a * sin(m->theta) + m->q_a * cos(m->theta)};
    double before[2];
    double after[2];
    flux_of(m, m->theta, before);
    flux_of(m, m->theta + m->w * T, after);
    int32_t u[2];
    for (int k = 0; k < 2; k++) {
        u[k] = pu(((after[k] - before[k]) / T + with_r_ohm * i[k]) / volt_per_pu);
        TEST_ASSERT_INT32_WITHIN(Q15_ONE, 0, u[k]);
    }
    const ab16_t voltage = {.v = q_pair(u[0], u[1])};
    const ab16_t current = {.v = q_pair(pu(i[0] / I_BASE_A), pu(i[1] / I_BASE_A))};
    if (++period_count % EMF_OBSERVER_ACQUIRE_PERIODS == 0) {
        emf_observer_acquire(&observer);
    }
    const observer_tuning_t tuning =
        observer_tuning(&constants, &winding, &constants.start, &config, V_DC_PU, 0,
                        config.motor.reference_temperature_cC);
    emf_observer_step(&observer, voltage, current, &tuning);
    m->theta += m->w * T;
}

static double error_deg(const machine_t *m)
{
    const uint16_t lead = observer_lead_turn(&constants.start, observer.speed_q32);
    const double turn = observer.theta_q32 / 4294967296.0 - lead / 65536.0;
    return 360.0 * remainder(turn - m->theta / (2.0 * PI), 1.0);
}

static double speed_rad_s(void)
{
    return observer.speed_q32 / 4294967296.0 * 2.0 * PI / T;
}

static void run(machine_t *m, int periods)
{
    for (int n = 0; n < periods; n++) {
        period(m, r_ohm);
    }
}

/* 5 to 60 km/h are 128 to 1533 rad/s. */
void test_angle_and_speed_are_exact_at_every_speed_and_current(void)
{
    const double speeds[] = {128.0, -128.0, 400.0, -900.0, 1533.0};
    for (int s = 0; s < 5; s++) {
        for (int sign = -1; sign <= 1; sign++) {
            emf_observer_reset(&observer);
            machine_t m = {
                .theta = s, .w = speeds[s], .d_a = -10.0 * abs(sign), .q_a = 40.0 * sign};
            run(&m, 2000);
            for (int n = 0; n < 500; n++) {
                period(&m, r_ohm);
                TEST_ASSERT_DOUBLE_WITHIN(0.4, 0.0, error_deg(&m));
                TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(m.w) + 1.0, m.w, speed_rad_s());
            }
        }
    }
}

/* The angle error is taken against 256 directions. Where the rotor passes a whole number of them in
 * a period, every period has the same rest to its direction, up to 0.7 degrees, which no loop
 * averages: 21, 43 and 64 rad/s of the wheel. Nearly that speed, so that every rest occurs. */
void test_angle_has_no_ripple_where_the_rotor_passes_whole_directions_in_a_period(void)
{
    for (int directions = 1; directions <= 3; directions++) {
        emf_observer_reset(&observer);
        machine_t m = {.w = 2.0 * PI * directions / 256.0 / T + 0.2};
        run(&m, 2000);
        double largest = 0.0;
        for (int n = 0; n < 4000; n++) {
            period(&m, r_ohm);
            largest = fmax(largest, fabs(error_deg(&m)));
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, largest);
    }
}

/* Without integrators of its own, before the current controller distorts the voltage. */
void test_from_every_angle_the_observer_is_within_16_degrees_after_5_milliseconds(void)
{
    const double speeds[] = {128.0, -128.0, 256.0, -512.0, 1022.0};
    for (int s = 0; s < 5; s++) {
        for (int k = 0; k < 24; k++) {
            emf_observer_reset(&observer);
            machine_t m = {.theta = 2.0 * PI * k / 24.0, .w = speeds[s]};
            run(&m, 100);
            for (int n = 0; n < 200; n++) {
                period(&m, r_ohm);
                TEST_ASSERT_DOUBLE_WITHIN(n < 60 ? 16.0 : 10.0, 0.0, error_deg(&m));
            }
        }
    }
}

/* R i is in phase with the EMF: no angle from a wrong R at i_d = 0. A wrong flux linkage does not
 * enter at all, because none is configured. */
void test_wrong_resistance_does_not_turn_the_angle(void)
{
    machine_t m = {.w = 128.0, .q_a = -40.0};
    for (int n = 0; n < 3000; n++) {
        period(&m, 1.2 * r_ohm);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 0.0, error_deg(&m));
}

void test_magnitude_is_the_expected_one(void)
{
    machine_t m = {.w = 400.0, .q_a = 30.0};
    run(&m, 3000);
    const uint16_t lead = observer_lead_turn(&constants.start, observer.speed_q32);
    const double seen = sqrt((double)q_pair_square(observer.x.v));
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * seen, observer_expected_flux_q14(&constants, lead), seen);
}

/* Any input: defined arithmetic (the sanitized build looks) and a speed within a quarter turn. */
void test_any_input_keeps_the_state_in_its_range(void)
{
    random_t random = random_seeded(5);
    for (int n = 0; n < 200000; n++) {
        const bool extreme = random_chance(&random, 0.5);
        ab16_t v[2];
        for (int k = 0; k < 2; k++) {
            const int32_t a = random_between(&random, -32768, 32767);
            const int32_t b = random_between(&random, -32768, 32767);
            v[k].v =
                extreme ? q_pair(a < 0 ? -32768 : 32767, b < 0 ? -32768 : 32767) : q_pair(a, b);
        }
        const observer_tuning_t tuning = {
            .volt = both(random_between(&random, 0, 8191)),
            .minus_resistance = both(random_between(&random, -8191, 0)),
            .minus_inductance = both(random_between(&random, -26214, 0)),
        };
        emf_observer_step(&observer, v[0], v[1], &tuning);
        TEST_ASSERT_TRUE(abs(observer.speed_q32) <= 1 << 30);
        TEST_ASSERT_TRUE(abs(observer.alpha_q30) <= 1 << 30 && abs(observer.beta_q30) <= 1 << 30);
        if (random_chance(&random, 0.001)) {
            emf_observer_reset(&observer);
        }
    }
}
