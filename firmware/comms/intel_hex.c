/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/intel_hex.h"

enum { LENGTH = 0, ADDRESS_HIGH = 1, ADDRESS_LOW = 2, TYPE = 3 };
enum {
    DATA_RECORD = 0,
    END_OF_FILE = 1,
    EXTENDED_SEGMENT = 2,
    EXTENDED_LINEAR = 4,
    START_LINEAR = 5
};
enum { NOT_A_DIGIT = 16 };

void intel_hex_init(intel_hex_t *hex, uint8_t *to, uint32_t capacity_bytes)
{
    hex->to = to;
    hex->capacity_bytes = capacity_bytes;
    hex->size_bytes = 0;
    hex->problem = INTEL_HEX_GOOD;
    hex->record = 0;
    hex->in_record = false;
    hex->half = false;
    hex->records = 0;
    hex->segment = 0;
    hex->next_address = 0;
}

static void refuse(intel_hex_t *hex, intel_hex_problem_t problem)
{
    if (hex->problem == INTEL_HEX_GOOD) {
        hex->problem = problem;
        hex->record = hex->records;
    }
    hex->in_record = false;
}

static void take_data(intel_hex_t *hex)
{
    const uint32_t length = hex->head[LENGTH];
    const uint32_t address =
        hex->segment + ((uint32_t)hex->head[ADDRESS_HIGH] << 8) + hex->head[ADDRESS_LOW];
    if (hex->problem != INTEL_HEX_GOOD) {
        return;
    }
    if (hex->size_bytes > 0 && address != hex->next_address) {
        refuse(hex, INTEL_HEX_GAP);
        return;
    }
    if (length > hex->capacity_bytes - hex->size_bytes) {
        refuse(hex, INTEL_HEX_TOO_LARGE);
        return;
    }
    for (uint32_t i = 0; i < length; i++) {
        hex->to[hex->size_bytes + i] = hex->data[i];
    }
    hex->size_bytes += length;
    hex->next_address = address + length;
}

/* A whole record whose sum is right. True if it was the last one. */
static bool take_record(intel_hex_t *hex)
{
    const uint32_t length = hex->head[LENGTH];
    const uint32_t word = (uint32_t)hex->data[0] << 8 | hex->data[1];
    switch (hex->head[TYPE]) {
    case DATA_RECORD:
        take_data(hex);
        return false;
    case END_OF_FILE:
        return true;
    case EXTENDED_SEGMENT:
    case EXTENDED_LINEAR:
        if (length != 2U) {
            refuse(hex, INTEL_HEX_TYPE);
        }
        hex->segment = hex->head[TYPE] == EXTENDED_LINEAR ? word << 16 : word << 4;
        return false;
    default:
        if (hex->head[TYPE] > START_LINEAR) {
            refuse(hex, INTEL_HEX_TYPE);
        }
        return false;
    }
}

/* Returns true if this byte ended the last record. */
static bool take_byte(intel_hex_t *hex, uint8_t byte)
{
    hex->sum = (uint8_t)(hex->sum + byte);
    if (hex->bytes < (uint32_t)INTEL_HEX_HEAD_BYTES) {
        hex->head[hex->bytes] = byte;
        hex->bytes++;
        return false;
    }
    const uint32_t index = hex->bytes - (uint32_t)INTEL_HEX_HEAD_BYTES;
    if (index < hex->head[LENGTH]) {
        hex->data[index] = byte;
        hex->bytes++;
        return false;
    }
    hex->in_record = false;
    if (hex->sum != 0U) {
        refuse(hex, INTEL_HEX_CHECKSUM);
        return false;
    }
    return take_record(hex);
}

static uint8_t value_of(uint8_t character)
{
    if (character >= (uint8_t)'0' && character <= (uint8_t)'9') {
        return (uint8_t)(character - (uint8_t)'0');
    }
    const uint8_t upper = (uint8_t)(character & 0xDFU);
    return upper >= (uint8_t)'A' && upper <= (uint8_t)'F' ? (uint8_t)(upper - (uint8_t)'A' + 10U)
                                                          : (uint8_t)NOT_A_DIGIT;
}

bool intel_hex_receive(intel_hex_t *hex, uint8_t character)
{
    if (character == (uint8_t)':') {
        if (hex->in_record) {
            refuse(hex, INTEL_HEX_CHARACTER); /* the record before it is not whole */
        }
        hex->in_record = true;
        hex->half = false;
        hex->sum = 0;
        hex->bytes = 0;
        hex->records++;
        return false;
    }
    if (!hex->in_record) {
        return false;
    }
    const uint8_t value = value_of(character);
    if (value == (uint8_t)NOT_A_DIGIT) {
        refuse(hex, INTEL_HEX_CHARACTER);
        return false;
    }
    hex->half = !hex->half;
    if (hex->half) {
        hex->digit = value;
        return false;
    }
    return take_byte(hex, (uint8_t)(hex->digit << 4 | value));
}

const char *intel_hex_text(intel_hex_problem_t problem)
{
    switch (problem) {
    case INTEL_HEX_CHARACTER:
        return "a character that is no hexadecimal digit";
    case INTEL_HEX_CHECKSUM:
        return "wrong checksum";
    case INTEL_HEX_TYPE:
        return "unknown type of record";
    case INTEL_HEX_GAP:
        return "data do not follow those before";
    case INTEL_HEX_TOO_LARGE:
        return "more data than a configuration has";
    case INTEL_HEX_GOOD:
        break;
    }
    return "good";
}
