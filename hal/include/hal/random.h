/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random.h: bits that nobody can predict, for the lock of the service protocol (comms/xcp.h). The
 * source is named in the port.
 */
#ifndef HAL_RANDOM_H
#define HAL_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

/* Draws 64 bits. False: this port has no source, or it does not work now; nothing is unlocked then.
 * Background context; at most a tenth of a millisecond. */
bool random_draw(uint64_t *bits);

#endif
