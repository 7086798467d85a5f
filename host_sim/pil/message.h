/* SPDX-License-Identifier: Apache-2.0 */
/*
 * message.h: the memory that bench and emulated core share: requests of the bench in a ring, and
 * what each wheel's controller answered last. Integers only, little-endian on both sides; inputs
 * and outputs are the raw values of exchange/variables.h in the order of its lists, so a member
 * that the controller gains is transferred as soon as it has a line there.
 *
 * The bench writes a request and then counts `posted` up; the core executes it, writes the answer
 * and then counts `done` up. The bench reads answers only when done == posted.
 */
#ifndef PIL_MESSAGE_H
#define PIL_MESSAGE_H

#include <stdatomic.h>
#include <stdint.h>
#include <string.h>

#include "config/config.h"
#include "exchange/variables.h"
#include "plant/fault.h"
#include "torque/torque_limits.h"

/* The second memory of QEMU's mps2-an386, which can be a file. */
#define PIL_ADDRESS 0x21000000U
#define PIL_MAGIC 0x204C4950U /* "PIL " */

enum {
    PIL_FILE_BYTES = 16 << 20,
    PIL_WHEELS_MAX = 16,
    PIL_REQUESTS = 64, /* a power of two, more than a period's */
    PIL_LINE_BYTES = 64
};

typedef enum { PIL_BEGIN = 1, PIL_FAST = 2, PIL_SLOW = 3 } pil_operation_t;

/* The raw values of a message, and back. Every member has one, two or four bytes; of a shorter one
 * the lower bytes of its raw value are all. */
#define PIL_TO_RAW(label, raw_name, where, ...) raw[k++] = (int32_t)message->where;
#define PIL_FROM_RAW(label, raw_name, where, ...)                                                  \
    memcpy(&message->where, &raw[k++], sizeof message->where);

#define PIL_FAULT_COUNT(name, lowest, highest, unit, text) +1
enum { PIL_FAULTS = 0 PROGRAM_FAULT_PARAMETERS(PIL_FAULT_COUNT) };
#undef PIL_FAULT_COUNT

typedef struct {
    uint32_t operation; /* pil_operation_t */
    uint32_t wheel;     /* of PIL_BEGIN their number */
    uint32_t has_fault; /* 1: of injection.h, even if all are 0 */
    uint32_t reserved;
    _Alignas(8) double fault[PIL_FAULTS]; /* PROGRAM_FAULT_PARAMETERS */
    int32_t raw[SIGNALS_SLOW_INPUT_COUNT];
} pil_request_t;

_Static_assert((int)SIGNALS_FAST_INPUT_COUNT <= (int)SIGNALS_SLOW_INPUT_COUNT,
               "the inputs of a fast step do not fit a request");

/* Where emulator.py writes `ended`. */
enum { PIL_ENDED_OFFSET = 8 };

/* One line of the table of torque limits. */
typedef struct {
    int32_t torque_mNm;
    int32_t reason;
} pil_limit_t;

typedef struct {
    int32_t fast[SIGNALS_FAST_OUTPUT_COUNT];
    int32_t theta_turn; /* estimated rotor angle */
    int32_t slow[SIGNALS_SLOW_OUTPUT_COUNT];
    int32_t winding_cC, switch_cC; /* that the controller uses */
    pil_limit_t driving[TORQUE_LINE_COUNT], braking[TORQUE_LINE_COUNT];
} pil_answer_t;

typedef struct {
    _Atomic uint32_t magic; /* by the core when it is ready */
    uint32_t layout;        /* pil_layout() of the core's program */
    _Atomic uint32_t ended; /* by whoever started the emulator: it has ended */
    _Alignas(PIL_LINE_BYTES) _Atomic uint32_t posted;
    _Atomic uint32_t core_sleeps;
    _Alignas(PIL_LINE_BYTES) _Atomic uint32_t done;
    _Atomic uint32_t bench_sleeps;
    _Alignas(PIL_LINE_BYTES) pil_request_t request[PIL_REQUESTS];
    pil_answer_t answer[PIL_WHEELS_MAX];
    config_t config;
} pil_memory_t;

_Static_assert(offsetof(pil_memory_t, ended) == PIL_ENDED_OFFSET, "emulator.py");
_Static_assert(sizeof(pil_memory_t) <= (size_t)PIL_FILE_BYTES, "the shared memory is too small");

/* The same for programs that agree on the shared memory. */
static inline uint32_t pil_layout(void)
{
    return (uint32_t)sizeof(pil_memory_t) ^ (uint32_t)offsetof(pil_memory_t, config) << 8 ^
           (uint32_t)CONFIG_FORMAT_VERSION << 24;
}

#endif
