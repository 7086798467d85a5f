/* SPDX-License-Identifier: Apache-2.0 */
/* The CAN bus: its nodes, their arbitration, and the vehicle's end of it. Errors and the states
 * that follow from them (error passive, bus off) are not modelled. */
#include "parts.h"

enum { OVERHEAD_BITS = 47, EXTENDED_BITS = 20, BYTES = 8, FIRST_OTHER = 2 };

/* A frame that wants to begin. */
typedef struct {
    chip_sender_t sender;
    unsigned which;
    uint32_t identifier;
    chip_ticks_t since;
} contender_t;

chip_ticks_t chip_can_frame_ticks(unsigned bytes)
{
    return (chip_ticks_t)(OVERHEAD_BITS + 8U * bytes) * CHIP_CAN_BIT_TICKS;
}

/* The bits of the arbitration, the first one highest: 11 of the identifier, then RTR and IDE, both
 * dominant in a data frame of 11 bits; else SRR and IDE, both recessive, and 18 more. */
uint32_t chip_can_arbitration(uint32_t identifier)
{
    if (identifier < CHIP_EXTENDED) {
        return identifier << 20;
    }
    return (identifier >> 18 & 0x7FFU) << 20 | 3U << 18 | (identifier & 0x3FFFFU);
}

static chip_ticks_t frame_ticks(const chip_frame_t *frame)
{
    return chip_can_frame_ticks(frame->length) +
           (frame->identifier < CHIP_EXTENDED ? 0U
                                              : (chip_ticks_t)EXTENDED_BITS * CHIP_CAN_BIT_TICKS);
}

static contender_t itself(chip_t *chip)
{
    const chip_can_t *can = &chip->can;
    const unsigned mailbox = chip_can_offered(chip);
    contender_t out = {.sender = CHIP_IDLE};
    if (mailbox < CHIP_MAILBOXES && can->joined != CHIP_NEVER && !chip->fault.can_mute) {
        const chip_ticks_t requested = can->requested[mailbox];
        out.sender = CHIP_ITSELF;
        out.which = mailbox;
        out.identifier = chip_can_mailbox(chip, mailbox).identifier;
        out.since = requested > can->joined ? requested : can->joined;
    }
    return out;
}

/* Of node 0, the chip; 1, the vehicle; and the others. */
static contender_t contender(chip_t *chip, unsigned node)
{
    const chip_can_t *can = &chip->can;
    contender_t out = {.sender = CHIP_IDLE};
    if (node == 0) {
        return itself(chip);
    }
    if (node >= FIRST_OTHER) {
        const chip_node_t *other = &can->other[node - FIRST_OTHER];
        out.sender = CHIP_OTHER;
        out.which = node - FIRST_OTHER;
        out.identifier = other->identifier;
        out.since = other->next;
    } else if (can->count > 0) {
        out.sender = CHIP_VEHICLE;
        out.identifier = can->to_chip[can->first].identifier;
        out.since = can->to_chip_since[can->first];
    }
    return out;
}

static chip_ticks_t least(chip_ticks_t a, chip_ticks_t b)
{
    return a < b ? a : b;
}

/* When the next frame begins: as soon as one wants to and the bus is free. Of the other nodes the
 * first is known, because this is asked after every few instructions. */
static chip_ticks_t begins(chip_t *chip)
{
    const chip_can_t *can = &chip->can;
    chip_ticks_t first = can->others > 0 ? can->others_next : CHIP_NEVER;
    for (unsigned node = 0; node < FIRST_OTHER; node++) {
        const contender_t one = contender(chip, node);
        first = one.sender == CHIP_IDLE ? first : least(first, one.since);
    }
    return first == CHIP_NEVER || first > can->bus_free ? first : can->bus_free;
}

static void find_next_other(chip_can_t *can)
{
    can->others_next = CHIP_NEVER;
    for (unsigned k = 0; k < can->others; k++) {
        can->others_next = least(can->others_next, can->other[k].next);
    }
}

/* Of the frames that begin together the lowest identifier stays: in each bit a dominant 0 overrides
 * a recessive 1, whose sender withdraws. */
static contender_t arbitrate(chip_t *chip, chip_ticks_t begin)
{
    contender_t winner = {.sender = CHIP_IDLE};
    for (unsigned node = 0; node < FIRST_OTHER + chip->can.others; node++) {
        const contender_t one = contender(chip, node);
        const bool takes_part = one.sender != CHIP_IDLE && one.since <= begin;
        if (takes_part &&
            (winner.sender == CHIP_IDLE ||
             chip_can_arbitration(one.identifier) < chip_can_arbitration(winner.identifier))) {
            winner = one;
        }
    }
    return winner;
}

