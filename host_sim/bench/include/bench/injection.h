/* SPDX-License-Identifier: Apache-2.0 */
/*
 * injection.h: faults of the program in one wheel's controller: steps that are missing, late or
 * doubled, a restart, a bit that flips.
 *
 * Around them stands what the board does: the watchdog of app/supervisor.h restarts the core after
 * SUPERVISOR_TIMEOUT_ms in which steps were missing or their rates were off by more than a quarter,
 * and again for as long as the cause stays: bridge off, no messages. What the application retains
 * over a reset is retained here, unless the supply went. Before that it switches a
 * bridge off that gets no fast step, and its background says so if the slow loop stands still. The
 * brake system takes its own path once the counter of the wheel's messages has stood still for five
 * cycles. A flipped bit of the configuration is found as app/background_check.h finds it: in parts,
 * once each round. The background's look at the fast monitor's trip and limits (app.c) takes two of
 * about ten passes a millisecond, so here it is done once in each: from the next slow step on the
 * self-test counts as failed, until a restart.
 */
#ifndef BENCH_INJECTION_H
#define BENCH_INJECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/controller.h"
#include "plant/fault.h"

enum {
    INJECTION_WATCHDOG_MS = 25,
    INJECTION_SLOW_STOPPED_MS = 5, /* the application names a slow loop that stands still */
    /* Without a fast step a port's stop timer switches a switching bridge off, within a period
     * less than this; the application any. */
    INJECTION_STOPPED_PERIODS = 2,
    INJECTION_FAST_STOPPED_MS = 3,
    INJECTION_MESSAGES_LOST_MS = 50,
    INJECTION_LATE_MS_MAX = 1000
};

/* All zero: no fault yet. */
typedef struct {
    bool has_restarted, has_flipped, has_late;
    bool in_reset;
    int reset_ms;                      /* left of a restart that takes its time */
    bool memory_damaged;               /* found by the background */
    int unfed_ms;                      /* since the watchdog was fed */
    int silent_ms;                     /* since the slow step made a message */
    int fast_missing_ms, fast_missing; /* since a fast step, milliseconds and PWM periods; the
                                          bridge stays off until the restart */
    fast_setpoint_t late_setpoint;
    fast_output_t late_output;
    double commands_nm[INJECTION_LATE_MS_MAX + 1]; /* to the hydraulic brake */
    int next_command;
    int flickers_ms;     /* since the hydraulic brake or its sensor began to flicker */
    double report_drift; /* of that sensor, share of the torque */
} injection_t;

/* One controller with what lies between its two steps. */
typedef struct {
    controller_t *controller;
    const config_t *config;
    fast_setpoint_t *to_fast;
} injection_target_t;

/* The application's background check, 640 bytes of configuration and program a millisecond. */
enum { CONFIG_WATCH_BYTES = 640, CONFIG_WATCH_PROGRAM_MS = 205 /* 128 KiB */ };

/* All zero: at the beginning of a round. */
typedef struct {
    uint32_t at_bytes, crc;
    uint32_t program_ms; /* left until the configuration is read again */
    bool damaged;        /* for ever, as in the application */
} config_watch_t;

/* Once per millisecond. Returns watch->damaged. */
bool config_watch_step(config_watch_t *watch, const config_t *config);

bool injection_present(const fault_params_t *params);

/* Instead of the slow step; last: what it returned before. */
slow_output_t injection_slow(const fault_params_t *params, injection_t *state,
                             const injection_target_t *target, const slow_input_t *in,
                             const slow_output_t *last);

/* Instead of the fast step; next: what the bridge does from the next period on. */
void injection_fast(const fault_params_t *params, injection_t *state,
                    const injection_target_t *target, const fast_input_t *in, fast_output_t *next);

/* Once per millisecond: the command that reaches the hydraulic brake, late by
 * params->hydraulic_late_s. */
double injection_hydraulic_nm(const fault_params_t *params, injection_t *state, double command_nm);

/* Once per millisecond: what flickers and drifts at the hydraulic brake. */
void injection_brake_step(const fault_params_t *params, injection_t *state);

/* Share of the hydraulic torque that the brake makes now. */
double injection_brake_share(const fault_params_t *params, const injection_t *state);

/* What the hydraulic brake's sensor reports now: with another gain, a share of the largest torque
 * more, or stuck. */
double injection_report_nm(const fault_params_t *params, const injection_t *state,
                           double reported_nm, double largest_nm);

#endif
