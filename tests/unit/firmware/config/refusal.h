/* SPDX-License-Identifier: Apache-2.0 */
/* refusal.h: a configuration that a test changes, and what it asks of its refusal. */
#ifndef TEST_REFUSAL_H
#define TEST_REFUSAL_H

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "config/validate.h"
#include "unity.h"

extern const config_t CONFIG_LU2013;

static config_t config;

static inline config_result_t sealed_result(void)
{
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    return config_validate(&config, sizeof(config));
}

/* The refusal, as it is printed, contains these words. */
static inline void assert_text_names(const config_result_t *result, const char *words)
{
    char text[160];
    (void)snprintf(text, sizeof text, "%s%s%s%s%s", CONFIG_RESULT_TEXTS(result));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, words), text);
}

/* A relation between fields is refused; back to the configuration of before. */
static inline void assert_relation(const char *fields)
{
    const config_result_t result = sealed_result();
    TEST_ASSERT_EQUAL_INT_MESSAGE(CONFIG_RESULT_RELATION, result.code, fields);
    assert_text_names(&result, fields);
    config = CONFIG_LU2013;
}

#endif
