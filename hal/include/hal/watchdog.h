/* SPDX-License-Identifier: Apache-2.0 */
/*
 * watchdog.h: resets the core, which switches the bridge off, unless it is fed in time. It cannot
 * be stopped. Also what else has reset it.
 */
#ifndef HAL_WATCHDOG_H
#define HAL_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

/* timeout_ms: 1 to 4000. The watchdog has an oscillator of its own, which may be up to 47 % fast or
 * slow, so the real timeout lies between two thirds and twice this value. */
void watchdog_start(uint32_t timeout_ms);

void watchdog_feed(void);

/* By falling precedence where a chip shows several. The numbers are kept in flash (the
 * application's counters of starts). */
typedef enum {
    RESET_UNKNOWN = 0,     /* the port cannot tell */
    RESET_POWER,           /* the supply came */
    RESET_BROWN_OUT,       /* the supply was too low; on some chips this is RESET_POWER */
    RESET_WATCHDOG,        /* this one */
    RESET_WINDOW_WATCHDOG, /* which this firmware does not start */
    RESET_LOW_POWER,       /* nor does it enter a low-power mode */
    RESET_PROGRAM,         /* as a debug probe makes it; this firmware does not */
    RESET_OPTION_BYTES,    /* loaded anew; not on all chips */
    RESET_PIN,
    RESET_CAUSES
} reset_cause_t;

/* Why the core started; constant until the next reset. */
reset_cause_t watchdog_reset_cause(void);

#endif
