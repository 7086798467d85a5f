/* SPDX-License-Identifier: Apache-2.0 */
#include "app/config_lines.h"

#include <stddef.h>

#include "config/fields.h"

static void add(const config_t *config, const config_field_t *field, text_t *line)
{
    text_add(line, field->section);
    text_add(line, field->name);
    for (uint32_t i = 0; i < field->count; i++) {
        text_add(line, " ");
        text_add_integer(line, config_field_value(config, field, i));
    }
}

/* Whether section and name in one begin with a prefix. */
static bool begins_with(const config_field_t *field, const char *prefix)
{
    const char *section = field->section;
    while (*section != '\0' && *section == *prefix) {
        section++;
        prefix++;
    }
    return *prefix == '\0' || (*section == '\0' && text_begins_with(field->name, prefix));
}

bool config_lines_get(const config_t *config, const char *prefix, uint32_t number, text_t *line)
{
    uint32_t left = number;
    config_field_t field = config_field_first();
    do {
        if (field.count > CONFIG_FIELD_VALUES_MAX || !begins_with(&field, prefix)) {
            continue;
        }
        if (left == 0) {
            add(config, &field, line);
            return true;
        }
        left--;
    } while (config_field_next(&field));
    return false;
}
