/* SPDX-License-Identifier: Apache-2.0 */
/*
 * digest.h: one hash of a whole run: MurmurHash3 over the fields of both steps' outputs, each as 32
 * bits. Field by field, because padding and size of enumerations depend on the compiler.
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

/* Adds the outputs of a fast step: bridge command, latest period, and report. */
void digest_fast(digest_t *digest, const fast_output_t *out, const controller_fast_t *fast);

/* Adds the outputs of a slow step to the vehicle and to the fast loop. */
void digest_slow(digest_t *digest, const slow_output_t *out, const fast_setpoint_t *setpoint);

uint32_t digest_end(const digest_t *digest);

#endif
