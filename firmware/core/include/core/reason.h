/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reason.h: codes of limits, warnings and faults, and the one table of faults.
 *
 * The code of the limit that determines a torque, or of the fault that switched the bridge off.
 * CAN, shell, log and report show it unchanged, so the numbers are part of the protocol: append,
 * never renumber, never reuse. Codes below 64 are limits and warnings of a healthy controller,
 * codes from 64 are faults.
 *
 * fault.h explains the columns of a fault and gives them to the program; findings.h has the checks
 * that find it. A new row is all that a new code needs; then firmware/monitor/generate.py and
 * firmware/comms/generate.py write it into README and DBC.
 */
#ifndef CORE_REASON_H
#define CORE_REASON_H

#include <stdbool.h>
#include <stdint.h>

/* clang-format off */
/* What bounds a healthy controller. X(number, identifier, text) */
#define LIMIT_LIST(X)                                                                              \
    X(0, NONE, "no limit")                                                                         \
    X(1, LOSS_OPTIMUM, "more torque would return less energy")                                     \
    X(2, MAX_TORQUE, "motor torque limit")                                                         \
    X(3, MAX_POWER, "electromagnetic power limit")                                                 \
    X(4, PHASE_CURRENT, "phase current limit")                                                     \
    X(5, CHARGE_CURRENT, "battery charge current limit")                                           \
    X(6, DISCHARGE_CURRENT, "battery discharge current limit")                                     \
    X(7, BUS_VOLTAGE_HIGH, "bus voltage near its upper limit")                                     \
    X(8, BUS_VOLTAGE_LOW, "bus voltage near its lower limit")                                      \
    X(9, WINDING_TEMPERATURE, "winding temperature derating")                                      \
    X(10, SWITCH_TEMPERATURE, "inverter temperature derating")                                     \
    X(11, BLEND_OUT, "blended out to the hydraulic brake at low speed")                            \
    X(12, TORQUE_RATE, "torque rate limit")                                                        \
    X(13, VOLTAGE, "phase voltage limit")                                                          \
    X(14, ELECTRIC_SHARE, "fixed electric share of the parallel brake")                            \
    X(15, ELECTRIC_RATED, "rated electric braking torque of the parallel brake")                   \
    X(16, ABS, "anti-lock intervention")                                                           \
    X(17, TORQUE_ENABLE, "torque not enabled in this mode")                                        \
    X(18, MAX_SPEED, "speed limit")                                                                \
    X(20, HYDRAULIC_LIMIT, "hydraulic brake at its limit")                                         \
    X(21, BRAKE_PRIORITY, "a braking demand overrides the driving demand")                         \
    X(22, DRIVE_DIRECTION, "drive direction neutral or refused at this speed")                     \
    X(23, HILL_HOLD, "held at standstill until it drives off")                                     \
    X(30, ACCELERATOR_LOCKED, "accelerator must be released before it drives")

/* What is detected and answered; findings.h has the checks, their times and what happens.
 * X(number, identifier, text, clearing, driver) */
