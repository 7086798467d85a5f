/* SPDX-License-Identifier: Apache-2.0 */
/*
 * reason.h: codes of limits and faults.
 *
 * The code of the limit that determines a torque, or of the fault that switched the bridge off.
 * CAN, shell, log and report show it unchanged, so the numbers are part of the protocol: append,
 * never renumber, never reuse. Codes below 64 are limits of a healthy controller, codes from 64 are
 * faults.
 */
#ifndef CORE_REASON_H
#define CORE_REASON_H

#include <stdint.h>

/* X(number, identifier, text) */
#define REASON_LIST(X)                                                                             \
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
    X(19, ROTOR_UNCERTAIN, "rotor angle not known well enough")                                    \
    X(20, HYDRAULIC_LIMIT, "hydraulic brake at its limit")                                         \
    X(21, BRAKE_PRIORITY, "a braking demand overrides the driving demand")                         \
    X(22, DRIVE_DIRECTION, "drive direction neutral or refused at this speed")                     \
    X(23, HILL_HOLD, "held at standstill until it drives off")                                     \
    X(26, HYDRAULIC_FEEDBACK, "measured hydraulic torque missing or implausible")                  \
    X(27, OVERSPEED, "too fast for the bus voltage: no torque can be controlled")                  \
    X(28, BATTERY_DISCONNECTED, "no battery on the bus")                                           \
    X(29, OFFSETS_STORED, "current sensors: stored offsets, none measured yet")                    \
    X(30, ACCELERATOR_LOCKED, "accelerator must be released before it drives")                     \
    X(64, CONFIG_INVALID, "configuration refused")                                                 \
    X(65, SELFTEST_FAILED, "self-test failed")                                                     \
    X(66, OFFSET_IMPLAUSIBLE, "current sensor offset out of range")                                \
    X(67, OVERCURRENT, "phase over-current")                                                       \
    X(68, BUS_OVERVOLTAGE, "bus over-voltage")                                                     \
    X(69, BUS_UNDERVOLTAGE, "bus under-voltage")                                                   \
    X(70, WINDING_OVERTEMPERATURE, "winding over-temperature")                                     \
    X(71, SWITCH_OVERTEMPERATURE, "inverter over-temperature")                                     \
    X(72, CURRENT_SUM, "phase currents do not add up to zero")                                     \
    X(73, ROTOR_LOST, "rotor position lost")                                                       \
    X(74, TORQUE_IMPLAUSIBLE, "torque differs from what is permitted")                             \
    X(75, PROGRAM_FLOW, "control steps missed or out of order")                                    \
    X(76, DEMAND_TIMEOUT, "torque demand timed out")                                               \
    X(77, HARDWARE_BREAK, "power stage reported a fault")                                          \
    X(78, CURRENT_SENSOR, "current sensor saturated or stuck")                                     \
    X(79, ROTOR_IMPLAUSIBLE, "rotor angle contradicts the back-EMF")                               \
    X(80, WINDING_SENSOR, "winding temperature sensor broken")                                     \
    X(81, SWITCH_SENSOR, "inverter temperature sensor broken")                                     \
    X(82, ACCELERATOR_SENSOR, "accelerator channels implausible or out of range")                  \
    X(83, BRAKE_PEDAL_SENSOR, "brake pedal channels implausible or out of range")

#define REASON_ENUM_LINE(number, identifier, text) REASON_##identifier = (number),
typedef enum { REASON_LIST(REASON_ENUM_LINE) } reason_t;
#undef REASON_ENUM_LINE

enum { REASON_FIRST_FAULT = 64 };

/* The text of a code for shells and logs; "unknown reason" for a number not in the list. Never
 * NULL. */
const char *reason_text(reason_t reason);

#endif
