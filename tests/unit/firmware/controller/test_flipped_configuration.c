/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A bit that flips in the configuration's memory acts until the background's check of the image
 * finds it. No step divides by zero until then, nor reads far beside a map: a processor that traps
 * would stop here.
 *
 * Each field in turn is zero, minus one, and has each of its bits flipped, in a controller that
 * brakes and drives, and in one whose bridge is off on a turning wheel.
 */
#include "config/fields.h"
#include "controller_rig.h"
#include "unity.h"

enum { SPEED_rpm = 300, FAST_rpm = 700, FLIPPED_ms = 4, WORD_BITS = 32, FEWEST = 150 };

static rig_t running;
static rig_t rig;

void setUp(void) {}

void tearDown(void) {}

static void start_turning(int sensor, double speed_rpm, bool enable)
{
    rig_start(&running);
    running.config.rotor.sensor = sensor;
    running.config.rotor.encoder_counts = 4096;
    running.config.battery.current_filter_ms = 1000;
    running.config.brake.hydraulic_timeout_ms = 50;
    controller_init(&running.controller, &running.config, BASES_MODEL_TIMER_Hz);
    running.slow_in.demand.enable = enable;
    rig_run(&running, 100);
    running.follows = true;
    rig_set_speed_rpm(&running, speed_rpm);
    rig_run(&running, 300);
    running.slow_in.hydraulic.valid = true;
}

static void run_with(uint32_t word, int32_t value)
{
    rig = running;
    ((int32_t *)(void *)&rig.config)[word] = value;
    for (int n = 0; n < FLIPPED_ms; n++) {
        const bool brakes = n % 2 == 0;
        rig.slow_in.demand.brake_torque_mNm = brakes ? 20000 : 0;
        rig.slow_in.demand.drive_torque_mNm = brakes ? 0 : 20000;
        rig_run(&rig, 1);
    }
}

/* Of the maps the numbers of points alone: what they count decides where is read. */
static bool is_left_out(const config_field_t *field)
{
    const bool of_a_map =
        strcmp(field->section, "regen_map.") == 0 || strcmp(field->section, "current_map.") == 0;
    return of_a_map && strstr(field->name, "_points") == NULL;
}

static int run_with_each_field(void)
{
    int runs = 0;
    config_field_t field = config_field_first();
    do {
        for (uint32_t place = 0; place < field.count && !is_left_out(&field); place++) {
            const uint32_t word = field.offset_bytes / (uint32_t)sizeof(int32_t) + place;
            const uint32_t is = (uint32_t)config_field_value(&running.config, &field, place);
            run_with(word, 0);
            run_with(word, -1);
            for (uint32_t bit = 0; bit < WORD_BITS; bit++) {
                run_with(word, (int32_t)(is ^ UINT32_C(1) << bit));
            }
            runs++;
        }
    } while (config_field_next(&field));
    return runs;
}

void test_no_step_divides_by_a_field_that_flipped_while_the_bridge_switches(void)
{
    for (int sensor = CONFIG_ROTOR_ANGLE; sensor <= CONFIG_ROTOR_ENCODER; sensor++) {
        start_turning(sensor, SPEED_rpm, true);
        if (sensor == CONFIG_ROTOR_ANGLE) {
            TEST_ASSERT_EQUAL_INT(MODE_RUN, running.out.mode);
            TEST_ASSERT_EQUAL_INT(BRIDGE_PWM, running.pwm.bridge);
        }
        TEST_ASSERT_GREATER_THAN_INT(FEWEST, run_with_each_field());
    }
}

void test_no_step_divides_by_a_field_that_flipped_while_a_wheel_turns_beyond_its_emf_limit(void)
{
    start_turning(CONFIG_ROTOR_ANGLE, FAST_rpm, false);
    TEST_ASSERT_NOT_EQUAL_INT(BRIDGE_PWM, running.pwm.bridge);
    TEST_ASSERT_GREATER_THAN_INT(FEWEST, run_with_each_field());
}
