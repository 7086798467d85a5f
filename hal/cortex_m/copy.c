/* SPDX-License-Identifier: Apache-2.0 */
#include "copy.h"

#include <stdint.h>

/* Else GCC may replace the loops by calls of the functions that they are in. */
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-loop-distribute-patterns")
#endif

/* Words of whatever object they are in. */
typedef uint32_t __attribute__((may_alias)) word_t;
typedef struct {
    uint32_t first, second, third, fourth;
} __attribute__((may_alias)) words_t;

void *copy_bytes(void *destination, const void *source, size_t size_bytes)
{
    uint8_t *to = destination;
    const uint8_t *from = source;
    const uint8_t *const end = to + size_bytes;
    if ((((uintptr_t)to | (uintptr_t)from) & 3U) == 0) {
        while ((size_t)(end - to) >= sizeof(word_t)) {
            *(word_t *)(void *)to = *(const word_t *)(const void *)from;
            to += sizeof(word_t);
            from += sizeof(word_t);
        }
    }
    while (to != end) {
        *to++ = *from++;
    }
    return destination;
}

void *fill_bytes(void *destination, int value, size_t size_bytes)
{
    uint8_t *to = destination;
    const uint8_t *const end = to + size_bytes;
    const uint32_t word = ((uint32_t)value & 0xFFU) * UINT32_C(0x01010101);
    while (to != end) {
        if (((uintptr_t)to & 3U) != 0 || (size_t)(end - to) < sizeof(word_t)) {
            *to++ = (uint8_t)word;
            continue;
        }
        while ((size_t)(end - to) >= sizeof(words_t)) {
            *(words_t *)(void *)to = (words_t){word, word, word, word};
            to += sizeof(words_t);
        }
        while ((size_t)(end - to) >= sizeof(word_t)) {
            *(word_t *)(void *)to = word;
            to += sizeof(word_t);
        }
    }
    return destination;
}
