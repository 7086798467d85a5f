/* SPDX-License-Identifier: Apache-2.0 */
/*
 * boards.h: what the boards with an STM32F405 connect with its pins, from the VESC firmware's
 * hwconf/trampa/vesc6/hw_60_core.h and hwconf/other/vesc4/hw_410.h, hw_410.c,
 * hwconf/trampa/75_300/hw_75_300_core.h, hwconf/makerbase/84_200_HP/hw_mksesc_84_200_hp.h; and a
 * gate board of one's own, as hal/stm32f405/boards/gate_board.h describes it.
 */
#ifndef CHIP_BOARDS_H
#define CHIP_BOARDS_H

#include <stdbool.h>
#include <stdint.h>

enum { BOARDS_NO_CHANNEL = 255, BOARDS_OUTPUTS_MOST = 3 };

typedef struct {
    char port; /* 0: not wired */
    uint8_t pin;
} wire_t;

typedef struct {
    wire_t wire;
    bool high;
} output_t;

typedef struct {
    const char *name;
    bool low_side_shunts; /* else in the phases */
    double settling_s;    /* of their amplifiers */
    double shunt_ohm, gain;
    bool rising;                /* with current into the motor; else falling */
    double reference_v;         /* of the converters */
    uint8_t current_channel[3]; /* of the converters, for a, b, c */
    uint8_t bus_channel, winding_channel, switch_channel;
    double upper_ohm, lower_ohm; /* divider of the bus voltage */
    double switch_beta_k;        /* its thermistor goes to the supply, the winding's to ground */
    wire_t hall[3];              /* or A, B and index of an encoder */
    bool encoder_at_tim3;        /* else at a timer that is not used */
    wire_t enable, fault;        /* of the gate driver; without enable it always drives, and its
                                    fault line is pulled both ways */
    wire_t sdi, sdo, sclk, nscs; /* its bus; the DRV8302 has none */
    uint32_t oc_adj_mV;          /* and has its threshold at this pin */
    wire_t calibrate;            /* high: its amplifiers measure no current */
    wire_t power_hold;           /* high: keeps the supply on */
    output_t outputs[BOARDS_OUTPUTS_MOST]; /* levels that the board needs from the start on */
} board_t;

/* The one in force, wiring_choose(). */
const board_t *boards_chosen(void);

static inline bool wire_is(wire_t wire, char port, unsigned pin)
{
    return wire.port == port && wire.pin == pin;
}

#endif
