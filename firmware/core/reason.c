/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reason.h"

/* Codes, identifiers and texts in the order of the lists. The words of a column are one string,
 * each behind the zero of the one before: for shells and logs, in half a kilobyte of flash less
 * than with a pointer to each. */
#define LIMIT_NUMBER(number, identifier, text) (number),
#define FAULT_NUMBER(number, identifier, text, clearing, driver) (number),
static const uint8_t NUMBERS[] = {LIMIT_LIST(LIMIT_NUMBER) FAULT_LIST(FAULT_NUMBER)};
#undef LIMIT_NUMBER
#undef FAULT_NUMBER

#define LIMIT_NAME(number, identifier, text) #identifier "\0"
#define FAULT_NAME(number, identifier, text, clearing, driver) #identifier "\0"
static const char NAMES[] = LIMIT_LIST(LIMIT_NAME) FAULT_LIST(FAULT_NAME);
#undef LIMIT_NAME
#undef FAULT_NAME

#define LIMIT_TEXT(number, identifier, text) text "\0"
#define FAULT_TEXT(number, identifier, text, clearing, driver) text "\0"
static const char TEXTS[] = LIMIT_LIST(LIMIT_TEXT) FAULT_LIST(FAULT_TEXT);
#undef LIMIT_TEXT
#undef FAULT_TEXT

static const char *word_of(reason_t reason, const char *words)
{
    for (uint32_t k = 0; k < sizeof NUMBERS; k++) {
        if (NUMBERS[k] == (uint32_t)reason) {
            return words;
        }
        while (*words != '\0') {
            words++;
        }
        words++;
    }
    return "unknown reason";
}

const char *reason_text(reason_t reason)
{
    return word_of(reason, TEXTS);
}

const char *reason_name(reason_t reason)
{
    return word_of(reason, NAMES);
}

bool reason_listed(uint32_t place, reason_t *reason)
{
    if (place >= sizeof NUMBERS) {
        return false;
    }
    *reason = (reason_t)NUMBERS[place];
    return true;
}
