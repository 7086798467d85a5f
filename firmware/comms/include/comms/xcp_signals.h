/* SPDX-License-Identifier: Apache-2.0 */
/*
 * xcp_signals.h: the signals that a tool may measure, by their places in a table. Any context in
 * which the records do not change meanwhile; a value by itself is read whole in any.
 */
#ifndef COMMS_XCP_SIGNALS_H
#define COMMS_XCP_SIGNALS_H

#include <stdbool.h>
#include <stdint.h>

/* What a signal is a member of. The slow records come first. */
typedef enum {
    XCP_RECORD_OUTPUT = 0, /* of one slow step */
    XCP_RECORD_INPUT = 1,
    XCP_RECORD_FAST_OUTPUT = 2, /* of one PWM period */
    XCP_RECORD_FAST_INPUT = 3,
    XCP_RECORD_FAST_VIEW = 4,
    XCP_RECORDS
} xcp_record_t;

enum { XCP_SIGNAL_BYTES = 4 };

/* Where a signal is: unsigned or bool in one or two bytes, int32_t or unsigned in four. */
typedef struct {
    uint16_t offset_bytes;
    uint8_t size_bytes;
    uint8_t record; /* xcp_record_t */
} xcp_signal_t;

typedef struct {
    const xcp_signal_t *signals;
    uint32_t signals_count;
    const void *record[XCP_RECORDS];
} xcp_table_t;

static inline bool xcp_signal_is_fast(const xcp_signal_t *signal)
{
    return signal->record >= XCP_RECORD_FAST_OUTPUT;
}

static inline const void *xcp_signal_at(const xcp_table_t *table, uint32_t place)
{
    const xcp_signal_t *signal = &table->signals[place];
    return (const uint8_t *)table->record[signal->record] + signal->offset_bytes;
}

/* Of one, two or four bytes, each aligned. */
static inline uint32_t xcp_load(const void *at, uint32_t bytes)
{
    return bytes == sizeof(uint32_t)   ? *(const uint32_t *)at
           : bytes == sizeof(uint16_t) ? *(const uint16_t *)at
                                       : *(const uint8_t *)at;
}

/* The lower bytes of a value, little endian. */
static inline void xcp_put(uint8_t *to, uint32_t value, uint32_t bytes)
{
    for (uint32_t i = 0; i < bytes; i++) {
        to[i] = (uint8_t)(value >> 8U * i);
    }
}

static inline uint32_t xcp_signal_value(const xcp_table_t *table, uint32_t place)
{
    return xcp_load(xcp_signal_at(table, place), table->signals[place].size_bytes);
}

#endif
