/* SPDX-License-Identifier: Apache-2.0 */
#include "app/vesc_link.h"

#include "hal/can.h"

/* 1 mA ms is 1 uC, 1 mrad/s ms is 1 urad. */
static void add(vesc_link_t *link, const slow_output_t *output, uint16_t milliseconds)
{
    const int64_t charge_uC = (int64_t)output->bus_current_mA * milliseconds;
    link->turned_urad += (int64_t)output->speed_mrad_s * milliseconds;
    link->drawn_uC += charge_uC > 0 ? (uint64_t)charge_uC : 0U;
    link->returned_uC += charge_uC < 0 ? (uint64_t)-charge_uC : 0U;
}

static uint8_t controller_id(const config_t *config)
{
    return (uint8_t)(config->can.vesc_status + config->vehicle.wheel_position);
}

/* A frame that has left, or has given its place, is not sent again: the next kind's turn. */
static void follow_sent(vesc_link_t *link, const config_t *config)
{
    const uint32_t identifier =
        CAN_EXTENDED | vesc_status_identifier(link->kind, controller_id(config));
    if (link->pending && can_progress(identifier) != CAN_PENDING) {
        link->pending = false;
        link->kind = (vesc_status_kind_t)(((uint32_t)link->kind + 1U) % VESC_STATUS_KINDS);
    }
}

static bool transmit(const vesc_link_t *link, const config_t *config, const vesc_link_view_t *view,
                     const energy_t *energy)
{
    const slow_output_t *output = view->output;
    const messages_energy_t since_start = energy_report(energy, false);
    const vesc_status_values_t values = {
        .speed_mrad_s = output->speed_mrad_s,
        .pole_pairs = config->motor.pole_pairs,
        .i_d_mA = output->i_d_mA,
        .i_q_mA = output->i_q_mA,
        .u_pu = dq_of(view->u_pu),
        .bus_voltage_mV = output->bus_voltage_mV,
        .bus_current_mA = output->bus_current_mA,
        .temperature = *view->temperature,
        .turned_urad = link->turned_urad,
        .drawn_uC = link->drawn_uC,
        .returned_uC = link->returned_uC,
        .drawn_10J = since_start.drawn_10J,
        .returned_10J = since_start.returned_10J,
    };
    const vesc_status_frame_t frame = vesc_status_frame(link->kind, controller_id(config), &values);
    can_frame_t sent = {.identifier = CAN_EXTENDED | frame.identifier, .length = sizeof sent.data};
    for (uint32_t k = 0; k < sizeof sent.data; k++) {
        sent.data[k] = frame.data[k];
    }
    return can_transmit(&sent);
}

void vesc_link_step(vesc_link_t *link, const config_t *config, const vesc_link_view_t *view,
                    const energy_t *energy, uint32_t now_ms)
{
    if (config->can.vesc_status == 0) {
        return;
    }
    add(link, view->output, (uint16_t)(view->slow_steps - link->slow_steps));
    link->slow_steps = view->slow_steps;
    follow_sent(link, config);
    if (now_ms - link->sent_ms >= VESC_LINK_PERIOD_ms && transmit(link, config, view, energy)) {
        link->sent_ms = now_ms;
        link->pending = true;
    }
}
