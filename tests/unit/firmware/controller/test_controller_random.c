/* SPDX-License-Identifier: Apache-2.0 */
#include "config/bases.h"
#include "controller_rig.h"
#include "random_values.h"
#include "unity.h"

static rig_t rig;

void setUp(void)
{
    rig_start(&rig);
}

void tearDown(void) {}

/* Numbers from the whole range now and then, ordinary ones in between, so that the controller gets
 * to run, too. */
static void randomise(random_t *random, slow_input_t *slow, fast_input_t *fast)
{
    const bool wild = random_chance(random, 2e-4);
    slow->demand.drive_torque_mNm =
        wild ? random_wild(random) : random_between(random, -40000, 40000);
    if (random_chance(random, 0.1)) {
        slow->demand.drive_torque_mNm = 0; /* the pedal must be released once before RUN */
    }
    slow->demand.brake_torque_mNm =
        wild ? random_wild(random) : q_max(random_between(random, -40000, 40000), 0);
    slow->demand_age_ms = (uint32_t)random_between(random, 0, 150);
    slow->bms.charge_current_mA = random_wild(random);
    slow->bms.discharge_current_mA = random_wild(random);
    slow->temperature.winding_cC =
        wild ? random_wild(random) : random_between(random, -4000, 15000);
    slow->temperature.switch_cC = wild ? random_wild(random) : random_between(random, -4000, 15000);
    slow->demand.enable = random_chance(random, 0.99);
    slow->demand.abs_active = random_chance(random, 0.01);
    for (int x = 0; x < 3; x++) {
        fast->phase_current_code[x] =
            (uint16_t)(wild ? random_between(random, 0, 4095) : random_between(random, 2040, 2056));
    }
    fast->bus_voltage_code =
        (uint16_t)(wild ? random_between(random, 0, 4095) : random_between(random, 3000, 4000));
    fast->rotor_angle_turn =
        (uint16_t)(wild ? random_between(random, 0, 65535) : fast->rotor_angle_turn + 1);
    fast->hall_state = (uint8_t)(wild ? random_between(random, 0, 255) : fast->hall_state);
    fast->encoder.count =
        (uint16_t)(wild ? random_between(random, 0, 65535) : fast->encoder.count + 1);
    fast->encoder.index = random_chance(random, 0.01);
    fast->encoder.index_count =
        (uint16_t)(wild ? random_between(random, 0, 65535) : fast->encoder.count / 4096 * 4096);
    fast->power_stage_fault = wild && random_chance(random, 0.1);
}

/* On a wheel so small that it comes to rest between the random speeds. */
static void with_sensor(rig_t *at, int sensor)
{
    at->config.rotor.sensor = sensor;
    at->config.rotor.encoder_counts = 4096;
    at->config.vehicle.wheel_radius_um = 1000;
    at->config.monitor.coasting_mm_s2 = at->config.monitor.tyre_grip_mm_s2;
}

/* Zero demand, then a rising edge of fault_reset. */
static void acknowledge(rig_t *at, int step)
{
    at->slow_in.demand.drive_torque_mNm = 0;
    at->slow_in.demand.brake_torque_mNm = 0;
    at->slow_in.demand.fault_reset = step % 2 == 0;
}

void test_bridge_switches_only_in_run_and_compare_values_stay_in_range(void)
{
    random_t random = random_seeded(1);
    for (int sensor = CONFIG_ROTOR_ANGLE; sensor <= CONFIG_ROTOR_ENCODER; sensor++) {
        int switched = 0;
        int faults = 0;
        rig_start(&rig);
        with_sensor(&rig, sensor);
        rig.fast_in.hall_state = 5;
        for (int n = 0; n < 30000; n++) {
            const operating_mode_t before = rig.out.mode;
            for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
                randomise(&random, &rig.slow_in, &rig.fast_in);
                rig.pwm = *controller_fast_step(&rig.controller.fast, &rig.config, &rig.to_fast,
                                                &rig.fast_in);
                controller_fast_report(&rig.controller.fast, &rig.to_slow);
                if (rig.pwm.bridge == BRIDGE_PWM) {
                    switched++;
                    TEST_ASSERT_TRUE(rig.out.mode == MODE_RUN || rig.out.mode == MODE_LIMP);
                    TEST_ASSERT_EQUAL_INT(REASON_NONE, rig.to_slow.trip);
                }
                for (int x = 0; x < 3; x++) {
                    TEST_ASSERT_LESS_OR_EQUAL_INT32(
                        bases_pwm_period_counts(&rig.config, BASES_MODEL_TIMER_Hz),
                        rig.pwm.compare_counts[x]);
                }
            }
            if (before == MODE_FAULT) {
                acknowledge(&rig, n);
            }
            rig_slow(&rig);
            faults += rig.out.mode == MODE_FAULT && before != MODE_FAULT ? 1 : 0;
            TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, rig.out.hydraulic_torque_mNm);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(rig.config.brake.max_hydraulic_torque_mNm,
                                            rig.out.hydraulic_torque_mNm);
            TEST_ASSERT_INT32_WITHIN(rig.config.motor.max_torque_mNm, 0,
                                     rig.out.motor_torque_command_mNm);
            if (rig.out.mode != MODE_RUN && rig.out.mode != MODE_LIMP) {
                TEST_ASSERT_EQUAL_INT32(0, rig.out.motor_torque_command_mNm);
            }
        }
        /* The run contains periods with and without PWM. */
        TEST_ASSERT_GREATER_THAN_INT(1500, switched);
        TEST_ASSERT_GREATER_THAN_INT(1, faults);
    }
}

