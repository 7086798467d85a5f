/* SPDX-License-Identifier: Apache-2.0 */
/* When a short circuit may begin or end: each condition alone. lu2013: 20.4 mWb, 76 uH. */
#include "monitor_rig.h"
#include "safe_state_case.h"

static safe_state_case_t at;

void setUp(void)
{
    rig_up(&SWITCHING);
    const safe_state_case_t still = {.winding_temperature_cC = 2500,
                                     .bus_voltage_mV = 53000,
                                     .charge_current_mA = 50000,
                                     .before = BRIDGE_OFF};
    at = still;
}

void tearDown(void) {}

/* A current of 1 A fits into a bus of 53 V below the devices' 75 V, and never into one whose
 * voltage is beyond the sensor's range: it may be at the devices' rating already. */
void test_a_short_circuit_with_current_stays_while_the_bus_voltage_is_unknown(void)
{
    at.before = BRIDGE_SHORT;
    at.bound_mrad_s = 10000; /* sqrt(3) w psi is 8.1 V */
    at.latest_i_d_mA = -1000;
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choice_of(&config, &at).bridge);
    at.bus_voltage_mV = config.drive.voltage_full_scale_mV;
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choice_of(&config, &at).bridge);
}

/* Within the trip from any angle: |i_s| + |i - i_s| is at most 2 |i_s| + |i|. At standstill
 * the model's settled current is small, not zero: the square of R / w L ends at 128. */
void test_a_short_circuit_surges_beyond_the_trip_from_any_angle_of_the_current(void)
{
    const int32_t trip_mA = (int32_t)((int64_t)config.monitor.overcurrent_pu_q15 *
                                      config.drive.current_full_scale_mA / 32768);
    const int32_t settled_mA = short_of(&config, &at).current_mA;
    TEST_ASSERT_LESS_THAN_INT32(trip_mA / 3, settled_mA);
    const steady_state_t off = {.bus_mV = 53000};
    int32_t *const axes[] = {&at.latest_i_d_mA, &at.latest_i_q_mA};
    for (int k = 0; k < 2; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            *axes[k] = sign * (trip_mA - 2 * settled_mA);
            TEST_ASSERT_FALSE(short_surges(&config, &at, &off));
            *axes[k] = sign * (trip_mA + 1);
            TEST_ASSERT_TRUE(short_surges(&config, &at, &off));
        }
        *axes[k] = 0;
    }
}

/* The settled current of 20.4 mWb / 76 uH, 268 A less resistance, is beyond any trip below 165 A.
 * No surge matters where the freewheel itself exceeds the phase current or the devices' voltage. */
void test_a_settled_current_beyond_the_trip_surges_unless_the_freewheel_is_worse(void)
{
    at.bound_mrad_s = 70000;
    steady_state_t off = {.bus_mV = 53000};
    TEST_ASSERT_TRUE(short_surges(&config, &at, &off));
    off.current_mA = config.motor.max_phase_current_mA;
    TEST_ASSERT_TRUE(short_surges(&config, &at, &off));
    off.current_mA++;
    TEST_ASSERT_FALSE(short_surges(&config, &at, &off));
    off.current_mA = 0;
    off.bus_mV = config.drive.device_voltage_mV - 1;
    TEST_ASSERT_TRUE(short_surges(&config, &at, &off));
    off.bus_mV++;
    TEST_ASSERT_FALSE(short_surges(&config, &at, &off));
}

/* Only a bus that has just been low is the battery's for longer: voltage_fault_time more than its
 * message takes. After a return of 100 ms that is forgotten. */
void test_a_bus_that_has_been_low_and_came_back_has_the_time_of_a_high_one(void)
{
    const int32_t message_ms = config.monitor.battery_message_time_ms;
    for (int returned = 0; returned < 2; returned++) {
        setUp();
        (void)run(10);
        in.now.bus_voltage_mV = config.battery.undervoltage_trip_mV - 1;
        TEST_ASSERT_TRUE(step().battery_lost);
        in.now.bus_voltage_mV = 53000;
        in.report.bridge = BRIDGE_OFF;
        (void)run(returned ? MONITOR_BUS_RETURN_STEPS + 10 : 10);
        in.now.bus_voltage_mV = config.battery.overvoltage_trip_mV + 1;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, run(message_ms - 1).fault);
        TEST_ASSERT_EQUAL_INT(returned != 0, step().fault != REASON_NONE);
        TEST_ASSERT_NOT_EQUAL(REASON_NONE, run(config.monitor.voltage_fault_time_ms).fault);
    }
}
