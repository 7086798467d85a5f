/* SPDX-License-Identifier: Apache-2.0 */
/*
 * derived.h: the fields that follow from others, and what they must be.
 *
 * The fast loop reads gains and constants per unit, which the generator computes from the motor's
 * physical values; the slow loop reads the physical values themselves. An image whose two halves
 * describe different motors would make torques that no limit sees, so the validator recomputes each
 * of these fields. Divides in 64 bits: for BOOT and host tools.
 */
#ifndef CONFIG_DERIVED_H
#define CONFIG_DERIVED_H

#include <stdint.h>

#include "config/config.h"

/* In the order in which they follow from each other: a gain from the gain before it. */
typedef enum {
    CONFIG_DERIVED_FLUX,
    CONFIG_DERIVED_INDUCTANCE_D,
    CONFIG_DERIVED_INDUCTANCE_Q,
    CONFIG_DERIVED_INTEGRAL_D,
    CONFIG_DERIVED_INTEGRAL_Q,
    CONFIG_DERIVED_PROPORTIONAL_D,
    CONFIG_DERIVED_PROPORTIONAL_Q,
    CONFIG_DERIVED_PLL_PROPORTIONAL,
    CONFIG_DERIVED_PLL_INTEGRAL,
    CONFIG_DERIVED_FIELDS
} config_derived_t;

typedef struct {
    uint32_t offset_bytes; /* in config_t */
    int32_t lowest;        /* what the field may be, within the rounding of those it follows from */
    int32_t highest;
} config_derived_range_t;

/* config: every field in its range. CONFIG_DERIVED_FIELDS counts as the last field. */
config_derived_range_t config_derived_range(const config_t *config, config_derived_t field);

#endif
