/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/text.h"

static void add_char(text_t *text, char c)
{
    if (text->length + 1U < TEXT_CAPACITY) {
        text->chars[text->length] = c;
        text->length++;
        text->chars[text->length] = '\0';
    }
}

void text_clear(text_t *text)
{
    text->length = 0;
    text->chars[0] = '\0';
}

void text_add(text_t *text, const char *chars)
{
    for (uint32_t i = 0; chars[i] != '\0'; i++) {
        add_char(text, chars[i]);
    }
}

void text_add_decimal(text_t *text, int32_t value, uint32_t decimals)
{
    char digits[12]; /* in reverse; ten digits, a point and a leading zero */
    uint32_t count = 0;
    uint32_t rest = value < 0 ? 0U - (uint32_t)value : (uint32_t)value;
    uint32_t places = 0;
    while (rest > 0 || places <= decimals) {
        if (places == decimals && decimals > 0) {
            digits[count++] = '.';
        }
        digits[count++] = (char)('0' + (char)(rest % 10U));
        rest /= 10U;
        places++;
    }
    if (value < 0) {
        add_char(text, '-');
    }
    while (count > 0) {
        add_char(text, digits[--count]);
    }
}

void text_add_integer(text_t *text, int32_t value)
{
    text_add_decimal(text, value, 0);
}

void text_add_hex(text_t *text, uint32_t value)
{
    text_add(text, "0x");
    for (uint32_t shift = 32; shift > 0; shift -= 4) {
        add_char(text, "0123456789ABCDEF"[(value >> (shift - 4U)) & 0xFU]);
    }
}

bool text_begins_with(const char *chars, const char *prefix)
{
    uint32_t i = 0;
    while (prefix[i] != '\0' && prefix[i] == chars[i]) {
        i++;
    }
    return prefix[i] == '\0';
}

void text_add_until(text_t *text, uint32_t column)
{
    add_char(text, ' ');
    while (text->length < column && text->length + 1U < TEXT_CAPACITY) {
        add_char(text, ' ');
    }
}