static void assert_same_slow(const slow_output_t *a, const slow_output_t *b)
{
    TEST_ASSERT_EQUAL_INT32(a->motor_torque_command_mNm, b->motor_torque_command_mNm);
    TEST_ASSERT_EQUAL_INT32(a->motor_torque_estimate_mNm, b->motor_torque_estimate_mNm);
    TEST_ASSERT_EQUAL_INT32(a->motor_torque_uncertainty_mNm, b->motor_torque_uncertainty_mNm);
    TEST_ASSERT_EQUAL_INT32(a->hydraulic_torque_mNm, b->hydraulic_torque_mNm);
    TEST_ASSERT_EQUAL_INT32(a->electric_brake_available_mNm, b->electric_brake_available_mNm);
    TEST_ASSERT_EQUAL_INT32(a->electric_brake_ahead_mNm, b->electric_brake_ahead_mNm);
    TEST_ASSERT_EQUAL_INT32(a->drive_available_mNm, b->drive_available_mNm);
    TEST_ASSERT_EQUAL_INT32(a->drive_ahead_mNm, b->drive_ahead_mNm);
    TEST_ASSERT_EQUAL_INT32(a->speed_mrad_s, b->speed_mrad_s);
    TEST_ASSERT_EQUAL_INT32(a->i_d_mA, b->i_d_mA);
    TEST_ASSERT_EQUAL_INT32(a->i_q_mA, b->i_q_mA);
    TEST_ASSERT_EQUAL_INT32(a->bus_voltage_mV, b->bus_voltage_mV);
    TEST_ASSERT_EQUAL_INT32(a->bus_current_mA, b->bus_current_mA);
    TEST_ASSERT_EQUAL_INT(a->torque_reason, b->torque_reason);
    TEST_ASSERT_EQUAL_INT(a->available_reason, b->available_reason);
    TEST_ASSERT_EQUAL_INT(a->ahead_reason, b->ahead_reason);
    TEST_ASSERT_EQUAL_INT(a->drive_available_reason, b->drive_available_reason);
    TEST_ASSERT_EQUAL_INT(a->drive_ahead_reason, b->drive_ahead_reason);
    TEST_ASSERT_EQUAL_INT(a->waits_for, b->waits_for);
    TEST_ASSERT_EQUAL_INT(a->hydraulic_reason, b->hydraulic_reason);
    TEST_ASSERT_EQUAL_INT(a->fault_reason, b->fault_reason);
    TEST_ASSERT_EQUAL_INT(a->mode, b->mode);
    TEST_ASSERT_EQUAL(a->stop_lamp, b->stop_lamp);
}

/* A slow step of both with the same random readings; the slow outputs are the caller's to compare.
 */
static void step_alike(random_t *random, rig_t *a, rig_t *b, int step)
{
    for (int k = 0; k < RIG_FAST_PER_SLOW; k++) {
        randomise(random, &a->slow_in, &a->fast_in);
        b->slow_in = a->slow_in;
        b->fast_in = a->fast_in;
        a->pwm = *controller_fast_step(&a->controller.fast, &a->config, &a->to_fast, &a->fast_in);
        b->pwm = *controller_fast_step(&b->controller.fast, &b->config, &b->to_fast, &b->fast_in);
        controller_fast_report(&a->controller.fast, &a->to_slow);
        controller_fast_report(&b->controller.fast, &b->to_slow);
        TEST_ASSERT_EQUAL_UINT16_ARRAY(a->pwm.compare_counts, b->pwm.compare_counts, 3);
        TEST_ASSERT_EQUAL_INT(a->pwm.bridge, b->pwm.bridge);
    }
    if (a->out.mode == MODE_FAULT) {
        acknowledge(a, step);
        acknowledge(b, step);
    }
    rig_slow(a);
    rig_slow(b);
}

