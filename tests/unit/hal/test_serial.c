/* SPDX-License-Identifier: Apache-2.0 */
/* stm32/serial.c between a background and a DMA controller that writes and reads its buffers. */
#include <string.h>

#include "hal/serial.h"
#include "serial_line.h"
#include "unity.h"

enum { BIT_RATE = 115200 };

serial_model_t line;

void setUp(void)
{
    uint8_t byte;
    while (line.incoming != NULL && serial_read(&byte)) {
    }
    /* The count goes on where the last test has left it: the buffer is one for all. */
    const uint32_t left = line.left;
    serial_init(BIT_RATE);
    line.left = left > 0 ? left : line.size;
}

void tearDown(void) {}

static void arrives(uint8_t byte)
{
    line.incoming[line.size - line.left] = byte;
    line.left = line.left > 1 ? line.left - 1U : line.size;
}

void test_bytes_keep_their_order_over_many_rounds_of_the_buffer(void)
{
    uint8_t in = 0;
    uint8_t out = 0;
    uint32_t waiting = 0;
    for (int i = 0; i < 10000; i++) {
        for (int k = 0; k < 1 + i % 7 && waiting < line.size - 1U; k++, waiting++) {
            arrives(in++);
        }
        for (int k = 0; k < 1 + i % 5; k++) {
            uint8_t byte;
            TEST_ASSERT_EQUAL(waiting > 0, serial_read(&byte));
            if (waiting > 0) {
                TEST_ASSERT_EQUAL_UINT8(out++, byte);
                waiting--;
            }
        }
    }
}

void test_there_is_no_byte_to_read_before_one_arrives(void)
{
    uint8_t byte = 0x77;
    TEST_ASSERT_FALSE(serial_read(&byte));
    arrives(0x5A);
    TEST_ASSERT_TRUE(serial_read(&byte));
    TEST_ASSERT_EQUAL_HEX8(0x5A, byte);
    TEST_ASSERT_FALSE(serial_read(&byte));
}

/* Of a buffer and seven bytes that are not read the last seven are left. */
void test_what_is_not_read_in_time_is_overwritten_by_what_follows(void)
{
    for (uint32_t i = 0; i < line.size + 7U; i++) {
        arrives((uint8_t)i);
    }
    for (uint32_t i = line.size; i < line.size + 7U; i++) {
        uint8_t byte;
        TEST_ASSERT_TRUE(serial_read(&byte));
        TEST_ASSERT_EQUAL_UINT8((uint8_t)i, byte);
    }
    uint8_t byte;
    TEST_ASSERT_FALSE(serial_read(&byte));
}

void test_the_line_sends_what_was_accepted_whatever_the_caller_does_then(void)
{
    char text[] = "status";
    TEST_ASSERT_EQUAL_UINT32(6, serial_write(text, 6));
    memset(text, 'x', sizeof text);
    TEST_ASSERT_EQUAL_UINT32(6, line.sending);
    TEST_ASSERT_EQUAL_MEMORY("status", line.outgoing, 6);
}

void test_a_busy_line_accepts_no_bytes_and_sends_on(void)
{
    TEST_ASSERT_EQUAL_UINT32(3, serial_write("abc", 3));
    TEST_ASSERT_EQUAL_UINT32(0, serial_write("defg", 4));
    TEST_ASSERT_EQUAL_MEMORY("abc", line.outgoing, 3);
    line.sending = 0;
    TEST_ASSERT_EQUAL_UINT32(4, serial_write("defg", 4));
    TEST_ASSERT_EQUAL_MEMORY("defg", line.outgoing, 4);
}

/* A DMA transfer of no bytes would never end. */
void test_no_bytes_start_no_transfer(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, serial_write("", 0));
    TEST_ASSERT_TRUE(serial_line_is_free());
}

void test_a_long_text_is_taken_in_parts(void)
{
    char text[1000];
    for (unsigned i = 0; i < sizeof text; i++) {
        text[i] = (char)(' ' + i % 90U);
    }
    uint32_t sent = 0;
    for (int part = 0; part < 100 && sent < sizeof text; part++) {
        const uint32_t accepted = serial_write(&text[sent], (uint32_t)sizeof text - sent);
        TEST_ASSERT_GREATER_THAN_UINT32(0, accepted);
        TEST_ASSERT_EQUAL_MEMORY(&text[sent], line.outgoing, accepted);
        sent += accepted;
        line.sending = 0;
    }
    TEST_ASSERT_EQUAL_UINT32(sizeof text, sent);
}