static chip_frame_t frame_of(const chip_t *chip, const contender_t *winner)
{
    const chip_can_t *can = &chip->can;
    if (winner->sender == CHIP_ITSELF) {
        return chip_can_mailbox(chip, winner->which);
    }
    if (winner->sender == CHIP_VEHICLE) {
        return can->to_chip[can->first];
    }
    const chip_frame_t frame = {.identifier = winner->identifier, .length = BYTES};
    return frame;
}

static void begin_frame(chip_t *chip)
{
    chip_can_t *can = &chip->can;
    if (can->sender != CHIP_IDLE) {
        return;
    }
    const chip_ticks_t begin = begins(chip);
    if (begin > chip->now) {
        return;
    }
    const contender_t winner = arbitrate(chip, begin);
    can->sender = winner.sender;
    can->which = winner.which;
    can->on_bus = frame_of(chip, &winner);
    can->ends = begin + frame_ticks(&can->on_bus);
}

static void other_has_sent(chip_node_t *node, chip_ticks_t now)
{
    node->sent++;
    node->delay = now - node->next > node->delay ? now - node->next : node->delay;
    node->next += node->period;
    while (node->next + node->period <= now) {
        node->next += node->period;
    }
}

static void keep_sent(chip_can_t *can)
{
    if (can->out_count < CHIP_FRAMES) {
        chip_frame_t *kept = &can->from_chip[(can->out_first + can->out_count) % CHIP_FRAMES];
        *kept = can->on_bus;
        kept->ended = can->ends;
        can->out_count++;
    }
}

static void end_frame(chip_t *chip)
{
    chip_can_t *can = &chip->can;
    can->bus_free = can->ends;
    if (can->sender == CHIP_ITSELF) {
        can->sender = CHIP_IDLE;
        keep_sent(can);
        chip_can_sent(chip, can->which);
        return;
    }
    if (can->sender == CHIP_OTHER) {
        other_has_sent(&can->other[can->which], can->ends);
        find_next_other(can);
    } else {
        can->first = (can->first + 1U) % CHIP_FRAMES;
        can->count--;
    }
    can->sender = CHIP_IDLE;
    chip_can_received(chip, &can->on_bus);
}

chip_ticks_t chip_can_next(chip_t *chip)
{
    begin_frame(chip);
    return chip->can.sender == CHIP_IDLE ? begins(chip) : chip->can.ends;
}

void chip_can_events(chip_t *chip)
{
    begin_frame(chip);
    while (chip->can.sender != CHIP_IDLE && chip->now >= chip->can.ends) {
        end_frame(chip);
        begin_frame(chip);
    }
}

bool chip_can_sends(const chip_t *chip, unsigned mailbox)
{
    return chip->can.sender == CHIP_ITSELF && chip->can.which == mailbox;
}

void chip_can_request(chip_t *chip, unsigned mailbox)
{
    chip_can_t *can = &chip->can;
    can->requested[mailbox] = chip->now;
    can->order[can->order_count] = mailbox;
    can->order_count++;
}

void chip_can_forget(chip_t *chip, unsigned mailbox)
{
    chip_can_t *can = &chip->can;
    unsigned kept = 0;
    for (unsigned i = 0; i < can->order_count; i++) {
        if (can->order[i] != mailbox) {
            can->order[kept] = can->order[i];
            kept++;
        }
    }
    can->order_count = kept;
}

void chip_traffic(chip_t *chip, chip_node_t *nodes, unsigned count)
{
    chip_can_t *can = &chip->can;
    if (can->sender == CHIP_OTHER) { /* its frame goes with it */
        can->sender = CHIP_IDLE;
        can->bus_free = can->ends;
    }
    can->other = nodes;
    can->others = count;
    find_next_other(can);
}

void chip_send(chip_t *chip, const chip_frame_t *frame)
{
    chip_can_t *can = &chip->can;
    if (can->count == CHIP_FRAMES) {
        return;
    }
    const unsigned last = (can->first + can->count) % CHIP_FRAMES;
    can->to_chip[last] = *frame;
    can->to_chip_since[last] = chip->now;
    can->count++;
}

bool chip_receive(chip_t *chip, chip_frame_t *frame)
{
    chip_can_t *can = &chip->can;
    if (can->out_count == 0) {
        return false;
    }
    *frame = can->from_chip[can->out_first];
    can->out_first = (can->out_first + 1U) % CHIP_FRAMES;
    can->out_count--;
    return true;
}
