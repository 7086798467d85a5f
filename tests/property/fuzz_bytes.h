/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_bytes.h: a fuzzer's input as a string of bytes, and memory changed by it. For the programs
 * fuzz_*.c, each of which includes it once.
 */
#ifndef FUZZ_BYTES_H
#define FUZZ_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config/config.h"

typedef struct {
    const uint8_t *at;
    size_t left;
} bytes_t;

#define require(holds) require_at(holds, __LINE__)

static inline void require_at(bool holds, int line)
{
    if (!holds) {
        fprintf(stderr, "broken promise in line %d\n", line);
        abort();
    }
}

/* After the end of the input everything is zero. */
static inline uint8_t take8(bytes_t *bytes)
{
    if (bytes->left == 0) {
        return 0;
    }
    bytes->left--;
    return *bytes->at++;
}

static inline uint16_t take16(bytes_t *bytes)
{
    const uint8_t low = take8(bytes);
    return (uint16_t)(low | (uint16_t)(take8(bytes) << 8));
}

static inline uint32_t take32(bytes_t *bytes)
{
    const uint16_t low = take16(bytes);
    return low | (uint32_t)take16(bytes) << 16;
}

/* Up to seven bytes of a memory. */
static inline void change_bytes(void *memory, size_t size, bytes_t *bytes)
{
    uint8_t *const at = memory;
    for (uint32_t changes = take8(bytes) % 8U; changes > 0; changes--) {
        const size_t where = take16(bytes) % size;
        at[where] = take8(bytes);
    }
}

/* Up to seven words of a copy of a configuration: other values, or others of their bits. */
static inline void change_words(config_t *image, const config_t *from, bytes_t *bytes)
{
    *image = *from;
    uint8_t *const at = (uint8_t *)image;
    for (uint32_t changes = take8(bytes) % 8U; changes > 0; changes--) {
        const uint16_t where = take16(bytes);
        /* Heads, names and scalar fields are in the first quarter; the rest is maps. */
        const size_t words = sizeof *image / 4U / (where < 0xC000U ? 4U : 1U);
        uint32_t word;
        memcpy(&word, at + 4U * (where % words), sizeof word);
        const uint8_t how = take8(bytes);
        word = how < 64U    ? word + how - 32U
               : how < 128U ? word ^ (UINT32_C(1) << how % 32U)
                            : take32(bytes);
        memcpy(at + 4U * (where % words), &word, sizeof word);
    }
}

/* CRC-32 of IEEE 802.3 by a table, independent of config_crc32(). */
static inline uint32_t crc_of(const void *memory, size_t size)
{
    static uint32_t table[256];
    if (table[1] == 0) {
        for (uint32_t i = 0; i < 256U; i++) {
            uint32_t rest = i;
            for (int bit = 0; bit < 8; bit++) {
                rest = (rest & 1U) != 0 ? rest >> 1 ^ UINT32_C(0xEDB88320) : rest >> 1;
            }
            table[i] = rest;
        }
    }
    const uint8_t *const at = memory;
    uint32_t crc = UINT32_MAX;
    for (size_t i = 0; i < size; i++) {
        crc = crc >> 8 ^ table[(crc ^ at[i]) & 0xFFU];
    }
    return ~crc;
}

#endif
