/* SPDX-License-Identifier: Apache-2.0 */
/* Two sectors for the configuration: the old or the new one after a cut of the supply at every
 * operation of an update. On the model of the chip: tests/target/chip/cuts.c. */
#include <string.h>

#include "app/config_store.h"
#include "flash_fake.h"
#include "unity.h"

enum { IMAGE_WORDS = 30, IMAGE_BYTES = 4 * IMAGE_WORDS, UPDATE_OPERATIONS = 1 + IMAGE_WORDS + 2 };

static uint32_t first[IMAGE_WORDS], second[IMAGE_WORDS], third[IMAGE_WORDS];

void setUp(void)
{
    for (uint32_t i = 0; i < IMAGE_WORDS; i++) {
        first[i] = 0x9E3779B9U * (i + 1U);
        second[i] = 0x85EBCA6BU * (i + 1U);
        third[i] = 0xC2B2AE35U * (i + 1U);
    }
    fake_deliver(first, IMAGE_BYTES);
}

void tearDown(void) {}

static bool in_force(const uint32_t *image)
{
    return memcmp(config_store_in_force().image.begin, image, IMAGE_BYTES) == 0;
}

static flash_status_t replace(const uint32_t *image)
{
    return config_store_replace(image, IMAGE_BYTES);
}

void test_the_builds_configuration_is_in_force_until_there_is_another(void)
{
    TEST_ASSERT_TRUE(in_force(first));
    TEST_ASSERT_EQUAL_UINT32(0, config_store_in_force().sequence);
    TEST_ASSERT_EQUAL_UINT32(FAKE_BYTES - CONFIG_STORE_MARK_BYTES,
                             config_store_in_force().image.size_bytes);
}

void test_updates_alternate_between_the_sectors(void)
{
    const uint32_t *const images[3] = {second, third, first};
    for (uint32_t i = 0; i < 20; i++) {
        const flash_sector_t before = config_store_in_force().sector;
        TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(images[i % 3U]));
        TEST_ASSERT_TRUE(in_force(images[i % 3U]));
        TEST_ASSERT_NOT_EQUAL_INT(before, config_store_in_force().sector);
        TEST_ASSERT_EQUAL_UINT32(i + 1U, config_store_in_force().sequence);
    }
}

/* Returns whether the supply failed. */
static bool replace_with_cut(const uint32_t *image, uint32_t at, uint32_t seed)
{
    fake.operations = 0;
    fake.cut_at = at;
    fake.random = seed;
    if (setjmp(fake.supply_lost) != 0) {
        fake.cut_at = 0;
        return true;
    }
    (void)replace(image);
    fake.cut_at = 0;
    return false;
}

/* `before` updates precede the one that is cut, so that it goes to sector B, to A, and to a B that
 * holds an older one. The mark's last word decides: before it the old one, after it the new one. */
static void cut_everywhere(uint32_t before)
{
    for (uint32_t at = 1; at <= UPDATE_OPERATIONS + 1U; at++) {
        for (uint32_t seed = 0; seed < 24; seed++) {
            const uint32_t *const images[3] = {first, second, third};
            fake_deliver(first, IMAGE_BYTES);
            for (uint32_t i = 1; i <= before; i++) {
                TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(images[i % 3U]));
            }
            const uint32_t *const old = images[before % 3U];
            const uint32_t *const new = images[(before + 1U) % 3U];
            const bool cut = replace_with_cut(new, at, seed * 0x9E3779B9U);
            TEST_ASSERT_EQUAL(at <= UPDATE_OPERATIONS, cut);
            TEST_ASSERT_TRUE(at < UPDATE_OPERATIONS ? in_force(old)
                                                    : in_force(new) || (cut && in_force(old)));
            /* Whatever the cut left behind, the next update works. */
            TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(images[(before + 2U) % 3U]));
            TEST_ASSERT_TRUE(in_force(images[(before + 2U) % 3U]));
        }
    }
}

