/* SPDX-License-Identifier: Apache-2.0 */
/* What a motor charges the battery beyond its model: by its terminals, and by the battery. */
#include "torque/charge_trim.h"

#include <math.h>

#include "paper_vehicle.h"
#include "unity.h"

static const int32_t BUS_mV = 53000;

static config_t config;
static motor_constants_t constants;
static motor_model_t model;
static charge_trim_state_t state;
static fast_report_t report;
static battery_limits_t battery;
static measured_t now;
static bool brakes;
static const current_setpoint_t BRAKING = {.i_d_mA = -70000, .i_q_mA = -10000};

/* 40 km/h of a wheel that is the battery's only source. */
void setUp(void)
{
    config = paper_vehicle();
    config.battery.driven_wheels = 1;
    config.drive.current_full_scale_mA = 1000; /* less than one code of it is a milliampere */
    motor_constants_init(&constants, &config);
    model = motor_model_at(&constants, &config, 44444, 2500);
    charge_trim_init(&state, &config);
    brakes = true;
    report = (fast_report_t){.bridge = BRIDGE_PWM};
    battery = (battery_limits_t){.current_given = false};
    now = (measured_t){.report = &report, .battery = &battery, .bus_voltage_mV = BUS_mV};
}

void tearDown(void) {}

static motor_point_t flowing(void)
{
    const motor_current_t i = {.d_mA = BRAKING.i_d_mA, .q_mA = BRAKING.i_q_mA};
    return motor_model_point(&model, i);
}

static int32_t modelled_mA(void)
{
    return motor_model_bus_current_mA(&model, flowing(), BUS_mV);
}

static int32_t switching_mA(void)
{
    return motor_model_switching_current_mA(&model, flowing(), BUS_mV);
}

static int32_t run(int steps)
{
    int32_t out_mA = 0;
    for (int n = 0; n < steps; n++) {
        charge_trim_commanded(&state, &model, BRAKING, brakes, BUS_mV);
        out_mA = charge_trim_step(&state, &model, &now, flowing());
    }
    return out_mA;
}

/* 1 - exp(-1) of it after 64 ms. */
void test_what_the_terminals_return_beyond_the_model_counts_with_64_ms(void)
{
    now.bus_current_mA = modelled_mA() - 1000;
    TEST_ASSERT_INT32_WITHIN(8, 632, run(64));
    TEST_ASSERT_INT32_WITHIN(2, 1000, run(1000));
}

/* exp(-1) of it is left after 512 ms. */
void test_what_they_no_longer_return_counts_less_with_512_ms(void)
{
    now.bus_current_mA = modelled_mA() - 1000;
    (void)run(1000);
    now.bus_current_mA = modelled_mA();
    TEST_ASSERT_INT32_WITHIN(4, 368, run(512));
    TEST_ASSERT_INT32_WITHIN(2, 0, run(8000));
}

/* A torque that the model is wrong by returns half of the power at half of the speed, at once; in
 * proportion through noise of the speed; and no more before it shows at a higher one. */
void test_what_the_terminals_show_falls_with_the_speed(void)
{
    now.bus_current_mA = modelled_mA() - 1000;
    (void)run(1000);
    model = motor_model_at(&constants, &config, 22222, 2500);
    now.bus_current_mA = modelled_mA() - 500;
    TEST_ASSERT_INT32_WITHIN(2, 500, run(1));
    model = motor_model_at(&constants, &config, -11111, 2500);
    now.bus_current_mA = modelled_mA() - 250;
    TEST_ASSERT_INT32_WITHIN(2, 250, run(1));
    model = motor_model_at(&constants, &config, 44444, 2500);
    now.bus_current_mA = modelled_mA() - 250;
    TEST_ASSERT_INT32_WITHIN(2, 250, run(100));
}

void test_what_the_terminals_draw_beyond_the_model_counts_below_zero(void)
{
    now.bus_current_mA = modelled_mA() + 1000;
    TEST_ASSERT_INT32_WITHIN(4, -1000, run(8000));
}

