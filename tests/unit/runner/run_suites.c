/* SPDX-License-Identifier: Apache-2.0 */
/*
 * run_suites.c: the main program of the unit tests of one module.
 *
 *   unit_torque                        runs all suites, one summary at the end
 *   unit_torque torque_limits pedals   only these
 *   unit_torque --list                 their names
 *
 * Programs for the emulated core have no arguments (SUITES_WITHOUT_ARGUMENTS).
 */
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "unity.h"

/* For Unity's own runner, which is not used. */
void setUp(void) {}

void tearDown(void) {}

/* What one test does is what a runner of Unity and CMock does. */
static void run_test(const suite_t *suite, const suite_test_t *test)
{
    Unity.CurrentTestName = test->name;
    Unity.CurrentTestLineNumber = (UNITY_LINE_TYPE)test->line;
    Unity.NumberOfTests++;
    UNITY_CLR_DETAILS();
    if (suite->begin_mocks) {
        suite->begin_mocks();
    }
    if (TEST_PROTECT()) {
        suite->set_up();
        test->run();
    }
    if (TEST_PROTECT()) {
        suite->tear_down();
        if (suite->verify_mocks) {
            suite->verify_mocks();
        }
    }
    if (suite->end_mocks) {
        suite->end_mocks();
    }
    UnityConcludeTest();
}

static void run_suite(const suite_t *suite)
{
    Unity.TestFile = suite->file;
    for (int i = 0; i < suite->count; i++) {
        run_test(suite, &suite->tests[i]);
    }
}

#ifdef SUITES_WITHOUT_ARGUMENTS
int main(void)
{
    UnityBegin("");
    for (int i = 0; i < SUITE_COUNT; i++) {
        run_suite(SUITES[i]);
    }
    return UnityEnd();
}
#else
static const suite_t *named(const char *name)
{
    for (int i = 0; i < SUITE_COUNT; i++) {
        if (strcmp(SUITES[i]->name, name) == 0) {
            return SUITES[i];
        }
    }
    return NULL;
}

int main(int count, char **arguments)
{
    if (count == 2 && strcmp(arguments[1], "--list") == 0) {
        for (int i = 0; i < SUITE_COUNT; i++) {
            puts(SUITES[i]->name);
        }
        return 0;
    }
    for (int i = 1; i < count; i++) {
        if (!named(arguments[i])) {
            fprintf(stderr, "no suite %s; --list shows them\n", arguments[i]);
            return 2;
        }
    }
    UnityBegin("");
    for (int i = 1; i < count; i++) {
        run_suite(named(arguments[i]));
    }
    for (int i = 0; count == 1 && i < SUITE_COUNT; i++) {
        run_suite(SUITES[i]);
    }
    return UnityEnd();
}
#endif
