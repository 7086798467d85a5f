/* SPDX-License-Identifier: Apache-2.0 */
#include "core/reason.h"

const char *reason_text(reason_t reason)
{
    switch (reason) {
#define LIMIT_TEXT(number, identifier, text)                                                       \
    case REASON_##identifier:                                                                      \
        return text;
#define FAULT_TEXT(number, identifier, text, qualify, heal, reaction, clearing, driver)            \
    LIMIT_TEXT(number, identifier, text)
        LIMIT_LIST(LIMIT_TEXT)
        FAULT_LIST(FAULT_TEXT)
#undef LIMIT_TEXT
#undef FAULT_TEXT
    }
    return "unknown reason";
}
