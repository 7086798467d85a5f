/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sequences: the sequences of tests/target/trace.c, whose program this is, with the oracle's hashes
 * in the place of its own.
 */
#include "print.h"
#include "program.h"

int trace_main(void); /* main() of trace.c */

void print_trace(uint32_t crc, const char *name, const uint32_t mode_steps[PRINT_MODES])
{
    (void)crc;
    (void)mode_steps;
    program_entry(name);
}

int main(int count, char **arguments)
{
    if (!program_begin(count, arguments, 1, 1)) {
        return 2;
    }
    const int status = trace_main();
    program_end();
    return status;
}
