/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shell.h: a line of typing in, lines of answer out; for people on a serial line.
 *
 * The owner passes received bytes to shell_receive(), answers what shell_next_request(), and
 * carries the bytes of shell_pending() away with shell_sent(), as fast or as slowly as its line is.
 * Pure: no clock, no hardware, nothing allocated, no pointers to functions (the depth of the stack
 * stays countable). What can be typed is the owner's list of commands and two of the shell's own:
 * help, made from that list, and reasons, made from core/reason.h. A command is answered line by
 * line, and the next line is asked for only when there is room, so an answer may be far longer than
 * the buffer and nothing of it is lost. What is typed meanwhile waits; ^C ends the answer. The keys
 * are line_edit.h's.
 *
 * The shell by itself only shows: it has no way to move the wheel or to change a limit.
 */
#ifndef COMMS_SHELL_H
#define COMMS_SHELL_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/line_edit.h"
#include "comms/text.h"

enum { SHELL_PENDING_BYTES = 1024, SHELL_AHEAD_BYTES = 128 };

typedef struct {
    const char *name;
    const char *argument; /* as help shows it; "" if the command takes none */
    const char *help;
} shell_command_t;

typedef struct {
    uint32_t command;     /* index into the owner's list */
    const char *argument; /* what followed the command; "" if nothing */
    uint32_t number;      /* of the line, from 0 */
} shell_request_t;

typedef struct {
    const shell_command_t *commands; /* the owner's */
    uint32_t command_count;

    line_edit_t edit;
    uint8_t ahead[SHELL_AHEAD_BYTES]; /* typed while an answer is being written */
    uint32_t ahead_bytes;

    char words[LINE_EDIT_CHARS + 1]; /* command and argument of the running answer */
    const char *argument;
    uint32_t running; /* the command that is being answered */
    uint32_t next_line;

    char waiting[SHELL_PENDING_BYTES];
    uint32_t pending_bytes; /* in the buffer; the first `sent_bytes` of them are gone */
    uint32_t sent_bytes;
    uint32_t dropped_lines;
} shell_t;

void shell_init(shell_t *shell, const shell_command_t *commands, uint32_t command_count);

/* One byte that was typed. */
void shell_receive(shell_t *shell, uint8_t byte);

/* A line nobody asked for; its end of line is added. Dropped whole and counted if there is no room.
 */
void shell_print(shell_t *shell, const text_t *line);

/* True if one of the owner's commands has been typed and there is room for the next line of its
 * answer. To be answered with shell_answer(), or with shell_answered() when there is no such line.
 */
bool shell_next_request(shell_t *shell, shell_request_t *question);
void shell_answer(shell_t *shell, const text_t *line);
void shell_answered(shell_t *shell);

/* What is to be sent now: its address, and how many bytes. */
uint32_t shell_pending(const shell_t *shell, const char **bytes);

/* That many of them have been sent. */
void shell_sent(shell_t *shell, uint32_t count);

/* Is everything sent, answered and understood? */
bool shell_idle(const shell_t *shell);

#endif
