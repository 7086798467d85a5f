/* SPDX-License-Identifier: Apache-2.0 */
/* Driven by name the controller does what it does driven through its structures, and it can be
 * copied at any moment. */
#include "config/bases.h"
#include "exchange/controller_instance.h"

#include <string.h>

#include "unity.h"
#include "vehicle_fixture.h"

enum { STEPS = 8000, STEPS_PER_MS = 20 };

static config_t config;

void setUp(void)
{
    config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
}

void tearDown(void) {}

/* Inputs that wander through everything a step may see; the same for the same n. */
static uint32_t scrambled(uint32_t n)
{
    n ^= n >> 16;
    n *= 0x7feb352dU;
    n ^= n >> 15;
    n *= 0x846ca68bU;
    return n ^ (n >> 16);
}

static fast_input_t fast_input(uint32_t n)
{
    const bool calm = n < STEPS / 2; /* boot and calibration want a quiet machine */
    const fast_input_t out = {
        .phase_current_code = {(uint16_t)(2048 + (calm ? 0 : scrambled(n) % 300)),
                               (uint16_t)(2048 - (calm ? 0 : scrambled(n + 1) % 300)), 2048},
        .bus_voltage_code = (uint16_t)(3500 + scrambled(n + 2) % 50),
        .rotor_angle_turn = (uint16_t)(n * 40),
        .encoder = {.count = (uint16_t)n, .index_count = (uint16_t)(n / 7), .index = n % 7 == 0},
        .hall_state = 5,
        .power_stage_fault = n == STEPS - 100,
    };
    return out;
}

static slow_input_t slow_input(uint32_t n)
{
    const slow_input_t out = {
        .demand.drive_torque_mNm = n > 3000 ? (int32_t)(scrambled(n) % 40000) - 20000 : 0,
        .demand.brake_torque_mNm = n > 5000 ? (int32_t)(scrambled(n + 7) % 40000) : 0,
        .demand_age_ms = scrambled(n + 8) % 10,
        .bms.charge_current_mA = 200000,
        .bms.discharge_current_mA = 150000,
        .bms.charge_peak_current_mA = 250000,
        .bms.voltage_mV = n > 6000 ? 45000 : 0,
        .bms.current_mA = (int32_t)(scrambled(n + 9) % 60000) - 30000,
        .bms.current_given = n % 1300 > 200,
        .hydraulic = {.torque_mNm = 12000, .age_ms = n % 10, .valid = true},
        .bms.contactor = n > 4000 ? CONTACTOR_CLOSED : CONTACTOR_NOT_REPORTED,
        .temperature.winding_cC = 4000,
        .temperature.switch_cC = 5000,
        .demand.direction = (drive_direction_t)(n / 1000 % 3),
        .demand.enable = true,
        .demand.abs_active = n % 700 == 0,
        .demand.abs_motor_share_percent = (uint8_t)(n % 101),
        .demand.fault_reset = n % 900 == 0,
        .selftest_passed = true,
        .config_accepted = true,
        .demand.reason = n % 1100 == 0 ? REASON_ACCELERATOR_LOCKED : REASON_NONE,
    };
    return out;
}

/* By hand, in the order of variables.h: a line in the wrong place shows as a wrong output. */
static void fast_array(const fast_input_t *in, int32_t *out)
{
    const int32_t values[] = {
        in->phase_current_code[0], in->phase_current_code[1], in->phase_current_code[2],
        in->bus_voltage_code,      in->rotor_angle_turn,      in->encoder.count,
        in->encoder.index_count,   in->encoder.index,         in->hall_state,
        in->power_stage_fault};
    _Static_assert(sizeof(values) / sizeof(values[0]) == SIGNALS_FAST_INPUT_COUNT, "all of them");
    memcpy(out, values, sizeof(values));
}

static void slow_array(const slow_input_t *in, int32_t *out)
{
    const int32_t values[] = {in->demand.drive_torque_mNm,
                              in->demand.brake_torque_mNm,
                              (int32_t)in->demand_age_ms,
                              in->bms.charge_current_mA,
                              in->bms.discharge_current_mA,
                              (int32_t)in->bms.contactor,
                              in->bms.charge_peak_current_mA,
                              in->hydraulic.torque_mNm,
                              (int32_t)in->hydraulic.age_ms,
                              in->hydraulic.valid,
                              in->temperature.winding_cC,
                              in->temperature.switch_cC,
                              in->demand.enable,
                              (int32_t)in->demand.direction,
                              in->demand.abs_active,
                              in->demand.abs_motor_share_percent,
                              in->demand.fault_reset,
                              in->selftest_passed,
                              in->config_accepted,
                              (int32_t)in->demand.reason,
                              in->bms.voltage_mV,
                              in->bms.current_mA,
                              in->bms.current_given};
    _Static_assert(sizeof(values) / sizeof(values[0]) == SIGNALS_SLOW_INPUT_COUNT, "all of them");
    memcpy(out, values, sizeof(values));
}

