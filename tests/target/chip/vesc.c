/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Frames with 29-bit identifiers: VESC status frames that the wheel sends, and others that it must
 * not receive.
 *
 *     chip_vesc ELF [--finds TEXT]
 *
 * Exit code 0: the image sends each kind every 100 ms if its port has them, WheelBrake comes as
 * without but for a frame of 29 bits, and frames whose identifiers contain that of Demand have no
 * effect; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <stdio.h>
#include <string.h>

#include "comms/messages.h"
#include "planted.h"
#include "rig.h"

enum { CONTROLLER_ID = 10, KINDS = 5, BYTES = 8, EXTENDED_BITS = 131, BIT_us = 2 };
static const uint32_t PACKETS[KINDS] = {9, 14, 15, 16, 27};
static const double WATCHED_S = 0.5, FOREIGN_EVERY_S = 0.001;
enum { EXPECTED = 5 }; /* of each kind in that time, or one less, or one more */

static struct {
    unsigned sent[KINDS], others; /* frames of 29 bits by their kind, and of none */
    chip_ticks_t last, gap;       /* of WheelBrake: end of the latest, longest time between two */
    unsigned brakes, errors;      /* WheelHealth.demand_errors: the latest */
    uint16_t brake, health, demand;
} seen;

static void see_extended(const chip_frame_t *frame)
{
    const uint32_t wheel = (uint32_t)rig.config.vehicle.wheel_position;
    for (unsigned k = 0; k < KINDS; k++) {
        if (frame->identifier == (CHIP_EXTENDED | PACKETS[k] << 8 | (CONTROLLER_ID + wheel)) &&
            frame->length == BYTES) {
            seen.sent[k]++;
            return;
        }
    }
    seen.others++;
}

static void see_frame(const chip_frame_t *frame)
{
    if (frame->identifier >= CHIP_EXTENDED) {
        see_extended(frame);
    } else if (frame->identifier == seen.brake) {
        const chip_ticks_t since = frame->ended - seen.last;
        seen.gap = seen.brakes > 0 && since > seen.gap ? since : seen.gap;
        seen.last = frame->ended;
        seen.brakes++;
    } else if (frame->identifier == seen.health) {
        seen.errors = frame->data[6] & 0xFU;
    }
}

static uint16_t identifier_of(messages_kind_t kind)
{
    const messages_address_t address = {.base = (uint16_t)rig.config.vehicle.can_base,
                                        .wheel =
                                            (messages_wheel_t)rig.config.vehicle.wheel_position};
    return messages_identifier(kind, address);
}

static void watch(void)
{
    memset(&seen, 0, sizeof seen);
    seen.brake = identifier_of(MESSAGES_WHEEL_BRAKE);
    seen.health = identifier_of(MESSAGES_WHEEL_HEALTH);
    seen.demand = identifier_of(MESSAGES_DEMAND);
    run(WATCHED_S);
}

static bool starts(int32_t vesc_status)
{
    use_vesc_status(vesc_status);
    if (!open_rig(rig.elf)) {
        return false;
    }
    boot();
    rig.drive.seen = see_frame;
    return expect(drive_off(&rig.coupling), "comes to RUN");
}

static bool sends_them(void)
{
    bool good = true;
    for (unsigned k = 0; k < KINDS; k++) {
        const unsigned most = IMAGE_SENDS_VESC_STATUS ? EXPECTED + 1U : 0U;
        const unsigned least = IMAGE_SENDS_VESC_STATUS ? EXPECTED - 1U : 0U;
        good = good && seen.sent[k] >= least && seen.sent[k] <= most;
    }
    return expect(good && seen.others == 0, "VESC status frames as the port has them");
}

/* Demand's identifier as the first 11 bits of 29, and as the last; content that would be damaged.
 */
static bool ignores_others(void)
{
    const uint32_t foreign[] = {CHIP_EXTENDED | (uint32_t)seen.demand << 18,
                                CHIP_EXTENDED | seen.demand};
    const unsigned before = seen.errors;
    for (double time_s = 0.0; time_s < WATCHED_S; time_s += FOREIGN_EVERY_S) {
        const unsigned turn = (unsigned)(time_s / FOREIGN_EVERY_S) % 2U;
        const chip_frame_t frame = {
            .identifier = foreign[turn], .length = BYTES, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
        chip_send(rig.chip, &frame);
        run(FOREIGN_EVERY_S);
    }
    return expect(seen.errors == before, "frames of 29 bits are not received") &&
           expect(rig.bench.wheel[0].slow.mode == IMAGE_MODE, "the wheel goes on");
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_vesc ELF [--finds TEXT]\n");
        return 2;
    }
    rig.elf = argv[1];
    bool good = starts(0);
    chip_ticks_t gap = 0;
    if (good) {
        watch();
        gap = seen.gap;
        good = expect(seen.sent[0] + seen.others == 0, "none as shipped") && starts(CONTROLLER_ID);
    }
    if (good) {
        watch();
        const chip_ticks_t frame = (chip_ticks_t)EXTENDED_BITS * BIT_us * CHIP_TICKS_PER_US;
        printf("longest gap of WheelBrake: %.2f ms without, %.2f ms with, a frame is %.2f ms\n",
               (double)gap / (1000.0 * (double)CHIP_TICKS_PER_US),
               (double)seen.gap / (1000.0 * (double)CHIP_TICKS_PER_US),
               (double)frame / (1000.0 * (double)CHIP_TICKS_PER_US));
        good = sends_them() && expect(seen.gap <= gap + frame, "WheelBrake waits for one frame") &&
               ignores_others();
    }
    good = good && expect(rig.bench.wheel[0].first_fault == REASON_NONE, "runs without a fault") &&
           obeys_the_manuals();
    return rig_result(good, finds);
}
