/* SPDX-License-Identifier: Apache-2.0 */
/*
 * words.h: a list of words as one string, each behind the zero of the one before: for shells and
 * logs, with less flash than a pointer to each. Any context.
 */
#ifndef CORE_WORDS_H
#define CORE_WORDS_H

#include <stdint.h>

/* Word `number` from 0 on of a list that ends with an empty one; "unknown" beyond it. */
const char *words_at(const char *words, uint32_t number);

#endif
