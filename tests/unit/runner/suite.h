/* SPDX-License-Identifier: Apache-2.0 */
/* suite.h: the tests of one file, as suites.py lists them, and the program that runs several. */
#ifndef SUITE_H
#define SUITE_H

typedef struct {
    void (*run)(void);
    const char *name;
    int line; /* where it stands in its file */
} suite_test_t;

/* NULL instead of the three functions of the mocks: the file has none. */
typedef struct {
    const char *name, *file;
    void (*set_up)(void), (*tear_down)(void);
    void (*begin_mocks)(void), (*verify_mocks)(void), (*end_mocks)(void);
    const suite_test_t *tests;
    int count;
} suite_t;

extern const suite_t *const SUITES[];
extern const int SUITE_COUNT;

#endif
