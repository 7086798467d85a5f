/* SPDX-License-Identifier: Apache-2.0 */
/* Halls of the flashable ports, their code unchanged, at the chip's addresses. */
#include <sys/mman.h>

#include "board.h"
#include "hal/rotor_sensor.h"
#include "rotor_sensor_sample.h"
#include "unity.h"

enum { PERIPHERALS = 0x40000000, PERIPHERALS_BYTES = 0x30000 };
static const pin_t LINE[3] = {BOARD_ROTOR_A, BOARD_ROTOR_B, BOARD_ROTOR_C};

static void show(unsigned state)
{
    for (unsigned x = 0; x < 3; x++) {
        const uint32_t bit = 1U << LINE[x].number;
        LINE[x].port->IDR =
            (state >> x & 1U) != 0 ? LINE[x].port->IDR | bit : LINE[x].port->IDR & ~bit;
    }
}

/* A period in which the lines show this at its two samples. */
static uint8_t period(unsigned first, unsigned second)
{
    show(first);
    rotor_sensor_sample();
    show(second);
    return rotor_sensor_hall_state();
}

void setUp(void)
{
    void *const at = (void *)(uintptr_t)PERIPHERALS;
    TEST_ASSERT_EQUAL_PTR(at, mmap(at, PERIPHERALS_BYTES, PROT_READ | PROT_WRITE,
                                   MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0));
    TEST_ASSERT_TRUE(rotor_sensor_init(ROTOR_SENSOR_HALL));
}

void tearDown(void) {}

void test_every_state_is_read_in_the_period_in_which_it_comes(void)
{
    for (unsigned state = 0; state < 8U; state++) {
        TEST_ASSERT_EQUAL_UINT8(state, period(state, state));
    }
}

void test_one_wrong_sample_has_no_effect_whatever_it_shows(void)
{
    for (unsigned state = 0; state < 8U; state++) {
        for (unsigned wrong = 0; wrong < 8U; wrong++) {
            TEST_ASSERT_EQUAL_UINT8(state, period(state, state));
            TEST_ASSERT_EQUAL_UINT8(state, period(wrong, state));
            TEST_ASSERT_EQUAL_UINT8(state, period(state, wrong));
            TEST_ASSERT_EQUAL_UINT8(state, period(state, state));
        }
    }
}

void test_an_edge_between_the_samples_is_read_one_period_later(void)
{
    TEST_ASSERT_EQUAL_UINT8(5, period(5, 5));
    TEST_ASSERT_EQUAL_UINT8(5, period(5, 1));
    TEST_ASSERT_EQUAL_UINT8(1, period(1, 1));
}
