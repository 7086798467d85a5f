/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fault_rows.h: which rows of the table of faults are latched.
 */
#ifndef FAULT_ROWS_H
#define FAULT_ROWS_H

#include <stdbool.h>

#include "core/fault.h"

/* A fault stays one until it is acknowledged or until a restart. */
static inline bool is_latched(const fault_t *row)
{
    return row->clearing == FAULT_CLEARING_ACKNOWLEDGED || row->clearing == FAULT_CLEARING_RESTART;
}

#endif
