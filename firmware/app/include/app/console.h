/* SPDX-License-Identifier: Apache-2.0 */
/*
 * console.h: moves bytes between the serial line and the shell, and answers the shell's commands.
 *
 *     status            mode, reason, torque, speed, bus, once
 *     watch             the same every second, until a key is typed
 *     limits            every torque limit, which one is the tightest, and why
 *     faults [PREFIX]   the table of faults: times, reaction, clearing, driver
 *     blackbox          the record of the first fault (app/recorder.h), counts of faults
 *     crash             the latest fault of the core or failed check (hal/crash.h)
 *     can               received frames and errors of each sender
 *     boot              what the self-tests found
 *     config [PREFIX]   the configuration's fields
 *     version           program, version, commit, port
 *     install           another configuration, as Intel HEX (installer.h)
 *     off               lets the board's supply go
 *     bootloader        restarts in the chip's own bootloader
 *     xcp               turns the line over to XCP (console_xcp.h)
 *     help, reasons     commands of the shell itself (shell.h)
 *
 * Background context; never blocks. When the buffer is full, a line that is not part of an answer
 * is dropped as a whole and counted.
 *
 * After `xcp` the line is a tool's (console_xcp.h); what is printed meanwhile follows then.
 */
#ifndef APP_CONSOLE_H
#define APP_CONSOLE_H

#include <stdbool.h>
#include <stdint.h>

#include "app/boot.h"
#include "app/console_xcp.h"
#include "app/installer.h"
#include "app/report.h"
#include "comms/shell.h"
#include "comms/text.h"

enum { CONSOLE_WATCH_PERIOD_ms = 1000 };

typedef struct {
    shell_t shell;
    const boot_report_t *boot;
    report_status_t status; /* of the latest pump */
    torque_limits_t limits; /* copy for the answer that is being printed */
    uint32_t watched_ms;    /* time of the latest line of `watch` */
    uint32_t now_ms;        /* of the latest pump */
    bool watching;          /* `watch` repeats the status line */
    bool off_wanted;        /* `off` has been typed */
    bool bootloader_wanted; /* likewise */
    installer_t installer;
    console_xcp_t xcp;
} console_t;

/* boot: must stay valid; may be filled in later. */
void console_init(console_t *console, const boot_report_t *boot);

/* Prints the banner and the results of the self-tests. */
void console_greet(console_t *console);

/* Prints the status line once, without a command. */
void console_status(console_t *console, const report_status_t *status);

/* An empty line for console_print(); any other function of the console may change it. */
text_t *console_line(console_t *console);

/* Prints one line that is not an answer to a command. */
void console_print(console_t *console, const text_t *line);

/* True if all output has been given to the serial line. */
bool console_drained(const console_t *console);

/* True once, when `off` has been typed. */
bool console_wants_off(console_t *console);

/* Lets the board's supply go if that is permitted, and prints what came of it. Where there is none
 * to let go, or the button is pressed, control goes on. */
void console_switch_off(console_t *console, bool permitted);

/* True once, when `bootloader` has been typed. */
bool console_wants_bootloader(console_t *console);

/* Requests the bootloader for the next reset if that is permitted, and prints what came of it.
 * True: requested; the caller stops control and feeding the watchdog. */
bool console_request_bootloader(console_t *console, bool permitted);

/* Prints why a staging page is refused. */
void console_refuse_staging(console_t *console, const config_result_t *result);

/* True once, when a configuration has been received and accepted. */
bool console_has_accepted(console_t *console);

/* Writes that configuration (installer_write() has the preconditions) and prints the result; not
 * permitted: prints only that it is refused. */
void console_install(console_t *console, bool permitted);

/* Background context, every pass: passes received bytes to the shell and its output to the serial
 * line. */
void console_pump(console_t *console, uint32_t now_ms, const report_status_t *status);

#endif
