/* SPDX-License-Identifier: Apache-2.0 */
/* What the tests of the validator ask of a refusal's text. */
#ifndef TEST_REFUSAL_H
#define TEST_REFUSAL_H

#include <stdio.h>
#include <string.h>

#include "config/validate.h"
#include "unity.h"

/* The refusal, as it is printed, contains these words. */
static inline void assert_text_names(const config_result_t *result, const char *words)
{
    char text[160];
    (void)snprintf(text, sizeof text, "%s%s%s%s%s", CONFIG_RESULT_TEXTS(result));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, words), text);
}

#endif
