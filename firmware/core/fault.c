/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fault.h"

#include <stddef.h>

#define FAULT_ROW(number, identifier, text, qualify_time, heal_time, reacts, clears, tells)        \
    {.qualify = (qualify_time),                                                                    \
     .heal = (heal_time),                                                                          \
     .reason = REASON_##identifier,                                                                \
     .reaction = FAULT_REACTION_##reacts,                                                          \
     .clearing = FAULT_CLEARING_##clears,                                                          \
     .driver = FAULT_DRIVER_##tells},
static const fault_t ROWS[] = {FAULT_LIST(FAULT_ROW)};
#undef FAULT_ROW

const fault_t *fault_row(unsigned number)
{
    return number < sizeof ROWS / sizeof ROWS[0] ? &ROWS[number] : NULL;
}

/* By the code's number: one more than the reaction, and CLEARING times how it ends; zero where
 * there is no such code. */
enum { CLEARING = 16 };
#define LIMIT_CODE(number, identifier, text)                                                       \
    [number] = FAULT_REACTION_NONE + 1 + CLEARING * FAULT_CLEARING_HEALS,
#define FAULT_CODE(number, identifier, text, qualify, heal, reaction, clearing, driver)            \
    [number] = FAULT_REACTION_##reaction + 1 + CLEARING * FAULT_CLEARING_##clearing,
static const uint8_t CODES[] = {LIMIT_LIST(LIMIT_CODE) FAULT_LIST(FAULT_CODE)};
#undef LIMIT_CODE
#undef FAULT_CODE

static uint32_t code_of(reason_t reason)
{
    return (uint32_t)reason < sizeof CODES ? CODES[reason] : 0;
}

fault_clearing_t fault_clearing(reason_t reason)
{
    const uint32_t code = code_of(reason);
    return code != 0 ? (fault_clearing_t)(code / CLEARING) : FAULT_CLEARING_RESTART;
}

fault_reaction_t fault_reaction(reason_t reason)
{
    const uint32_t code = code_of(reason);
    return code != 0 ? (fault_reaction_t)(code % CLEARING - 1U) : FAULT_REACTION_SAFE_STATE;
}

/* Each word behind the zero of the one before, and the last one before an empty one. */
static const char *word_at(const char *words, uint32_t number)
{
    for (; number > 0 && *words != '\0'; number--) {
        while (*words != '\0') {
            words++;
        }
        words++;
    }
    return *words != '\0' ? words : "unknown";
}

#define FAULT_TEXT(identifier, text) text "\0"
const char *fault_reaction_text(fault_reaction_t reaction)
{
    return word_at(FAULT_REACTION_LIST(FAULT_TEXT), (uint32_t)reaction);
}

const char *fault_clearing_text(fault_clearing_t clearing)
{
    return word_at(FAULT_CLEARING_LIST(FAULT_TEXT), (uint32_t)clearing);
}

const char *fault_driver_text(fault_driver_t driver)
{
    return word_at(FAULT_DRIVER_LIST(FAULT_TEXT), (uint32_t)driver);
}
