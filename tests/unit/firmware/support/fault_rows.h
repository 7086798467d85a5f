/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault_rows.h: which codes of the table of faults are latched.
 */
#ifndef FAULT_ROWS_H
#define FAULT_ROWS_H

#include <stdbool.h>

#include "core/fault.h"

/* A fault stays one until it is acknowledged or until a restart. */
static inline bool is_latched(reason_t reason)
{
    const fault_clearing_t clearing = fault_clearing(reason);
    return clearing == FAULT_CLEARING_ACKNOWLEDGED || clearing == FAULT_CLEARING_RESTART;
}

#endif
