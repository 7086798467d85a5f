/* SPDX-License-Identifier: Apache-2.0 */
/*
 * waits_for.h: what driving torque waits for, in plain words. modes.h decides it.
 *
 * Of several the first in the order of the modes. The numbers are part of the protocol
 * (hubfoc.dbc): append, never renumber, never reuse.
 */
#ifndef CORE_WAITS_FOR_H
#define CORE_WAITS_FOR_H

/* X(number, identifier, text) */
#define WAITS_FOR_LIST(X)                                                                          \
    X(0, NONE, "no condition")                                                                     \
    X(1, CONFIGURATION, "an accepted configuration")                                               \
    X(2, SELFTEST, "the self-test")                                                                \
    X(3, LOWER_SPEED, "a lower speed, to measure offsets")                                         \
    X(4, OFFSETS, "current sensor offsets")                                                        \
    X(5, ENABLE, "being switched on")                                                              \
    X(6, DEMAND_LINK, "a valid torque demand")                                                     \
    X(7, PEDAL_RELEASE, "the drive pedal's release")                                               \
    X(8, ROTOR_ANGLE, "the rotor's angle")                                                         \
    X(9, BATTERY, "the battery on the bus")                                                        \
    X(10, DIRECTION, "a permitted drive direction")                                                \
    X(11, FAULT_CAUSE, "the fault's cause to go")                                                  \
    X(12, REST, "standstill without demand")                                                       \
    X(13, ACKNOWLEDGEMENT, "an acknowledgement")                                                   \
    X(14, RESTART, "a restart of the controller")                                                  \
    X(15, COOLING, "a colder winding or inverter")

#define WAITS_FOR_ENUM_LINE(number, identifier, text) WAITS_FOR_##identifier = (number),
typedef enum { WAITS_FOR_LIST(WAITS_FOR_ENUM_LINE) } waits_for_t;
#undef WAITS_FOR_ENUM_LINE

/* The text for shells and logs; "unknown" for a number not in the list. Never NULL. */
const char *waits_for_text(waits_for_t waits_for);

#endif
