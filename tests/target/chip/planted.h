/* SPDX-License-Identifier: Apache-2.0 */
/* planted.h: images with an error planted, and with what it must be found. */
#ifndef CHIP_PLANTED_H
#define CHIP_PLANTED_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* Takes `--finds TEXT` from the end of the arguments. NULL: no error is planted. */
static inline const char *planted_text(int *argc, char **argv)
{
    if (*argc < 3 || strcmp(argv[*argc - 2], "--finds") != 0) {
        return NULL;
    }
    *argc -= 2;
    return argv[*argc + 1];
}

/* Whether something that is wrong begins as expected. */
static inline bool planted_is(const char *finding, const char *finds)
{
    return finds != NULL && finds[0] != '\0' && strncmp(finding, finds, strlen(finds)) == 0;
}

#endif
