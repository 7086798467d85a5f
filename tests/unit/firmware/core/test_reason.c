/* SPDX-License-Identifier: Apache-2.0 */
/* Reasons are part of the CAN protocol: their published numbers must not change. */
#include "core/reason.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* An independent copy of the list: this test fails when a number changes. */
typedef struct {
    int number;
    reason_t reason;
} frozen_t;

static const frozen_t FROZEN[] = {
    {0, REASON_NONE},
    {1, REASON_LOSS_OPTIMUM},
    {2, REASON_MAX_TORQUE},
    {3, REASON_MAX_POWER},
    {4, REASON_PHASE_CURRENT},
    {5, REASON_CHARGE_CURRENT},
    {6, REASON_DISCHARGE_CURRENT},
    {7, REASON_BUS_VOLTAGE_HIGH},
    {8, REASON_BUS_VOLTAGE_LOW},
    {9, REASON_WINDING_TEMPERATURE},
    {10, REASON_SWITCH_TEMPERATURE},
    {11, REASON_BLEND_OUT},
    {12, REASON_TORQUE_RATE},
    {13, REASON_VOLTAGE},
    {14, REASON_ELECTRIC_SHARE},
    {15, REASON_ELECTRIC_RATED},
    {16, REASON_ABS},
    {17, REASON_TORQUE_ENABLE},
    {18, REASON_MAX_SPEED},
    {19, REASON_ROTOR_UNCERTAIN},
    {20, REASON_HYDRAULIC_LIMIT},
    {21, REASON_BRAKE_PRIORITY},
    {22, REASON_DRIVE_DIRECTION},
    {23, REASON_HILL_HOLD},
    {26, REASON_HYDRAULIC_FEEDBACK},
    {27, REASON_OVERSPEED},
    {28, REASON_BATTERY_DISCONNECTED},
    {29, REASON_OFFSETS_STORED},
    {30, REASON_ACCELERATOR_LOCKED},
    {64, REASON_CONFIG_INVALID},
    {65, REASON_SELFTEST_FAILED},
    {66, REASON_OFFSET_IMPLAUSIBLE},
    {67, REASON_OVERCURRENT},
    {68, REASON_BUS_OVERVOLTAGE},
    {69, REASON_BUS_UNDERVOLTAGE},
    {70, REASON_WINDING_OVERTEMPERATURE},
    {71, REASON_SWITCH_OVERTEMPERATURE},
    {72, REASON_CURRENT_SUM},
    {73, REASON_ROTOR_LOST},
    {74, REASON_TORQUE_IMPLAUSIBLE},
    {75, REASON_PROGRAM_FLOW},
    {76, REASON_DEMAND_TIMEOUT},
    {77, REASON_HARDWARE_BREAK},
    {78, REASON_CURRENT_SENSOR},
    {79, REASON_ROTOR_IMPLAUSIBLE},
    {80, REASON_WINDING_SENSOR},
    {81, REASON_SWITCH_SENSOR},
    {82, REASON_ACCELERATOR_SENSOR},
    {83, REASON_BRAKE_PEDAL_SENSOR},
    {84, REASON_MEMORY},
    {85, REASON_CURRENT_SENSOR_A},
    {86, REASON_CURRENT_SENSOR_B},
    {87, REASON_CURRENT_SENSOR_C},
    {91, REASON_ROTOR_SLIPPED},
    {92, REASON_ROTOR_FROZEN},
    {93, REASON_ROTOR_REVERSED},
    {96, REASON_FLUX_WEAK},
    {97, REASON_BUS_SENSOR},
    {98, REASON_HYDRAULIC_WEAK},
    {99, REASON_HYDRAULIC_DEAD},
    {100, REASON_HYDRAULIC_STRONG},
    {101, REASON_HYDRAULIC_STUCK},
    {102, REASON_HYDRAULIC_LATE},
    {107, REASON_HOLD_FAILED},
};
enum { FROZEN_COUNT = sizeof(FROZEN) / sizeof(FROZEN[0]) };

void test_published_numbers_are_unchanged(void)
{
    for (int i = 0; i < FROZEN_COUNT; i++) {
        TEST_ASSERT_EQUAL_INT(FROZEN[i].number, FROZEN[i].reason);
    }
}

void test_numbers_distinguish_limits_and_faults(void)
{
    TEST_ASSERT_TRUE((int)REASON_HYDRAULIC_LIMIT < (int)REASON_FIRST_FAULT);
    TEST_ASSERT_EQUAL_INT((int)REASON_FIRST_FAULT, (int)REASON_CONFIG_INVALID);
}

/* The lists again, as the enumeration is made of them. */
#define LIMIT_ROW(number, identifier, text) {number, #identifier},
#define FAULT_ROW(number, identifier, text, clearing, driver) LIMIT_ROW(number, identifier, text)
static const struct {
    int number;
    const char *name;
} ROWS[] = {LIMIT_LIST(LIMIT_ROW) FAULT_LIST(FAULT_ROW)};
enum { ROW_COUNT = sizeof(ROWS) / sizeof(ROWS[0]) };

void test_every_row_has_its_number_and_name(void)
{
    for (uint32_t place = 0; place < ROW_COUNT; place++) {
        reason_t reason = REASON_NONE;
        TEST_ASSERT_TRUE(reason_listed(place, &reason));
        TEST_ASSERT_EQUAL_INT(ROWS[place].number, reason);
        TEST_ASSERT_EQUAL_STRING(ROWS[place].name, reason_name(reason));
        TEST_ASSERT_EQUAL_UINT32(place, reason_place(reason));
    }
}

void test_last_row_ends_the_list(void)
{
    reason_t reason = REASON_NONE;
    TEST_ASSERT_FALSE(reason_listed(ROW_COUNT, &reason));
    TEST_ASSERT_FALSE(reason_listed(UINT32_MAX, &reason));
    TEST_ASSERT_EQUAL_STRING("unknown reason", reason_name((reason_t)40));
    TEST_ASSERT_EQUAL_UINT32(ROW_COUNT, reason_place((reason_t)40));
}
