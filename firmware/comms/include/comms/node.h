/* SPDX-License-Identifier: Apache-2.0 */
/*
 * node.h: one wheel's CAN node: receives the vehicle's command, schedules what the wheel sends.
 * Background context. Pure: frames and time in, frames out; app/can_link.h moves them to and from
 * the CAN controller.
 *
 * A demand beyond the configured torque, or one that rises faster than the configuration's
 * demand_rise, is refused as if its frame were lost, and command.demand.reason says so for a
 * second. Falling torque is always accepted.
 *
 * Two senders: an intact Demand with the counter of the one before it and other content shows a
 * second sender, and which of them is right cannot be known. From then on, until none has come for
 * a second, there is no driving torque and no acknowledgement, and the braking torque is the larger
 * of both; command.demand.reason says so.
 *
 * Reception: only frames that e2e.h qualifies are used; the others are counted and have no other
 * effect. In particular they do not refresh command.demand_time_ms, so the age of the demand grows
 * and after config.brake.demand_timeout_ms the torque ramps to zero. Before the first BatteryLimits
 * frame the configuration's pack limits apply; after a timeout the charge limit is zero.
 * BatteryPeak and HydraulicFeedback are optional: after a timeout limit and voltage are not given,
 * the torque not valid. The pack's current is given only until the next frame is half a cycle late.
 *
 * Transmission: each message in its cycle (hubfoc.dbc), in the order of priority, one at a time,
 * with the newest values. A frame that the CAN controller does not take stays due, one that has not
 * left after a cycle is due again and replaces itself; there is no queue. A counter advances only
 * with a frame that has left, so a gap in it means a frame lost on the bus.
 *
 * While WheelBrake does not leave, the brake system has to assume that the motor does not brake:
 * node_is_unsent() follows its receiver, timeout and qualification included.
 */
#ifndef COMMS_NODE_H
#define COMMS_NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/e2e.h"
#include "comms/messages.h"

enum {
    /* Cycle times without a usable frame after which the sender has to qualify again. */
    NODE_TIMEOUT_CYCLES = 5,
    /* A cycle and a half of BatteryPeak: no single value of the pack's current lasts for as long as
     * it has to contradict the current sensors (monitor_window.h, 200 ms). */
    NODE_PACK_CURRENT_AGE_ms = 150,
    /* Longer than any timeout of the controller, shorter than the clock's wrap. */
    NODE_DEMAND_EXPIRY_ms = 10000,
    NODE_REFUSAL_SHOWN_ms = 1000,       /* demand.reason after a refused demand */
    NODE_CONTRADICTION_SHOWN_ms = 1000, /* and without driving torque after a second sender's */
    NODE_CONTRADICTION_BRAKE_ms = 50,   /* its braking torque: NODE_TIMEOUT_CYCLES of Demand */
    NODE_UNSENT_ms = 50 /* without a WheelBrake that leaves: NODE_TIMEOUT_CYCLES of it */
};

/* What a node is configured with. Magnitudes. */
typedef struct {
    battery_limits_t pack;     /* of the whole pack, before the first BatteryLimits frame */
    int32_t largest_drive_mNm; /* a demand with more is refused */
    int32_t largest_brake_mNm;
    /* A demand that rises faster than from zero to the largest in this time is refused; 0: any
     * rise is accepted. */
    int32_t demand_rise_ms;
    int32_t demand_lost_frames; /* in a row that may be missing, 0 .. 3 */
} node_limits_t;

/* The latest intact Demand, used or not, and what a second sender shows by it. */
typedef struct {
    uint8_t data[E2E_FRAME_BYTES];
    uint32_t received_ms;
    int32_t brake_torque_mNm; /* 0 beyond largest_brake_mNm */
    bool received;
    bool contradicts;         /* less than NODE_CONTRADICTION_SHOWN_ms ago */
    uint32_t contradicted_ms; /* the latest time */
    int32_t larger_brake_mNm; /* of the latest two frames that contradict each other */
} node_senders_t;

/* What the vehicle sends, as the slow step takes it (slow_input_t). */
typedef struct {
    wheel_demand_t demand;
    battery_limits_t bms;
    hydraulic_feedback_t hydraulic; /* age_ms is not kept here */
    uint32_t hydraulic_time_ms;     /* when it arrived */
    uint32_t demand_time_ms;        /* when the demand arrived */
    bool demand_known;              /* received less than NODE_DEMAND_EXPIRY_ms ago */
    bool brake_received;            /* the brake system's receiver of WheelBrake is qualified */
    uint32_t brake_received_ms;     /* by the latest that left, or the first one after a gap */
} node_command_t;

