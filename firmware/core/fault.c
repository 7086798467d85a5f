/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fault.h"

#include <stddef.h>

#define FAULT_ROW(number, identifier, text, qualify_time, heal_time, reacts, clears, tells)        \
    {.name = #identifier,                                                                          \
     .qualify = (qualify_time),                                                                    \
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

/* One more than the column, by the code's number; zero where there is no such code. */
#define LIMIT_NO_REACTION(number, identifier, text) [number] = FAULT_REACTION_NONE + 1,
#define LIMIT_HEALS(number, identifier, text) [number] = FAULT_CLEARING_HEALS + 1,
#define FAULT_REACTS(number, identifier, text, qualify, heal, reaction, clearing, driver)          \
    [number] = FAULT_REACTION_##reaction + 1,
#define FAULT_CLEARS(number, identifier, text, qualify, heal, reaction, clearing, driver)          \
    [number] = FAULT_CLEARING_##clearing + 1,
static const uint8_t REACTIONS[] = {LIMIT_LIST(LIMIT_NO_REACTION) FAULT_LIST(FAULT_REACTS)};
static const uint8_t CLEARINGS[] = {LIMIT_LIST(LIMIT_HEALS) FAULT_LIST(FAULT_CLEARS)};
#undef LIMIT_NO_REACTION
#undef LIMIT_HEALS
#undef FAULT_REACTS
#undef FAULT_CLEARS

fault_clearing_t fault_clearing(reason_t reason)
{
    const unsigned number = (unsigned)reason;
    const bool listed = number < sizeof CLEARINGS && CLEARINGS[number] != 0;
    return listed ? (fault_clearing_t)(CLEARINGS[number] - 1U) : FAULT_CLEARING_RESTART;
}

fault_reaction_t fault_reaction(reason_t reason)
{
    const unsigned number = (unsigned)reason;
    const bool listed = number < sizeof REACTIONS && REACTIONS[number] != 0;
    return listed ? (fault_reaction_t)(REACTIONS[number] - 1U) : FAULT_REACTION_FREEWHEEL;
}

const char *fault_reaction_text(fault_reaction_t reaction)
{
#define FAULT_TEXT(identifier, text) [FAULT_REACTION_##identifier] = (text),
    static const char *const TEXTS[] = {FAULT_REACTION_LIST(FAULT_TEXT)};
#undef FAULT_TEXT
    return (unsigned)reaction < sizeof TEXTS / sizeof TEXTS[0] ? TEXTS[reaction] : "unknown";
}

const char *fault_clearing_text(fault_clearing_t clearing)
{
#define FAULT_TEXT(identifier, text) [FAULT_CLEARING_##identifier] = (text),
    static const char *const TEXTS[] = {FAULT_CLEARING_LIST(FAULT_TEXT)};
#undef FAULT_TEXT
    return (unsigned)clearing < sizeof TEXTS / sizeof TEXTS[0] ? TEXTS[clearing] : "unknown";
}

const char *fault_driver_text(fault_driver_t driver)
{
#define FAULT_TEXT(identifier, text) [FAULT_DRIVER_##identifier] = (text),
    static const char *const TEXTS[] = {FAULT_DRIVER_LIST(FAULT_TEXT)};
#undef FAULT_TEXT
    return (unsigned)driver < sizeof TEXTS / sizeof TEXTS[0] ? TEXTS[driver] : "unknown";
}
