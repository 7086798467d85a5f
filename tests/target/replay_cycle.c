/* SPDX-License-Identifier: Apache-2.0 */
/*
 * On the emulated core: calls both step functions with the inputs in CYCLE_FILE, which the
 * emulator reads from the host (semihosting), and prints the digest of every output as
 * record_cycle.c does.
 */
#include <stddef.h>
#include <string.h>

#include "config/bases.h"
#include "cycle.h"
#include "digest.h"
#include "print.h"
#include "semihost.h"

extern const config_t CONFIG_LU2013;

enum { SYS_OPEN = 0x01, SYS_READ = 0x06, READ_BINARY = 1, BUFFERED_UNITS = 256 };

typedef struct {
    int32_t handle; /* -1: there is no such file */
    uint32_t next, count;
    unsigned char units[BUFFERED_UNITS][CYCLE_UNIT_BYTES];
} source_t;

static int32_t request(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm("r0") = operation;
    register const void *r1 __asm("r1") = argument;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return (int32_t)r0;
}

static void source_open(source_t *source)
{
    const struct {
        const char *name;
        uint32_t mode, length;
    } block = {CYCLE_FILE, READ_BINARY, sizeof CYCLE_FILE - 1U};
    source->handle = request(SYS_OPEN, &block);
    source->next = 0;
    source->count = 0;
}

/* The next unit, or NULL at the end. SYS_READ returns how many bytes were not read. */
static const void *source_next(source_t *source)
{
    if (source->next == source->count) {
        const struct {
            int32_t handle;
            void *bytes;
            uint32_t length;
        } block = {source->handle, source->units, sizeof source->units};
        const int32_t unread = request(SYS_READ, &block);
        if (unread < 0 || (uint32_t)unread > sizeof source->units) {
            return NULL;
        }
        source->count = (sizeof source->units - (uint32_t)unread) / CYCLE_UNIT_BYTES;
        source->next = 0;
    }
    return source->next < source->count ? source->units[source->next++] : NULL;
}

int main(void)
{
    static source_t source;
    static controller_t controller;
    uint32_t mode_steps[PRINT_MODES] = {0};
    digest_t digest;
    source_open(&source);
    if (source.handle < 0) {
        print("no " CYCLE_FILE " here\n");
        return 1;
    }
    controller_init(&controller, &CONFIG_LU2013, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t setpoint = controller_initial_setpoint(&CONFIG_LU2013, BASES_MODEL_TIMER_Hz);
    digest_begin(&digest);
    for (const void *unit = source_next(&source); unit != NULL; unit = source_next(&source)) {
        cycle_fast_t fast;
        memcpy(&fast, unit, sizeof fast);
        if (!cycle_is_slow(&fast)) {
            const fast_input_t in = cycle_fast_input(&fast);
            const fast_output_t out =
                *controller_fast_step(&controller.fast, &CONFIG_LU2013, &setpoint, &in);
            digest_fast(&digest, &out, &controller.fast);
            continue;
        }
        cycle_slow_t slow;
        memcpy(&slow, unit, CYCLE_UNIT_BYTES);
        unit = source_next(&source);
        if (unit == NULL) {
            print("the last slow step is cut off\n");
            return 1;
        }
        memcpy((unsigned char *)&slow + CYCLE_UNIT_BYTES, unit, CYCLE_UNIT_BYTES);
        const slow_input_t in = cycle_slow_input(&slow);
        fast_report_t report;
        controller_fast_report(&controller.fast, &report);
        const slow_output_t out =
            controller_slow_step(&controller.slow, &CONFIG_LU2013, &report, &in, &setpoint);
        digest_slow(&digest, &out, &setpoint);
        mode_steps[out.mode]++;
    }
    print_trace(digest_end(&digest), CYCLE_NAME, mode_steps);
    return 0;
}
