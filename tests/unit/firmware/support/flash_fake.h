/* SPDX-License-Identifier: Apache-2.0 */
/*
 * flash_fake.h: hal/flash.h as the manual describes such a memory: an erase sets all bits,
 * programming only clears them, and a supply that fails meanwhile leaves the word or the sector in
 * work undefined between before and after.
 */
#ifndef FLASH_FAKE_H
#define FLASH_FAKE_H

#include <setjmp.h>

#include "hal/flash.h"

/* Of a sector; whoever stores whole configurations defines more. */
#ifndef FLASH_FAKE_WORDS
#define FLASH_FAKE_WORDS 1360
#endif
enum { FAKE_WORDS = FLASH_FAKE_WORDS, FAKE_BYTES = 4 * FAKE_WORDS };

typedef struct {
    uint32_t word[FLASH_SECTORS][FAKE_WORDS];
    uint32_t operations; /* erases and words */
    uint32_t cut_at;     /* the supply fails in this operation, from 1; 0: never */
    uint32_t fails_at;   /* this operation does not work */
    uint32_t random;
    bool bridge_on;
    jmp_buf supply_lost; /* where a cut goes */
} flash_fake_t;

extern flash_fake_t fake;

/* Sectors erased but for an image in configuration A. */
void fake_deliver(const void *image, uint32_t size_bytes);

#endif
