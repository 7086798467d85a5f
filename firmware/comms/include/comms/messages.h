/* SPDX-License-Identifier: Apache-2.0 */
/*
 * messages.h: encodes physical quantities into CAN frames and decodes them. hubfoc.dbc defines the
 * layout; the C code for it is generated from that file.
 *
 * One wheel's messages differ from another's in two bits of the identifier (and in the data id,
 * e2e.h), and a vehicle's in the configured base, so one DBC is for all of them. The structures are
 * the controller's own (core/slow_messages.h), in SI milli-units; a frame holds whole steps of 0.1
 * N m (demands 0.2, uncertainty 0.05 N m), 0.1 A, 0.1 V, 0.1 degrees and 0.01 rad/s. What is sent
 * is rounded to the nearest step, except that available torques are rounded down, so that they are
 * never overstated. A quantity of the wheel beyond the DBC's range is sent as NOT_AVAILABLE, a
 * hydraulic command with hydraulic_valid 0, never as the end of the range. Demands are kept within
 * the range: the configuration admits none beyond it.
 *
 * Signs: torque, speed and current are positive when they drive forward; braking torques are
 * magnitudes >= 0; the bus current is positive out of the battery. Pure; any context.
 */
#ifndef COMMS_MESSAGES_H
#define COMMS_MESSAGES_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/e2e.h"
#include "core/slow_messages.h"

/* The numbers are part of the protocol: the lowest two bits of the identifier, so that on a crowded
 * bus an urgent message of any wheel has priority over a less urgent one of every other. */
typedef enum {
    MESSAGES_FRONT_LEFT = 0,
    MESSAGES_FRONT_RIGHT = 1,
    MESSAGES_REAR_LEFT = 2,
    MESSAGES_REAR_RIGHT = 3
} messages_wheel_t;

/* Where a wheel is on the bus. Its messages, and those for all wheels, have the identifiers base
 * .. base + 0x9F, in the DBC those of MESSAGES_BASE. */
typedef struct {
    uint16_t base; /* a multiple of 32, at most 0x740 */
    messages_wheel_t wheel;
} messages_address_t;

enum { MESSAGES_BASE = 0x100 };

/* In the order of arbitration: the lowest wins. */
typedef enum {
    MESSAGES_DEMAND,             /* received */
    MESSAGES_HYDRAULIC_FEEDBACK, /* received */
    MESSAGES_BATTERY_LIMITS,     /* received */
    MESSAGES_BATTERY_PEAK,       /* received */
    MESSAGES_WHEEL_STATE,        /* this and all that follow: sent */
    MESSAGES_WHEEL_BRAKE,
    MESSAGES_WHEEL_DRIVE,
    MESSAGES_WHEEL_POWER,
    MESSAGES_WHEEL_HEALTH,
    MESSAGES_WHEEL_AHEAD,
    MESSAGES_WHEEL_AVAILABLE,
    MESSAGES_WHEEL_ENERGY,
    MESSAGES_KINDS
} messages_kind_t;

enum {
    MESSAGES_RECEIVED = MESSAGES_WHEEL_STATE,
    MESSAGES_SENT = MESSAGES_KINDS - MESSAGES_RECEIVED
};

/* A classic CAN data frame with an 11-bit identifier. */
typedef struct {
    uint16_t identifier;
    uint8_t length;
    uint8_t data[E2E_FRAME_BYTES];
} messages_frame_t;

/* State of the receivers, for WheelHealth and WheelBrake: what comms adds to the controller's
 * values. */
typedef struct {
    e2e_link_t demand;
    e2e_link_t battery;
    e2e_link_t hydraulic;
    e2e_link_t peak;
    uint32_t demand_errors;
    uint32_t battery_errors;
    uint8_t demand_counter; /* of the newest demand in use, for WheelBrake */
} messages_links_t;

/* An energy account of the wheel. */
typedef struct {
    uint32_t drawn_10J, returned_10J;
    uint8_t friction_percent; /* of the braking work of both brakes; MESSAGES_NO_SHARE */
} messages_energy_t;

/* There was no braking work. */
enum { MESSAGES_NO_SHARE = 255 };

/* Everything that one wheel sends but for its energy accounts. */
typedef struct {
    const slow_output_t *output;
    const wheel_temperatures_t *temperature; /* 29 999 or more is 300 degrees: not available */
    messages_links_t links;
} messages_values_t;

/* "front left" and so on; never NULL. */
const char *messages_wheel_text(messages_wheel_t wheel);

uint16_t messages_identifier(messages_kind_t kind, messages_address_t address);

/* The DBC's GenMsgCycleTime. */
uint32_t messages_cycle_ms(messages_kind_t kind);

/* How a message is protected: profile 5 what commands a torque or limits one. */
e2e_profile_t messages_profile(messages_kind_t kind);

/* Decodes a frame; its protection is checked by e2e_receive(). False, and the structure
 * untouched, if the length is wrong or a value is outside the DBC's range: driving torque
 * 1638.2 N m, braking torque 3276.6 N m in steps of 0.2 N m, measured torque 20 000 N m, currents
 * 32 000 A. */
bool messages_read_demand(const messages_frame_t *frame, wheel_demand_t *demand);
bool messages_read_battery(const messages_frame_t *frame, battery_limits_t *limits);

/* Only charge_peak_current_mA and voltage_mV of the limits. */
bool messages_read_peak(const messages_frame_t *frame, battery_limits_t *limits);

/* Torque and `valid`; the age is the receiver's. */
bool messages_read_hydraulic(const messages_frame_t *frame, hydraulic_feedback_t *feedback);

/* For simulators of vehicle and battery: a complete, protected frame. */
messages_frame_t messages_demand(const wheel_demand_t *demand, messages_address_t address,
                                 uint8_t counter);
messages_frame_t messages_battery(const battery_limits_t *limits, messages_address_t address,
                                  uint8_t counter);
messages_frame_t messages_peak(const battery_limits_t *limits, messages_address_t address,
                               uint8_t counter);
messages_frame_t messages_hydraulic(const hydraulic_feedback_t *feedback,
                                    messages_address_t address, uint8_t counter);

/* Decodes for the vehicle's side: the fields that this kind of frame carries, in whole steps; the
 * others, and those that are NOT_AVAILABLE, are left as they are. False, and the structure
 * untouched, if it is none of what that wheel sends of them: also for WheelEnergy. */
bool messages_read_output(const messages_frame_t *frame, messages_address_t address,
                          slow_output_t *output);

/* WheelEnergy, complete and protected. An even counter takes the account since the start, in steps
 * of 0.1 Wh, an odd one that for life, in steps of 5 Wh; energies are rounded down. */
messages_frame_t messages_energy(const messages_energy_t *since_start,
                                 const messages_energy_t *for_life, messages_address_t address,
                                 uint8_t counter);

/* One of the other sent kinds, complete and protected; an empty frame for the received ones. */
messages_frame_t messages_output(messages_kind_t kind, const messages_values_t *values,
                                 messages_address_t address, uint8_t counter);

#endif
