/* Temperatures: 10 K above where no torque is left is a fault, and so is one that none can be. */
#include "monitor/monitor.h"
#include "paper_vehicle.h"
#include "unity.h"

enum { FAST_PER_SLOW = 20 };

static config_t config;
static monitor_slow_state_t state;
static monitor_slow_input_t in;

static const monitor_slow_input_t HEALTHY = {
    .rotor_valid = true,
    .bus_voltage_mV = 53000,
    .winding_temperature_cC = 2500,
    .switch_temperature_cC = 2500,
};

void setUp(void)
{
    config = paper_vehicle();
    config.motor.max_winding_temperature_cC = 15000;
    config.drive.max_switch_temperature_cC = 10000;
    monitor_slow_init(&state);
    in = HEALTHY;
}

void tearDown(void) {}

static monitor_verdict_t step(void)
{
    in.fast_step_count = (uint16_t)(in.fast_step_count + FAST_PER_SLOW);
    return monitor_slow_step(&state, &config, &in);
}

static monitor_verdict_t run(int milliseconds)
{
    for (int n = 1; n < milliseconds; n++) {
        step();
    }
    return step();
}

/* The condition that `in` describes now is a fault after exactly `milliseconds`, and none once it has gone. */
static void assert_fault_after(int milliseconds, reason_t fault)
{
    for (int n = 1; n < milliseconds; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault);
    }
    TEST_ASSERT_EQUAL_INT(fault, step().fault);
    TEST_ASSERT_EQUAL_INT(fault, run(100).fault);
    const uint16_t count = in.fast_step_count;
    in = HEALTHY;
    in.fast_step_count = count;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step().fault); /* remembering a fault is the business of modes */
}

static void assert_never_a_fault(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000).fault);
    const uint16_t count = in.fast_step_count;
    in = HEALTHY;
    in.fast_step_count = count;
}

void test_an_overheated_winding_is_a_fault(void)
{
    in.winding_temperature_cC = 16001;
    assert_fault_after(20, REASON_WINDING_OVERTEMPERATURE);
    in.winding_temperature_cC = 16000;
    assert_never_a_fault();
}

void test_overheated_switches_are_a_fault(void)
{
    in.switch_temperature_cC = 11001;
    assert_fault_after(20, REASON_SWITCH_OVERTEMPERATURE);
    in.switch_temperature_cC = 11000;
    assert_never_a_fault();
}

void test_what_no_winding_and_no_switch_can_be_is_a_broken_sensor(void)
{
    int32_t *const temperatures[] = {&in.winding_temperature_cC, &in.switch_temperature_cC};
    const reason_t broken[] = {REASON_WINDING_SENSOR, REASON_SWITCH_SENSOR};
    const reason_t hot[] = {REASON_WINDING_OVERTEMPERATURE, REASON_SWITCH_OVERTEMPERATURE};
    for (int k = 0; k < 2; k++) {
        *temperatures[k] = 29999; /* what hal/analog.h reports for an open or a shorted line */
        assert_fault_after(20, broken[k]);
        *temperatures[k] = 29001;
        assert_fault_after(20, broken[k]);
        *temperatures[k] = 29000;
        assert_fault_after(20, hot[k]);
        *temperatures[k] = -6001;
        assert_fault_after(20, broken[k]);
        *temperatures[k] = -6000;
        assert_never_a_fault();
    }
}

void test_a_sensor_whose_limit_is_off_may_be_missing(void)
{
    config.motor.max_winding_temperature_cC = 30000;
    config.drive.max_switch_temperature_cC = 30000;
    in.winding_temperature_cC = 29999;
    in.switch_temperature_cC = 29999;
    assert_never_a_fault();
}
