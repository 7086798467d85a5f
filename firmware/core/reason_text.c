/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reason.h"
#include "core/words.h"

#define LIMIT_TEXT(number, identifier, text) text "\0"
#define FAULT_TEXT(number, identifier, text, clearing, driver) text "\0"
static const char TEXTS[] = LIMIT_LIST(LIMIT_TEXT) FAULT_LIST(FAULT_TEXT) "unknown reason\0";
#undef LIMIT_TEXT
#undef FAULT_TEXT

const char *reason_text(reason_t reason)
{
    return words_at(TEXTS, reason_place(reason));
}
