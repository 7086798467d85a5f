/* SPDX-License-Identifier: Apache-2.0 */
#include "encoder.h"

#include "angle_tracker.h"
#include "core/angle.h"
#include "core/q15.h"

void encoder_init(encoder_t *encoder, const config_t *config)
{
    const encoder_t fresh = {.sign = config->rotor.encoder_reversed != 0 ? -1 : 1};
    *encoder = fresh;
    const uint64_t counts = (uint64_t)q_max(config->rotor.encoder_counts, 1);
    const uint64_t pole_pairs = (uint64_t)config->motor.pole_pairs;
    encoder->counts = (int32_t)counts;
    encoder->tolerance_counts = config->rotor.encoder_index_tolerance_counts;
    encoder->overdue_counts = encoder->counts + encoder->counts / ENCODER_OVERDUE_DIVISOR;
    encoder->max_counts = (int32_t)(counts / (8U * pole_pairs)) + 1;
    encoder->turn_per_count_q32 = (uint32_t)(((pole_pairs << 32) + counts / 2U) / counts);
    encoder->count_turn = (int32_t)(encoder->turn_per_count_q32 >> 16) + 1;
    /* The counter changes at the edges of the lines in both directions: the captured count begins
     * at the index and extends forward. */
    encoder->origin_q32 =
        ((uint32_t)config->rotor.encoder_index_turn << 16) + encoder->turn_per_count_q32 / 2U;
    encoder->base_q32 = encoder->origin_q32;
}

/* b - a of a wrapping counter, -32 768 .. 32 767. */
static int32_t difference(uint16_t b, uint16_t a)
{
    return angle_difference(b, a);
}

/* Moves the origin of the position to at_counts. The tracked angle makes the same jump, so that the
 * loop keeps its speed. */
static void move_origin(encoder_t *encoder, int32_t at_counts)
{
    encoder->position_counts -= at_counts;
    encoder->tracker.theta_q32 -= (uint32_t)at_counts * encoder->turn_per_count_q32;
}

static bool within(const encoder_t *encoder, int32_t deviation_counts)
{
    return q_abs(deviation_counts) <= encoder->tolerance_counts;
}

/* An index pulse at a position: the first one, a confirming one (a turn later, a turn earlier or at
 * the same place), or one that contradicts the counts and becomes the new reference. */
static void process_index(encoder_t *encoder, int32_t at_counts)
{
    if (!encoder->referenced) {
        encoder->referenced = true;
        encoder->valid = true;
        encoder->tracker.theta_q32 += encoder->origin_q32 - encoder->base_q32;
        encoder->base_q32 = encoder->origin_q32;
        move_origin(encoder, at_counts);
    } else if (within(encoder, at_counts)) {
        encoder->valid = true;
    } else if (within(encoder, at_counts - encoder->counts)) {
        encoder->valid = true;
        move_origin(encoder, encoder->counts);
    } else if (within(encoder, at_counts + encoder->counts)) {
        encoder->valid = true;
        move_origin(encoder, -encoder->counts);
    } else {
        encoder->valid = false;
        encoder->faults++;
        move_origin(encoder, at_counts);
    }
}

/* More than a turn and an eighth from the last index: one was missed. */
static void process_missing_index(encoder_t *encoder)
{
    encoder->faults++;
    move_origin(encoder, encoder->position_counts > 0 ? encoder->counts : -encoder->counts);
}

/* The first period, or a jump that no rotor can make. After a jump the angle continues from its
 * predicted value until the next index. */
static void restart(encoder_t *encoder)
{
    if (encoder->started) {
        encoder->faults++;
        encoder->base_q32 = encoder->tracker.theta_q32 + (uint32_t)encoder->tracker.speed_q32;
    }
    encoder->started = true;
    encoder->referenced = false;
    encoder->valid = false;
    encoder->position_counts = 0;
}

void encoder_step(encoder_t *encoder, const config_t *config, const encoder_input_t *in)
{
    int32_t moved_counts = encoder->sign * difference(in->count, encoder->last_count);
    if (!encoder->started || q_abs(moved_counts) > encoder->max_counts) {
        restart(encoder);
        moved_counts = 0;
    }
    encoder->last_count = in->count;
    encoder->position_counts += moved_counts;
    if (in->index) {
        process_index(encoder, encoder->position_counts +
                                   encoder->sign * difference(in->index_count, in->count));
    }
    if (q_abs(encoder->position_counts) > encoder->overdue_counts) {
        process_missing_index(encoder);
    }
    const uint32_t measured_q32 =
        encoder->base_q32 + (uint32_t)encoder->position_counts * encoder->turn_per_count_q32;
    const uint16_t measured_turn = (uint16_t)(measured_q32 >> 16);
    angle_tracker_step(&encoder->tracker, config, measured_turn);
    const int32_t ahead_turn =
        angle_difference((uint16_t)(encoder->tracker.theta_q32 >> 16), measured_turn);
    encoder->theta_turn =
        (uint16_t)(measured_turn + (uint32_t)q_limit(ahead_turn, encoder->count_turn));
}
