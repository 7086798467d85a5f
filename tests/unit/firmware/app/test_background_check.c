/* SPDX-License-Identifier: Apache-2.0 */
/* Configuration, program and stack are checked again and again while the controller runs. */
#include <stddef.h>

#include "app/background_check.h"
#include "config/validate.h"
#include "config_image.h"
#include "unity.h"

enum { PROGRAM_BYTES = 1000, MUCH_STACK_bytes = 1000 };

static config_t config;
static uint8_t program[PROGRAM_BYTES];
static background_check_t check;

void setUp(void)
{
    config = CONFIG_IMAGE;
    for (int i = 0; i < PROGRAM_BYTES; i++) {
        program[i] = (uint8_t)(i * 37);
    }
    const flash_image_t image = {program, PROGRAM_BYTES};
    background_check_init(&check, &config, image, config_crc32(program, PROGRAM_BYTES));
}

void tearDown(void) {}

/* As many passes as a round of both images takes. */
static bool round_is_good(void)
{
    const int config_passes =
        (int)(offsetof(config_t, crc32) + BACKGROUND_CHECK_BYTES - 1) / BACKGROUND_CHECK_BYTES;
    bool good = true;
    for (int pass = 0; pass < config_passes + 16; pass++) { /* 1000 / 64 */
        good = background_check_step(&check, MUCH_STACK_bytes);
    }
    return good;
}

void test_undamaged_images_stay_good_for_many_rounds(void)
{
    for (int n = 0; n < 20; n++) {
        TEST_ASSERT_TRUE(round_is_good());
    }
}

/* Whatever bit it is, and for good, although the bit comes back. */
void test_any_flipped_bit_is_found_within_two_rounds_and_stays_found(void)
{
    const size_t config_bytes = offsetof(config_t, service_key); /* no step uses the key */
    for (size_t at = 0; at < config_bytes + PROGRAM_BYTES; at += 101) {
        setUp();
        TEST_ASSERT_TRUE(round_is_good());
        uint8_t *byte = at < config_bytes ? (uint8_t *)&config + at : &program[at - config_bytes];
        const uint8_t bit = (uint8_t)(1U << (at % 8U));
        *byte = (uint8_t)(*byte ^ bit);
        (void)round_is_good();
        TEST_ASSERT_FALSE(round_is_good());
        *byte = (uint8_t)(*byte ^ bit);
        TEST_ASSERT_FALSE(round_is_good());
    }
}

void test_a_stack_that_is_nearly_used_up_is_damage(void)
{
    TEST_ASSERT_TRUE(background_check_step(&check, BACKGROUND_CHECK_STACK_bytes));
    TEST_ASSERT_FALSE(background_check_step(&check, BACKGROUND_CHECK_STACK_bytes - 1));
    TEST_ASSERT_FALSE(background_check_step(&check, MUCH_STACK_bytes));
}

void test_crc_in_parts_equals_the_crc_of_the_whole(void)
{
    const uint32_t first = config_crc32("1234", 4);
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926, config_crc32_continue(first, "56789", 5));
}
