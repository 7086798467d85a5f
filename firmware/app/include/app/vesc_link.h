/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vesc_link.h: sends the wheel's VESC status frames (comms/vesc_status.h), one each 20 ms in turn,
 * so each kind every 100 ms. Background context, every pass after all other frames: hal/can.h takes
 * a frame of 29 bits only while none of ours is under way.
 */
#ifndef APP_VESC_LINK_H
#define APP_VESC_LINK_H

#include <stdbool.h>
#include <stdint.h>

#include "app/energy.h"
#include "comms/vesc_status.h"
#include "config/config.h"
#include "core/fast_messages.h"

enum { VESC_LINK_PERIOD_ms = 20 };

/* All zero at the start. */
typedef struct {
    int64_t turned_urad; /* sums of each millisecond, as energy_t */
    uint64_t drawn_uC, returned_uC;
    uint16_t slow_steps;     /* until the latest pass */
    uint32_t sent_ms;        /* when the latest frame was given to the CAN controller */
    bool pending;            /* the controller has that frame */
    vesc_status_kind_t kind; /* of it, or of the next one */
} vesc_link_t;

/* Of the slow step slow_steps. */
typedef struct {
    const slow_output_t *output;
    const wheel_temperatures_t *temperature;
    dq16_t u_pu; /* fast_report_t */
    uint16_t slow_steps;
} vesc_link_view_t;

/* Nothing at all with config->can.vesc_status 0. */
void vesc_link_step(vesc_link_t *link, const config_t *config, const vesc_link_view_t *view,
                    const energy_t *energy, uint32_t now_ms);

#endif
