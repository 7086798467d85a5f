/* SPDX-License-Identifier: Apache-2.0 */
/* wiring.h: the plant's signals at the pins of the board that the image is for. Codes as in
 * hal/analog.h. */
#ifndef CHIP_WIRING_H
#define CHIP_WIRING_H

#include "chip.h"

/* The board of every chip from here on; without a call the first of the chip's. False: there is
 * none of this name. */
bool wiring_choose(const char *board);

typedef struct {
    bool low_side;     /* else in the phases, which carry the current all the time */
    bool at[3];        /* phases a, b, c */
    double settling_s; /* of their amplifiers, before the converters begin to sample */
} wiring_shunts_t;
wiring_shunts_t wiring_shunts(void);

/* What the plant's codes stand for, of the image's configuration. */
void wiring_full_scales(double current_a, double voltage_v);

void wiring_currents(chip_t *chip, const uint16_t code[3]);
void wiring_bus_voltage(chip_inputs_t *in, uint16_t code);
void wiring_halls(chip_inputs_t *in, uint8_t state);
void wiring_temperatures(chip_inputs_t *in, int32_t winding_cC, int32_t switch_cC);

/* The program drives the outputs that the board needs from the start on, its supply included. */
bool wiring_outputs_hold(chip_t *chip);

/* A line of its own shows a fault of the gate drivers. */
bool wiring_has_fault_line(void);

/* These pins of a port, 0 = A, at these levels. */
static inline void wiring_pins(chip_inputs_t *in, int port, unsigned pins, unsigned level)
{
    in->driven[port] = (uint16_t)(in->driven[port] | pins);
    in->level[port] = (uint16_t)((in->level[port] & ~pins) | (level & pins));
}

#endif
