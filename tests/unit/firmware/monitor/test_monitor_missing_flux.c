/* SPDX-License-Identifier: Apache-2.0 */
/* What is missing of the magnets' flux reaches torque only while a battery confirms the bus voltage
 * from which it is known. */
#include "monitor_rig.h"

/* 70 % of the flux: 0.3 * 32 768 are missing. */
enum { MISSING_Q15 = 9830, MISSING_TOLERANCE_Q15 = 98 };

void setUp(void)
{
    rig_up(&TURNING);
    config.monitor.flux_tolerance_permille = 150;
    in.now.latest_u_q_mV = 9853;
    (void)run(3000);
}

void tearDown(void) {}

void test_missing_flux_is_given_from_the_first_voltage_of_a_battery_on(void)
{
    const shown_t out = step();
    TEST_ASSERT_EQUAL_INT(REASON_FLUX_WEAK, out.flux_warning);
    TEST_ASSERT_EQUAL_INT32(0, out.monitored.flux_missing_q15);
    in.battery.voltage_mV = 1; /* the least that is a message; not yet compared */
    TEST_ASSERT_INT32_WITHIN(MISSING_TOLERANCE_Q15, MISSING_Q15, step().monitored.flux_missing_q15);
}

void test_missing_flux_is_not_given_while_the_battery_contradicts_the_bus(void)
{
    in.battery.voltage_mV = 40000;
    const shown_t out = run(1000);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, out.flux_warning);
    TEST_ASSERT_EQUAL_INT32(0, out.monitored.flux_missing_q15);
}