static void step(controller_instance_t *instance, uint32_t n, int32_t fast_out[],
                 int32_t slow_out[])
{
    int32_t in[SIGNALS_SLOW_INPUT_COUNT];
    if (n % STEPS_PER_MS == 0) {
        const slow_input_t slow = slow_input(n);
        slow_array(&slow, in);
        controller_instance_slow_step(instance, in, slow_out);
    }
    const fast_input_t fast = fast_input(n);
    fast_array(&fast, in);
    controller_instance_fast_step(instance, in, fast_out);
}

void test_access_by_name_and_by_structure_give_the_same_outputs(void)
{
    static controller_instance_t instance;
    controller_instance_init(&instance, &config);
    controller_t direct;
    controller_init(&direct, &config, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t to_fast = controller_initial_setpoint(&config, BASES_MODEL_TIMER_Hz);
    slow_output_t slow = {.mode = MODE_BOOT};
    int32_t fast_out[SIGNALS_FAST_OUTPUT_COUNT];
    int32_t slow_out[SIGNALS_SLOW_OUTPUT_COUNT];
    bool has_switched = false;
    for (uint32_t n = 0; n < STEPS; n++) {
        step(&instance, n, fast_out, slow_out);
        if (n % STEPS_PER_MS == 0) {
            const slow_input_t in = slow_input(n);
            fast_report_t report;
            controller_fast_report(&direct.fast, &report);
            slow = controller_slow_step(&direct.slow, &config, &report, &in, &to_fast);
        }
        const fast_input_t in = fast_input(n);
        const fast_output_t fast = *controller_fast_step(&direct.fast, &config, &to_fast, &in);
        const int32_t fast_expected[] = {fast.compare_counts[0], fast.compare_counts[1],
                                         fast.compare_counts[2], (int32_t)fast.bridge};
        const int32_t slow_expected[] = {slow.motor_torque_command_mNm,
                                         slow.motor_torque_estimate_mNm,
                                         slow.hydraulic_torque_mNm,
                                         slow.electric_brake_available_mNm,
                                         slow.electric_brake_ahead_mNm,
                                         slow.drive_available_mNm,
                                         slow.drive_ahead_mNm,
                                         slow.speed_mrad_s,
                                         slow.i_d_mA,
                                         slow.i_q_mA,
                                         slow.bus_voltage_mV,
                                         slow.bus_current_mA,
                                         (int32_t)slow.torque_reason,
                                         (int32_t)slow.available_reason,
                                         (int32_t)slow.ahead_reason,
                                         (int32_t)slow.drive_available_reason,
                                         (int32_t)slow.drive_ahead_reason,
                                         (int32_t)slow.hydraulic_reason,
                                         (int32_t)slow.fault_reason,
                                         (int32_t)slow.warning_reason,
                                         (int32_t)slow.mode,
                                         (int32_t)slow.waits_for,
                                         (int32_t)slow.direction,
                                         slow.hydraulic_valid,
                                         slow.stop_lamp,
                                         slow.standstill,
                                         (int32_t)slow.present_warning,
                                         slow.motor_torque_uncertainty_mNm};
        TEST_ASSERT_EQUAL_INT32_ARRAY(fast_expected, fast_out, SIGNALS_FAST_OUTPUT_COUNT);
        TEST_ASSERT_EQUAL_INT32_ARRAY(slow_expected, slow_out, SIGNALS_SLOW_OUTPUT_COUNT);
        has_switched = has_switched || fast.bridge == BRIDGE_PWM;
    }
    TEST_ASSERT_TRUE_MESSAGE(has_switched, "the inputs never made the controller work");
    TEST_ASSERT_EQUAL_INT(MODE_FAULT, slow.mode);
}

void test_a_copy_continues_bit_identically_to_the_original(void)
{
    static controller_instance_t original;
    static controller_instance_t copy;
    int32_t fast_out[SIGNALS_FAST_OUTPUT_COUNT];
    int32_t slow_out[SIGNALS_SLOW_OUTPUT_COUNT];
    int32_t fast_copy[SIGNALS_FAST_OUTPUT_COUNT];
    int32_t slow_copy[SIGNALS_SLOW_OUTPUT_COUNT];
    controller_instance_init(&original, &config);
    for (uint32_t n = 0; n < STEPS / 2; n++) {
        step(&original, n, fast_out, slow_out);
    }
    memcpy(&copy, &original, sizeof(copy));
    for (uint32_t n = STEPS / 2; n < STEPS; n++) {
        step(&original, n, fast_out, slow_out);
    }
    for (uint32_t n = STEPS / 2; n < STEPS; n++) {
        step(&copy, n, fast_copy, slow_copy);
    }
    TEST_ASSERT_EQUAL_INT32_ARRAY(fast_out, fast_copy, SIGNALS_FAST_OUTPUT_COUNT);
    TEST_ASSERT_EQUAL_INT32_ARRAY(slow_out, slow_copy, SIGNALS_SLOW_OUTPUT_COUNT);
}
