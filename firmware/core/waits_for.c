/* SPDX-License-Identifier: Apache-2.0 */
#include "core/waits_for.h"

const char *waits_for_text(waits_for_t waits_for)
{
    switch (waits_for) {
#define WAITS_FOR_TEXT_LINE(number, identifier, text)                                              \
    case WAITS_FOR_##identifier:                                                                   \
        return text;
        WAITS_FOR_LIST(WAITS_FOR_TEXT_LINE)
#undef WAITS_FOR_TEXT_LINE
    }
    return "unknown";
}
