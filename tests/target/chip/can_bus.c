/* SPDX-License-Identifier: Apache-2.0 */
/* The CAN bus beyond the controller: who sends to it and hears it. */
#include "parts.h"

enum { OVERHEAD_BITS = 47 };

chip_ticks_t chip_can_frame_ticks(const chip_frame_t *frame)
{
    return (chip_ticks_t)(OVERHEAD_BITS + 8U * frame->length) * CHIP_CAN_BIT_TICKS;
}

chip_ticks_t chip_can_arrival(const chip_t *chip)
{
    const chip_can_t *can = &chip->can;
    return can->count == 0 ? CHIP_NEVER
                           : can->bus_free + chip_can_frame_ticks(&can->to_chip[can->first]);
}

chip_frame_t chip_can_arrived(chip_t *chip)
{
    chip_can_t *can = &chip->can;
    const chip_frame_t frame = can->to_chip[can->first];
    can->bus_free = chip_can_arrival(chip);
    can->first = (can->first + 1U) % CHIP_FRAMES;
    can->count--;
    return frame;
}

void chip_can_sent(chip_t *chip, const chip_frame_t *frame)
{
    chip_can_t *can = &chip->can;
    if (can->out_count < CHIP_FRAMES) {
        can->from_chip[(can->out_first + can->out_count) % CHIP_FRAMES] = *frame;
        can->out_count++;
    }
}

void chip_send(chip_t *chip, const chip_frame_t *frame)
{
    chip_can_t *can = &chip->can;
    if (can->count == CHIP_FRAMES) {
        return;
    }
    if (can->count == 0 && can->bus_free < chip->now) {
        can->bus_free = chip->now;
    }
    can->to_chip[(can->first + can->count) % CHIP_FRAMES] = *frame;
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