#define FAULT_LIST(X)                                                                              \
    X(19, ROTOR_UNCERTAIN, "rotor angle not known well enough", HEALS, REDUCED)                    \
    X(26, HYDRAULIC_FEEDBACK, "measured hydraulic torque missing or implausible", HEALS, SERVICE)  \
    X(27, OVERSPEED, "too fast for the bus voltage: no torque can be controlled", HEALS, REDUCED)  \
    X(28, BATTERY_DISCONNECTED, "no battery on the bus", HEALS, NO_MOTOR)                          \
    X(29, OFFSETS_STORED, "current sensors: stored offsets, none measured yet", HEALS, REDUCED)    \
    X(64, CONFIG_INVALID, "configuration refused", RESTART, SERVICE)                               \
    X(65, SELFTEST_FAILED, "self-test failed", RESTART, SERVICE)                                   \
    X(66, OFFSET_IMPLAUSIBLE, "current sensor offset out of range", ACKNOWLEDGED, SERVICE)         \
    X(67, OVERCURRENT, "phase over-current", ACKNOWLEDGED, NO_MOTOR)                               \
    X(68, BUS_OVERVOLTAGE, "bus over-voltage", ACKNOWLEDGED, NO_MOTOR)                             \
    X(69, BUS_UNDERVOLTAGE, "bus under-voltage", ACKNOWLEDGED, NO_MOTOR)                           \
    X(70, WINDING_OVERTEMPERATURE, "winding over-temperature", HEALS, NO_MOTOR)                    \
    X(71, SWITCH_OVERTEMPERATURE, "inverter over-temperature", HEALS, NO_MOTOR)                    \
    X(72, CURRENT_SUM, "phase currents do not add up to zero", ACKNOWLEDGED, SERVICE)              \
    X(73, ROTOR_LOST, "rotor position lost", ACKNOWLEDGED, SERVICE)                                \
    X(74, TORQUE_IMPLAUSIBLE, "torque differs from what is permitted", ACKNOWLEDGED, NO_MOTOR)     \
    X(75, PROGRAM_FLOW, "control steps missed or out of order", ACKNOWLEDGED, SERVICE)             \
    X(76, DEMAND_TIMEOUT, "torque demand timed out", SHOWN, NO_MOTOR)                              \
    X(77, HARDWARE_BREAK, "power stage reported a fault", ACKNOWLEDGED, SERVICE)                   \
    X(78, CURRENT_SENSOR, "current sensor saturated or stuck", ACKNOWLEDGED, SERVICE)              \
    X(79, ROTOR_IMPLAUSIBLE, "rotor angle contradicts the back-EMF", ACKNOWLEDGED, SERVICE)        \
    X(80, WINDING_SENSOR, "winding temperature sensor beyond its range, estimated",                \
      HEALS, SERVICE)                                                                              \
    X(81, SWITCH_SENSOR, "inverter temperature sensor beyond its range, estimated",                \
      HEALS, SERVICE)                                                                              \
    X(82, ACCELERATOR_SENSOR, "accelerator channels implausible or out of range", SHOWN, SERVICE)  \
    X(83, BRAKE_PEDAL_SENSOR, "brake pedal channels implausible or out of range", SHOWN, SERVICE)  \
    X(84, MEMORY, "memory damaged: mode or fault differ from their inverted copy",                 \
      RESTART, SERVICE)                                                                            \
    X(85, CURRENT_SENSOR_A, "current sensor a wrong, reconstructed from b and c", HEALS, SERVICE)  \
    X(86, CURRENT_SENSOR_B, "current sensor b wrong, reconstructed from c and a", HEALS, SERVICE)  \
    X(87, CURRENT_SENSOR_C, "current sensor c wrong, reconstructed from a and b", HEALS, SERVICE)  \
    X(90, DEMAND_IMPLAUSIBLE, "torque demand refused: beyond the configured torque or its rise",   \
      SHOWN, SERVICE)                                                                              \
    X(91, ROTOR_SLIPPED, "rotor sensor displaced against the back-EMF", HEALS, SERVICE)            \
    X(92, ROTOR_FROZEN, "rotor sensor stands still while the back-EMF turns", HEALS, SERVICE)      \
    X(93, ROTOR_REVERSED, "rotor sensor turns against the back-EMF", HEALS, SERVICE)               \
    X(96, FLUX_WEAK, "back-EMF below the magnets': magnets weak, or the bus voltage reads low",    \
      HEALS, SERVICE)                                                                              \
    X(97, BUS_SENSOR, "bus voltage reads wrong, against the battery's, the EMF or its range",      \
      HEALS, SERVICE)                                                                              \
    X(98, HYDRAULIC_WEAK, "hydraulic brake makes less torque than commanded", HEALS, REDUCED)      \
    X(99, HYDRAULIC_DEAD, "hydraulic brake makes less than a quarter of its command",              \
      HEALS, REDUCED)                                                                              \
    X(100, HYDRAULIC_STRONG, "hydraulic brake makes more torque than commanded", HEALS, SERVICE)   \
    X(101, HYDRAULIC_STUCK, "hydraulic brake does not release", HEALS, SERVICE)                    \
    X(102, HYDRAULIC_LATE, "hydraulic brake comes later than configured", HEALS, SERVICE)          \
    X(103, PHASE_OPEN, "phase wire or switch open: no current where one is wanted",                \
      ACKNOWLEDGED, SERVICE)                                                                       \
    X(104, CURRENT_GAIN, "gain of all current sensors wrong, by the battery's charge",             \
      HEALS, SERVICE)                                                                              \
    X(105, TRANSMIT_TIMEOUT, "own messages do not leave: the brake system brakes by its own path", \
      SHOWN, NO_MOTOR)                                                                             \
    X(106, DEMAND_CONTRADICTED, "two senders of the demand: one counter, different content",       \
      SHOWN, SERVICE)                                                                              \
    X(107, HOLD_FAILED, "vehicle rolls that was to be held at standstill", HEALS, SERVICE)
/* clang-format on */

#define REASON_LIMIT_ENUM(number, identifier, text) REASON_##identifier = (number),
#define REASON_FAULT_ENUM(number, identifier, text, clearing, driver)                              \
    REASON_##identifier = (number),
typedef enum { LIMIT_LIST(REASON_LIMIT_ENUM) FAULT_LIST(REASON_FAULT_ENUM) } reason_t;
#undef REASON_LIMIT_ENUM
#undef REASON_FAULT_ENUM

enum { REASON_FIRST_FAULT = 64 };

/* The text of a code for shells and logs; "unknown reason" for a number not in the list. Never
 * NULL. A port without space for texts (reason_text_absent.c) has the identifier in its place. */
const char *reason_text(reason_t reason);

/* The identifier of a code, such as "MAX_TORQUE"; "unknown reason" likewise. */
const char *reason_name(reason_t reason);

/* The place of a code's row as of reason_listed(); for a number not in the list that behind the
 * last. */
uint32_t reason_place(reason_t reason);

/* True, with its code, if there is a row `place`, from 0 on: limits, then faults, in the order of
 * the lists. */
bool reason_listed(uint32_t place, reason_t *reason);

#endif
