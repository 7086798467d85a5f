/* SPDX-License-Identifier: Apache-2.0 */
#include "semihost.h"

enum { SYS_WRITE0 = 0x04, SYS_GET_CMDLINE = 0x15, SYS_EXIT = 0x18 };
#define EXIT_SUCCESS_REASON ((const void *)0x20026U) /* ADP_Stopped_ApplicationExit */
#define EXIT_FAILURE_REASON ((const void *)0x20023U) /* ADP_Stopped_RunTimeErrorUnknown */

static uint32_t request(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = argument;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

_Noreturn void semihost_exit(bool success)
{
    (void)request(SYS_EXIT, success ? EXIT_SUCCESS_REASON : EXIT_FAILURE_REASON);
    for (;;) {
    }
}

void semihost_print(const char *text)
{
    (void)request(SYS_WRITE0, text);
}

/* Where `name` with the '=' after it stands in `text`, or NULL. */
static const char *find_value(const char *text, const char *name)
{
    for (; *text != '\0'; text++) {
        uint32_t i = 0;
        while (name[i] != '\0' && text[i] == name[i]) {
            i++;
        }
        if (name[i] == '\0' && text[i] == '=') {
            return &text[i + 1U];
        }
    }
    return 0;
}

uint32_t semihost_option(const char *name, uint32_t otherwise)
{
    char line[256] = {0};
    struct {
        char *buffer;
        uint32_t size;
    } block = {line, sizeof line - 1U};
    if (request(SYS_GET_CMDLINE, &block) != 0) {
        return otherwise;
    }
    const char *digit = find_value(line, name);
    if (digit == 0) {
        return otherwise;
    }
    uint32_t value = 0;
    for (; *digit >= '0' && *digit <= '9'; digit++) {
        value = 10U * value + (uint32_t)(*digit - '0');
    }
    return value;
}
