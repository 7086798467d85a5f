/* SPDX-License-Identifier: Apache-2.0 */
/*
 * operating_mode.h: operating modes of a controller. modes.h describes the transitions.
 *
 * The numbers are part of the protocol (hubfoc.dbc): append, never renumber, never reuse.
 */
#ifndef CORE_OPERATING_MODE_H
#define CORE_OPERATING_MODE_H

typedef enum {
    MODE_BOOT = 0,
    MODE_SELFTEST = 1,
    MODE_OFFSET_CAL = 2,
    MODE_READY = 3, /* bridge in its safe state; RUN needs enable, a released drive pedal and a
                       known angle */
    MODE_RUN = 4,
    MODE_LIMP = 5, /* reduced driving torque after a warning; braking is not reduced */
    MODE_FAULT = 6
} operating_mode_t;

/* "RUN" and so on; "unknown mode" for a number not in the list. Never NULL. */
const char *operating_mode_text(operating_mode_t mode);

#endif
