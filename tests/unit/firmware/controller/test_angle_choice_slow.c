/* SPDX-License-Identifier: Apache-2.0 */
/* Sensor against observer below the observer's speed. */
#include "angle_choice_rig.h"

/* 30 degrees of 65 536, rounded up; a sixteenth of the current's full scale; a time of the header.
 */
enum { ASKEW = 5461, LEAST_PU = 2048, SLOW_SLIP_ms = 6 };

void setUp(void)
{
    rig_up_to_compare();
}

void tearDown(void) {}

/* Below half of its speed, or where its flux is not plausible. */
void test_an_observer_without_a_plausible_angle_contradicts_no_sensor(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        setUp();
        at.observer_mrad_s = sign * (FROM_mrad_s / 2 - 1);
        at.sensor_mrad_s = at.observer_mrad_s;
        at.i_pu.q = LEAST_PU;
        run_at(100, OPPOSED);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        at.observer_mrad_s = sign * FROM_mrad_s / 2;
        at.flux_q14 = 0;
        run_at(100, OPPOSED);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
    }
}

/* With the current that makes torque. Halls are half a sector late there: 60 degrees. */
static bool is_a_slow_slip(int32_t sensor, int sign, int16_t size_turn, int steps)
{
    const int16_t difference_turn = (int16_t)(sign * size_turn);
    setUp();
    config.rotor.sensor = sensor;
    at.observer_mrad_s = -sign * FROM_mrad_s / 2;
    at.sensor_mrad_s = at.observer_mrad_s;
    at.i_pu.q = sign * LEAST_PU;
    run(100);
    run_at(steps, difference_turn);
    return seen.sensor_wrong;
}

void test_below_the_observer_s_speed_30_degrees_are_a_slip_or_60_of_halls(void)
{
    static const int32_t SENSORS[] = {CONFIG_ROTOR_ENCODER, CONFIG_ROTOR_ANGLE, CONFIG_ROTOR_HALL};
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int k = 0; k < 3; k++) {
            const int16_t least = SENSORS[k] == CONFIG_ROTOR_HALL ? OPPOSED : ASKEW;
            TEST_ASSERT_FALSE(is_a_slow_slip(SENSORS[k], sign, (int16_t)(least - 1), 100));
            TEST_ASSERT_FALSE(is_a_slow_slip(SENSORS[k], sign, least, SLOW_SLIP_ms - 1));
            TEST_ASSERT_TRUE(is_a_slow_slip(SENSORS[k], sign, least, SLOW_SLIP_ms));
            TEST_ASSERT_TRUE(observed() && !seen.valid);
        }
    }
}

/* Less current makes no torque that could be wrong. A sensor that does not turn as fast as the
 * observer is judged by 60 degrees, in twice the time. */
void test_a_slow_slip_has_a_current_and_the_observer_s_speed(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_FALSE(is_a_slow_slip(CONFIG_ROTOR_ANGLE, sign, ASKEW, 0));
        at.i_pu.q = sign * (LEAST_PU - 1);
        run_at(100, ASKEW);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        at.i_pu.q = sign * LEAST_PU;
        for (int faster = -1; faster <= 1; faster += 2) {
            at.sensor_mrad_s = at.observer_mrad_s + faster * (FROM_mrad_s / 8 + 1);
            run_at(100, ASKEW);
            TEST_ASSERT_FALSE(seen.sensor_wrong);
        }
        run_at(SLOW_ms - 1, OPPOSED);
        TEST_ASSERT_FALSE(seen.sensor_wrong);
        run(1);
        TEST_ASSERT_TRUE(seen.sensor_wrong);
        for (int faster = -1; faster <= 1; faster += 2) {
            TEST_ASSERT_FALSE(is_a_slow_slip(CONFIG_ROTOR_ANGLE, sign, ASKEW, 0));
            at.sensor_mrad_s = at.observer_mrad_s + faster * FROM_mrad_s / 8;
            run_at(SLOW_SLIP_ms, ASKEW);
            TEST_ASSERT_TRUE(seen.sensor_wrong);
        }
    }
}
