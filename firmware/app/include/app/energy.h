/* SPDX-License-Identifier: Apache-2.0 */
/*
 * energy.h: the wheel's energy account, since the start of the program and for life. Background
 * context, every pass.
 *
 *     drawn            bus voltage * bus current, while positive
 *     returned         the same, while negative
 *     motor braking    motor torque * speed, while it brakes
 *     friction         commanded hydraulic torque * speed
 *
 * Powers of each millisecond; where a pass of the background takes longer, the latest ones count
 * for all its milliseconds. The bus current is the controller's estimate, and the friction is what
 * was commanded: none while the brake system uses its own path (slow_output_t.hydraulic_valid).
 *
 * For life is what the journal had at the start and what came since; fault_journal.h stores it
 * each time the driver switches off. What came since then is lost with the supply and with a reset.
 * energy_frame.h sends both by CAN.
 */
#ifndef APP_ENERGY_H
#define APP_ENERGY_H

#include <stdbool.h>
#include <stdint.h>

#include "comms/messages.h"
#include "comms/text.h"
#include "core/slow_messages.h"

enum { ENERGY_DRAWN, ENERGY_RETURNED, ENERGY_MOTOR_BRAKING, ENERGY_FRICTION, ENERGY_KINDS };

typedef struct {
    uint32_t life_10J[ENERGY_KINDS];   /* saturating */
    uint32_t before_10J[ENERGY_KINDS]; /* of that, at the start */
    uint64_t rest_nJ[ENERGY_KINDS];    /* less than 10 J */
    uint16_t slow_steps;               /* until the latest pass */
} energy_t;

/* before_10J: for life, as the journal has it. */
void energy_init(energy_t *energy, const uint32_t before_10J[ENERGY_KINDS]);

/* slow_steps: counted by the slow loop, modulo 2^16. */
void energy_step(energy_t *energy, const slow_output_t *output, uint16_t slow_steps);

messages_energy_t energy_report(const energy_t *energy, bool for_life);

/* Line `number` (from 0) of the shell's answer; false if there is no such line. */
bool energy_line(const energy_t *energy, uint32_t number, text_t *line);

#endif
