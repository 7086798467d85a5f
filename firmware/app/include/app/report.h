/* SPDX-License-Identifier: Apache-2.0 */
/*
 * report.h: status of the controller as lines of text, for the console. Background context.
 */
#ifndef APP_REPORT_H
#define APP_REPORT_H

#include <stdbool.h>
#include <stdint.h>

#include "app/boot.h"
#include "app/fault_journal.h"
#include "app/recorder.h"
#include "comms/node.h"
#include "comms/text.h"
#include "controller/controller.h"
#include "hal/crash.h"

/* Present values for the lines below. */
typedef struct {
    const slow_output_t *output;
    const torque_limits_t *limits;
    const node_t *node;
    /* Longest app_pwm_period_isr() since the start, core clock cycles; 0 if the core cannot count.
     */
    uint32_t fast_cycles_worst;
    uint32_t stack_free_bytes;
    uint32_t driver_status;             /* of the gate driver, inverter_driver_status() */
    const recorder_memory_t *black_box; /* NULL: this board has none, or no control runs */
    const fault_journal_t *journal;     /* its counts: meaningful with a black box */
    bool bus_off;
    bool control; /* the control steps run; otherwise the pointers are meaningless */
} report_status_t;

/* Program, version, commit and port. */
void report_version(text_t *line);

/* Name and checksum of an accepted configuration; the reason of a refusal. */
void report_identity(const config_t *config, text_t *line);
void report_refusal(const config_result_t *result, text_t *line);

/* Program, version, commit and port; also the name of the configuration if it was accepted. The
 * name of a refused configuration is not printed, because it may contain arbitrary bytes. */
void report_banner(const boot_report_t *boot, text_t *line);

/* Line `number` (from 0) of the results of the self-tests, with the field for which a
 * configuration was refused. False if there is no such line; likewise below. */
bool report_boot(const boot_report_t *boot, uint32_t number, text_t *line);

/* Adds by what the program was started. */
void report_start(reset_cause_t cause, text_t *line);

/* Mode, reason, torque, speed, bus, and load of the core, in one line. */
void report_status(const report_status_t *status, text_t *line);

/* The table of torque limits (torque_limits.h): the tightest bound for driving and for braking with
 * its reason, then one line for each line of the table with both bounds in N m; "-" means
 * unbounded, "*" marks the tightest. `limits` must be the same table for all lines of an answer. */
bool report_limits(const report_status_t *status, const torque_limits_t *limits, uint32_t number,
                   text_t *line);

/* One line for each sender that this wheel receives, with its error counts since the start. */
bool report_can(const report_status_t *status, uint32_t number, text_t *line);

/* For each fault (core/reason.h) whose name begins with `prefix`: number, name, meaning and what
 * the driver is told; then a line for each check that finds it (core/findings.h): qualify time, of
 * an accepted configuration with the value of its field, reaction, clearing, and the heal time. */
bool report_faults(const boot_report_t *boot, const char *prefix, uint32_t number, text_t *line);

/* What the black box holds, the counters of faults and starts that are not zero, and the
 * whole memory as hex, 32 bytes a line after their offset: what `hubsim blackbox` reads. */
bool report_black_box(const report_status_t *status, uint32_t number, text_t *line);

/* The latest crash (hal/crash.h): its cause and where; then the registers. crash: NULL if there was
 * none. */
bool report_crash(const crash_record_t *crash, uint32_t number, text_t *line);

/* Name, checksum and versions; then the fields whose names begin with `prefix`. */
bool report_config(const boot_report_t *boot, const char *prefix, uint32_t number, text_t *line);

#endif
