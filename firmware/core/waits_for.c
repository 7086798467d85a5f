/* SPDX-License-Identifier: Apache-2.0 */
#include "core/waits_for.h"

/* One behind the other, as in reason.c; the numbers of the list are its places. */
#define WAITS_FOR_TEXT_LINE(number, identifier, text) text "\0"
static const char TEXTS[] = WAITS_FOR_LIST(WAITS_FOR_TEXT_LINE);
#undef WAITS_FOR_TEXT_LINE

#define WAITS_FOR_COUNT_LINE(number, identifier, text) +1
enum { COUNT = 0 WAITS_FOR_LIST(WAITS_FOR_COUNT_LINE) };
#undef WAITS_FOR_COUNT_LINE

const char *waits_for_text(waits_for_t waits_for)
{
    if ((unsigned)waits_for >= COUNT) {
        return "unknown";
    }
    const char *text = TEXTS;
    for (unsigned before = 0; before < (unsigned)waits_for; text++) {
        before += *text == '\0' ? 1U : 0U;
    }
    return text;
}
