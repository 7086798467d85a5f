/* SPDX-License-Identifier: Apache-2.0 */
/* The angle check and a rotor that is slower than its sensor shows, or stands. */
#include "monitor/monitor_emf.h"

#include <string.h>

#include "emf_motor.h"
#include "random_values.h"
#include "unity.h"

void setUp(void)
{
    config = paper_vehicle();
    state.level = 0;
}

void tearDown(void) {}

/* Between two edges of its halls a rotor that is braked to standstill still has the speed of the
 * latest. Its EMF is smaller than w psi, in the end zero, and the error may turn it anywhere. Half
 * of U's resistance and dead time, and all of w L |i|, which a standing rotor does not have, stay
 * within U: 3/4 w L |i| is 0.16 V at 10 A and 120 r/min, R/4 |i| + t_d f v_dc/3 0.43 V. */
void test_rotor_slower_than_its_sensor_shows_is_no_fault(void)
{
    random_t random = random_seeded(5);
    for (int n = 0; n < 100000; n++) {
        const plant_t plant = {
            .resistance = random_real(&random, 0.75, 1.25),
            .inductance = 1.0,
            .flux = 1.0,
            .dead_time_share = random_real(&random, -0.25, 0.25),
        };
        const double sensor_rpm = random_real(&random, 60.0, 120.0);
        const bool stands = n % 2 == 0;
        const double rpm = stands ? 0.0 : random_real(&random, 0.0, sensor_rpm);
        const double offset_deg = stands ? random_real(&random, -180.0, 180.0) : 0.0;
        monitor_case_t in = measured(rpm, random_real(&random, -3.0, 3.0),
                                     random_real(&random, -7.0, 7.0), offset_deg, &plant);
        in.now.speed_mrad_s = mrad_s_of_rpm(sensor_rpm);
        state.level = (uint16_t)(MONITOR_EMF_SEEN * (config.monitor.angle_fault_time_ms - 1));
        TEST_ASSERT_FALSE(monitor_emf_step(&state, &config, measured_of(&in)));
    }
}

/* ... but what turns backwards, or stands across, is found where w psi is 4 U: 60 r/min. */
void test_angle_error_of_60_degrees_is_found_from_the_first_checked_speed_on(void)
{
    for (int sixth = 1; sixth <= 5; sixth++) {
        const monitor_case_t in = measured(60.0, 0.0, 0.0, 60.0 * sixth, &AS_CONFIGURED);
        TEST_ASSERT_EQUAL_INT(20, time_to_fault(&in));
    }
}

/* 32 times the qualify time, longer than a hall sensor without edges has a speed: a quarter of a
 * second (hall.c). */
void test_zero_voltage_at_speed_is_a_fault_after_640_ms(void)
{
    monitor_case_t in = measured(400.0, 0.0, 0.0, 0.0, &AS_CONFIGURED);
    in.now.latest_u_d_mV = 0;
    in.now.latest_u_q_mV = 0;
    TEST_ASSERT_EQUAL_INT(32 * 20, time_to_fault(&in));
}

#define LOWEST_OF_ANGLE_FAULT_TIME(name, lowest, highest, unit, text)                              \
    if (strcmp(#name, "angle_fault_time_ms") == 0) {                                               \
        config.monitor.angle_fault_time_ms = (lowest);                                             \
    }

/* So the shortest time that a configuration may have is longer than that as well. */
void test_shortest_qualify_time_outlasts_halls_that_still_show_a_speed(void)
{
    enum { HALLS_STANDSTILL_ms = 250 };
    config.monitor.angle_fault_time_ms = 0;
    CONFIG_MONITOR_FIELDS(LOWEST_OF_ANGLE_FAULT_TIME)
    monitor_case_t in = measured(400.0, 0.0, 0.0, 0.0, &AS_CONFIGURED);
    in.now.latest_u_d_mV = 0;
    in.now.latest_u_q_mV = 0;
    TEST_ASSERT_GREATER_THAN_INT(HALLS_STANDSTILL_ms, time_to_fault(&in));
}

/* Without a current none of the dead-time voltage may be compensated, and beside a rotor that is
 * much slower than its halls show, e is what is left of it: half of w psi in any direction. Halls
 * whose speed moves by more than an eighth a turn are not believed so much. */
void test_dead_time_beside_a_braked_rotor_is_no_fault(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    for (double rpm = 60.0; rpm <= 120.0; rpm += 10.0) {
        for (double offset_deg = 0.0; offset_deg < 360.0; offset_deg += 15.0) {
            const plant_t plant = {
                .resistance = 1.0, .inductance = 1.0, .flux = 1.0, .dead_time_share = 1.0};
            state.level = 0;
            for (int n = 0; n < 250; n++) {
                monitor_case_t in = measured(0.1 * rpm, 0.0, 0.0, offset_deg, &plant);
                in.now.speed_mrad_s = mrad_s_of_rpm(rpm * pow(0.8, n / 30));
                TEST_ASSERT_FALSE(monitor_emf_step(&state, &config, measured_of(&in)));
            }
        }
    }
}
