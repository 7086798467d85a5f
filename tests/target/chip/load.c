/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A bus with other nodes, and when the wheel's own messages leave.
 *
 *     chip_load ELF [--finds TEXT]
 *
 * Prints a table: the traffic, the load of the bus, the part of it with identifiers of more urgency
 * than WheelBrake's, the longest gap between two WheelBrake, and between two WheelHealth, the last
 * but two of the wheel's messages in urgency.
 *
 * Every fourth phase and one seed; with HUBFOC_FOR_LONG in the environment all of them.
 *
 * Where the wheel has XCP, the first of both once more while a DAQ list of it sends a frame a
 * millisecond as far as the bus has time, and how many of them came.
 *
 * Exit code 0: WheelBrake comes in time with every traffic, and with DAQ as it does without but for
 * two frames, which has every millisecond on a free bus; of an image with an error planted, that
 * TEXT finds it (rig.h).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "comms/messages.h"
#include "comms/xcp.h"
#include "core/signals.h"
#include "plant/random.h"
#include "planted.h"
#include "rig.h"

enum { NODES = 256, STARTS = 10, STARTS_APART = 5, SEEDS = 4, BYTES = 8 };
static const double WATCHED_S = 0.5;
static const double URGENT_SHARE = 0.60, LOAD = 0.95;
static const double WORST_GAP_ms = 20.5; /* a cycle left out, and a frame */
static const uint16_t URGENT = 0x010;    /* and upwards: all other nodes of more urgency */

typedef struct {
    uint16_t identifier;
    chip_ticks_t last, gap; /* end of the latest frame; the longest time between two ends */
    unsigned count;
} message_t;

static struct {
    chip_node_t node[NODES];
    unsigned nodes;
    random_t random;
    message_t brake, health;
    unsigned own, own_urgent;   /* frames of the wheel */
    unsigned measured, answers; /* of XCP */
    chip_ticks_t began;
} load;

static messages_address_t address(void)
{
    const messages_address_t out = {.base = (uint16_t)rig.config.vehicle.can_base,
                                    .wheel = (messages_wheel_t)rig.config.vehicle.wheel_position};
    return out;
}

static uint16_t identifier_of(messages_kind_t kind)
{
    return messages_identifier(kind, address());
}

static void see(message_t *message, const chip_frame_t *frame)
{
    if (frame->identifier != message->identifier || frame->ended < load.began) {
        return;
    }
    const chip_ticks_t since = frame->ended - message->last;
    message->gap = since > message->gap ? since : message->gap;
    message->last = frame->ended;
    message->count++;
}

static uint16_t service_identifier(void)
{
    return (uint16_t)(rig.config.service.can_base + rig.config.vehicle.wheel_position);
}

static void see_service(const chip_frame_t *frame)
{
    if (frame->identifier == service_identifier() + (uint32_t)CONFIG_WHEELS) {
        load.answers += frame->data[0] == 0xFF ? 1U : 0U;
        load.measured += (frame->data[0] & ~(unsigned)DAQ_OVERLOAD) == 0 ? 1U : 0U;
    }
}

static void see_frame(const chip_frame_t *frame)
{
    see_service(frame);
    see(&load.brake, frame);
    see(&load.health, frame);
    if (frame->ended >= load.began) {
        load.own++;
        load.own_urgent += frame->identifier < load.brake.identifier ? 1U : 0U;
    }
}

static double ms_of(chip_ticks_t ticks)
{
    return (double)ticks / (1000.0 * (double)CHIP_TICKS_PER_US);
}

static chip_ticks_t ticks_of_ms(double ms)
{
    return (chip_ticks_t)llround(ms * 1000.0 * (double)CHIP_TICKS_PER_US);
}

static void add_node(uint16_t identifier, double period_ms, double phase_ms)
{
    chip_node_t *node = &load.node[load.nodes];
    node->identifier = identifier;
    node->period = ticks_of_ms(period_ms);
    node->next = load.began + ticks_of_ms(phase_ms);
    load.nodes++;
}

/* ---- traffic ---- */

/* Cycles of the network, in ms. */
static const double CYCLES_ms[] = {5.0, 10.0, 20.0, 50.0, 100.0};
enum { CYCLES = sizeof CYCLES_ms / sizeof CYCLES_ms[0], TEN_ms = 1, HUNDRED_ms = CYCLES - 1 };

/* Another node, which is not this wheel. */
static uint16_t next_identifier(uint16_t identifier)
{
    const uint16_t next = (uint16_t)(identifier + 1U);
    return ((next ^ load.brake.identifier) & 3U) == 0 ? (uint16_t)(next + 1U) : next;
}

/* Nodes from this identifier on until they take this share of the bus, with cycles and phases at
 * random, or, from a phase of 0 on, with the same of both. */
