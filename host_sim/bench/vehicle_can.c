/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/vehicle_can.h"

enum { TIMEOUT_CYCLES = 5 };

void vehicle_can_init(vehicle_can_t *can, messages_address_t address)
{
    const vehicle_can_t fresh = {.address = address, .received = {.mode = MODE_BOOT}};
    *can = fresh;
    for (messages_kind_t kind = MESSAGES_WHEEL_STATE; kind < MESSAGES_KINDS; kind++) {
        e2e_receiver_init(&can->link[kind], messages_profile(kind),
                          TIMEOUT_CYCLES * messages_cycle_ms(kind));
    }
}

static void queue(vehicle_can_t *can, messages_frame_t frame)
{
    can->queued[can->queued_count] = frame;
    can->queued_count++;
}

void vehicle_can_send(vehicle_can_t *can, const slow_input_t *in)
{
    can->queued_count = 0;
    const uint32_t demand_cycle_ms = messages_cycle_ms(MESSAGES_DEMAND);
    if (can->now_ms % demand_cycle_ms == 0 && in->demand_age_ms < demand_cycle_ms) {
        queue(can, messages_demand(&in->demand, can->address, can->demand_counter++));
    }
    if (can->now_ms % messages_cycle_ms(MESSAGES_BATTERY_LIMITS) == 0) {
        queue(can, messages_battery(&in->bms, can->address, can->battery_counter++));
    }
    if ((in->bms.charge_peak_current_mA > 0 || in->bms.voltage_mV > 0 || in->bms.current_given) &&
        can->now_ms % messages_cycle_ms(MESSAGES_BATTERY_PEAK) == 0) {
        queue(can, messages_peak(&in->bms, can->address, can->peak_counter++));
    }
    if (in->hydraulic.valid && in->hydraulic.age_ms == 0) {
        queue(can, messages_hydraulic(&in->hydraulic, can->address, can->hydraulic_counter++));
    }
}

static e2e_receiver_t *link_of(vehicle_can_t *can, uint16_t identifier)
{
    messages_kind_t kind = MESSAGES_WHEEL_STATE;
    while (identifier != messages_identifier(kind, can->address)) {
        kind++;
    }
    return &can->link[kind];
}

void vehicle_can_receive(vehicle_can_t *can, const messages_frame_t *frame)
{
    slow_output_t message = can->received;
    if (!messages_read_output(frame, can->address, &message)) {
        return; /* not of this wheel */
    }
    const e2e_status_t check = e2e_receive(link_of(can, frame->identifier), frame->data,
                                           frame->identifier, true, can->now_ms);
    if (check == E2E_OK || check == E2E_SOME_LOST) {
        can->received = message;
    }
}

void vehicle_can_expire(vehicle_can_t *can)
{
    for (messages_kind_t kind = MESSAGES_WHEEL_STATE; kind < MESSAGES_KINDS; kind++) {
        (void)e2e_timed_out(&can->link[kind], can->now_ms);
    }
    if (can->link[MESSAGES_WHEEL_BRAKE].link != E2E_VALID) {
        can->received.hydraulic_valid = false;
        can->received.electric_brake_available_mNm = 0;
    }
}
