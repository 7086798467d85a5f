/* SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "app/config_lines.h"
#include "config_image.h"
#include "unity.h"

static text_t line;

void setUp(void)
{
    text_clear(&line);
}

void tearDown(void) {}

static const char *field(const char *prefix, uint32_t number)
{
    text_clear(&line);
    return config_lines_get(&CONFIG_IMAGE, prefix, number, &line) ? line.chars : NULL;
}

static void assert_shows(const char *name, int32_t value)
{
    text_t expected;
    text_clear(&expected);
    text_add(&expected, name);
    text_add(&expected, " ");
    text_add_integer(&expected, value);
    TEST_ASSERT_EQUAL_STRING(expected.chars, field(name, 0));
}

void test_fields_of_every_section_show_their_value(void)
{
    assert_shows("motor.pole_pairs", CONFIG_IMAGE.motor.pole_pairs);
    assert_shows("drive.dead_time_ns", CONFIG_IMAGE.drive.dead_time_ns);
    assert_shows("current_loop.bandwidth_Hz", CONFIG_IMAGE.current_loop.bandwidth_Hz);
    assert_shows("rotor.sensor", CONFIG_IMAGE.rotor.sensor);
    assert_shows("battery.max_voltage_mV", CONFIG_IMAGE.battery.max_voltage_mV);
    assert_shows("brake.strategy", CONFIG_IMAGE.brake.strategy);
    assert_shows("vehicle.mass_g", CONFIG_IMAGE.vehicle.mass_g);
    assert_shows("monitor.torque_fault_time_ms", CONFIG_IMAGE.monitor.torque_fault_time_ms);
    assert_shows("regen_map.speed_points", CONFIG_IMAGE.regen_map.speed_points);
    assert_shows("current_map.torque_points", CONFIG_IMAGE.current_map.torque_points);
}

void test_an_array_is_one_line(void)
{
    text_t expected;
    text_clear(&expected);
    text_add(&expected, "rotor.edge_turn");
    for (int i = 0; i < CONFIG_HALL_EDGES; i++) {
        text_add(&expected, " ");
        text_add_integer(&expected, CONFIG_IMAGE.rotor.edge_turn[i]);
    }
    TEST_ASSERT_EQUAL_STRING(expected.chars, field("rotor.edge_turn", 0));
}

void test_prefix_selects_the_lines_of_a_section(void)
{
    uint32_t count = 0;
    while (field("battery.", count) != NULL) {
        TEST_ASSERT_EQUAL_STRING_LEN("battery.", line.chars, 8);
        count++;
    }
    TEST_ASSERT_EQUAL_UINT32(sizeof(config_battery_t) / sizeof(int32_t), count);
}

void test_unknown_field_has_no_line(void)
{
    TEST_ASSERT_NULL(field("motor.pole_pear", 0));
    TEST_ASSERT_NULL(field("motor.pole_pairs", 1));
}

/* The numbers in all lines plus the omitted fields have the size of the whole structure, so that a
 * new section without lines fails this test. */
void test_only_maps_and_header_have_no_lines(void)
{
    size_t numbers = 0;
    for (uint32_t i = 0; field("", i) != NULL; i++) {
        for (const char *c = line.chars; *c != '\0'; c++) {
            numbers += *c == ' ' ? 1U : 0U;
        }
    }
    const size_t head = offsetof(config_t, motor);
    const size_t maps =
        sizeof CONFIG_IMAGE.temperature.winding_cC + sizeof CONFIG_IMAGE.temperature.switch_cC +
        sizeof CONFIG_IMAGE.regen_map.torque_lsb + sizeof CONFIG_IMAGE.current_map.current_d_lsb +
        sizeof CONFIG_IMAGE.flux_map.psi_d_lsb + sizeof CONFIG_IMAGE.flux_map.psi_q_lsb;
    TEST_ASSERT_EQUAL_size_t(offsetof(config_t, crc32), /* the key is not among them */
                             head + maps + sizeof(int32_t) * numbers);
}