static void fill(uint16_t identifier, double share, int same_cycle, double phase_ms)
{
    const double frame_ms = ms_of(chip_can_frame_ticks(BYTES));
    const bool random = phase_ms < 0.0;
    double left = share;
    while (load.nodes < NODES && left > frame_ms / CYCLES_ms[HUNDRED_ms]) {
        int cycle = random ? (int)(random_uniform(&load.random) * CYCLES) : same_cycle;
        while (frame_ms / CYCLES_ms[cycle] > left) {
            cycle++;
        }
        left -= frame_ms / CYCLES_ms[cycle];
        add_node(identifier, CYCLES_ms[cycle],
                 random ? random_uniform(&load.random) * CYCLES_ms[cycle] : phase_ms);
        identifier = next_identifier(identifier);
    }
}

/* Of a message that the chip or the vehicle sends. */
static double share_of(messages_kind_t kind)
{
    return ms_of(chip_can_frame_ticks(BYTES)) / messages_cycle_ms(kind);
}

/* What the wheel and the vehicle, which has no torque sensor, take of the bus themselves; those
 * before WheelBrake. */
static double own_share(bool urgent)
{
    double out = 0.0;
    for (messages_kind_t kind = MESSAGES_DEMAND; kind < MESSAGES_KINDS; kind++) {
        const bool counts = !urgent || identifier_of(kind) < load.brake.identifier;
        out += counts && kind != MESSAGES_HYDRAULIC_FEEDBACK ? share_of(kind) : 0.0;
    }
    return out;
}

/* The others have identifiers from WheelBrake's on: they pass most of the wheel's own. In phase,
 * those before it begin together every 10 ms, the others every 100 ms. */
static void busy_bus(double phase_ms)
{
    const double urgent = URGENT_SHARE - own_share(true);
    const double others = LOAD - own_share(false) - urgent;
    fill(URGENT, urgent, TEN_ms, phase_ms);
    fill((uint16_t)(load.brake.identifier + 1U), others, HUNDRED_ms, phase_ms);
}

static void babble(uint16_t identifier)
{
    add_node(identifier, ms_of(chip_can_frame_ticks(BYTES)), 0.0);
}

/* ---- what is expected ---- */

static double node_share(uint16_t below)
{
    chip_ticks_t busy = 0;
    for (unsigned k = 0; k < load.nodes; k++) {
        busy +=
            load.node[k].identifier < below ? load.node[k].sent * chip_can_frame_ticks(BYTES) : 0U;
    }
    return ms_of(busy) / (1000.0 * WATCHED_S);
}

static void close_gap(message_t *message)
{
    const chip_ticks_t since = chip_now(rig.chip) - message->last;
    message->gap = since > message->gap ? since : message->gap;
}

static void count_from_now(void)
{
    load.began = chip_now(rig.chip);
    load.brake.gap = 0;
    load.health.gap = 0;
    load.health.count = 0;
    load.own = 0;
    load.own_urgent = 0;
    load.measured = 0;
    for (unsigned k = 0; k < load.nodes; k++) {
        load.node[k].sent = 0;
    }
}

/* Of a chip that already runs, once all nodes do. */
static void watch(void)
{
    chip_traffic(rig.chip, load.node, load.nodes);
    run(CYCLES_ms[HUNDRED_ms] / 1000.0);
    count_from_now();
    run(WATCHED_S);
    chip_traffic(rig.chip, NULL, 0);
    close_gap(&load.brake);
    close_gap(&load.health);
}

/* Each traffic meets the cycles of the wheel's own messages at the same phase. */
static void await_cycle(void)
{
    const chip_ticks_t cycle = ticks_of_ms(CYCLES_ms[HUNDRED_ms]);
    run(ms_of(cycle - chip_now(rig.chip) % cycle) / 1000.0);
}

static void begin(uint64_t seed)
{
    await_cycle();
    memset(&load, 0, sizeof load);
    load.random = random_init(seed, 0);
    load.began = chip_now(rig.chip);
    load.brake.identifier = identifier_of(MESSAGES_WHEEL_BRAKE);
    load.brake.last = load.began;
    load.health.identifier = identifier_of(MESSAGES_WHEEL_HEALTH);
    load.health.last = load.began;
}

static double gap_ms(const char *traffic)
{
    const double frame_s = ms_of(chip_can_frame_ticks(BYTES)) / 1000.0;
    const double own = load.own * frame_s / WATCHED_S;
    const double urgent = load.own_urgent * frame_s / WATCHED_S;
    const double vehicle = share_of(MESSAGES_DEMAND) + share_of(MESSAGES_BATTERY_LIMITS) +
                           share_of(MESSAGES_BATTERY_PEAK);
    printf("| %s | %.0f %% | %.0f %% | %.1f ms | %.0f ms |\n", traffic,
           100.0 * (node_share(UINT16_MAX) + own + vehicle),
           100.0 * (node_share(load.brake.identifier) + urgent + vehicle), ms_of(load.brake.gap),
           ms_of(load.health.gap));
    return ms_of(load.brake.gap);
}

static bool brake_comes(const char *traffic, double *gap)
{
    watch();
    *gap = gap_ms(traffic);
    return expect(*gap <= WORST_GAP_ms, "WheelBrake comes in time");
}

