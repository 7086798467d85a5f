/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/mac.h"

/* Numbers of the paper: rounds after each block of the message and at the end, initial state
 * ("somepseudorandomlygeneratedbytes"), and the rotations of a round. */
enum { ROUNDS_A_BLOCK = 2, ROUNDS_AT_THE_END = 4 };

typedef struct {
    uint64_t v0, v1, v2, v3;
} state_t;

static uint64_t rotated(uint64_t x, unsigned bits)
{
    return x << bits | x >> (64U - bits);
}

static void mix(state_t *s, int rounds)
{
    for (int i = 0; i < rounds; i++) {
        s->v0 += s->v1;
        s->v2 += s->v3;
        s->v1 = rotated(s->v1, 13) ^ s->v0;
        s->v3 = rotated(s->v3, 16) ^ s->v2;
        s->v0 = rotated(s->v0, 32);
        s->v2 += s->v1;
        s->v0 += s->v3;
        s->v1 = rotated(s->v1, 17) ^ s->v2;
        s->v3 = rotated(s->v3, 21) ^ s->v0;
        s->v2 = rotated(s->v2, 32);
    }
}

static void absorb(state_t *s, uint64_t block)
{
    s->v3 ^= block;
    mix(s, ROUNDS_A_BLOCK);
    s->v0 ^= block;
}

uint64_t mac_of(const uint32_t key[MAC_KEY_WORDS], uint64_t message)
{
    const uint64_t k0 = key[0] | (uint64_t)key[1] << 32;
    const uint64_t k1 = key[2] | (uint64_t)key[3] << 32;
    state_t s = {.v0 = k0 ^ UINT64_C(0x736F6D6570736575),
                 .v1 = k1 ^ UINT64_C(0x646F72616E646F6D),
                 .v2 = k0 ^ UINT64_C(0x6C7967656E657261),
                 .v3 = k1 ^ UINT64_C(0x7465646279746573)};
    absorb(&s, message);
    absorb(&s, (uint64_t)MAC_BYTES << 56); /* the last block holds the message's length */
    s.v2 ^= 0xFF;
    mix(&s, ROUNDS_AT_THE_END);
    return s.v0 ^ s.v1 ^ s.v2 ^ s.v3;
}
