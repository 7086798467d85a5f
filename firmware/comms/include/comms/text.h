/* SPDX-License-Identifier: Apache-2.0 */
/*
 * text.h: lines of text in a buffer of fixed size, without stdio. Text that does not fit
 * is cut off; the text is always zero-terminated.
 */
#ifndef COMMS_TEXT_H
#define COMMS_TEXT_H

#include <stdbool.h>
#include <stdint.h>

enum { TEXT_CAPACITY = 256 };

typedef struct {
    char chars[TEXT_CAPACITY];
    uint32_t length; /* without the terminating zero */
} text_t;

void text_clear(text_t *text);
void text_add(text_t *text, const char *chars);
void text_add_integer(text_t *text, int32_t value);
/* value * 10^-decimals, e.g. 53012 with 3 decimals: 53.012; decimals 0 .. 9. */
void text_add_decimal(text_t *text, int32_t value, uint32_t decimals);
/* Blanks up to a column, at least one. */
void text_add_until(text_t *text, uint32_t column);
/* 0x and eight digits. */
void text_add_hex(text_t *text, uint32_t value);
/* The first characters of `chars` are `prefix`; every text begins with an empty one. */
bool text_begins_with(const char *chars, const char *prefix);

#endif
