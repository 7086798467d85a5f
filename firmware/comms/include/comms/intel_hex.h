/* SPDX-License-Identifier: Apache-2.0 */
/*
 * intel_hex.h: decodes an image from Intel HEX text, one character at a time, into a buffer of the
 * caller.
 *
 * Accepts the subset that objcopy and device programmers write: records ":", length, address, type,
 * data and a checksum that makes the sum of all bytes zero, in hexadecimal digits. Data records
 * must follow each other without a gap, wherever the first one begins; an extended address may lie
 * between them, a start address is ignored. Characters between records, such as line ends, are
 * skipped. The first error is kept with the number of its record, and data after it are ignored;
 * the text always ends with the end-of-file record, so that the rest of a damaged one does not
 * reach the shell. Pure; any context. Format:
 * Intel, Hexadecimal Object File Format Specification, revision A.
 */
#ifndef COMMS_INTEL_HEX_H
#define COMMS_INTEL_HEX_H

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    INTEL_HEX_GOOD = 0,
    INTEL_HEX_CHARACTER, /* not a hexadecimal digit where one must be */
    INTEL_HEX_CHECKSUM,
    INTEL_HEX_TYPE,     /* a type or length that the format does not have */
    INTEL_HEX_GAP,      /* data that do not follow the data before them */
    INTEL_HEX_TOO_LARGE /* more data than the buffer holds */
} intel_hex_problem_t;

enum { INTEL_HEX_HEAD_BYTES = 4, INTEL_HEX_DATA_MAX = 255 };

typedef struct {
    uint8_t *to;
    uint32_t capacity_bytes;
    uint32_t size_bytes; /* written so far */
    intel_hex_problem_t problem;
    uint32_t record; /* number of the record that is being read, of the first bad one after a
                        problem; from 1 */

    bool in_record;
    bool half;      /* the first digit of a byte has been received ... */
    uint8_t digit;  /* ... and has this value */
    uint8_t sum;    /* of the record's bytes, modulo 256 */
    uint32_t bytes; /* of the record, received so far */
    uint32_t records;
    uint8_t head[INTEL_HEX_HEAD_BYTES]; /* length, address, type */
    uint8_t data[INTEL_HEX_DATA_MAX];
    uint32_t segment;      /* base address: the address of a record is relative to it */
    uint32_t next_address; /* required address of the next data, after the first data record */
} intel_hex_t;

void intel_hex_init(intel_hex_t *hex, uint8_t *to, uint32_t capacity_bytes);

/* True when the text has ended: the image is whole if hex->problem is INTEL_HEX_GOOD. */
bool intel_hex_receive(intel_hex_t *hex, uint8_t character);

/* The error as text; never NULL. */
const char *intel_hex_text(intel_hex_problem_t problem);

#endif
