/* SPDX-License-Identifier: Apache-2.0 */
#include "app/pedal_link.h"

#include "app/can_link.h"
#include "comms/messages.h"
#include "config/demand_age.h"
#include "hal/analog.h"
#include "hal/can.h"

enum { RATIO_STEPS_A_CODE = 8 /* 32 768 over 4096 */ };
_Static_assert((int)ANALOG_PEDAL_CHANNELS == CONFIG_PEDAL_CHANNELS, "one code a channel");

void pedal_link_init(pedal_link_t *link)
{
    const pedal_link_t none = {.in = {.age_ms = UINT32_MAX}};
    *link = none;
    pedals_init(&link->state);
}

static void sample(pedals_input_t *in)
{
    uint16_t code[ANALOG_PEDAL_CHANNELS];
    if (analog_pedals(code)) {
        in->age_ms = 0;
        for (int k = 0; k < CONFIG_PEDAL_CHANNELS; k++) {
            in->ratio_q15[k] = code[k] * RATIO_STEPS_A_CODE;
        }
    } else if (in->age_ms < UINT32_MAX) {
        in->age_ms++;
    }
}

void pedal_link_step(pedal_link_t *link, const config_t *config, slow_input_t *in)
{
    sample(&link->in);
    link->in.received = in->demand;
    link->in.received_age_ms = in->demand_age_ms;
    link->out = pedals_step(&link->state, config, &link->in);
    in->demand = pedals_wheel_demand(config, &link->out.demand, config->vehicle.wheel_position);
    in->demand_age_ms = link->out.age_ms;
}

void pedal_sender_init(pedal_sender_t *sender, uint32_t now_ms)
{
    for (int wheel = 0; wheel < CONFIG_WHEELS; wheel++) {
        sender->sent_ms[wheel] = now_ms;
        sender->counter[wheel] = 0;
        sender->pending[wheel] = false;
    }
}

static bool transmit(const config_t *config, const pedals_output_t *pedals, int32_t wheel,
                     uint8_t counter)
{
    const wheel_demand_t demand = pedals_wheel_demand(config, &pedals->demand, wheel);
    const messages_frame_t frame =
        messages_demand(&demand, can_link_address(config, wheel), counter);
    can_frame_t sent = {.identifier = frame.identifier, .length = frame.length};
    for (uint32_t k = 0; k < sizeof sent.data; k++) {
        sent.data[k] = frame.data[k];
    }
    return can_transmit(&sent);
}

/* A counter advances with a frame that has left. */
static void follow_sent(pedal_sender_t *sender, const config_t *config, int32_t wheel)
{
    const messages_address_t address = can_link_address(config, wheel);
    const can_progress_t progress =
        sender->pending[wheel] ? can_progress(messages_identifier(MESSAGES_DEMAND, address))
                               : CAN_PENDING;
    if (progress != CAN_PENDING) {
        sender->pending[wheel] = false;
        sender->counter[wheel] =
            (uint8_t)(sender->counter[wheel] + (progress == CAN_SENT ? 1U : 0U));
    }
}

void pedal_sender_transmit(pedal_sender_t *sender, const config_t *config,
                           const pedals_output_t *pedals, uint32_t now_ms)
{
    const bool lost = demand_is_lost(config, pedals->age_ms);
    for (int32_t wheel = 0; wheel < CONFIG_WHEELS; wheel++) {
        follow_sent(sender, config, wheel);
        const bool listens = ((uint32_t)config->pedals.other_wheels >> wheel & 1U) != 0 &&
                             wheel != config->vehicle.wheel_position;
        const bool due = now_ms - sender->sent_ms[wheel] >= messages_cycle_ms(MESSAGES_DEMAND);
        if (!lost && listens && due && transmit(config, pedals, wheel, sender->counter[wheel])) {
            sender->pending[wheel] = true;
            sender->sent_ms[wheel] = now_ms;
        }
    }
}
