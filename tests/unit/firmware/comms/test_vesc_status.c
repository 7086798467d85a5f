/* SPDX-License-Identifier: Apache-2.0 */
/* VESC status frames, read as their documentation describes them. */
#include "comms/vesc_status.h"

#include "unity.h"

enum { ID = 10 };

static vesc_status_values_t values;
static vesc_status_frame_t frame;

void setUp(void)
{
    const vesc_status_values_t at_rest = {.pole_pairs = 26};
    values = at_rest;
}

void tearDown(void) {}

static void make(vesc_status_kind_t kind, uint32_t identifier)
{
    frame = vesc_status_frame(kind, ID, &values);
    TEST_ASSERT_EQUAL_HEX32(identifier, frame.identifier);
    TEST_ASSERT_EQUAL_HEX32(identifier, vesc_status_identifier(kind, ID));
}

/* Big endian. */
static int32_t word(uint32_t first)
{
    const uint8_t *d = &frame.data[first];
    return (int32_t)((uint32_t)d[0] << 24 | (uint32_t)d[1] << 16 | (uint32_t)d[2] << 8 | d[3]);
}

static int16_t half(uint32_t first)
{
    return (int16_t)((uint32_t)frame.data[first] << 8 | frame.data[first + 1U]);
}

static void assert_status(int32_t speed_rpm, int current, int duty)
{
    make(VESC_STATUS, 0x90A);
    TEST_ASSERT_EQUAL_INT32(speed_rpm, word(0));
    TEST_ASSERT_EQUAL_INT(current, half(4));
    TEST_ASSERT_EQUAL_INT(duty, half(6));
}

/* 10 rad/s are 95.493 1/min, with 26 pole pairs 2482.8; 30 A and 40 A across are 50 A; 0.3 and 0.4
 * of the voltage circle are 0.5. */
void test_speed_current_and_duty_cycle_have_their_signs_in_all_four_quadrants(void)
{
    const dq_t forward = {.d = -9830, .q = 13107}, reverse = {.d = 9830, .q = -13107};
    values.i_d_mA = -30000;
    values.i_q_mA = 40000;
    values.u_pu = forward;
    values.speed_mrad_s = 10000;
    assert_status(2483, 500, 500);
    values.i_q_mA = -40000; /* brakes */
    assert_status(2483, -500, 500);
    values.speed_mrad_s = -10000; /* drives in reverse */
    values.u_pu = reverse;
    assert_status(-2483, 500, -500);
    values.i_q_mA = 40000; /* brakes in reverse */
    assert_status(-2483, -500, -500);
}

/* 2.5 Ah are 9 kC; 0.54 C are 0.15 mAh, of which 0.1 mAh are whole. */
void test_charges_are_in_tenths_of_a_milliampere_hour(void)
{
    values.drawn_uC = 9000000000;
    values.returned_uC = 540000;
    make(VESC_STATUS_2, 0xE0A);
    TEST_ASSERT_EQUAL_INT32(25000, word(0));
    TEST_ASSERT_EQUAL_INT32(1, word(4));
}

/* 10 kJ are 2.7777 Wh, 360 J are 0.1 Wh. */
void test_energies_are_in_tenths_of_a_milliwatt_hour(void)
{
    values.drawn_10J = 1000;
    values.returned_10J = 36;
    make(VESC_STATUS_3, 0xF0A);
    TEST_ASSERT_EQUAL_INT32(27777, word(0));
    TEST_ASSERT_EQUAL_INT32(1000, word(4));
}

void test_temperatures_and_bus_current_are_rounded_to_tenths(void)
{
    values.temperature.switch_cC = 4567;
    values.temperature.winding_cC = -1234;
    values.bus_current_mA = -12345;
    make(VESC_STATUS_4, 0x100A);
    TEST_ASSERT_EQUAL_INT(457, half(0));
    TEST_ASSERT_EQUAL_INT(-123, half(2));
    TEST_ASSERT_EQUAL_INT(-123, half(4));
    TEST_ASSERT_EQUAL_INT(0, half(6));
}

void test_a_broken_temperature_sensor_shows_300_degrees(void)
{
    values.temperature.switch_cC = 29999;
    values.temperature.winding_cC = INT32_MAX;
    make(VESC_STATUS_4, 0x100A);
    TEST_ASSERT_EQUAL_INT(3000, half(0));
    TEST_ASSERT_EQUAL_INT(3000, half(2));
}

/* Two turns of the wheel are 52 electrical ones, each of six steps. */
void test_the_tachometer_counts_six_steps_in_an_electrical_turn(void)
{
    values.turned_urad = 12566371;
    values.bus_voltage_mV = 52340;
    make(VESC_STATUS_5, 0x1B0A);
    TEST_ASSERT_EQUAL_INT32(312, word(0));
    TEST_ASSERT_EQUAL_INT(523, half(4));
    TEST_ASSERT_EQUAL_INT(0, half(6));
    values.turned_urad = -12566371;
    make(VESC_STATUS_5, 0x1B0A);
    TEST_ASSERT_EQUAL_INT32(-312, word(0));
}

/* The largest that the configuration lets a controller have, and sums of ten years at them. */
void test_what_does_not_fit_is_sent_as_the_end_of_the_range(void)
{
    values.pole_pairs = 60;
    values.speed_mrad_s = -5200000;
    values.i_q_mA = -6000000;
    values.u_pu.q = -40000;
    values.bus_current_mA = -6000000;
    values.bus_voltage_mV = 2000000;
    values.turned_urad = -5200000 * INT64_C(315360000) * 10;
    values.drawn_uC = UINT64_C(6000000) * 1000 * 315360000;
    values.drawn_10J = UINT32_MAX;
    assert_status(-2979381, 32767, -1221);
    make(VESC_STATUS_2, 0xE0A);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, word(0));
    make(VESC_STATUS_3, 0xF0A);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, word(0));
    make(VESC_STATUS_4, 0x100A);
    TEST_ASSERT_EQUAL_INT(-32768, half(4));
    make(VESC_STATUS_5, 0x1B0A);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, word(0));
    TEST_ASSERT_EQUAL_INT(20000, half(4));
}

void test_the_controller_id_is_the_lowest_byte(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x1BFD, vesc_status_frame(VESC_STATUS_5, 253, &values).identifier);
}
