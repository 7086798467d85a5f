/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reason.h"

const char *reason_text(reason_t reason)
{
    switch (reason) {
#define REASON_TEXT_LINE(number, identifier, text)                                                 \
    case REASON_##identifier:                                                                      \
        return text;
        REASON_LIST(REASON_TEXT_LINE)
#undef REASON_TEXT_LINE
    }
    return "unknown reason";
}
