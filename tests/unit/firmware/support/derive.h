/* SPDX-License-Identifier: Apache-2.0 */
/* derive.h: makes a changed configuration agree with itself, as the generator would. */
#ifndef TEST_DERIVE_H
#define TEST_DERIVE_H

#include <stdbool.h>

#include "config/derived.h"
#include "config/fields.h"

/* Each field that follows from others becomes the middle of what it may be. False if that is
 * outside its field. */
static inline bool derive(config_t *config)
{
    bool fit = true;
    int32_t *values = (int32_t *)(void *)config;
    for (int k = 0; k < CONFIG_DERIVED_FIELDS; k++) {
        const config_derived_range_t range = config_derived_range(config, (config_derived_t)k);
        const config_field_t field = config_field_at(range.offset_bytes);
        const int32_t middle = (int32_t)(((int64_t)range.lowest + range.highest) / 2);
        values[range.offset_bytes / sizeof(int32_t)] = middle;
        fit = fit && middle >= field.lowest && middle <= field.highest;
    }
    return fit;
}

#endif
