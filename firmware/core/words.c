/* SPDX-License-Identifier: Apache-2.0 */
#include "core/words.h"

const char *words_at(const char *words, uint32_t number)
{
    for (; number > 0 && *words != '\0'; number--) {
        while (*words != '\0') {
            words++;
        }
        words++;
    }
    return *words != '\0' ? words : "unknown";
}
