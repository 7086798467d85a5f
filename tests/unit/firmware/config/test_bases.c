/* SPDX-License-Identifier: Apache-2.0 */
/* Conversions between per-unit and SI, against double arithmetic from the definitions of the bases.
 */
#include <math.h>

#include "config/bases.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

void test_current_one_per_unit_is_the_current_base(void)
{
    config.drive.current_full_scale_mA = 165000;
    for (int32_t pu = -32768; pu <= 32767; pu++) {
        TEST_ASSERT_DOUBLE_WITHIN(1.0, pu / 32768.0 * 165000.0, bases_current_mA(&config, pu));
    }
    TEST_ASSERT_EQUAL_INT32(-165000, bases_current_mA(&config, -32768));
}

void test_milliamperes_to_per_unit_saturate_at_full_scale(void)
{
    config.drive.current_full_scale_mA = 165000;
    TEST_ASSERT_EQUAL_INT16(16384, bases_current_pu_q15(&config, 82500));
    TEST_ASSERT_EQUAL_INT16(-16384, bases_current_pu_q15(&config, -82500));
    TEST_ASSERT_EQUAL_INT16(32767, bases_current_pu_q15(&config, 165000));
    TEST_ASSERT_EQUAL_INT16(32767, bases_current_pu_q15(&config, INT32_MAX));
    TEST_ASSERT_EQUAL_INT16(-32768, bases_current_pu_q15(&config, INT32_MIN));
}

void test_current_to_per_unit_and_back_is_within_one_lsb(void)
{
    const double lsb_mA = 165000.0 / 32768.0;
    config.drive.current_full_scale_mA = 165000;
    for (int32_t mA = -164000; mA <= 164000; mA += 37) {
        TEST_ASSERT_DOUBLE_WITHIN(lsb_mA + 1.0, mA,
                                  bases_current_mA(&config, bases_current_pu_q15(&config, mA)));
    }
}

void test_bus_voltage_one_per_unit_is_the_voltage_base(void)
{
    config.drive.voltage_full_scale_mV = 61800;
    for (int32_t pu = 0; pu <= 32767; pu += 7) {
        TEST_ASSERT_DOUBLE_WITHIN(1.0, pu / 32768.0 * 61800.0, bases_bus_voltage_mV(&config, pu));
    }
}

/* omega = turns per period * f_pwm * 2 pi / pole pairs */
static double mechanical_mrad_s(double turns_per_period)
{
    return turns_per_period * config.drive.pwm_frequency_Hz * 2.0 * 3.14159265358979323846 /
           config.motor.pole_pairs * 1000.0;
}

void test_speed_is_turns_per_period_times_pwm_frequency_over_pole_pairs(void)
{
    static const int32_t POLE_PAIRS[] = {1, 4, 23, 60};
    static const int32_t FREQUENCY_HZ[] = {4000, 20000, 100000};
    for (int p = 0; p < 4; p++) {
        for (int f = 0; f < 3; f++) {
            config.motor.pole_pairs = POLE_PAIRS[p];
            config.drive.pwm_frequency_Hz = FREQUENCY_HZ[f];
            for (double turns = -0.1; turns < 0.1; turns += 0.00317) {
                const int32_t speed_q32 = (int32_t)lround(ldexp(turns, 32));
                const double exact =
                    fmax(fmin(mechanical_mrad_s(ldexp(speed_q32, -32)), INT32_MAX), INT32_MIN);
                /* 2 pi has eight digits, turns per second 16 fraction bits: 96 mrad/s over 65 536 a
                 * pole pair. */
                TEST_ASSERT_DOUBLE_WITHIN(fabs(exact) * 1e-6 + 1.1, exact,
                                          bases_speed_mrad_s(&config, speed_q32));
            }
        }
    }
}

void test_the_fastest_speed_of_the_fastest_loop_does_not_wrap(void)
{
    config.motor.pole_pairs = 1;
    config.drive.pwm_frequency_Hz = 100000;
    /* Half a turn per period at 100 kHz: 50 000 turns or 314 159 rad a second. */
    TEST_ASSERT_DOUBLE_WITHIN(320.0, 314159265.4, bases_speed_mrad_s(&config, INT32_MAX));
    TEST_ASSERT_DOUBLE_WITHIN(320.0, -314159265.4, bases_speed_mrad_s(&config, INT32_MIN));
}

void test_electrical_speed_is_mechanical_speed_times_pole_pairs_and_saturates(void)
{
    config.motor.pole_pairs = 23;
    TEST_ASSERT_EQUAL_INT32(-230000, bases_electrical_mrad_s(&config, -10000));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, bases_electrical_mrad_s(&config, 100000000));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, bases_electrical_mrad_s(&config, -100000000));
}
