/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Braking from 636 r/min, 60 km/h: the back-EMF of 31.3 V is above the largest voltage (0.92 *
 * 53 V/sqrt 3 = 28.1 V), so the current can be controlled only with field weakening. The pack's
 * charge limit bounds the torque during the whole ramp.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "config/bases.h"
#include "config/validate.h"
#include "unity.h"
#include "vehicle_fixture.h"

static const double START_KM_H = 63.0;
static const double END_RAD_S = 60.0;      /* 573 r/min */
static const double BEYOND = 1.05;         /* of the limit */
static const int LONGEST_BEYOND_ms = 1;    /* that much of it is allowed for so long */
static const double RIPPLE_WINDOW_s = 0.2; /* for means: many turns of the rotor */

typedef struct {
    double peak_a; /* into the battery, mean of a PWM period */
    double longest_beyond_s;
    double least_i_d_a;
    double largest_miss_nm; /* airgap torque less the command, means over the window; 0.3 is 1 % of
                               rated */
    double largest_misread_nm; /* airgap torque less the firmware's estimate, likewise */
    double largest_misread_a; /* bus current less the firmware's estimate and the losses it does not
                                 see, likewise */
    double lowest_command_nm;
    reason_t fault;
} ramp_t;

void setUp(void) {}

void tearDown(void) {}

static config_t configuration(int32_t sensor, double charge_limit_a)
{
    config_t config = fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, sensor);
    config.battery.max_charge_current_mA = (int32_t)lround(charge_limit_a * 1000.0);
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    return config;
}

static ramp_t brake(const config_t *config, double demand_nm, double winding_c,
                    double charge_limit_a)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = START_KM_H / 3.6;
    params.thermal.winding_temperature_c = winding_c;
    bench_t *bench = fixture_start(&params, config);
    fixture_run(bench, 0.2);
    bench->params.driver.brake_demand_nm = demand_nm;
    bench_refresh(bench);

    const wheel_t *wheel = &bench->wheel[0];
    const double period_s = bench->world.step_s;
    ramp_t out = {.peak_a = 0.0};
    double beyond_s = 0.0;
    double dc_j = wheel->totals.dc_j;
    double impulse_nms = wheel->totals.torque_impulse_nms;
    double commanded_nms = 0.0;
    double estimated_nms = 0.0;
    double unseen_as = 0.0;
    double switching_j = wheel->totals.switching_j;
    double window_s = 0.0;
    const double ramped_s = bench->time_s + 2.0 * RIPPLE_WINDOW_s;
    while (bench_wheel_speed_rad_s(bench) > END_RAD_S) {
        bench_period(bench);
        const double into_battery_a =
            (dc_j - wheel->totals.dc_j) / period_s / bench->battery.terminal_v;
        dc_j = wheel->totals.dc_j;
        beyond_s = into_battery_a > BEYOND * charge_limit_a ? beyond_s + period_s : 0.0;
        out.longest_beyond_s = fmax(out.longest_beyond_s, beyond_s);
        out.peak_a = fmax(out.peak_a, into_battery_a);
        const double i_d_a = wheel->slow.i_d_mA * 1e-3;
        out.least_i_d_a = fmin(out.least_i_d_a, i_d_a);
        const double command_nm = wheel->slow.motor_torque_command_mNm * 1e-3;
        out.lowest_command_nm = fmin(out.lowest_command_nm, command_nm);
        commanded_nms += command_nm * period_s;
        estimated_nms += wheel->slow.motor_torque_estimate_mNm * 1e-3 * period_s;
        const double lost_j = wheel->totals.switching_j - switching_j;
        switching_j = wheel->totals.switching_j;
        unseen_as += (-into_battery_a - wheel->slow.bus_current_mA * 1e-3) * period_s -
                     lost_j / bench->battery.terminal_v;
        window_s += period_s;
        if (window_s >= RIPPLE_WINDOW_s) {
            const double miss_nm =
                (wheel->totals.torque_impulse_nms - impulse_nms - commanded_nms) / window_s;
            if (bench->time_s > ramped_s) {
                const double misread_nm =
                    (wheel->totals.torque_impulse_nms - impulse_nms - estimated_nms) / window_s;
                out.largest_miss_nm = fmax(out.largest_miss_nm, fabs(miss_nm));
                out.largest_misread_nm = fmax(out.largest_misread_nm, fabs(misread_nm));
                out.largest_misread_a = fmax(out.largest_misread_a, fabs(unseen_as / window_s));
            }
            impulse_nms = wheel->totals.torque_impulse_nms;
            commanded_nms = 0.0;
            estimated_nms = 0.0;
            unseen_as = 0.0;
            window_s = 0.0;
        }
    }
    out.fault = wheel->first_fault;
    return out;
}

