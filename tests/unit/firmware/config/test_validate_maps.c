/* SPDX-License-Identifier: Apache-2.0 */
/* The validator on the two maps. */
#include <stddef.h>
#include <string.h>

#include "config/validate.h"
#include "derive.h"
#include "refusal.h"
#include "unity.h"

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

/* One beyond an end is refused with field, value and range, the end itself is not. */
static void assert_refused(const char *field, int32_t value, int32_t lowest, int32_t highest)
{
    const config_result_t result = sealed_result();
    TEST_ASSERT_EQUAL_INT_MESSAGE(CONFIG_RESULT_RANGE, result.code, field);
    TEST_ASSERT_EQUAL_STRING_LEN(result.section, field, strlen(result.section));
    TEST_ASSERT_EQUAL_STRING(field + strlen(result.section), result.field);
    TEST_ASSERT_EQUAL_INT32(value, result.value);
    TEST_ASSERT_EQUAL_INT32(lowest, result.lowest);
    TEST_ASSERT_EQUAL_INT32(highest, result.highest);
}

static void assert_range(const char *field, int32_t *value, int32_t lowest, int32_t highest)
{
    const int32_t good = *value;
    *value = lowest - 1;
    assert_refused(field, lowest - 1, lowest, highest);
    *value = highest + 1;
    assert_refused(field, highest + 1, lowest, highest);
    *value = lowest;
    TEST_ASSERT_NOT_EQUAL(CONFIG_RESULT_RANGE, sealed_result().code);
    *value = highest;
    TEST_ASSERT_NOT_EQUAL(CONFIG_RESULT_RANGE, sealed_result().code);
    *value = good;
}

/* 16 bits hold no value above the range of an entry, and one below it. */
static void assert_entry_range(const char *field, int16_t *entry, int32_t lowest, int32_t highest)
{
    TEST_ASSERT_EQUAL_INT32(INT16_MIN + 1, lowest);
    TEST_ASSERT_EQUAL_INT32(INT16_MAX, highest);
    const int16_t good = *entry;
    *entry = INT16_MIN;
    assert_refused(field, INT16_MIN, lowest, highest);
    *entry = INT16_MIN + 1;
    TEST_ASSERT_NOT_EQUAL(CONFIG_RESULT_RANGE, sealed_result().code);
    *entry = INT16_MAX;
    TEST_ASSERT_NOT_EQUAL(CONFIG_RESULT_RANGE, sealed_result().code);
    *entry = good;
}

#define CHECK_SCALAR(section, name, lowest, highest)                                               \
    assert_range(#section "." #name, &config.section.name, lowest, highest);
#define CHECK_ENTRIES(section, name, count, lowest, highest)                                       \
    for (int i = 0; i < (count); i++) {                                                            \
        assert_entry_range(#section "." #name, &config.section.name[i], lowest, highest);          \
    }
#define CHECK_MAP(name, lowest, highest, unit, text) CHECK_SCALAR(regen_map, name, lowest, highest)
#define CHECK_MAP_ARRAY(name, count, lowest, highest, unit, text)                                  \
    CHECK_ENTRIES(regen_map, name, count, lowest, highest)
#define CHECK_CURRENT(name, lowest, highest, unit, text)                                           \
    CHECK_SCALAR(current_map, name, lowest, highest)
#define CHECK_CURRENT_ARRAY(name, count, lowest, highest, unit, text)                              \
    CHECK_ENTRIES(current_map, name, count, lowest, highest)
#define CHECK_FLUX(name, lowest, highest, unit, text) CHECK_SCALAR(flux_map, name, lowest, highest)
#define CHECK_FLUX_ARRAY(name, count, lowest, highest, unit, text)                                 \
    CHECK_ENTRIES(flux_map, name, count, lowest, highest)

void test_every_field_of_the_maps_is_checked_against_the_range_of_the_header(void)
{
    CONFIG_REGEN_MAP_FIELDS(CHECK_MAP)
    CONFIG_REGEN_MAP_ARRAY(CHECK_MAP_ARRAY)
    CONFIG_CURRENT_MAP_FIELDS(CHECK_CURRENT)
    CONFIG_CURRENT_MAP_ARRAY(CHECK_CURRENT_ARRAY)
    CONFIG_FLUX_MAP_FIELDS(CHECK_FLUX)
    CONFIG_FLUX_MAP_ARRAY(CHECK_FLUX_ARRAY)
}

void test_d_current_map_must_have_a_point_at_zero_torque(void)
{
    config.current_map.torque_points = 4;
    assert_relation("current_map.torque_points odd");
}

void test_maps_must_fit_their_arrays(void)
{
    config.current_map.torque_points = 31;
    config.current_map.speed_points = 19;
    config.current_map.temperature_points = 2;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.current_map.temperature_points = 3;
    assert_relation(
        "current_map.torque_points * speed_points * temperature_points within the table");
    config.current_map.temperature_points = 2;
    config.regen_map.speed_points = 47;
    config.regen_map.temperature_points = 17;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.regen_map.speed_points = 48;
    assert_relation("regen_map.speed_points * regen_map.temperature_points within the table");
}

void test_the_map_must_reach_half_of_torque_and_speed(void)
{
    config.motor.max_torque_mNm = 2 * 2 << config.current_map.torque_step_log2;
    config.driver.largest_drive_mNm = config.motor.max_torque_mNm;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.motor.max_torque_mNm++;
    assert_relation("current_map covers half");
    config.current_map.speed_step_log2 = 12;
    assert_relation("current_map covers half");
}

/* 75 A: 70.3 A at most demagnetise. */
void test_d_currents_of_the_map_must_leave_current_for_a_torque(void)
{
    /* Five torques 32.8 N m apart: the middle one, zero, and the first, beyond the largest. */
    config.current_map.lsb_log2 = 1;
    config.current_map.current_d_lsb[2] = -32767;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.current_map.lsb_log2 = 3;
    memset(config.current_map.current_d_lsb, 0, sizeof config.current_map.current_d_lsb);
    config.current_map.current_d_lsb[0] = -150000 / 8;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.current_map.current_d_lsb[0]--;
    assert_relation("within twice beyond");
    config.current_map.lsb_log2 = 2;
    config.current_map.current_d_lsb[2] = -17579;
    assert_relation("current_map.current_d_lsb within 15/16 of motor.max_phase_current_mA");
}

void test_d_currents_of_the_map_must_leave_a_quarter_of_the_flux(void)
{
    /* psi = 20.4 mWb: with L_q - L_d = 0.255 mH, i_d = 60 A cancels three quarters of it. */
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.q_inductance_nH = config.motor.d_inductance_nH + 255000;
    config.current_loop.bandwidth_Hz = 200; /* so that the gains fit */
    TEST_ASSERT_TRUE(derive(&config));
    memset(config.current_map.current_d_lsb, 0, sizeof config.current_map.current_d_lsb);
    config.current_map.lsb_log2 = 3;
    config.current_map.current_d_lsb[CONFIG_CURRENT_MAP_POINTS_MAX - 1] = 60000 / 8;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.current_map.current_d_lsb[CONFIG_CURRENT_MAP_POINTS_MAX - 1] = 60000 / 8 + 1;
    assert_relation("leaves a quarter of motor.flux_linkage_nWb");
}
