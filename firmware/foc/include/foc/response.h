/* SPDX-License-Identifier: Apache-2.0 */
/*
 * response.h: how the current answers its reference, so that it does what it is designed for at
 * every sample, and so that whoever needs it knows the current that will flow (dead_time.h).
 *
 * Designed for: 1 - exp(-w (t - 1.5 T)) of a change, t since the sample that meets it first, w the
 * bandwidth. With b = exp(-w T/2) and a = b^2 that is 1 - b, 1 - a b, 1 - a^2 b .. at the samples
 * 2, 3, 4 .. The sampled loop has the poles a and 1 - a (current_loop.h) and answers a step with 0,
 * 0, K, 2 K .., K = a (1 - a): 0.197, 0.394 where 0.145, 0.376 are designed at w T = 0.31, because
 * the design begins half-way through a period and a bridge holds its voltage for a whole one. What
 * a reference of
 *
 *     w1 r[n] + (w2 - w1) r[n-1] + (1 - w2) r[n-2]        w1 = 1 / (b^2 (1 + b))        w2 = 1 / b
 *
 * makes of it is the design exactly: design over loop is (1 - b + (b - a)/z) (1 - (1 - a)/z) / K,
 * these three numbers. A change is held back by 1 - w1 in its first period and exceeded by w2 - 1
 * in the second; from the third on the reference is itself.
 *
 * The current is straight between samples. In the middle of the first period in which a voltage
 * answers, 1.5 periods after the sample, (1 - b)/2 has come; in the next one 1 - (b + a b)/2, from
 * where on what is missing shrinks to a share a of itself. Every share of a change that comes in a
 * period is positive: out of references in a circle no current is expected outside it, but for 24
 * LSB of rounding, and for what its mean is beside the reference.
 *
 * Where a sampled current is to be brought forward to that moment, 1 - a (1 + a)/2 =: m of what is
 * missing of the reference will have come: the current will be (1 - m) i + m r. In the first two
 * periods after a change, when nothing of it is there yet, the same shares hold with an aim before
 * r, (1 - b)/2 / m and (1 - (b + a b)/2) / m of the change.
 */
#ifndef FOC_RESPONSE_H
#define FOC_RESPONSE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/frames.h"
#include "core/q15.h"

/* What is not shaped is a twentieth off, so a change of less than this is not worth it: that is
 * below half a code of a 12-bit converter. A ramp of the torque is made of such changes. */
enum { RESPONSE_LEAST_PU = 128 };

/* The current that is expected. */
typedef struct {
    int32_t lag_q15; /* 1 - a, at least 1/16 */
    /* State. */
    dq_t settled_pu; /* once all has come, in the current circle */
    dq_t behind_pu;  /* what will be missing of it while the next voltage acts */
} response_expected_t;

/* The reference and its shape. */
typedef struct {
    int32_t held_q15;       /* 1 - w1, 0.07 .. 0.5 */
    int32_t exceeded_q15;   /* w2 - 1, 0 .. 0.29 */
    int32_t begun_q15;      /* (1 - b)/2 */
    int32_t begun_next_q15; /* b (1 - b)/2: what is missing in the second period beyond a share a of
                               the first */
    int32_t nearer_q15;     /* m, 0 .. 0.52 */
    int32_t short_q15; /* of a change, by which the aim lies before it in its first period, 0.78 ..
                          0.84 */
    int32_t short_next_q15; /* in its second period, 0.27 .. 0.34 */
    /* State. */
    dq_t reference_pu; /* in the current circle */
    dq_t change_pu;    /* of it, one period ago */
    bool settled; /* the reference was given as it is: without a change it need not be looked at
                     again */
} response_t;

typedef struct {
    dq_t reference_pu; /* for the regulators, up to 0.29 of a change beyond the reference */
    dq_t aim_pu; /* that brings sampled currents forward, between the references of three periods */
} response_given_t;

/* Faster than w T = 1/2, which regen_table refuses, counts as that. Divides. */
void response_init(response_t *response, response_expected_t *expected, const config_t *config);

/* Once a period while there are changes or it has not settled. reference: inside the unit circle.
 * mean: the current that is then to be expected, which need not be the one that is sampled; inside
 * the unit circle too. */
response_given_t response_follow(response_t *response, dq_t reference,
                                 response_expected_t *expected, dq_t mean);

/* Nothing flows, and nothing is to flow. */
void response_rest(response_t *response, response_expected_t *expected);

/* The current expected while this period's voltage acts. Once a period. */
Q_TARGET_INLINE dq_t response_expect(response_expected_t *expected)
{
    const dq_t behind = expected->behind_pu;
    const int32_t lag = expected->lag_q15;
    const dq_t next = {.d = behind.d - ((behind.d * lag) >> 15),
                       .q = behind.q - ((behind.q * lag) >> 15)};
    expected->behind_pu = next;
    const dq_t out = {.d = expected->settled_pu.d - behind.d,
                      .q = expected->settled_pu.q - behind.q};
    return out;
}

#endif
