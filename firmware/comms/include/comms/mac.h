/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mac.h: a message authentication code: SipHash-2-4 (J.-P. Aumasson, D. J. Bernstein, "SipHash: a
 * fast short-input PRF", 2012) of eight bytes. Who does not know the key cannot compute it.
 */
#ifndef COMMS_MAC_H
#define COMMS_MAC_H

#include <stdint.h>

enum { MAC_KEY_WORDS = 4, MAC_BYTES = 8 };

/* Key, message and result as bytes are little endian, word after word. */
uint64_t mac_of(const uint32_t key[MAC_KEY_WORDS], uint64_t message);

#endif
