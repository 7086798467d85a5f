/* SPDX-License-Identifier: Apache-2.0 */
/* From the driver's feet to the demand: with healthy sensors the converter's code of 12 bits is all
 * that is lost on the way. */
#include "bench/cockpit.h"

#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;
static driver_params_t driver;
static pedal_sensors_params_t sensors;
static cockpit_t cockpit;

static const wheel_demand_t FORWARD = {.direction = DRIVE_DIRECTION_FORWARD, .enable = true};

/* The sensors are as the configuration says. */
void setUp(void)
{
    const driver_params_t feet_off = {.accelerator = 0.0, .brake_pedal = 0.0};
    const pedal_sensors_params_t healthy = {
        .accelerator_a_released = 0.15,
        .accelerator_a_pressed = 0.85,
        .accelerator_b_released = 0.075,
        .accelerator_b_pressed = 0.425,
        .brake_a_released = 0.15,
        .brake_a_pressed = 0.85,
        .brake_b_released = 0.075,
        .brake_b_pressed = 0.425,
    };
    config = CONFIG_LU2013;
    config.pedals.accelerator_channels = 2;
    config.pedals.brake_channels = 2;
    config.pedals.drive_torque_mNm = 40000;
    config.pedals.brake_torque_mNm = 200000;
    driver = feet_off;
    sensors = healthy;
    cockpit = cockpit_init();
    cockpit_step(&cockpit, &config, &driver, &sensors, &FORWARD, 0.0);
}

void tearDown(void) {}

/* A code is 1/4096 of the supply, at half the slope 1/1434 of the travel. */
void test_travel_becomes_torque_within_a_code(void)
{
    driver.accelerator = 0.525; /* half behind the dead band of 5 % */
    cockpit_step(&cockpit, &config, &driver, &sensors, &FORWARD, 0.0);
    TEST_ASSERT_INT32_WITHIN(40000 / 1300, 20000, cockpit.out.demand.drive_torque_mNm);
    driver.brake_pedal = 0.24; /* a fifth */
    cockpit_step(&cockpit, &config, &driver, &sensors, &FORWARD, 0.0);
    TEST_ASSERT_INT32_WITHIN(200000 / 1300, 40000, cockpit.out.demand.brake_torque_mNm);
    TEST_ASSERT_EQUAL_UINT32(0, cockpit.out.age_ms);
}

void test_a_plug_that_is_off_loses_the_brake_pedal(void)
{
    sensors.brake_a_broken = 1.0;
    sensors.brake_b_broken = 2.0;
    for (int ms = 0; ms < config.pedals.fault_time_ms; ms++) {
        TEST_ASSERT_EQUAL_UINT32(0, cockpit.out.age_ms);
        cockpit_step(&cockpit, &config, &driver, &sensors, &FORWARD, 0.0);
    }
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, cockpit.out.age_ms);
}

/* The brake system's own line has no dead band: 0.24 of 200 N m. */
void test_the_brake_system_has_its_own_line_to_the_pedal(void)
{
    driver.brake_pedal = 0.24;
    TEST_ASSERT_DOUBLE_WITHIN(200.0 / 32768.0, 48.0, cockpit_brake_nm(&config, &driver));
}
