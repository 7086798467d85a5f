/* SPDX-License-Identifier: Apache-2.0 */
/*
 * encoder.h: angle and speed from an incremental encoder with index (A, B, I), once per PWM period.
 *
 * The port gives a free-running 16-bit count of all four edges of a line, and the count that a
 * timer captured at the index pulse. Differences of counts wrap with the counter, so neither its
 * start nor its overflow means anything. The angle is what was counted since the index, times the
 * electrical angle of one count (a reciprocal of the counts in a turn, worked out at start-up),
 * plus the configured angle at the index.
 *
 * Before the index has been seen the angle is not valid, and nothing may be driven by it: the wheel
 * must be rolled, at most one turn. There is no alignment by current: a wheel that carries a
 * vehicle is not free to turn to where a field points, and one held by its brake would only seem to
 * have arrived.
 *
 * Every index pulse must come where the last one was, a whole turn of counts later or earlier or at
 * the same place (rocking), within encoder_index_tolerance_counts. One that does not says that
 * counts were lost or came from nowhere, or that the pulse itself is false. Which of the two cannot
 * be known: the angle stops being valid, the new pulse becomes the reference, and the next one must
 * confirm it. No index over a turn and an eighth is noticed, too, but leaves the angle valid. More
 * than half an electrical turn in one period is no movement: the angle stops being valid and goes
 * on from where it was expected, to let the torque go with, and the index is looked for again. All
 * three count in faults.
 *
 * The speed is that of the tracking loop. Its angle interpolates between counts and is held within
 * one count of what the encoder says: however fast the speed changes, the angle is wrong by one
 * count at most.
 */
#ifndef FOC_ENCODER_H
#define FOC_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "foc/tracking.h"

enum {
    ENCODER_OVERDUE_DIVISOR = 8 /* of a turn: so much beyond a whole one an index is missing */
};

/* What the port saw in this period. */
typedef struct {
    uint16_t count;       /* free running, four to a line */
    uint16_t index_count; /* the count at the latest index pulse */
    bool index; /* an index pulse came since the last period; only then index_count is read */
} encoder_input_t;

typedef struct {
    /* Worked out once from the configuration. */
    uint32_t turn_per_count_q32; /* electrical */
    uint32_t origin_q32;         /* angle of count 0 after the index, in the middle of the count */
    int32_t counts;              /* in a mechanical turn */
    int32_t tolerance_counts;
    int32_t overdue_counts; /* beyond the last index: the next one is missing */
    int32_t most_counts;    /* in one period */
    int32_t count_turn;     /* electrical angle of one count */
    int32_t sign;           /* of a count when turning forward */
    /* State. */
    tracking_t tracking;
    uint16_t theta_turn;
    uint32_t base_q32; /* angle of position 0: origin_q32, or after a jump what was expected */
    int32_t position_counts; /* forward from the last index, or from anywhere before the first */
    int32_t age_periods;     /* since a count, at most 65 535 */
    uint16_t last_count;
    uint16_t faults; /* wrapping */
    bool started;
    bool referenced; /* an index was seen */
    bool valid;
} encoder_t;

/* Only with config.rotor.sensor = CONFIG_ROTOR_ENCODER. Divides. */
void encoder_init(encoder_t *encoder, const config_t *config);

/* Updates theta_turn, tracking.speed_q32, age_periods, faults and valid. No division, no loop. */
void encoder_step(encoder_t *encoder, const config_t *config, const encoder_input_t *in);

#endif