void test_outputs_depend_only_on_inputs_after_init(void)
{
    static rig_t other;
    for (int sensor = CONFIG_ROTOR_ANGLE; sensor <= CONFIG_ROTOR_ENCODER; sensor++) {
        rig_start(&rig);
        rig_start(&other);
        memset(&rig.controller, 0x00, sizeof rig.controller);
        memset(&other.controller, 0xA5, sizeof other.controller);
        with_sensor(&rig, sensor);
        with_sensor(&other, sensor);
        controller_init(&rig.controller, &rig.config, BASES_MODEL_TIMER_Hz);
        controller_init(&other.controller, &other.config, BASES_MODEL_TIMER_Hz);
        random_t random = random_seeded(2);
        for (int n = 0; n < 5000; n++) {
            step_alike(&random, &rig, &other, n);
            assert_same_slow(&rig.out, &other.out);
        }
    }
}

/* The widest tolerances beside none: all that differs is what is said of the estimate. */
void test_tolerances_move_the_stated_uncertainty_alone(void)
{
    static const config_tolerance_t NONE = {0};
    static const config_tolerance_t WIDEST = {16384, 32768, 32768, 16384, 16384};
    static rig_t other;
    rig_start(&rig);
    rig_start(&other);
    rig.config.tolerance = NONE;
    other.config.tolerance = WIDEST;
    random_t random = random_seeded(4);
    int differ = 0;
    for (int n = 0; n < 5000; n++) {
        step_alike(&random, &rig, &other, n);
        differ += rig.out.motor_torque_uncertainty_mNm < other.out.motor_torque_uncertainty_mNm;
        other.out.motor_torque_uncertainty_mNm = rig.out.motor_torque_uncertainty_mNm;
        assert_same_slow(&rig.out, &other.out);
    }
    TEST_ASSERT_GREATER_THAN_INT(1000, differ);
}

void test_two_controllers_in_one_process_are_independent(void)
{
    static rig_t alone;
    static rig_t left;
    static rig_t right;
    rig_start_running(&alone);
    rig_start(&left);
    rig_start(&right);
    left.slow_in.demand.enable = true;
    right.slow_in.demand.enable = true;
    rig_set_speed_rpm(&right, -200.0);
    for (int n = 0; n < 100; n++) {
        rig_run(&left, 1);
        rig_run(&right, 1);
    }
    assert_same_slow(&alone.out, &left.out);
    TEST_ASSERT_NOT_EQUAL_INT32(left.out.speed_mrad_s, right.out.speed_mrad_s);
}

/* ---- an open bridge ---- */

enum { LIVES = 60, LIFE_ms = 1500, CLOSING_ms = 12 };

/* Each sensor stuck anywhere or right, any speed, a healthy bus and battery now and then. */
static void draw_readings(random_t *random)
{
    for (int x = 0; x < 3; x++) {
        rig.fast_in.phase_current_code[x] =
            (uint16_t)(random_chance(random, 0.5) ? random_between(random, 0, 4095) : 2048);
    }
    if (random_chance(random, 0.3)) {
        rig.fast_in.bus_voltage_code =
            rig_bus_code(&rig, 1e-3 * random_between(random, 20000, 60000));
    }
    if (random_chance(random, 0.3)) {
        rig_set_speed_rpm(&rig, random_between(random, -800, 800));
    }
    rig.slow_in.bms.contactor = random_chance(random, 0.1) ? CONTACTOR_OPEN : CONTACTOR_CLOSED;
    rig.slow_in.demand.brake_torque_mNm =
        random_chance(random, 0.2) ? 0 : random_between(random, 1000, 100000);
}

/* What the split owes the hydraulic brake while no bridge switches; a short brakes by itself. */
static void assert_demand_is_made(int open_ms)
{
    const int32_t demand_mNm =
        q_min(rig.slow_in.demand.brake_torque_mNm, rig.config.brake.max_hydraulic_torque_mNm);
    if (open_ms > CLOSING_ms && !bridge_is_short(rig.to_slow.bridge)) {
        TEST_ASSERT_TRUE(rig.out.hydraulic_valid);
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(demand_mNm, rig.out.hydraulic_torque_mNm);
    }
}

void test_a_braking_demand_is_the_hydraulic_brakes_while_the_bridge_stays_open(void)
{
    random_t random = random_seeded(6);
    int enabled_open = 0;
    for (int life = 0; life < LIVES; life++) {
        rig_start_running(&rig);
        rig.config.modes.coast_delay_ms = life % 2 * 50;
        rig_set_speed_rpm(&rig, random_between(&random, -600, 600));
        int open_ms = 0;
        int left_ms = 100;
        for (int n = 0; n < LIFE_ms; n++) {
            if (left_ms-- <= 0) {
                draw_readings(&random);
                left_ms = random_between(&random, 5, 300);
            }
            rig_run(&rig, 1);
            const bool waits =
                rig.to_slow.bridge != BRIDGE_PWM && rig.slow_in.demand.brake_torque_mNm > 0;
            open_ms = waits ? open_ms + 1 : 0;
            const bool runs = rig.out.mode == MODE_RUN || rig.out.mode == MODE_LIMP;
            enabled_open += runs && open_ms > CLOSING_ms ? 1 : 0;
            assert_demand_is_made(open_ms);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(500, enabled_open);
}
