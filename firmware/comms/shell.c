/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/shell.h"

#include <stddef.h>

#include "core/reason.h"

enum { HELP_COLUMN = 20, NAME_COLUMN = 4, MEANING_COLUMN = 30, CANCEL = 0x03 };
enum { LONGEST_LINE = TEXT_CAPACITY + 1 /* without its zero, with its end */ };

/* Indices of commands: the shell's own, then the owner's, then these. */
enum { HELP, REASONS, OWN_COUNT };
static const uint32_t NO_COMMAND = UINT32_MAX;
static const uint32_t UNKNOWN = UINT32_MAX - 1U;

static const shell_command_t OWN[OWN_COUNT] = {
    [HELP] = {"help", "", "this list"},
    [REASONS] = {"reasons", "", "number, name and meaning of every limit and fault"},
};

void shell_init(shell_t *shell, const shell_command_t *commands, uint32_t command_count)
{
    /* Field by field: a whole one on the stack, only to be copied, would be the deepest point of
     * the firmware. */
    shell->commands = commands;
    shell->command_count = command_count;
    line_edit_init(&shell->edit);
    shell->ahead_bytes = 0;
    shell->words[0] = '\0';
    shell->argument = shell->words;
    shell->running = NO_COMMAND;
    shell->next_line = 0;
    shell->pending_bytes = 0;
    shell->sent_bytes = 0;
}

text_t *shell_line(shell_t *shell)
{
    text_clear(&shell->line);
    return &shell->line;
}

/* ---- output buffer ---- */

static uint32_t free_bytes(const shell_t *shell)
{
    return SHELL_PENDING_BYTES - shell->pending_bytes;
}

/* Moves the unsent bytes to the front, only when space is needed. */
static void move_to_front(shell_t *shell)
{
    for (uint32_t i = shell->sent_bytes; i < shell->pending_bytes; i++) {
        shell->waiting[i - shell->sent_bytes] = shell->waiting[i];
    }
    shell->pending_bytes -= shell->sent_bytes;
    shell->sent_bytes = 0;
}

static bool has_space(shell_t *shell, uint32_t count)
{
    if (count > free_bytes(shell)) {
        move_to_front(shell);
    }
    return count <= free_bytes(shell);
}

/* All bytes or none. */
static bool put(shell_t *shell, const char *chars, uint32_t count)
{
    if (!has_space(shell, count)) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        shell->waiting[shell->pending_bytes + i] = chars[i];
    }
    shell->pending_bytes += count;
    return true;
}

static bool put_line(shell_t *shell, const text_t *line)
{
    static const char END[] = {'\r', '\n'};
    return has_space(shell, line->length + (uint32_t)sizeof END) &&
           put(shell, line->chars, line->length) && put(shell, END, sizeof END);
}

/* Dropped when the buffer is full, as an echo is. */
static void put_prompt(shell_t *shell)
{
    static const char PROMPT[] = LINE_EDIT_PROMPT;
    (void)put(shell, PROMPT, sizeof PROMPT - 1U);
}

void shell_print(shell_t *shell, const text_t *line)
{
    (void)put_line(shell, line);
}

void shell_sent(shell_t *shell, uint32_t count)
{
    const uint32_t left = shell->pending_bytes - shell->sent_bytes;
    shell->sent_bytes += count < left ? count : left;
}

bool shell_idle(const shell_t *shell)
{
    return shell->running == NO_COMMAND && shell->ahead_bytes == 0 &&
           shell->sent_bytes == shell->pending_bytes;
}

/* ---- the shell's own commands ---- */

static uint32_t count_of_commands(const shell_t *shell)
{
    return OWN_COUNT + shell->command_count;
}

static const shell_command_t *command_at(const shell_t *shell, uint32_t index)
{
    return index < OWN_COUNT ? &OWN[index] : &shell->commands[index - OWN_COUNT];
}

static bool answer_help(const shell_t *shell, uint32_t number, text_t *line)
{
    if (number >= count_of_commands(shell)) {
        return false;
    }
    const shell_command_t *command = command_at(shell, number);
    text_add(line, command->name);
    text_add(line, " ");
    text_add(line, command->argument);
    text_add_until(line, HELP_COLUMN);
    text_add(line, command->help);
    return true;
}

static bool answer_reasons(uint32_t number, text_t *line)
{
    reason_t reason;
    if (!reason_listed(number, &reason)) {
        return false;
    }
    text_add_integer(line, (int32_t)reason);
    text_add_until(line, NAME_COLUMN);
    text_add(line, reason_name(reason));
    text_add_until(line, MEANING_COLUMN);
    text_add(line, reason_text(reason));
    return true;
}

