/* SPDX-License-Identifier: Apache-2.0 */
/* Intel HEX as in the specification and as objcopy writes it; checksums in the literals are
 * computed by hand. */
#include <string.h>

#include "comms/intel_hex.h"
#include "unity.h"

enum { CAPACITY = 64 };
#define END_RECORD ":00000001FF\n"

static intel_hex_t hex;
static uint8_t image[CAPACITY];

void setUp(void)
{
    memset(image, 0xEE, sizeof image);
    intel_hex_init(&hex, image, CAPACITY);
}

void tearDown(void) {}

/* Returns the number of characters up to the end record, 0 without one. */
static uint32_t receive(const char *text)
{
    for (uint32_t i = 0; text[i] != '\0'; i++) {
        if (intel_hex_receive(&hex, (uint8_t)text[i])) {
            return i + 1U;
        }
    }
    return 0;
}

static void assert_refused(const char *text, intel_hex_problem_t problem, uint32_t record)
{
    intel_hex_init(&hex, image, CAPACITY);
    TEST_ASSERT_TRUE_MESSAGE(receive(text) > 0, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(problem, hex.problem, text);
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(record, hex.record, text);
}

/* The example of the format's specification: 16 bytes at 0x0100, checksum 0x40. */
void test_example_record_is_read(void)
{
    static const uint8_t EXPECTED[16] = {0x21, 0x46, 0x01, 0x36, 0x01, 0x21, 0x47, 0x01,
                                         0x36, 0x00, 0x7E, 0xFE, 0x09, 0xD2, 0x19, 0x01};
    TEST_ASSERT_TRUE(receive(":10010000214601360121470136007EFE09D2190140\r\n" END_RECORD) > 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_GOOD, hex.problem);
    TEST_ASSERT_EQUAL_UINT32(16, hex.size_bytes);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(EXPECTED, image, 16);
    TEST_ASSERT_EQUAL_HEX8(0xEE, image[16]);
}

/* 0x00FF, then 0x0010 * 16 + 0: the byte after it. */
void test_segment_address_is_in_units_of_16_bytes(void)
{
    TEST_ASSERT_TRUE(receive(":0100FF0041BF\n:020000020010EC\n:0100000042BD\n" END_RECORD) > 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_GOOD, hex.problem);
    TEST_ASSERT_EQUAL_UINT32(2, hex.size_bytes);
    TEST_ASSERT_EQUAL_HEX8(0x41, image[0]);
    TEST_ASSERT_EQUAL_HEX8(0x42, image[1]);
}

void test_every_error_has_its_own_text(void)
{
    for (int one = INTEL_HEX_GOOD; one <= INTEL_HEX_TOO_LARGE; one++) {
        for (int other = INTEL_HEX_GOOD; other < one; other++) {
            TEST_ASSERT_NOT_EQUAL(0, strcmp(intel_hex_text((intel_hex_problem_t)one),
                                            intel_hex_text((intel_hex_problem_t)other)));
        }
    }
}

void test_lower_case_blank_lines_and_comments_between_records_are_accepted(void)
{
    TEST_ASSERT_TRUE(receive("; hello\n\n:02000000aB0152\r\r\n\n:01000200 EE0F") == 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_CHARACTER, hex.problem); /* but a blank within one does */
    intel_hex_init(&hex, image, CAPACITY);
    TEST_ASSERT_TRUE(receive("; hello\n\n:02000000aB0152\r\r\n\n:01000200ee0F\n" END_RECORD) > 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_GOOD, hex.problem);
    TEST_ASSERT_EQUAL_UINT32(3, hex.size_bytes);
}

/* 0x0800 4000, where the configuration lies, as objcopy writes it from an ELF file: linear address
 * and start address. */
void test_data_may_start_at_any_address_and_cross_an_extended_address(void)
{
    TEST_ASSERT_TRUE(receive(":020000040800F2\n:02FFFE001122CE\n:020000040801F1\n:020000003344"
                             "87\n"
                             ":0400000508008201"
                             "6C\n" END_RECORD) > 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_GOOD, hex.problem);
    static const uint8_t EXPECTED[4] = {0x11, 0x22, 0x33, 0x44};
    TEST_ASSERT_EQUAL_UINT32(4, hex.size_bytes);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(EXPECTED, image, 4);
}

void test_every_single_wrong_digit_is_an_error(void)
{
    static const char GOOD[] = ":0300100001020EDC\n" END_RECORD;
    TEST_ASSERT_TRUE(receive(GOOD) > 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_GOOD, hex.problem);
    for (uint32_t at = 1; at < 17; at++) {
        static const char DIGITS[] = "0123456789ABCDEF";
        for (uint32_t d = 0; d < 16; d++) {
            char bad[sizeof GOOD];
            memcpy(bad, GOOD, sizeof GOOD);
            if (bad[at] == DIGITS[d]) {
                continue;
            }
            bad[at] = DIGITS[d];
            intel_hex_init(&hex, image, CAPACITY);
            (void)receive(bad);
            TEST_ASSERT_TRUE_MESSAGE(hex.problem != INTEL_HEX_GOOD, bad);
            TEST_ASSERT_EQUAL_UINT32_MESSAGE(1, hex.record, bad);
        }
    }
}

void test_error_has_its_record_number_and_the_rest_is_ignored_up_to_the_end(void)
{
    assert_refused(":0100000011EE\n:0100010022DD\n" END_RECORD, INTEL_HEX_CHECKSUM, 2);
    assert_refused(":0100000011EE\n:01000200"
                   "22DB\n" END_RECORD,
                   INTEL_HEX_GAP, 2);
    assert_refused(":0100000011EE\n:0100zz0022DD\n:0100020033CA\n" END_RECORD, INTEL_HEX_CHARACTER,
                   2);
    assert_refused(":0100000011EE\n:010001002\n" END_RECORD, INTEL_HEX_CHARACTER, 2);
    assert_refused(":01000000:0100000011EE\n" END_RECORD, INTEL_HEX_CHARACTER, 1);
    assert_refused(":00000006FA\n" END_RECORD, INTEL_HEX_TYPE, 1);
    assert_refused(":0100000400FB\n" END_RECORD, INTEL_HEX_TYPE, 1);
}

void test_no_byte_is_written_beyond_the_buffer_or_after_an_error(void)
{
    uint8_t guarded[CAPACITY];
    memset(guarded, 0xEE, sizeof guarded);
    intel_hex_init(&hex, guarded, 3);
    TEST_ASSERT_TRUE(receive(":020000001122CB\n:020002003344"
                             "85\n:0100020055"
                             "A8\n" END_RECORD) > 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_TOO_LARGE, hex.problem);
    TEST_ASSERT_EQUAL_UINT32(2, hex.record);
    TEST_ASSERT_EQUAL_UINT32(2, hex.size_bytes);
    for (int i = 2; i < CAPACITY; i++) {
        TEST_ASSERT_EQUAL_HEX8(0xEE, guarded[i]);
    }
}

void test_end_record_with_a_wrong_checksum_is_an_error(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, receive(":0100000011EE\n:00000001FE\n"));
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_CHECKSUM, hex.problem);
    TEST_ASSERT_TRUE(receive(END_RECORD) > 0);
}

void test_a_reader_can_be_used_again(void)
{
    assert_refused(":00000006FA\n" END_RECORD, INTEL_HEX_TYPE, 1);
    intel_hex_init(&hex, image, CAPACITY);
    TEST_ASSERT_TRUE(receive(":0100000011EE\n" END_RECORD) > 0);
    TEST_ASSERT_EQUAL_INT(INTEL_HEX_GOOD, hex.problem);
}
