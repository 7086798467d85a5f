/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/link.h"

#include <math.h>

#include "core/q15.h"

enum { HEALTHY_MS = 300, DATA_BYTES = 8, OTHER_BYTES = 255 };
static const double ON = 0.5, MS = 1e3;

bool link_fault_present(const fault_params_t *p)
{
#define PRESENT(name, lowest, highest, unit, text) || p->name != 0.0
    return false LINK_FAULT_PARAMETERS(PRESENT);
#undef PRESENT
}

node_limits_t link_limits(const config_t *config)
{
    const config_battery_t *battery = &config->battery;
    const config_driver_t *driver = &config->driver;
    const int32_t wheels = battery->driven_wheels;
    const node_limits_t limits = {
        .pack = {.charge_current_mA = q_scale(battery->max_charge_current_mA, wheels, 1),
                 .discharge_current_mA = q_scale(battery->max_discharge_current_mA, wheels, 1)},
        .largest_drive_mNm = driver->largest_drive_mNm,
        .largest_brake_mNm = driver->largest_brake_mNm,
        .demand_rise_ms = driver->demand_rise_ms,
        .demand_lost_frames = driver->demand_lost_frames,
    };
    return limits;
}

messages_address_t link_address(const config_t *config)
{
    const messages_address_t address = {.base = (uint16_t)config->vehicle.can_base,
                                        .wheel = (messages_wheel_t)config->vehicle.wheel_position};
    return address;
}

void link_reset(link_t *link)
{
    link->active = false;
}

static void deliver(link_t *link, const messages_frame_t *frame)
{
    (void)node_receive(&link->node, frame, link->can.now_ms);
}

/* A link on which all was well until now: it has sent what it would send now. */
static void begin(link_t *link, const config_t *config, const slow_input_t *in)
{
    const node_limits_t limits = link_limits(config);
    const messages_address_t address = link_address(config);
    vehicle_can_init(&link->can, address);
    node_init(&link->node, address, &limits, 0);
    slow_input_t before = *in;
    before.demand_age_ms = 0;
    for (int ms = 0; ms < HEALTHY_MS; ms++) {
        vehicle_can_send(&link->can, &before);
        (void)node_tick(&link->node, link->can.now_ms);
        for (uint32_t k = 0; k < link->can.queued_count; k++) {
            deliver(link, &link->can.queued[k]);
        }
        link->can.now_ms++;
    }
    link->latest_demand =
        messages_demand(&in->demand, address, (uint8_t)(link->can.demand_counter - 1U));
    link->began_ms = link->can.now_ms;
    link->first = 0;
    link->count = 0;
    link->replayed = 0;
    link->random = random_init(1, 0);
    link->active = true;
}

static void keep(link_t *link, const messages_frame_t *frame)
{
    if (link->count < LINK_FRAMES) {
        link_sent_t *kept = &link->sent[(link->first + link->count) % LINK_FRAMES];
        kept->frame = *frame;
        kept->sent_ms = link->can.now_ms;
        link->count++;
    }
}

/* Sent now, received late. */
static void delay(link_t *link, uint32_t late_ms)
{
    for (uint32_t k = 0; k < link->can.queued_count; k++) {
        keep(link, &link->can.queued[k]);
    }
    while (link->count > 0 && link->can.now_ms - link->sent[link->first].sent_ms >= late_ms) {
        deliver(link, &link->sent[link->first].frame);
        link->first = (link->first + 1U) % LINK_FRAMES;
        link->count--;
    }
}

/* The frames of the first milliseconds pass and are recorded; from then on they come again, in
 * their own time, round after round, instead of all others. */
static void replay(link_t *link, uint32_t round_ms)
{
    const uint32_t since_ms = link->can.now_ms - link->began_ms;
    if (since_ms < round_ms) {
        for (uint32_t k = 0; k < link->can.queued_count; k++) {
            keep(link, &link->can.queued[k]);
            deliver(link, &link->can.queued[k]);
        }
        return;
    }
    const uint32_t at_ms = since_ms % round_ms;
    link->replayed = at_ms == 0 ? 0 : link->replayed;
    while (link->replayed < link->count &&
           link->sent[link->replayed].sent_ms - link->began_ms <= at_ms) {
        deliver(link, &link->sent[link->replayed].frame);
        link->replayed++;
    }
}

/* One byte is any other, so often. */
static void corrupt(link_t *link, messages_frame_t *frame, double share)
{
    if (random_uniform(&link->random) < share) {
        const uint32_t at = (uint32_t)(random_uniform(&link->random) * DATA_BYTES);
        const uint32_t change = 1U + (uint32_t)(random_uniform(&link->random) * OTHER_BYTES);
        frame->data[at % DATA_BYTES] ^= (uint8_t)change;
    }
}

/* A gateway puts the frame of the next wheel under this wheel's identifier. */
static messages_frame_t of_other_wheel(const link_t *link, const slow_input_t *in,
                                       const messages_frame_t *frame)
{
    messages_address_t other = link->can.address;
    other.wheel = other.wheel == MESSAGES_FRONT_LEFT ? MESSAGES_FRONT_RIGHT : MESSAGES_FRONT_LEFT;
    const uint8_t counter = e2e_counter(messages_profile(MESSAGES_DEMAND), frame->data);
    messages_frame_t out = messages_demand(&in->demand, other, counter);
    out.identifier = frame->identifier;
    return out;
}

static void change(const fault_params_t *p, link_t *link, const slow_input_t *in)
{
    const uint16_t demand = messages_identifier(MESSAGES_DEMAND, link->can.address);
    for (uint32_t k = 0; k < link->can.queued_count; k++) {
        messages_frame_t frame = link->can.queued[k];
        if (p->can_repeated > ON && frame.identifier == demand) {
            frame = link->latest_demand;
        }
        if (p->can_wrong_wheel > ON && frame.identifier == demand) {
            frame = of_other_wheel(link, in, &frame);
        }
        if (p->can_corrupt > 0.0) {
            corrupt(link, &frame, p->can_corrupt);
        }
        deliver(link, &frame);
    }
}

void link_step(const fault_params_t *p, link_t *link, const config_t *config, slow_input_t *in)
{
    if (!link->active) {
        begin(link, config, in);
    }
    vehicle_can_send(&link->can, in);
    (void)node_tick(&link->node, link->can.now_ms);
    if (p->can_delay_s > 0.0) {
        delay(link, (uint32_t)lround(p->can_delay_s * MS));
    } else if (p->can_replay_s > 0.0) {
        replay(link, (uint32_t)lround(fmax(p->can_replay_s * MS, 1.0)));
    } else {
        change(p, link, in);
    }
    const node_command_t *command = &link->node.command;
    in->demand = command->demand;
    in->demand_age_ms = node_demand_age_ms(command, link->can.now_ms);
    in->bms = command->bms;
    in->hydraulic = node_hydraulic(command, link->can.now_ms);
    link->can.now_ms++;
}
