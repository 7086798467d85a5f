/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reason.h"

#include "core/words.h"

/* Codes and identifiers in the order of the lists, behind them that of a number without a row. */
#define LIMIT_NUMBER(number, identifier, text) (number),
#define FAULT_NUMBER(number, identifier, text, clearing, driver) (number),
static const uint8_t NUMBERS[] = {LIMIT_LIST(LIMIT_NUMBER) FAULT_LIST(FAULT_NUMBER)};
#undef LIMIT_NUMBER
#undef FAULT_NUMBER

#define LIMIT_NAME(number, identifier, text) #identifier "\0"
#define FAULT_NAME(number, identifier, text, clearing, driver) #identifier "\0"
static const char NAMES[] = LIMIT_LIST(LIMIT_NAME) FAULT_LIST(FAULT_NAME) "unknown reason\0";
#undef LIMIT_NAME
#undef FAULT_NAME

uint32_t reason_place(reason_t reason)
{
    uint32_t place = 0;
    while (place < sizeof NUMBERS && NUMBERS[place] != (uint32_t)reason) {
        place++;
    }
    return place;
}

const char *reason_name(reason_t reason)
{
    return words_at(NAMES, reason_place(reason));
}

bool reason_listed(uint32_t place, reason_t *reason)
{
    if (place >= sizeof NUMBERS) {
        return false;
    }
    *reason = (reason_t)NUMBERS[place];
    return true;
}
