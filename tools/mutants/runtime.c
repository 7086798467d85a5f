/* SPDX-License-Identifier: Apache-2.0 */
/* What a test program with mutants in it does besides: it takes the mutant's number and a limit of
 * CPU time from the environment, ends at the first test that fails, and writes which mutants'
 * places it evaluated. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/time.h>
#include <unistd.h>

#include "unity.h"

#include "runtime.h"

enum { MUTANTS = 20000 };

int hubfoc_mutant;
unsigned char hubfoc_reached[MUTANTS];

static int number_of(const char *name)
{
    const char *text = getenv(name);
    return text ? atoi(text) : 0;
}

__attribute__((constructor)) static void begin(void)
{
    const int limit_ms = number_of("HUBFOC_MUTANT_LIMIT_MS");
    const struct itimerval limit = {.it_value = {limit_ms / 1000, limit_ms % 1000 * 1000}};
    setitimer(ITIMER_PROF, &limit, NULL); /* its signal ends the program */
    hubfoc_mutant = number_of("HUBFOC_MUTANT");
}

__attribute__((destructor)) static void end(void)
{
    const char *name = getenv("HUBFOC_MUTANTS_REACHED");
    FILE *file = name ? fopen(name, "wb") : NULL;
    if (file) {
        fwrite(hubfoc_reached, 1, MUTANTS, file);
        fclose(file);
    }
}

void __real_UnityConcludeTest(void);
void __wrap_UnityConcludeTest(void);

void __wrap_UnityConcludeTest(void)
{
    if (hubfoc_mutant != 0 && Unity.CurrentTestFailed) {
        _exit(1);
    }
    __real_UnityConcludeTest();
}
