/* SPDX-License-Identifier: Apache-2.0 */
/*
 * encoder.h: an incremental encoder with index on the shaft, and its 16-bit counter.
 *
 * The counter follows both edges of both tracks and wraps; where it stands at the beginning means
 * nothing. The index pulse begins where the electrical angle is index_deg, once in a mechanical
 * turn, and is width counts long: turning forward its front is captured, turning back its end.
 */
#ifndef PLANT_ENCODER_H
#define PLANT_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#include "plant/parameter.h"

/* clang-format off */
#define ENCODER_PARAMETERS(X) \
    X(counts,              0.0,   65536.0, "1", \
      "in a mechanical turn, four to a line; 0: no encoder") \
    X(index_deg,           0.0,   360.0,   "deg", "electrical angle at the index pulse") \
    X(index_width_counts,  0.0,   1024.0,  "1",   "length of the index pulse") \
    X(reversed,            0.0,   1.0,     "",    "1: the count falls when turning forward") \
    X(lost_counts,        -1000.0, 1000.0, "1", \
      "counts that go missing half-way between two index pulses")
/* clang-format on */

typedef struct {
    ENCODER_PARAMETERS(PLANT_PARAMETER_MEMBER)
} encoder_params_t;

typedef struct {
    double theta_turn;  /* electrical, of the last sample, within one turn */
    int64_t turns;      /* electrical turns since the beginning */
    double shaft_turns; /* mechanical, from an index, of the last sample */
    double lost_counts; /* so far */
} encoder_shaft_t;

typedef struct {
    uint16_t count, index_count;
    bool index; /* since the last sample */
} encoder_sample_t;

/* first_turn: whole electrical turns of the shaft from its index at the beginning, anywhere in a
 * mechanical turn. */
encoder_shaft_t encoder_begin(const encoder_params_t *params, double pole_pairs, double theta_turn,
                              int64_t first_turn);

/* theta_turn: electrical, 0 <= theta < 1, less than half a turn away from the last one. */
encoder_sample_t encoder_read(const encoder_params_t *params, double pole_pairs,
                              encoder_shaft_t *shaft, double theta_turn);

#endif
