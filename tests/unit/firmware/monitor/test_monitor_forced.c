/* SPDX-License-Identifier: Apache-2.0 */
/* Forced torque: where even the largest demagnetising current may leave more voltage than the bus
 * has. Numbers of a motor that divide well, DERIVATIONS.md, Forced torque:
 *
 *     sqrt(3) (w (psi - I L_d) + 3/2 I R) > 7/8 m v_dc, sqrt(3) as 1.732
 */
#include "monitor/monitor.h"
#include "paper_vehicle.h"
#include "unity.h"

static config_t config;

/* 1 Wb, 1 pole pair, 0.1 ohm; a range of 32.768 A, so that a unit of Q15 is 1 mA; m = 1. */
void setUp(void)
{
    config = paper_vehicle();
    config.motor.pole_pairs = 1;
    config.motor.flux_linkage_nWb = 1000000000;
    config.motor.phase_resistance_uOhm = 100000;
    config.motor.d_inductance_nH = 50000000;
    config.motor.max_torque_mNm = 4321;
    config.drive.current_full_scale_mA = 32768;
    config.current_loop.field_weakening_current_pu_q15 = 0;
    config.current_loop.modulation_limit_pu_q15 = 32768;
    config.current_loop.modulation_target_pu_q15 = 32768 + 1000;
    config.current_loop.modulation_reserve_pu_q15 = 1000;
}

void tearDown(void) {}

/* Forced at this bus voltage and not at one more millivolt, in both directions of rotation. */
static void assert_forced_up_to(int32_t bus_mV, int32_t speed_mrad_s)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        const int32_t mrad_s = sign * speed_mrad_s;
        TEST_ASSERT_EQUAL_INT32(4321, monitor_forced_torque_mNm(&config, mrad_s, bus_mV));
        TEST_ASSERT_EQUAL_INT32(0, monitor_forced_torque_mNm(&config, mrad_s, bus_mV + 1));
    }
}

/* 1000 V * 1.732 * 8/7 = 1979.43 V. */
void test_whole_flux_without_a_demagnetising_current(void)
{
    assert_forced_up_to(1979428, 1000000);
    /* 7 V * 1.732 * 8/7 = 13.856 V: not at the equal voltage. */
    assert_forced_up_to(13855, 7000);
}

/* 10 A of 50 mH take half a weber, and need 1.5 * 1 V: 501.5 V * 1.732 * 8/7 = 992.68 V. */
void test_demagnetising_current_takes_its_flux_and_needs_its_voltage(void)
{
    config.current_loop.field_weakening_current_pu_q15 = 10000;
    assert_forced_up_to(992683, 1000000);
    config.motor.d_inductance_nH = 200000000; /* more than the flux: none is left */
    assert_forced_up_to(2969, 1000000);
    assert_forced_up_to(2969, 1050000000);
}

/* 1 nWb at 1 050 000 rad/s: 1 mV beside the 1500 mV, 1501 mV * 1.732 * 8/7 = 2971.1 mV. */
void test_the_least_flux_that_is_left_counts(void)
{
    config.motor.flux_linkage_nWb = 1000000001;
    config.motor.d_inductance_nH = 100000000;
    config.current_loop.field_weakening_current_pu_q15 = 10000;
    assert_forced_up_to(2971, 1050000000);
}

/* 0.9 * 0.8 = 0.72 of the bus: 1979428.6 mV / 0.72 = 2749206.3 mV. */
void test_share_of_the_bus_is_limit_times_target_less_reserve(void)
{
    config.current_loop.modulation_limit_pu_q15 = 29491;
    config.current_loop.modulation_target_pu_q15 = 26214 + 3000;
    config.current_loop.modulation_reserve_pu_q15 = 3000;
    /* 29491 * 26214 / 32768 = 23592.4, rounded down: 23592/32768. */
    const int32_t forced_mV = (int32_t)(1979428.571 * 32768.0 / 23592.0);
    TEST_ASSERT_EQUAL_INT32(4321, monitor_forced_torque_mNm(&config, 1000000, forced_mV));
    TEST_ASSERT_EQUAL_INT32(0, monitor_forced_torque_mNm(&config, 1000000, forced_mV + 2));
}

void test_a_bus_below_zero_counts_as_empty(void)
{
    TEST_ASSERT_EQUAL_INT32(0, monitor_forced_torque_mNm(&config, 0, -1000));
    TEST_ASSERT_EQUAL_INT32(0, monitor_forced_torque_mNm(&config, 0, 0));
    TEST_ASSERT_EQUAL_INT32(4321, monitor_forced_torque_mNm(&config, 1, 0));
    TEST_ASSERT_EQUAL_INT32(4321, monitor_forced_torque_mNm(&config, -1, INT32_MIN));
}
