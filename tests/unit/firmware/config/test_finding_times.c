/* SPDX-License-Identifier: Apache-2.0 */
/* The times of the table of findings: fields of the configuration, numbers, and what has a filter
 * of its own. */
#include "config/finding_times.h"

#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;
static finding_times_t times[FINDING_COUNT];

/* 40 N m fall to zero at 400 N m/s in 100 ms. */
void setUp(void)
{
    config = CONFIG_LU2013;
    config.motor.max_torque_mNm = 40000;
    config.brake.torque_rate_mNm_s = 400000;
    config.monitor.sensor_fault_time_ms = 17;
    config.monitor.torque_fault_time_ms = 23;
    config.monitor.rotor_warning_time_ms = 3100;
    config.monitor.rotor_fault_time_ms = 41;
}

void tearDown(void) {}

static finding_times_t times_of(finding_t row)
{
    finding_times(&config, times);
    return times[row];
}

static void assert_times(int qualify, int heal, finding_t row)
{
    TEST_ASSERT_EQUAL_INT(qualify, times_of(row).qualify_steps);
    TEST_ASSERT_EQUAL_INT(heal, times_of(row).heal_steps);
}

void test_fields_of_the_configuration_are_times_in_milliseconds(void)
{
    assert_times(17, 1, FINDING_CURRENT_RAIL);
    assert_times(17, 1, FINDING_SUM);
    assert_times(23, 1, FINDING_TORQUE);
    assert_times(1, 3100, FINDING_ROTOR_READING);
    assert_times(1, 1000, FINDING_FORCED_TORQUE); /* fixed */
    assert_times(1, 1000, FINDING_ROTOR_GLITCH);
    assert_times(1, 1000, FINDING_ROTOR_STOPS);
    assert_times(200, 1, FINDING_OBSERVER_IN_USE);
    for (finding_t row = FINDING_WINDING_HOT; row <= FINDING_SWITCH_HOT; row++) {
        assert_times(17, 1000, row);
    }
    for (finding_t row = FINDING_WINDING_THERMISTOR; row <= FINDING_SWITCH_THERMISTOR; row++) {
        assert_times(17, 1000, row);
    }
    assert_times(1000, 1000, FINDING_BRAKE_DEAD);
    assert_times(250, 1000, FINDING_BRAKE_WEAK);
    assert_times(250, 1000, FINDING_BRAKE_STUCK);
    assert_times(250, 1000, FINDING_BRAKE_STRONG);
    assert_times(1, 10000, FINDING_BRAKE_LATE);
    assert_times(1, 1000, FINDING_HOLD_FAILS);
}

/* Without a valid angle the torque leaves in its ramp, which must not be cut off in the middle. */
void test_a_missing_angle_is_waited_for_behind_the_ramp_of_the_largest_torque(void)
{
    assert_times(100 + 41, 1, FINDING_ANGLE_MISSING);
    config.brake.torque_rate_mNm_s = 20000;
    assert_times(2000 + 41, 1, FINDING_ANGLE_MISSING);
}

void test_every_other_row_has_a_filter_of_its_own_and_counts_at_once(void)
{
    static const finding_t TIMED[] = {
        FINDING_CURRENT_RAIL,      FINDING_SUM,           FINDING_TORQUE,
        FINDING_ROTOR_READING,     FINDING_FORCED_TORQUE, FINDING_ANGLE_MISSING,
        FINDING_WINDING_HOT,       FINDING_SWITCH_HOT,    FINDING_WINDING_THERMISTOR,
        FINDING_ROTOR_GLITCH,      FINDING_ROTOR_STOPS,   FINDING_OBSERVER_IN_USE,
        FINDING_SWITCH_THERMISTOR, FINDING_BRAKE_DEAD,    FINDING_BRAKE_WEAK,
        FINDING_BRAKE_STUCK,       FINDING_BRAKE_STRONG,  FINDING_BRAKE_LATE,
        FINDING_HOLD_FAILS,
    };
    for (int row = 0; row < FINDING_COUNT; row++) {
        bool timed = false;
        for (unsigned k = 0; k < sizeof TIMED / sizeof TIMED[0]; k++) {
            timed = timed || TIMED[k] == (finding_t)row;
        }
        if (!timed) {
            assert_times(1, 1, (finding_t)row);
        }
    }
}

void test_a_time_is_one_to_65535_steps(void)
{
    config.monitor.sensor_fault_time_ms = 0;
    assert_times(1, 1, FINDING_SUM);
    config.monitor.sensor_fault_time_ms = -5;
    assert_times(1, 1, FINDING_SUM);
    config.monitor.sensor_fault_time_ms = UINT16_MAX;
    assert_times(UINT16_MAX, 1, FINDING_SUM);
    config.monitor.sensor_fault_time_ms = UINT16_MAX + 1;
    assert_times(UINT16_MAX, 1, FINDING_SUM);
    config.motor.max_torque_mNm = UINT16_MAX - 41;
    config.brake.torque_rate_mNm_s = 1000;
    assert_times(UINT16_MAX, 1, FINDING_ANGLE_MISSING);
    config.motor.max_torque_mNm = 100000;
    assert_times(UINT16_MAX, 1, FINDING_ANGLE_MISSING);
}
