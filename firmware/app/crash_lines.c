/* SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>

#include "app/report.h"

static void add_cause(uint32_t cause, text_t *line)
{
    static const char *const NAMES[] = {"NMI", "hard fault", "memory fault", "bus fault",
                                        "usage fault"};
    enum { FIRST = 2, COUNT = sizeof NAMES / sizeof NAMES[0] };
    if (cause - FIRST < COUNT) {
        text_add(line, NAMES[cause - FIRST]);
    } else if (cause == CRASH_CAUSE_STACK) {
        text_add(line, "stack overflow");
    } else if (cause == CRASH_CAUSE_CHECK) {
        text_add(line, "failed check");
    } else {
        text_add(line, "exception ");
        text_add_integer(line, (int32_t)cause);
    }
}

bool report_crash(const crash_record_t *crash, uint32_t number, text_t *line)
{
    if (crash == NULL) {
        text_add(line, "no crash since the supply came");
        return number == 0;
    }
    if (number == 0) {
        text_add(line, "crash ");
        text_add_integer(line, (int32_t)crash->value[CRASH_COUNT]);
        text_add(line, " since the supply came: ");
        add_cause(crash->value[CRASH_CAUSE], line);
        text_add(line, " at ");
        text_add_hex(line, crash->value[CRASH_PC]);
    } else {
        text_add(line, "r0 .. r3 r12 lr pc psr sp cfsr hfsr address:");
        for (uint32_t i = 0; i < CRASH_CAUSE; i++) {
            text_add(line, " ");
            text_add_hex(line, crash->value[i]);
        }
    }
    return number <= 1;
}
