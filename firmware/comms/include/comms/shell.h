/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shell.h: command lines in, lines of answer out, on a serial terminal. Background context.
 *
 * The owner passes received bytes to shell_receive(), answers shell_next_request(), sends the bytes
 * of shell_pending() and reports them with shell_sent(), at any rate. Pure: no clock, no hardware,
 * no allocation, no pointers to functions (so the stack depth can be computed). The commands
 * are the owner's list and two of the shell's own: help, made from that list, and reasons, made
 * from core/reason.h. An answer is made line by line, and the next line is requested only when the
 * buffer has space for it, so an answer may be longer than the buffer. Keys typed meanwhile are
 * kept; ^C ends the answer. Editing: line_edit.h.
 *
 * The shell is read-only: it can neither move the wheel nor change a limit.
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
    const char *argument; /* the text after the command; "" if there is none */
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

    text_t line; /* shell_line() */
    char waiting[SHELL_PENDING_BYTES];
    uint32_t pending_bytes; /* in the buffer; the first `sent_bytes` of them are sent */
    uint32_t sent_bytes;
} shell_t;

void shell_init(shell_t *shell, const shell_command_t *commands, uint32_t command_count);

/* An empty line, to be filled in for shell_print() or shell_answer(): the shell's own, so that no
 * line needs stack. Any other function of the shell may change it. */
text_t *shell_line(shell_t *shell);

/* One byte that was typed. */
void shell_receive(shell_t *shell, uint8_t byte);

/* A line that is not an answer; its end of line is added. Dropped whole if the buffer is full. */
void shell_print(shell_t *shell, const text_t *line);

/* True if one of the owner's commands has been typed and the buffer has space for the next line of
 * its answer. To be answered with shell_answer(), or with shell_answered() when there is no such
 * line.
 */
bool shell_next_request(shell_t *shell, shell_request_t *question);
void shell_answer(shell_t *shell, const text_t *line);
void shell_answered(shell_t *shell);

/* The bytes to be sent: their address and number. */
uint32_t shell_pending(const shell_t *shell, const char **bytes);

/* That many of them have been sent. */
void shell_sent(shell_t *shell, uint32_t count);

/* True if all input is processed and all output sent. */
bool shell_idle(const shell_t *shell);

#endif