/* The gaps of the traffics that DAQ is measured with. */
static bool comes_with_busy_buses(double *together, double *random)
{
    const bool for_long = getenv("HUBFOC_FOR_LONG") != NULL;
    bool good = true;
    char traffic[40];
    for (unsigned k = 0; k < STARTS; k += for_long ? 1U : STARTS_APART) {
        (void)snprintf(traffic, sizeof traffic, "cycles of 10 and 100 ms, phase %u ms", 11U * k);
        begin(0);
        busy_bus(11.0 * k);
        double gap;
        good = brake_comes(traffic, &gap) && good;
        *together = k == 0 ? gap : *together;
    }
    for (unsigned seed = 1; seed <= (for_long ? SEEDS : 1U); seed++) {
        (void)snprintf(traffic, sizeof traffic, "cycles and phases by seed %u", seed);
        begin(seed);
        busy_bus(-1.0);
        double gap;
        good = brake_comes(traffic, &gap) && good;
        *random = seed == 1 ? gap : *random;
    }
    return good;
}

/* A node that sends without a pause, of less urgency than WheelBrake and of more than the wheel's
 * other messages: they fill whatever place there is and never leave. */
static bool comes_beside_a_babbling_node(void)
{
    begin(0);
    babble((uint16_t)(load.brake.identifier + 1U));
    double gap;
    return brake_comes("a babbling node next to WheelBrake", &gap) &&
           expect(load.health.count == 0, "the other messages do not come");
}

/* ---- DAQ ---- */

#define OUTPUT_PLACE(name, ...) OUTPUT_##name,
enum { SIGNALS_SLOW_OUTPUTS(OUTPUT_PLACE) OUTPUTS };
static const double FREE_s = 0.1;

static bool command(const uint8_t bytes[BYTES])
{
    chip_frame_t frame = {.identifier = service_identifier(), .length = BYTES};
    memcpy(frame.data, bytes, BYTES);
    load.answers = 0;
    chip_send(rig.chip, &frame);
    run(0.005);
    return expect(load.answers == 1, "a command of XCP is answered");
}

/* A list of one signal in each slow step. */
static bool start_measuring(void)
{
    static const uint32_t SPEED = XCP_SIGNALS_ADDRESS + 4U * OUTPUT_speed_rad_per_s;
    static const uint8_t COMMANDS[][BYTES] = {
        {0xFF},
        {0xE2},
        {0xE1, 0xFF, 4, 0, (uint8_t)(SPEED & 0xFFU), 0, 0, (uint8_t)(SPEED >> 24)},
        {0xDE, 1}};
    bool good = true;
    for (unsigned k = 0; good && k < sizeof COMMANDS / sizeof COMMANDS[0]; k++) {
        good = command(COMMANDS[k]);
    }
    load.measured = 0;
    run(FREE_s);
    return good && expect(load.measured + 1U >= (unsigned)(1000.0 * FREE_s),
                          "DAQ has every millisecond of a free bus");
}

/* A frame that has begun is not withdrawn: one is in the way at most. Another one for the time at
 * which the wheel asks, which is a few PWM periods earlier or later. */
static bool comes_as_before(const char *traffic, double before, double phase_ms, unsigned seed)
{
    if (!start_measuring()) {
        return false;
    }
    begin(seed);
    busy_bus(phase_ms);
    watch();
    const double gap = gap_ms(traffic);
    printf("| with %u frames of DAQ in %.1f s | | | | |\n", load.measured, WATCHED_S);
    const uint8_t disconnect[BYTES] = {0xFE};
    return expect(gap <= before + 2.0 * ms_of(chip_can_frame_ticks(BYTES)),
                  "DAQ makes no gap of WheelBrake longer") &&
           expect(load.measured > 0, "DAQ uses what is left of the bus") && command(disconnect);
}

static bool comes_with_daq(double together, double random)
{
    return comes_as_before("together, with DAQ", together, 0.0, 0) &&
           comes_as_before("at random, with DAQ", random, -1.0, 1);
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_load ELF [--finds TEXT]\n");
        return 2;
    }
    bool good = open_rig(argv[1]);
    if (good) {
        boot();
        rig.drive.seen = see_frame;
        good = expect(drive_off(&rig.coupling), "comes to RUN");
        printf("| traffic, " IMAGE_CHIP
               " | load | before WheelBrake | gap of WheelBrake | of WheelHealth |\n"
               "|---|---|---|---|---|\n");
    }
    if (good) {
        const bool beside = comes_beside_a_babbling_node();
        double together = 0.0, random = 0.0;
        good = comes_with_busy_buses(&together, &random) && beside &&
               (!IMAGE_HAS_XCP || comes_with_daq(together, random));
    }
    good = good && expect(rig.bench.wheel[0].first_fault == REASON_NONE, "runs without a fault") &&
           obeys_the_manuals();
    return rig_result(good, finds);
}
