/* SPDX-License-Identifier: Apache-2.0 */
#include "program.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct {
    int with_reports, entry, listed_entry;
    const char *list_path;
} program = {.listed_entry = -1};

static int place_of(const char *name)
{
    for (int place = 0; place < oracle_value_count(); place++) {
        if (strcmp(oracle_value_name(place), name) == 0) {
            return place;
        }
    }
    return -1;
}

static int read_option(int left, char **arguments)
{
    if (left > 2 && strcmp(arguments[0], "--values") == 0) {
        program.list_path = arguments[1];
        program.listed_entry = atoi(arguments[2]);
        return 3;
    }
    if (left > 2 && strcmp(arguments[0], "--change") == 0) {
        const int place = place_of(arguments[1]);
        if (place < 0) {
            fprintf(stderr, "%s: no such value\n", arguments[1]);
            return 0;
        }
        oracle_change(place, strtoll(arguments[2], NULL, 10));
        return 3;
    }
    fprintf(stderr, "%s: no such option, or its arguments are missing\n", arguments[0]);
    return 0;
}

static int begin_entry(void)
{
    const char *path = program.entry == program.listed_entry ? program.list_path : NULL;
    if (!oracle_list_values(path)) {
        perror(path);
        return 0;
    }
    oracle_begin(program.with_reports);
    return 1;
}

int program_begin(int count, char **arguments, int first, int with_reports)
{
    program.with_reports = with_reports;
    for (int k = first; k < count;) {
        const int read = read_option(count - k, &arguments[k]);
        if (read == 0) {
            return 0;
        }
        k += read;
    }
    return begin_entry();
}

void program_entry(const char *name)
{
    const oracle_hashes_t hashes = oracle_end();
    printf("entry %s: %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %" PRId64
           " %" PRId64 "\n",
           name, hashes.fast, hashes.slow, hashes.events, hashes.bytes, hashes.fast_steps,
           hashes.slow_steps);
    fflush(stdout); /* progress */
    program.entry++;
    if (!begin_entry()) {
        exit(1);
    }
}

void program_end(void)
{
    for (int list = 0; list < oracle_reached_lists(); list++) {
        for (int number = 0; number < ORACLE_NUMBERS; number++) {
            const int64_t steps = oracle_reached(list, number);
            if (steps > 0) {
                printf("reached %s %d: %" PRId64 "\n", oracle_reached_name(list), number, steps);
            }
        }
    }
}
