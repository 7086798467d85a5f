/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/closing_voltage.h"

#include "paper_vehicle.h"
#include "unity.h"

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
}

void tearDown(void) {}

/* 48 mOhm of pack for a motor: 50 A of charging lift 46 V by 2.4 V, so PWM has 43.6/46 of the
 * voltage, and a 128th less for the hysteresis. */
void test_voltage_of_pwm_is_that_without_the_charging_current_of_the_diodes(void)
{
    config.battery.resistance_uOhm = 48000;
    TEST_ASSERT_INT32_WITHIN(2, 20000 * 127 / 128, closing_voltage_mV(&config, 20000, 46000, 0));
    TEST_ASSERT_INT32_WITHIN(3, (int32_t)(20000 * 43.6 / 46.0 * 127.0 / 128.0),
                             closing_voltage_mV(&config, 20000, 46000, 50000));
    const int32_t bus_mV[] = {-1000, 0, 1, 46000, INT32_MAX};
    for (int k = 0; k < 5; k++) { /* no input is trusted */
        const int32_t found = closing_voltage_mV(&config, 20000, bus_mV[k], INT32_MAX);
        TEST_ASSERT_TRUE(found >= 0 && found <= 20000);
    }
}