/* 3/2 31 mOhm (75 A)^2 / 2 over the highest voltage. */
void test_the_terminals_count_up_to_half_of_the_copper_loss(void)
{
    const double current_a = 1e-3 * config.motor.max_phase_current_mA;
    const double most_a = 0.75e-6 * config.motor.phase_resistance_uOhm * current_a * current_a /
                          (1e-3 * config.battery.max_voltage_mV);
    const int32_t ANY_mA[] = {-INT32_MAX - 1, -100000, 100000, INT32_MAX};
    for (int k = 0; k < 4; k++) {
        now.bus_current_mA = ANY_mA[k];
        const double expected_mA = ANY_mA[k] < 0 ? 1e3 * most_a : -1e3 * most_a;
        TEST_ASSERT_DOUBLE_WITHIN(3.0, expected_mA, run(8000));
    }
}

void test_without_switching_or_braking_the_terminals_show_nothing(void)
{
    now.bus_current_mA = modelled_mA() - 1000;
    brakes = false;
    TEST_ASSERT_EQUAL_INT32(0, run(1000));
    brakes = true;
    report.bridge = BRIDGE_OFF;
    TEST_ASSERT_EQUAL_INT32(0, run(1000));
}

/* 280 A / 4 096 are 68 mA. */
void test_one_code_of_the_current_sensors_counts_always(void)
{
    config.drive.current_full_scale_mA = 280000;
    now.bus_current_mA = modelled_mA();
    TEST_ASSERT_EQUAL_INT32(68, run(1));
}

/* What switching loses is in the battery's current alone. */
static void battery_shows(int32_t beyond_mA)
{
    now.bus_current_mA = modelled_mA();
    battery.current_given = true;
    battery.current_mA = modelled_mA() + switching_mA() - beyond_mA;
}

void test_the_battery_shows_what_the_bridge_does_not_lose(void)
{
    battery_shows(switching_mA() / 2);
    TEST_ASSERT_INT32_WITHIN(2, switching_mA() / 2, run(3000));
    battery_shows(-switching_mA() / 2);
    TEST_ASSERT_INT32_WITHIN(2, 0, run(3000));
}

void test_a_bridge_loses_no_less_than_nothing(void)
{
    battery_shows(20 * switching_mA());
    TEST_ASSERT_INT32_WITHIN(2, switching_mA(), run(3000));
    battery.current_mA = -INT32_MAX - 1;
    TEST_ASSERT_INT32_WITHIN(2, switching_mA(), run(3000));
}

void test_a_battery_is_believed_only_of_one_motor_with_a_closed_contactor(void)
{
    battery_shows(switching_mA());
    TEST_ASSERT_INT32_WITHIN(2, switching_mA(), run(3000));
    battery.contactor = CONTACTOR_OPEN;
    TEST_ASSERT_EQUAL_INT32(0, run(1));
    battery.contactor = CONTACTOR_CLOSED;
    battery.current_given = false;
    TEST_ASSERT_EQUAL_INT32(0, run(1));
    battery.current_given = true;
    config.battery.driven_wheels = 2;
    TEST_ASSERT_EQUAL_INT32(0, run(1));
}

/* A bridge as it is modelled, a current that falls and rises, and a message every 100 ms behind a
 * filter: it never shows more than what has flowed, but for the 4 ms of the motor's own. */
void test_a_late_message_behind_any_filter_up_to_the_configured_one_is_no_charge(void)
{
    const double FILTER_ms[] = {1.0, 100.0, 500.0, 2000.0};
    for (int k = 0; k < 4; k++) {
        charge_trim_init(&state, &config);
        double filtered_mA = 0.0;
        battery = (battery_limits_t){.current_given = true};
        for (int ms = 0; ms < 20000; ms++) {
            const double share = 0.5 + 0.5 * cos(ms * 6.2831853 / 4000.0);
            const bool returns = ms % 7000 < 5000;
            now.bus_current_mA = returns ? (int32_t)(-20000.0 * share) : 0;
            const double battery_mA = now.bus_current_mA + (returns ? switching_mA() : 0.0);
            filtered_mA += (battery_mA - filtered_mA) / FILTER_ms[k];
            battery.current_mA = ms % 100 == 50 ? (int32_t)filtered_mA : battery.current_mA;
            const motor_point_t none = {.d_b = 0, .x_b = 0};
            (void)charge_trim_step(&state, &model, &now, returns ? flowing() : none);
            TEST_ASSERT_LESS_THAN_INT32(switching_mA() / 8,
                                        state.pack.accumulator >> CHARGE_TRIM_PACK_LOG2);
        }
    }
}