void test_a_cut_of_the_supply_leaves_the_old_or_the_new_one(void)
{
    for (uint32_t before = 0; before < 4; before++) {
        cut_everywhere(before);
    }
}

void test_two_cuts_in_a_row_leave_the_old_or_the_new_one(void)
{
    for (uint32_t at = 1; at <= UPDATE_OPERATIONS; at++) {
        for (uint32_t again = 1; again <= UPDATE_OPERATIONS; again++) {
            fake_deliver(first, IMAGE_BYTES);
            (void)replace_with_cut(second, at, at * 0x9E3779B9U);
            const bool was_new = in_force(second);
            (void)replace_with_cut(third, again, again * 0x85EBCA6BU);
            TEST_ASSERT_TRUE(in_force(was_new ? second : first) ||
                             (again == UPDATE_OPERATIONS && in_force(third)));
        }
    }
}

void test_an_operation_that_fails_leaves_the_old_one(void)
{
    TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(second));
    for (uint32_t at = 1; at < UPDATE_OPERATIONS; at++) {
        fake.operations = 0;
        fake.fails_at = at;
        TEST_ASSERT_EQUAL_INT(at == 1 ? FLASH_ERASE_FAILED : FLASH_WRITE_FAILED, replace(third));
        TEST_ASSERT_TRUE(in_force(second));
    }
}

void test_no_sector_is_erased_while_the_bridge_switches(void)
{
    fake.bridge_on = true;
    TEST_ASSERT_EQUAL_INT(FLASH_BRIDGE_ON, replace(second));
    TEST_ASSERT_EQUAL_UINT32(0, fake.operations);
    TEST_ASSERT_TRUE(in_force(first));
}

void test_an_image_that_does_not_fit_is_refused_before_anything_is_erased(void)
{
    static const uint8_t LARGE[FAKE_BYTES];
    TEST_ASSERT_EQUAL_INT(FLASH_TOO_LARGE,
                          config_store_replace(LARGE, FAKE_BYTES - CONFIG_STORE_MARK_BYTES + 4));
    TEST_ASSERT_EQUAL_UINT32(0, fake.operations);
    TEST_ASSERT_EQUAL_INT(FLASH_OK,
                          config_store_replace(LARGE, FAKE_BYTES - CONFIG_STORE_MARK_BYTES));
}

/* The older one may be another motor's. */
void test_a_configuration_damaged_after_its_mark_stays_in_force_to_be_refused(void)
{
    TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(second));
    fake.word[FLASH_CONFIGURATION_B][3] ^= 1U;
    TEST_ASSERT_EQUAL_INT(FLASH_CONFIGURATION_B, config_store_in_force().sector);
    TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(third));
    TEST_ASSERT_TRUE(in_force(third));
}

/* A probe writes sector A and erases the mark of B. */
void test_a_configuration_written_by_a_probe_is_in_force(void)
{
    TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(second));
    memset(fake.word[FLASH_CONFIGURATION_A], 0xFF, FAKE_BYTES);
    memcpy(fake.word[FLASH_CONFIGURATION_A], third, IMAGE_BYTES);
    fake.word[FLASH_CONFIGURATION_B][FAKE_WORDS - 1] = UINT32_MAX;
    fake.word[FLASH_CONFIGURATION_B][FAKE_WORDS - 2] = UINT32_MAX;
    TEST_ASSERT_TRUE(in_force(third));
}

void test_sequence_numbers_wrap_without_the_builds_zero(void)
{
    uint32_t *const mark = &fake.word[FLASH_CONFIGURATION_A][FAKE_WORDS - 2];
    mark[0] = UINT32_MAX - 1U;
    mark[1] = ~mark[0];
    TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(second));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, config_store_in_force().sequence);
    TEST_ASSERT_EQUAL_INT(FLASH_OK, replace(third));
    TEST_ASSERT_EQUAL_UINT32(1, config_store_in_force().sequence);
    TEST_ASSERT_TRUE(in_force(third));
}
