/* SPDX-License-Identifier: Apache-2.0 */
/*
 * line_edit.h: edits a line from the keys of a terminal. Background context.
 *
 * Printable characters are echoed; backspace and delete remove one; ^U clears the line; ^C cancels;
 * the arrow up recalls the last line; CR, LF or CR LF end a line. Other keys are ignored; a full
 * line rings the bell. The output for the terminal is returned as text.
 */
#ifndef COMMS_LINE_EDIT_H
#define COMMS_LINE_EDIT_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/text.h"

#define LINE_EDIT_PROMPT "> "

enum { LINE_EDIT_CHARS = 64 };

typedef enum { LINE_EDIT_GOES_ON, LINE_EDIT_ENDED, LINE_EDIT_CANCELLED } line_edit_event_t;

typedef enum { LINE_EDIT_PLAIN = 0, LINE_EDIT_ESCAPE = 1, LINE_EDIT_SEQUENCE = 2 } line_edit_key_t;

typedef struct {
    char line[LINE_EDIT_CHARS + 1]; /* after LINE_EDIT_ENDED and until the next key: what was typed,
                                       without blanks around it */
    uint32_t length;
    char last[LINE_EDIT_CHARS + 1]; /* the last line that was not empty */
    line_edit_key_t key;
    bool after_return; /* so that CR LF ends one line, not two */
} line_edit_t;

void line_edit_init(line_edit_t *edit);

/* One typed byte. Adds the output for the terminal to `echo`; TEXT_CAPACITY suffices. */
line_edit_event_t line_edit_receive(line_edit_t *edit, uint8_t byte, text_t *echo);

#endif
