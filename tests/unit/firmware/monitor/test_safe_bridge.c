/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "monitor/monitor.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "unity.h"

static config_t config;

void setUp(void)
{
    config = paper_vehicle();
}

void tearDown(void) {}

static bridge_mode_t choose(double line_emf_over_bus, int32_t bus_mV, bridge_mode_t now,
                            int32_t direction)
{
    /* sqrt(3) psi p omega = share * v_dc */
    const double psi_wb = config.motor.flux_linkage_nWb * 1e-9;
    const double omega =
        line_emf_over_bus * bus_mV * 1e-3 / (sqrt(3.0) * psi_wb * config.motor.pole_pairs);
    return monitor_safe_bridge(&config, direction * (int32_t)lround(omega * 1e3), bus_mV, now);
}

void test_freewheel_below_and_active_short_circuit_above_an_emf_of_the_bus_voltage(void)
{
    random_t random = random_seeded(1);
    for (int n = 0; n < 10000; n++) {
        const int32_t bus_mV = random_between(&random, 20000, 60000);
        const int32_t direction = random_chance(&random, 0.5) ? 1 : -1;
        TEST_ASSERT_EQUAL_INT(
            BRIDGE_OFF, choose(random_real(&random, 0.0, 0.999), bus_mV, BRIDGE_OFF, direction));
        TEST_ASSERT_EQUAL_INT(
            BRIDGE_OFF, choose(random_real(&random, 0.0, 0.999), bus_mV, BRIDGE_PWM, direction));
        TEST_ASSERT_EQUAL_INT(
            BRIDGE_SHORT, choose(random_real(&random, 1.001, 3.0), bus_mV, BRIDGE_OFF, direction));
        TEST_ASSERT_EQUAL_INT(
            BRIDGE_SHORT, choose(random_real(&random, 1.001, 3.0), bus_mV, BRIDGE_PWM, direction));
    }
}

void test_active_short_circuit_ends_ten_percent_below_its_limit(void)
{
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choose(0.95, 53000, BRIDGE_SHORT, 1));
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT, choose(0.901, 53000, BRIDGE_SHORT, 1));
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose(0.899, 53000, BRIDGE_SHORT, 1));
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, choose(0.95, 53000, BRIDGE_OFF, 1));
}

void test_freewheel_limit_of_the_paper_s_vehicle_is_622_rpm_at_53_V(void)
{
    /* sqrt(3) * 0.0204 * 23 * omega = 53 V at omega = 65.217 rad/s = 622.8 r/min */
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF,
                          monitor_safe_bridge(&config, mrad_s_of_rpm(622.0), 53000, BRIDGE_OFF));
    TEST_ASSERT_EQUAL_INT(BRIDGE_SHORT,
                          monitor_safe_bridge(&config, mrad_s_of_rpm(624.0), 53000, BRIDGE_OFF));
}

void test_freewheel_at_standstill_at_any_positive_bus_voltage(void)
{
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, monitor_safe_bridge(&config, 0, 1, BRIDGE_OFF));
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, monitor_safe_bridge(&config, 0, 53000, BRIDGE_SHORT));
}
