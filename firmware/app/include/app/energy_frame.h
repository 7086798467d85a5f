/* SPDX-License-Identifier: Apache-2.0 */
/*
 * energy_frame.h: sends the energy account (energy.h) as WheelEnergy. Background context, every
 * pass after can_link_transmit(): the least urgent message of the wheel.
 */
#ifndef APP_ENERGY_FRAME_H
#define APP_ENERGY_FRAME_H

#include <stdint.h>

#include "app/can_link.h"
#include "app/energy.h"

/* Sends the frame if it is due and the CAN controller takes it. */
void energy_frame_transmit(can_link_t *link, uint32_t now_ms, const energy_t *energy);

#endif