typedef struct {
    messages_address_t address;
    node_command_t command;
    node_limits_t limits;
    e2e_receiver_t demand;
    e2e_receiver_t battery;
    e2e_receiver_t hydraulic;
    e2e_receiver_t peak;
    wheel_demand_t accepted; /* the demand in use, before what a second sender takes of it */
    node_senders_t senders;
    uint32_t refused_ms;    /* when the last demand was refused */
    bool refused;           /* less than NODE_REFUSAL_SHOWN_ms ago */
    uint8_t demand_counter; /* of the newest demand in use */
    uint32_t foreign;       /* received frames with other identifiers */
    uint32_t due_ms[MESSAGES_SENT];
    uint8_t counter[MESSAGES_SENT];
    bool pending[MESSAGES_SENT]; /* the CAN controller has it */
    uint8_t left_in_order;       /* of WheelBrake since a gap, up to E2E_QUALIFYING_FRAMES */
    messages_kind_t offered;     /* by the last node_next() */
} node_t;

void node_init(node_t *node, messages_address_t address, const node_limits_t *limits,
               uint32_t now_ms);

/* The identifiers that a receive filter has to pass. */
void node_accepted(messages_address_t address, uint16_t identifiers[MESSAGES_RECEIVED]);

/* Every pass of the background, with or without frames: timeouts. True if the command has changed.
 */
bool node_tick(node_t *node, uint32_t now_ms);

/* Background context, once for each received frame. True if the command has changed. */
bool node_receive(node_t *node, const messages_frame_t *frame, uint32_t now_ms);

/* The most urgent frame that is due, but for WheelEnergy; false if there is none. The same one
 * again until node_taken().
 */
bool node_next(node_t *node, uint32_t now_ms, const slow_output_t *output,
               const wheel_temperatures_t *temperature, messages_frame_t *frame);

/* True while WheelEnergy is due. node_next() leaves it out: it comes after everything else, and its
 * accounts are made for it alone. */
bool node_energy_is_due(const node_t *node, uint32_t now_ms);

/* WheelEnergy, if it is due. */
bool node_next_energy(node_t *node, uint32_t now_ms, const messages_energy_t *since_start,
                      const messages_energy_t *for_life, messages_frame_t *frame);

/* The same of WheelState alone: the brake system sees the other counters stand still. */
bool node_next_state(node_t *node, uint32_t now_ms, const slow_output_t *output,
                     const wheel_temperatures_t *temperature, messages_frame_t *frame);

/* The same of a wheel without control: WheelState in BOOT, and WheelAvailable for waits_for;
 * torques and speed are 0. */
bool node_next_boot(node_t *node, uint32_t now_ms, waits_for_t waits_for, messages_frame_t *frame);

/* The CAN controller has taken the frame of the last node_next(). */
void node_taken(node_t *node, uint32_t now_ms);

/* Message `place` of those sent, 0 .. MESSAGES_SENT - 1: true, with its identifier, if the CAN
 * controller has it. */
bool node_pending(const node_t *node, uint32_t place, uint16_t *identifier);

/* What became of that one: it has left, or was given up and is due again. True if the command has
 * changed. */
bool node_left(node_t *node, uint32_t place, uint32_t now_ms);
void node_aborted(node_t *node, uint32_t place, uint32_t now_ms);

/* True while WheelBrake has not left for NODE_UNSENT_ms, or its receiver is not qualified again. */
bool node_is_unsent(const node_command_t *command, uint32_t now_ms);

/* While node_is_unsent() the demand in `in` is lost, by the reason TRANSMIT_TIMEOUT. Without any
 * demand nothing changes: a controller alone on its bus gets no acknowledge. */
void node_hand_over(const node_command_t *command, uint32_t now_ms, slow_input_t *in);

/* The measured hydraulic torque with its age; not valid if there is none. */
hydraulic_feedback_t node_hydraulic(const node_command_t *command, uint32_t now_ms);

/* Age of the demand in milliseconds; UINT32_MAX if there is none. */
uint32_t node_demand_age_ms(const node_command_t *command, uint32_t now_ms);

#endif
