/* SPDX-License-Identifier: Apache-2.0 */
/*
 * encoder.h: angle and speed from an incremental encoder with index (A, B, I), once per PWM period.
 *
 * Input: a free-running 16-bit count of all four edges of a line, and the count captured at the
 * index pulse. The angle is the count since the index times the electrical angle of one count, plus
 * the configured angle at the index. Output: theta_turn, tracker.speed_q32, faults, valid.
 *
 * Validity: false until the first index; false after an index pulse outside
 * encoder_index_tolerance_counts of its expected place, until the next one confirms; false after a
 * jump of more than 1/8 electrical turn and a count in one period, twice what the largest speed
 * makes (validator), until the next index. A missing index leaves it true. The last three count in
 * faults (DERIVATIONS.md, Encoder).
 *
 * The angle interpolates between counts with the tracking loop and never differs from the counted
 * angle by more than one count.
 */
#ifndef FOC_ENCODER_H
#define FOC_ENCODER_H

#include "config/config.h"
#include "foc/input.h"
#include "foc/state.h"

/* An index is missing 1/8 turn beyond a whole one: geometry, wider than any index pulse. */
enum { ENCODER_OVERDUE_DIVISOR = 8 };

/* Only with config.rotor.sensor = CONFIG_ROTOR_ENCODER. Divides. */
void encoder_init(encoder_t *encoder, const config_t *config);

/* One period. No division, no loop. */
void encoder_step(encoder_t *encoder, const config_t *config, const encoder_input_t *in);

#endif
