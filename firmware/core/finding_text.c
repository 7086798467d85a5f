/* SPDX-License-Identifier: Apache-2.0 */
#include "core/findings.h"

/* Times as words, of which the linker keeps each one once. */
#define AT_ONCE "at once"
#define NEVER "never"
#define MS(n) #n " ms"
#define FIELD(section, name) #section "." #name
#define RAMP(section, name) "torque ramp + " #section "." #name
#define OWN(text) text
#define TIMES(check, name, evidence, qualify, heal, explanation, reacts) {qualify, heal},
static const struct {
    const char *qualify, *heal;
} TIMES_TEXT[] = {FINDING_LIST(TIMES)};

finding_text_t finding_text(finding_t row)
{
    const bool known = row < FINDING_COUNT;
    const finding_text_t out = {
        .qualify = known ? TIMES_TEXT[row].qualify : "unknown",
        .heal = known ? TIMES_TEXT[row].heal : "unknown",
    };
    return out;
}
