/* SPDX-License-Identifier: Apache-2.0 */
/*
 * digest.h: one number for a long story. CRC-32 (IEEE 802.3) over the fields of the controller's
 * outputs, each as four bytes, low byte first: not over the structures, whose padding and
 * enumeration sizes are each compiler's own.
 */
#ifndef TARGET_DIGEST_H
#define TARGET_DIGEST_H

#include <stdint.h>

#include "controller/controller.h"

typedef struct {
    uint32_t crc;
} digest_t;

void digest_begin(digest_t *digest);
void digest_fast(digest_t *digest, const fast_output_t *out, const fast_report_t *report);
void digest_slow(digest_t *digest, const slow_output_t *out, const fast_setpoint_t *command);
uint32_t digest_end(const digest_t *digest);

#endif
