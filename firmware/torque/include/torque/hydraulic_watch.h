/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_watch.h: is the torque of the hydraulic brake the commanded one? 1 kHz.
 *
 * The braking that the wheel's deceleration does not show, beside what motor and hydraulic brake
 * should make, is
 *
 *     missing = inertia * acceleration + air drag - (motor torque - hydraulic torque expected) -
 * road
 *
 * with torques along the rotation, all filtered alike (64 ms). `road`, slope and rolling
 * resistance, follows no faster than brake.hydraulic_watch_road allows for the distance rolled, and
 * waits for up to HYDRAULIC_WATCH_AWAITS_ms while the brake answers a new command.
 * What is missing, or in excess, beyond the tolerance is summed: floor, three quarters of what the
 * brake's times leave open, and a share of both torques, without reports for no longer than the
 * road takes to follow a fifth of the brake's torque and a tenth of all known. The inertia is
 * learned from steps of the motor torque without the hydraulic brake, within
 * HYDRAULIC_WATCH_LIGHTEST and _HEAVIEST. A sum of brake.hydraulic_watch_speed times the inertia is
 * a finding:
 *
 *     missing             HYDRAULIC_WEAK; HYDRAULIC_DEAD if it stays below a quarter for a second
 *     in excess           HYDRAULIC_STRONG; HYDRAULIC_STUCK if next to no torque is commanded
 *     first missing, then there within 1.5 s                                       HYDRAULIC_LATE
 *
 * A road that is acquired while the brake makes torque already holds what that misses. It shows a
 * brake that fails later, and is acquired anew once no torque is commanded.
 *
 * With reports of the torque that contradict the commands, the deceleration decides which of the
 * two is wrong, by half of their difference; a third of the sum suffices. Reports that agree leave
 * nothing to find. A finding corrects the torque that is expected from then on, so that its
 * opposite ends it; an acknowledgement at rest ends it as well. A brake that its reports show to be
 * short is so until they agree, for brake.hydraulic_timeout, with a command large enough to tell,
 * or are missing. Derivation and false alarms: DERIVATIONS.md, Watch of the hydraulic
 * brake.
 */
#ifndef TORQUE_HYDRAULIC_WATCH_H
#define TORQUE_HYDRAULIC_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/filter.h"
#include "core/reason.h"

enum {
    HYDRAULIC_WATCH_ACQUIRE_ms = 512, /* road unknown: after a start, or when the wheel reversed */
    HYDRAULIC_WATCH_QUIET_ms = 512,   /* without hydraulic torque, until the inertia is learned */
    HYDRAULIC_WATCH_SETTLE_ms = 256,  /* of the filters, after a finding has corrected the torque */
    HYDRAULIC_WATCH_PAUSE_ms = 300,   /* after a wheel that slipped */
    HYDRAULIC_WATCH_AWAITS_ms = 512,  /* longest change of the brake for which the road waits */
    HYDRAULIC_WATCH_ENDS_ms = 384,    /* before standstill, where halls say little */
    HYDRAULIC_WATCH_ROLLS_ON_ms = 448,
    HYDRAULIC_WATCH_DEAD_ms = 1000,
    HYDRAULIC_WATCH_LATE_ms = 1500
};

#define HYDRAULIC_WATCH_LIGHTEST_Q15 19661 /* 0.6 of the configured inertia */
#define HYDRAULIC_WATCH_HEAVIEST_Q15 55706 /* 1.7 */

typedef struct {
    int32_t speed_mrad_s;    /* mechanical, signed */
    int32_t motor_mNm;       /* estimated from measured currents, at the shaft, signed */
    int32_t modelled_mNm;    /* measured, or by the model of a brake as configured, magnitude */
    int32_t commanded_mNm;   /* by that model, magnitude */
    int32_t uncertain_mNm;   /* between a brake twice as early and one twice as late, >= 0 */
    int32_t contradicts_mNm; /* report beyond (> 0) or short of (< 0) what the commands explain */
    int32_t reported_mNm;    /* last report, magnitude */
    int32_t outside_ms;      /* used reports are beyond (> 0) the band, short of (< 0) the gain */
    bool reported;           /* reports arrive in time */
    bool trusted;            /* speed and motor torque are valid, and no wheel slips */
    bool acknowledged;       /* by the driver, at rest */
} hydraulic_watch_input_t;

typedef struct {
    reason_t reason;             /* the finding, REASON_NONE: none */
    int32_t gain_q15, extra_mNm; /* of the torque: gain * modelled + extra */
    int32_t road_q8_mNm;         /* all but motor and hydraulic brake, along the rotation */
    int32_t inertial_mNm;        /* along the rotation, with the configured inertia */
    int32_t quarter_q8_mNm; /* of the inertial torque in which it was followed; as configured */
    int32_t hydraulic_q4_mNm, known_q4_mNm; /* of which the road has followed an error */
    int32_t road_mNm; /* of this step, or when the wheel last rolled: road and what is missing */
    int32_t speed_lp_q8_mrad_s;
    filter_t known_lp_mNm, motor_lp_mNm;
    filter_t known_slow_mNm, inertial_slow_mNm; /* what has lasted for a quarter of a second */
    int64_t known_square, known_by_inertial;    /* of steps of the motor torque alone, fading */
    int32_t weight_q15; /* inertia over the configured one, learned; 32 768 = 1.0 */
    int32_t missing_mNm_ms, excess_mNm_ms; /* sums beyond the tolerance */
    int32_t report_mNm_ms;                 /* > 0: the brake is wrong, < 0: its sensor */
    int32_t acquired_ms, pause_ms, found_ms, quiet_ms;
    int32_t agrees_ms;   /* reports show a brake as commanded for so long */
    int32_t certain_ms;  /* of the brake's torque, less the time of changes */
    int32_t rolls_on_ms; /* left of HYDRAULIC_WATCH_ROLLS_ON_ms */
    bool rolls, backwards;
    bool stale;           /* the road was last followed before a standstill */
    bool provisional;     /* the road was acquired while the hydraulic brake made torque */
    bool by_report;       /* found by reports that are used */
    bool confirms_report; /* the deceleration agrees with reports that contradict the commands */
    bool refutes_report;  /* in this step it has shown them to be wrong */
} hydraulic_watch_t;

void hydraulic_watch_init(hydraulic_watch_t *watch);

/* After hydraulic_model_step() of the same millisecond. Without brake.hydraulic_watch_inertia there
 * is no finding; an untrusted input keeps the one there is, and pauses the watch. */
void hydraulic_watch_step(hydraulic_watch_t *watch, const config_t *config,
                          const hydraulic_watch_input_t *in);

/* Torque of the hydraulic brake by the model, corrected by the finding; magnitude. */
int32_t hydraulic_watch_corrected_mNm(const hydraulic_watch_t *watch, int32_t modelled_mNm);

/* True if the motor is to brake beyond what the strategy leaves it. */
static inline bool hydraulic_watch_is_short(const hydraulic_watch_t *watch)
{
    return watch->reason == REASON_HYDRAULIC_WEAK || watch->reason == REASON_HYDRAULIC_DEAD;
}

#endif
