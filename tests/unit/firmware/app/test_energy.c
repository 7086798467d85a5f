/* SPDX-License-Identifier: Apache-2.0 */
/* The energy account: powers of each millisecond, since the start and for life. */
#include "app/energy.h"

#include "unity.h"

enum { HOUR_ms = 3600 * 1000, WATTHOUR_10J = 360 };

static const uint32_t ZERO_10J[ENERGY_KINDS];
static energy_t energy;
static slow_output_t output;

void setUp(void)
{
    energy_init(&energy, ZERO_10J);
    output = (slow_output_t){.bus_voltage_mV = 50000, .hydraulic_valid = true};
}

void tearDown(void) {}

static void pass(int32_t milliseconds)
{
    uint16_t steps = energy.slow_steps;
    for (int32_t ms = 0; ms < milliseconds; ms++) {
        steps++;
        energy_step(&energy, &output, steps);
    }
}

static messages_energy_t since_start(void)
{
    return energy_report(&energy, false);
}

/* 50 V and 20 A are 1 kW. */
void test_a_kilowatt_for_an_hour_is_a_kilowatt_hour(void)
{
    output.bus_current_mA = 20000;
    pass(HOUR_ms);
    TEST_ASSERT_EQUAL_UINT32(1000 * WATTHOUR_10J, since_start().drawn_10J);
    TEST_ASSERT_EQUAL_UINT32(0 * WATTHOUR_10J, since_start().returned_10J);
    output.bus_current_mA = -10000;
    pass(HOUR_ms / 2);
    TEST_ASSERT_EQUAL_UINT32(1000 * WATTHOUR_10J, since_start().drawn_10J);
    TEST_ASSERT_EQUAL_UINT32(250 * WATTHOUR_10J, since_start().returned_10J);
}

/* 50 V and 0.1 A are 5 J a second, and that for 7201 s 36.005 kJ, in steps of 5 mJ: what is less
 * than the account's 10 J is kept. */
void test_small_amounts_are_not_lost(void)
{
    output.bus_current_mA = 100;
    pass(HOUR_ms * 2 + 1000);
    TEST_ASSERT_EQUAL_UINT32(3600, since_start().drawn_10J);
    pass(1000);
    TEST_ASSERT_EQUAL_UINT32(3601, since_start().drawn_10J);
}

/* A pass of the background that takes five milliseconds, and a counter that wraps. */
void test_a_pass_counts_for_all_its_milliseconds(void)
{
    output.bus_current_mA = 20000;
    uint16_t steps = 0;
    for (int32_t n = 0; n < HOUR_ms / 5; n++) {
        steps = (uint16_t)(steps + 5U);
        energy_step(&energy, &output, steps);
        energy_step(&energy, &output, steps); /* no new step: nothing more */
    }
    TEST_ASSERT_EQUAL_UINT32(1000 * WATTHOUR_10J, since_start().drawn_10J);
}

/* Motor 30 N m, hydraulic brake 10 N m, forwards and backwards; a driving motor brakes nothing. */
void test_friction_is_a_share_of_the_braking_work_of_both_brakes(void)
{
    TEST_ASSERT_EQUAL_UINT8(MESSAGES_NO_SHARE, since_start().friction_percent);
    output.speed_mrad_s = 40000;
    output.motor_torque_estimate_mNm = 30000;
    pass(10000);
    TEST_ASSERT_EQUAL_UINT8(MESSAGES_NO_SHARE, since_start().friction_percent);
    output.motor_torque_estimate_mNm = -30000;
    output.hydraulic_torque_mNm = 10000;
    pass(10000);
    TEST_ASSERT_EQUAL_UINT8(25, since_start().friction_percent);
    output.speed_mrad_s = -40000;
    output.motor_torque_estimate_mNm = 30000;
    pass(10000);
    TEST_ASSERT_EQUAL_UINT8(25, since_start().friction_percent);
    output.hydraulic_valid = false; /* the brake system's own path: unknown */
    output.motor_torque_estimate_mNm = 0;
    pass(10000);
    TEST_ASSERT_EQUAL_UINT8(25, since_start().friction_percent);
}

void test_for_life_goes_on_from_what_the_journal_had(void)
{
    const uint32_t before[ENERGY_KINDS] = {360000, 36000, 300, 100};
    energy_init(&energy, before);
    TEST_ASSERT_EQUAL_UINT32(0 * WATTHOUR_10J, since_start().drawn_10J);
    output.bus_current_mA = 20000;
    pass(HOUR_ms / 10);
    TEST_ASSERT_EQUAL_UINT32(100 * WATTHOUR_10J, since_start().drawn_10J);
    const messages_energy_t life = energy_report(&energy, true);
    TEST_ASSERT_EQUAL_UINT32(1100 * WATTHOUR_10J, life.drawn_10J);
    TEST_ASSERT_EQUAL_UINT32(100 * WATTHOUR_10J, life.returned_10J);
    TEST_ASSERT_EQUAL_UINT8(25, life.friction_percent);
    TEST_ASSERT_EQUAL_UINT8(MESSAGES_NO_SHARE, since_start().friction_percent);
}

void test_an_energy_ends_at_what_its_number_holds(void)
{
    const uint32_t before[ENERGY_KINDS] = {UINT32_MAX - 1U, 0, 0, 0};
    energy_init(&energy, before);
    output.bus_voltage_mV = 2000000;
    output.bus_current_mA = 2000000;
    pass(10);
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, energy.life_10J[ENERGY_DRAWN]);
}

void test_the_shell_shows_both(void)
{
    const uint32_t before[ENERGY_KINDS] = {360000, 36000, 300, 100};
    energy_init(&energy, before);
    text_t line;
    text_clear(&line);
    TEST_ASSERT_TRUE(energy_line(&energy, 0, &line));
    TEST_ASSERT_EQUAL_STRING("energy since the start: drawn 0 Wh, returned 0 Wh", line.chars);
    text_clear(&line);
    TEST_ASSERT_TRUE(energy_line(&energy, 1, &line));
    TEST_ASSERT_EQUAL_STRING(
        "energy for life: drawn 1000 Wh, returned 100 Wh, friction 25 % of the braking work",
        line.chars);
    TEST_ASSERT_FALSE(energy_line(&energy, 2, &line));
}
