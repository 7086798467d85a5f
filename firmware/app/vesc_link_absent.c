/* SPDX-License-Identifier: Apache-2.0 */
/* The port has no flash for VESC status frames: can.vesc_status has no effect. */
#include "app/vesc_link.h"

void vesc_link_step(vesc_link_t *link, const config_t *config, const vesc_link_view_t *view,
                    const energy_t *energy, uint32_t now_ms)
{
    (void)link;
    (void)config;
    (void)view;
    (void)energy;
    (void)now_ms;
}
