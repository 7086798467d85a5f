/* SPDX-License-Identifier: Apache-2.0 */
#include "app/energy_frame.h"

void energy_frame_transmit(can_link_t *link, uint32_t now_ms, const energy_t *energy)
{
    if (node_energy_is_due(&link->node, now_ms)) {
        const messages_energy_t since_start = energy_report(energy, false);
        const messages_energy_t for_life = energy_report(energy, true);
        can_link_transmit_energy(link, now_ms, &since_start, &for_life);
    }
}