static bool answer_unknown(const shell_t *shell, uint32_t number, text_t *line)
{
    text_add(line, shell->words);
    text_add(line, ": unknown; help lists the commands");
    return number == 0;
}

static bool answer_itself(const shell_t *shell, text_t *line)
{
    switch (shell->running) {
    case HELP:
        return answer_help(shell, shell->next_line, line);
    case REASONS:
        return answer_reasons(shell->next_line, line);
    default:
        return answer_unknown(shell, shell->next_line, line);
    }
}

/* ---- from a line to an answer ---- */

static bool same(const char *a, const char *b)
{
    uint32_t i = 0;
    while (a[i] != '\0' && a[i] == b[i]) {
        i++;
    }
    return a[i] == b[i];
}

/* Keeps the line, cut into its first word and the rest. */
static void split_line(shell_t *shell)
{
    uint32_t length = 0;
    for (; shell->edit.line[length] != '\0'; length++) {
        shell->words[length] = shell->edit.line[length];
    }
    shell->words[length] = '\0';
    uint32_t end = 0;
    while (end < length && shell->words[end] != ' ') {
        end++;
    }
    uint32_t rest = end;
    while (rest < length && shell->words[rest] == ' ') {
        rest++;
    }
    shell->words[end] = '\0';
    shell->argument = &shell->words[rest];
}

static void begin_answer(shell_t *shell)
{
    split_line(shell);
    if (shell->words[0] == '\0') {
        put_prompt(shell);
        return;
    }
    shell->next_line = 0;
    shell->running = UNKNOWN;
    for (uint32_t i = 0; i < count_of_commands(shell); i++) {
        if (same(shell->words, command_at(shell, i)->name)) {
            shell->running = i;
        }
    }
}

static void process_key(shell_t *shell, uint8_t byte)
{
    text_t *echo = shell_line(shell);
    const line_edit_event_t event = line_edit_receive(&shell->edit, byte, echo);
    (void)put(shell, echo->chars, echo->length);
    if (event == LINE_EDIT_ENDED) {
        begin_answer(shell);
    } else if (event == LINE_EDIT_CANCELLED) {
        shell->running = NO_COMMAND;
    }
}

void shell_receive(shell_t *shell, uint8_t byte)
{
    if (shell->running == NO_COMMAND && shell->ahead_bytes == 0) {
        process_key(shell, byte);
    } else if (byte == CANCEL) {
        shell->ahead_bytes = 0;
        process_key(shell, byte);
    } else if (shell->ahead_bytes < SHELL_AHEAD_BYTES) {
        shell->ahead[shell->ahead_bytes] = byte;
        shell->ahead_bytes++;
    }
}

void shell_answer(shell_t *shell, const text_t *line)
{
    (void)put_line(shell, line); /* has space: shell_next_request() checked it */
    shell->next_line++;
}

void shell_answered(shell_t *shell)
{
    shell->running = NO_COMMAND;
    put_prompt(shell);
}

static bool is_owners(const shell_t *shell)
{
    return shell->running >= OWN_COUNT && shell->running < count_of_commands(shell);
}

static void process_typed_ahead(shell_t *shell)
{
    uint32_t done = 0;
    while (done < shell->ahead_bytes && shell->running == NO_COMMAND) {
        process_key(shell, shell->ahead[done]);
        done++;
    }
    for (uint32_t i = done; i < shell->ahead_bytes; i++) {
        shell->ahead[i - done] = shell->ahead[i];
    }
    shell->ahead_bytes -= done;
}

bool shell_next_request(shell_t *shell, shell_request_t *question)
{
    process_typed_ahead(shell);
    while (shell->running != NO_COMMAND && has_space(shell, LONGEST_LINE)) {
        if (is_owners(shell)) {
            const shell_request_t asked = {shell->running - OWN_COUNT, shell->argument,
                                           shell->next_line};
            *question = asked;
            return true;
        }
        text_t *line = shell_line(shell);
        if (answer_itself(shell, line)) {
            shell_answer(shell, line);
        } else {
            shell_answered(shell);
            process_typed_ahead(shell);
        }
    }
    return false;
}

uint32_t shell_pending(const shell_t *shell, const char **bytes)
{
    *bytes = &shell->waiting[shell->sent_bytes];
    return shell->pending_bytes - shell->sent_bytes;
}
