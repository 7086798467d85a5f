/* SPDX-License-Identifier: Apache-2.0 */
/* mmap and fileno: only to build memory with a fault in it. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

#include "app/selftest.h"
#include "unity.h"

enum { WORDS = 64 };

static volatile uint32_t window[WORDS];

void setUp(void) {}

void tearDown(void) {}

void test_working_memory_passes_with_any_previous_content(void)
{
    for (uint32_t i = 0; i < WORDS; i++) {
        window[i] = 0xFFFFFFFFU / (i + 1U);
    }
    TEST_ASSERT_TRUE(selftest_ram(window, WORDS));
    TEST_ASSERT_TRUE(selftest_ram(window, 1));
    TEST_ASSERT_TRUE(selftest_ram(window, 0));
}

void test_no_byte_outside_the_window_is_changed(void)
{
    window[0] = 0xA5A5A5A5U;
    window[WORDS - 1] = 0x5A5A5A5AU;
    TEST_ASSERT_TRUE(selftest_ram(&window[1], WORDS - 2));
    TEST_ASSERT_EQUAL_HEX32(0xA5A5A5A5U, window[0]);
    TEST_ASSERT_EQUAL_HEX32(0x5A5A5A5AU, window[WORDS - 1]);
}

/* A broken address line: the host maps one page at two addresses. */
void test_memory_with_two_addresses_of_one_cell_fails(void)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    FILE *file = tmpfile();
    TEST_ASSERT_NOT_NULL(file);
    TEST_ASSERT_EQUAL_INT(0, ftruncate(fileno(file), (off_t)page));
    char *base = mmap(NULL, 2 * page, PROT_READ | PROT_WRITE, MAP_SHARED, fileno(file), 0);
    TEST_ASSERT_TRUE(base != MAP_FAILED);
    void *again =
        mmap(base + page, page, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, fileno(file), 0);
    TEST_ASSERT_EQUAL_PTR(base + page, again);
    volatile uint32_t *words = (volatile uint32_t *)(void *)base;
    TEST_ASSERT_TRUE(selftest_ram(words, (uint32_t)(page / 4)));
    TEST_ASSERT_FALSE(selftest_ram(words, (uint32_t)(2 * page / 4)));
    TEST_ASSERT_FALSE(selftest_ram(&words[page / 4 - 1],
                                   (uint32_t)(page / 4 + 1))); /* overlap only at the ends */
    (void)munmap(base, 2 * page);
    (void)fclose(file);
}

/* The published check value: CRC-32 of "123456789". */
void test_image_is_accepted_only_with_its_crc(void)
{
    TEST_ASSERT_TRUE(selftest_firmware("123456789", 9, 0xCBF43926U));
    TEST_ASSERT_FALSE(selftest_firmware("123456789", 9, 0xCBF43927U));
    TEST_ASSERT_FALSE(selftest_firmware("123456788", 9, 0xCBF43926U));
    TEST_ASSERT_FALSE(selftest_firmware("123456789", 8, 0xCBF43926U));
}
