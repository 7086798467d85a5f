/* SPDX-License-Identifier: Apache-2.0 */
/*
 * digest.h: one number for a long story: MurmurHash3 over the fields of both steps' outputs, each
 * as 32 bits. Not over the structures, whose padding and enumeration sizes are each compiler's own.
 */
#ifndef TARGET_DIGEST_H
#define TARGET_DIGEST_H

#include <stdint.h>

#include "controller/controller.h"

typedef struct {
    uint32_t state;
    uint32_t words;
} digest_t;

void digest_begin(digest_t *digest);

/* What a fast step hands to the bridge, its latest period, and what it would report. */
void digest_fast(digest_t *digest, const fast_output_t *out, const controller_fast_t *fast);

/* What a slow step hands to the vehicle and to the fast loop. */
void digest_slow(digest_t *digest, const slow_output_t *out, const fast_setpoint_t *setpoint);

uint32_t digest_end(const digest_t *digest);

#endif
