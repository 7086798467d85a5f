/* SPDX-License-Identifier: Apache-2.0 */
/* The fields of the configuration one after another, beside the structure that the compiler laid
 * out. */
#include <stddef.h>
#include <string.h>

#include "config/config.h"
#include "config/fields.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* Place, size and range of a field with this name, from the lists of config.h and config_t. */
typedef struct {
    const char *name; /* with its section */
    size_t offset_bytes;
    size_t count;
    int32_t lowest;
    int32_t highest;
} expected_t;

#define FIELD(section, name, lowest, highest)                                                      \
    FIELD_OF(section, name, sizeof(int32_t), lowest, highest)
#define FIELD_OF(section, name, bytes, lowest, highest)                                            \
    {#section "." #name, offsetof(config_t, section.name),                                         \
     sizeof(((config_t *)0)->section.name) / (bytes), (lowest), (highest)},
#define MOTOR(name, lowest, highest, unit, text) FIELD(motor, name, lowest, highest)
#define ROTOR(name, lowest, highest, unit, text) FIELD(rotor, name, lowest, highest)
#define HALL(name, count, lowest, highest, unit, text) FIELD(rotor, name, lowest, highest)
#define PEDALS(name, lowest, highest, unit, text) FIELD(pedals, name, lowest, highest)
#define CHANNEL(name, count, lowest, highest, unit, text) FIELD(pedals, name, lowest, highest)
#define MONITOR(name, lowest, highest, unit, text) FIELD(monitor, name, lowest, highest)
#define CURRENT(name, lowest, highest, unit, text) FIELD(current_map, name, lowest, highest)
#define CURRENTS(name, count, lowest, highest, unit, text)                                         \
    FIELD_OF(current_map, name, sizeof(int16_t), lowest, highest)
#define FLUX(name, lowest, highest, unit, text) FIELD(flux_map, name, lowest, highest)
#define FLUXES(name, count, lowest, highest, unit, text)                                           \
    FIELD_OF(flux_map, name, sizeof(int16_t), lowest, highest)

static const expected_t EXPECTED[] = {
    CONFIG_MOTOR_FIELDS(MOTOR) CONFIG_ROTOR_FIELDS(ROTOR) CONFIG_HALL_ARRAY(HALL)
        CONFIG_PEDALS_FIELDS(PEDALS) CONFIG_PEDALS_ARRAY(CHANNEL) CONFIG_MONITOR_FIELDS(MONITOR)
            CONFIG_CURRENT_MAP_FIELDS(CURRENT) CONFIG_CURRENT_MAP_ARRAY(CURRENTS)
                CONFIG_FLUX_MAP_FIELDS(FLUX) CONFIG_FLUX_MAP_ARRAY(FLUXES)};

static void assert_is(const expected_t *expected, const config_field_t *field)
{
    const size_t section = strlen(field->section);
    TEST_ASSERT_EQUAL_STRING_LEN(expected->name, field->section, section);
    TEST_ASSERT_EQUAL_STRING(expected->name + section, field->name);
    TEST_ASSERT_EQUAL_MESSAGE(expected->offset_bytes, field->offset_bytes, expected->name);
    TEST_ASSERT_EQUAL_MESSAGE(expected->count, field->count, expected->name);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected->lowest, field->lowest, expected->name);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected->highest, field->highest, expected->name);
}

void test_field_is_found_at_its_place_with_name_size_and_range(void)
{
    for (size_t k = 0; k < sizeof EXPECTED / sizeof EXPECTED[0]; k++) {
        const config_field_t field = config_field_at((uint32_t)EXPECTED[k].offset_bytes);
        assert_is(&EXPECTED[k], &field);
    }
}

/* From the first value to the checksum, without a gap and without an overlap. */
void test_fields_cover_everything_between_header_and_checksum(void)
{
    config_field_t field = config_field_first();
    TEST_ASSERT_EQUAL(offsetof(config_t, motor), field.offset_bytes);
    uint32_t end_bytes = field.offset_bytes;
    uint32_t number = 0;
    do {
        TEST_ASSERT_EQUAL_UINT32(number, field.number);
        TEST_ASSERT_EQUAL_UINT32(end_bytes, field.offset_bytes);
        TEST_ASSERT_GREATER_THAN(0, strlen(field.name));
        TEST_ASSERT_GREATER_THAN_UINT32(0, field.count);
        /* A map is of half-words. */
        end_bytes += field.count * (field.count > CONFIG_FIELD_VALUES_MAX ? 2U : 4U);
        number++;
    } while (config_field_next(&field));
    TEST_ASSERT_EQUAL(offsetof(config_t, crc32), end_bytes);
}

void test_last_field_stays_the_last(void)
{
    config_field_t last = config_field_at((uint32_t)offsetof(config_t, crc32));
    const config_field_t before = last;
    TEST_ASSERT_FALSE(config_field_next(&last));
    TEST_ASSERT_EQUAL_STRING("flux_map.", last.section);
    TEST_ASSERT_EQUAL_STRING("psi_q_lsb", last.name);
    TEST_ASSERT_EQUAL_UINT32(before.number, last.number);
    TEST_ASSERT_EQUAL_UINT32(before.offset_bytes, last.offset_bytes);
}

void test_place_inside_an_array_finds_the_next_field(void)
{
    const uint32_t inside = (uint32_t)offsetof(config_t, rotor.edge_turn) + 4U;
    const config_field_t field = config_field_at(inside);
    TEST_ASSERT_EQUAL_STRING("battery.", field.section);
    TEST_ASSERT_EQUAL(offsetof(config_t, battery), field.offset_bytes);
}

void test_values_of_a_field_are_those_of_the_structure(void)
{
    static config_t config;
    config.rotor.edge_turn[0] = 7;
    config.rotor.edge_turn[5] = 9;
    const config_field_t field = config_field_at((uint32_t)offsetof(config_t, rotor.edge_turn));
    TEST_ASSERT_EQUAL_INT32(7, config_field_value(&config, &field, 0));
    TEST_ASSERT_EQUAL_INT32(9, config_field_value(&config, &field, 5));
    config.regen_map.torque_lsb[0] = -32767;
    config.regen_map.torque_lsb[799] = 1234;
    const config_field_t map = config_field_at((uint32_t)offsetof(config_t, regen_map.torque_lsb));
    TEST_ASSERT_EQUAL_INT32(-32767, config_field_value(&config, &map, 0));
    TEST_ASSERT_EQUAL_INT32(1234, config_field_value(&config, &map, 799));
}
