/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/line_edit.h"

enum { BELL = 0x07, BACKSPACE = 0x08, CANCEL = 0x03, KILL = 0x15, ESCAPE = 0x1B, DELETE = 0x7F };

void line_edit_init(line_edit_t *edit)
{
    edit->line[0] = '\0';
    edit->length = 0;
    edit->last[0] = '\0';
    edit->key = LINE_EDIT_PLAIN;
    edit->after_return = false;
}

static void add_char(text_t *echo, char c)
{
    const char chars[] = {c, '\0'};
    text_add(echo, chars);
}

static void type(line_edit_t *edit, char c, text_t *echo)
{
    if (edit->length == LINE_EDIT_CHARS) {
        add_char(echo, BELL);
        return;
    }
    edit->line[edit->length] = c;
    edit->length++;
    add_char(echo, c);
}

static void take_back(line_edit_t *edit, text_t *echo)
{
    if (edit->length > 0) {
        edit->length--;
        text_add(echo, "\b \b");
    }
}

/* To the first column, and the line's remains off the screen (ECMA-48, EL). */
static void take_all_back(line_edit_t *edit, text_t *echo)
{
    edit->length = 0;
    text_add(echo, "\r\x1B[K" LINE_EDIT_PROMPT);
}

static void bring_back_last(line_edit_t *edit, text_t *echo)
{
    take_all_back(edit, echo);
    for (uint32_t i = 0; edit->last[i] != '\0'; i++) {
        type(edit, edit->last[i], echo);
    }
}

/* ESC [, parameters, and one final character (ECMA-48, CSI). Anything but a printable character
 * ends a sequence that was cut off, and is a key: otherwise it would take away a ^C. */
static bool is_part_of_sequence(line_edit_t *edit, uint8_t byte, text_t *echo)
{
    switch (edit->key) {
    case LINE_EDIT_PLAIN:
        return false;
    case LINE_EDIT_ESCAPE:
        edit->key = byte == '[' ? LINE_EDIT_SEQUENCE : LINE_EDIT_PLAIN;
        return byte == '[';
    case LINE_EDIT_SEQUENCE:
        if (byte < ' ' || byte > '~') {
            edit->key = LINE_EDIT_PLAIN;
            return false;
        }
        if (byte >= '@') {
            edit->key = LINE_EDIT_PLAIN;
            if (byte == 'A') {
                bring_back_last(edit, echo);
            }
        }
        return true;
    }
    return false;
}

static void finish(line_edit_t *edit)
{
    uint32_t first = 0;
    uint32_t end = edit->length;
    while (first < end && edit->line[first] == ' ') {
        first++;
    }
    while (end > first && edit->line[end - 1U] == ' ') {
        end--;
    }
    for (uint32_t i = first; i < end; i++) {
        edit->line[i - first] = edit->line[i];
    }
    edit->line[end - first] = '\0';
    edit->length = 0;
    for (uint32_t i = 0; end > first && i <= end - first; i++) {
        edit->last[i] = edit->line[i];
    }
}

static line_edit_event_t end_line(line_edit_t *edit, uint8_t byte, text_t *echo)
{
    const bool second_half = byte == '\n' && edit->after_return;
    edit->after_return = byte == '\r';
    if (second_half) {
        return LINE_EDIT_GOES_ON;
    }
    finish(edit);
    text_add(echo, "\r\n");
    return LINE_EDIT_ENDED;
}

line_edit_event_t line_edit_receive(line_edit_t *edit, uint8_t byte, text_t *echo)
{
    if (is_part_of_sequence(edit, byte, echo)) {
        return LINE_EDIT_GOES_ON;
    }
    if (byte == '\r' || byte == '\n') {
        return end_line(edit, byte, echo);
    }
    edit->after_return = false;
    if (byte == CANCEL) {
        edit->length = 0;
        text_add(echo, "^C\r\n" LINE_EDIT_PROMPT);
        return LINE_EDIT_CANCELLED;
    }
    if (byte == BACKSPACE || byte == DELETE) {
        take_back(edit, echo);
    } else if (byte == KILL) {
        take_all_back(edit, echo);
    } else if (byte == ESCAPE) {
        edit->key = LINE_EDIT_ESCAPE;
    } else if (byte >= ' ' && byte <= '~') {
        type(edit, (char)byte, echo);
    }
    return LINE_EDIT_GOES_ON;
}
