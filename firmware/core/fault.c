/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fault.h"

#include "core/words.h"

/* By the code's number: one more than how it ends, and DRIVER times what the driver is told; zero
 * where there is no such code. */
enum { DRIVER = 16 };
#define LIMIT_CODE(number, identifier, text)                                                       \
    [number] = FAULT_CLEARING_HEALS + 1 + DRIVER * FAULT_DRIVER_REDUCED,
#define FAULT_CODE(number, identifier, text, clearing, driver)                                     \
    [number] = FAULT_CLEARING_##clearing + 1 + DRIVER * FAULT_DRIVER_##driver,
static const uint8_t CODES[] = {LIMIT_LIST(LIMIT_CODE) FAULT_LIST(FAULT_CODE)};
#undef LIMIT_CODE
#undef FAULT_CODE

#define FAULT_NUMBER(number, identifier, text, clearing, driver) (number),
static const uint8_t NUMBERS[] = {FAULT_LIST(FAULT_NUMBER)};
#undef FAULT_NUMBER

bool fault_listed(uint32_t place, reason_t *reason)
{
    if (place >= sizeof NUMBERS) {
        return false;
    }
    *reason = (reason_t)NUMBERS[place];
    return true;
}

static uint32_t code_of(reason_t reason)
{
    return (uint32_t)reason < sizeof CODES ? CODES[reason] : 0;
}

fault_clearing_t fault_clearing(reason_t reason)
{
    const uint32_t code = code_of(reason);
    return code != 0 ? (fault_clearing_t)(code % DRIVER - 1U) : FAULT_CLEARING_RESTART;
}

fault_driver_t fault_driver(reason_t reason)
{
    const uint32_t code = code_of(reason);
    return code != 0 ? (fault_driver_t)(code / DRIVER) : FAULT_DRIVER_SERVICE;
}

#define FAULT_TEXT(identifier, text) text "\0"
const char *fault_clearing_text(fault_clearing_t clearing)
{
    return words_at(FAULT_CLEARING_LIST(FAULT_TEXT), (uint32_t)clearing);
}

const char *fault_driver_text(fault_driver_t driver)
{
    return words_at(FAULT_DRIVER_LIST(FAULT_TEXT), (uint32_t)driver);
}
