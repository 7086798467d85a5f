/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_tolerance.h: what a healthy hydraulic brake and an inertia that is not learned may add
 * to the torque that is missing, part of hydraulic_watch.c. README, Watch of the hydraulic brake.
 */
#ifndef TORQUE_HYDRAULIC_TOLERANCE_H
#define TORQUE_HYDRAULIC_TOLERANCE_H

#include "core/q15.h"
#include "torque/hydraulic_watch.h"

enum {
    HYDRAULIC_GAIN_PART = 5,             /* of its torque, that a brake may make more or less */
    HYDRAULIC_INERTIA_PART = 10,         /* of the known torque, that another inertia may take */
    HYDRAULIC_FOLLOWED_MOST_q8 = 1 << 23 /* largest change of the road in a millisecond */
};

/* An error by a part of a torque looks like a road: what of it the road has had no time to follow.
 * |torque| < 2^24. */
static inline int32_t unfollowed_mNm(int32_t *followed_q4_mNm, int32_t torque_mNm,
                                     int32_t change_q8_mNm, int32_t part)
{
    const int32_t apart_q4_mNm = torque_mNm * 16 - *followed_q4_mNm;
    const int32_t most_q8_mNm = q_min(change_q8_mNm, HYDRAULIC_FOLLOWED_MOST_q8);
    const int32_t follows_q4_mNm = q_limit(apart_q4_mNm, most_q8_mNm * part / 16);
    *followed_q4_mNm += follows_q4_mNm;
    return q_abs(apart_q4_mNm - follows_q4_mNm) / (16 * part);
}

/* Of both, after a change of the road by up to that much. */
static inline int32_t hydraulic_unfollowed_mNm(hydraulic_watch_t *watch, int32_t hydraulic_mNm,
                                               int32_t known_mNm, int32_t change_q8_mNm)
{
    return unfollowed_mNm(&watch->hydraulic_q4_mNm, hydraulic_mNm, change_q8_mNm,
                          HYDRAULIC_GAIN_PART) +
           unfollowed_mNm(&watch->known_q4_mNm, known_mNm, change_q8_mNm, HYDRAULIC_INERTIA_PART);
}

/* Of a ramp, a brake twice as late as configured misses two thirds of what lies between that and
 * one twice as early. */
static inline int32_t hydraulic_late_mNm(int32_t uncertain_mNm)
{
    return uncertain_mNm - uncertain_mNm / 4;
}

/* What is found without reports: a sixteenth more, since less is tolerated. */
static inline int32_t hydraulic_end_mNm_ms(int32_t enough_mNm_ms)
{
    return q_min(enough_mNm_ms, INT32_MAX / 2) / 16 * 17;
}

/* Sum of what exceeds the tolerance, from zero up to the end. */
static inline int32_t hydraulic_summed(int32_t sum_mNm_ms, int32_t beyond_mNm, int32_t end_mNm_ms)
{
    return q_clamp(q_saturate64((int64_t)sum_mNm_ms + beyond_mNm), 0, end_mNm_ms);
}

#endif