static void check_ramps(int32_t sensor)
{
    static const double LIMIT_A[] = {10.0, 15.0, 25.0, 50.0};
    static const double DEMAND_NM[] = {20.0, 40.0};
    static const double WINDING_C[] = {25.0, 110.0};
    for (int l = 0; l < 4; l++) {
        for (int d = 0; d < 2; d++) {
            for (int t = 0; t < 2; t++) {
                const config_t config = configuration(sensor, LIMIT_A[l]);
                const ramp_t ramp = brake(&config, DEMAND_NM[d], WINDING_C[t], LIMIT_A[l]);
                char text[160];
                snprintf(text, sizeof(text),
                         "limit %g A, %g N m, %g degC: peak %.2f A, %.2f ms beyond, torque off by "
                         "%.2f N m, misread "
                         "%.2f N m %.2f A",
                         LIMIT_A[l], DEMAND_NM[d], WINDING_C[t], ramp.peak_a,
                         ramp.longest_beyond_s * 1e3, ramp.largest_miss_nm, ramp.largest_misread_nm,
                         ramp.largest_misread_a);
                TEST_ASSERT_EQUAL_INT_MESSAGE(REASON_NONE, ramp.fault, text);
                TEST_ASSERT_TRUE_MESSAGE(ramp.longest_beyond_s <= 1e-3 * LONGEST_BEYOND_ms, text);
                TEST_ASSERT_TRUE_MESSAGE(ramp.least_i_d_a < -30.0, text);
                TEST_ASSERT_TRUE_MESSAGE(ramp.largest_miss_nm < 0.3, text);
                TEST_ASSERT_TRUE_MESSAGE(ramp.largest_misread_nm < 0.3, text);
                TEST_ASSERT_TRUE_MESSAGE(ramp.largest_misread_a < 0.3, text);
                if (LIMIT_A[l] < 20.0) { /* 20 N m at 636 r/min return 22 A */
                    TEST_ASSERT_TRUE_MESSAGE(ramp.peak_a > 0.95 * LIMIT_A[l], text);
                    TEST_ASSERT_TRUE_MESSAGE(ramp.lowest_command_nm > -DEMAND_NM[d] + 2.0, text);
                }
            }
        }
    }
}

void test_braking_ramp_above_base_speed_keeps_the_charge_limit_with_an_angle_sensor(void)
{
    check_ramps(CONFIG_ROTOR_ANGLE);
}

void test_braking_ramp_above_base_speed_keeps_the_charge_limit_with_hall_sensors(void)
{
    check_ramps(CONFIG_ROTOR_HALL);
}

void test_larger_configured_charge_limit_exceeds_the_real_one(void)
{
    const config_t config = configuration(CONFIG_ROTOR_ANGLE, 17.0);
    TEST_ASSERT_TRUE(brake(&config, 40.0, 25.0, 15.0).longest_beyond_s > 0.1);
}

/* A fast loop's field weakening of 10 A lowers 32.8 V by 1.2 V, not below what the bus leaves. The
 * setpoint's i_d, down to the current circle, does. */
void test_setpoint_holds_the_voltage_with_little_field_weakening_of_the_fast_loop(void)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = START_KM_H / 3.6;
    config_t config = configuration(CONFIG_ROTOR_ANGLE, 50.0);
    config.current_loop.field_weakening_current_pu_q15 = bases_current_pu_q15(&config, 10000);
    params.driver.brake_demand_nm = 10.0;
    bench_t *bench = fixture_start(&params, &config);
    fixture_run(bench, 0.2);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, bench->wheel[0].active.bridge);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, bench->wheel[0].slow.mode);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, bench->wheel[0].first_fault);
    /* At a back-EMF of 25.8 V none is needed. */
    params.run.initial_speed_m_per_s = 50.0 / 3.6;
    bench = fixture_start(&params, &config);
    fixture_run(bench, 0.2);
    TEST_ASSERT_EQUAL_INT(MODE_RUN, bench->wheel[0].slow.mode);
    TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, bench->wheel[0].active.bridge);
}
