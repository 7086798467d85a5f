/* SPDX-License-Identifier: Apache-2.0 */
/* The bench's side of the processor in the loop: a processor_t whose steps are requests in the RAM
 * of an emulated core. */
#define _GNU_SOURCE /* syscall() */

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "bench/handle.h"
#include "message.h"
#include "wait.h"

enum { READY_ms = 20000, ANSWER_ms = 60000 };

_Static_assert((int)PIL_WHEELS_MAX == (int)BENCH_WHEELS_MAX, "wheels of bench and core");

typedef struct {
    pil_memory_t *memory;
    const char *objection;
} pil_t;

static void wait_for_answers(pil_t *pil)
{
    pil_memory_t *memory = pil->memory;
    const uint32_t posted = atomic_load_explicit(&memory->posted, memory_order_relaxed);
    uint32_t done = atomic_load_explicit(&memory->done, memory_order_acquire);
    for (int waited_ms = 0; done != posted && pil->objection == NULL;) {
        if (!pil_wait(&memory->done, done, &memory->bench_sleeps)) {
            waited_ms += PIL_SLEEP_ms;
            if (atomic_load(&memory->ended) != 0) {
                pil->objection = "the emulated core has ended during the run";
            } else if (waited_ms >= ANSWER_ms) {
                pil->objection = "the emulated core does not answer";
            }
        }
        done = atomic_load_explicit(&memory->done, memory_order_acquire);
    }
}

/* The next request, empty; not more than PIL_REQUESTS without waiting. */
static pil_request_t *next_request(pil_t *pil, pil_operation_t operation, int wheel)
{
    const uint32_t posted = atomic_load_explicit(&pil->memory->posted, memory_order_relaxed);
    pil_request_t *request = &pil->memory->request[posted % PIL_REQUESTS];
    request->operation = (uint32_t)operation;
    request->wheel = (uint32_t)wheel;
    request->has_fault = 0;
    return request;
}

static void post(pil_t *pil)
{
    pil_memory_t *memory = pil->memory;
    atomic_store(&memory->posted, atomic_load(&memory->posted) + 1U);
    pil_wake(&memory->posted, &memory->core_sleeps);
}

static void add_fault(pil_request_t *request, const fault_params_t *fault)
{
    if (fault == NULL) {
        return;
    }
    int k = 0;
    request->has_fault = 1;
#define TO_NUMBER(name, lowest, highest, unit, text) request->fault[k++] = fault->name;
    PROGRAM_FAULT_PARAMETERS(TO_NUMBER)
#undef TO_NUMBER
}

static void configure(void *context, const config_t *config)
{
    pil_t *pil = context;
    wait_for_answers(pil);
    pil->memory->config = *config;
}

static void begin(void *context, int wheels)
{
    pil_t *pil = context;
    (void)next_request(pil, PIL_BEGIN, wheels);
    post(pil);
    wait_for_answers(pil);
}

static void fast(void *context, int wheel, const fault_params_t *fault, const fast_input_t *message)
{
    pil_t *pil = context;
    pil_request_t *request = next_request(pil, PIL_FAST, wheel);
    int32_t *raw = request->raw;
    int k = 0;
    SIGNALS_FAST_INPUTS(PIL_TO_RAW)
    add_fault(request, fault);
    post(pil);
}

static void finish(void *context, int wheel, fast_output_t *message, controller_t *shown)
{
    pil_t *pil = context;
    wait_for_answers(pil);
    const pil_answer_t *answer = &pil->memory->answer[wheel];
    const int32_t *raw = answer->fast;
    int k = 0;
    SIGNALS_FAST_OUTPUTS(PIL_FROM_RAW)
    shown->fast.foc.period.rotor.theta_turn = (uint16_t)answer->theta_turn;
}

static void show_limits(const pil_limit_t *lines, limit_t *shown)
{
    for (int k = 0; k < (int)TORQUE_LINE_COUNT; k++) {
        shown[k].torque_mNm = lines[k].torque_mNm;
        shown[k].reason = (reason_t)lines[k].reason;
    }
}

static slow_output_t slow(void *context, int wheel, const fault_params_t *fault,
                          const slow_input_t *in, controller_t *shown)
{
    pil_t *pil = context;
    pil_request_t *request = next_request(pil, PIL_SLOW, wheel);
    {
        const slow_input_t *message = in;
        int32_t *raw = request->raw;
        int k = 0;
        SIGNALS_SLOW_INPUTS(PIL_TO_RAW)
    }
    add_fault(request, fault);
    post(pil);
    wait_for_answers(pil);
    const pil_answer_t *answer = &pil->memory->answer[wheel];
    slow_output_t out = {.mode = MODE_BOOT};
    slow_output_t *message = &out;
    const int32_t *raw = answer->slow;
    int k = 0;
    SIGNALS_SLOW_OUTPUTS(PIL_FROM_RAW)
    shown->slow.last.temperature.winding_cC = answer->winding_cC;
    shown->slow.last.temperature.switch_cC = answer->switch_cC;
    show_limits(answer->driving, shown->slow.torque.table.driving);
    show_limits(answer->braking, shown->slow.torque.table.braking);
    return out;
}

static const char *objection(const void *context)
{
    return ((const pil_t *)context)->objection;
}

static void close_memory(void *context)
{
    pil_t *pil = context;
    (void)munmap(pil->memory, PIL_FILE_BYTES);
    free(pil);
}

/* NULL with errno, or if the file has another size. */
static pil_memory_t *map(const char *path)
{
    const int file = open(path, O_RDWR | O_CLOEXEC);
    if (file < 0) {
        return NULL;
    }
    struct stat status;
    void *memory = MAP_FAILED;
    errno = EINVAL;
    if (fstat(file, &status) == 0 && status.st_size == PIL_FILE_BYTES) {
        memory = mmap(NULL, PIL_FILE_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    }
    const int error = errno;
    (void)close(file);
    errno = error;
    return memory == MAP_FAILED ? NULL : memory;
}

static bool is_ready(pil_memory_t *memory)
{
    const struct timespec pause = {.tv_nsec = 1000000L};
    for (int ms = 0; ms < READY_ms && atomic_load(&memory->ended) == 0; ms++) {
        if (atomic_load(&memory->magic) == PIL_MAGIC) {
            return true;
        }
        (void)nanosleep(&pause, NULL);
    }
    return false;
}

int hubsim_processor(hubsim_t *sim, const char *path)
{
    if (sim->has_started || sim->has_processor) {
        return handle_fail(sim, HUBSIM_BAD_ORDER,
                           "hubsim_processor: accepted: once, before hubsim_start");
    }
    pil_memory_t *memory = map(path);
    if (memory == NULL) {
        return handle_fail(sim, HUBSIM_BAD_VALUE, "%s: not the memory of an emulated core: %s",
                           path, strerror(errno));
    }
    pil_t *pil = malloc(sizeof *pil);
    const bool ready = pil != NULL && is_ready(memory);
    if (!ready || memory->layout != pil_layout()) {
        free(pil);
        const char *what = pil == NULL ? "no memory"
                           : !ready    ? "the emulated core does not start"
                                       : "its program is of another version than this engine";
        (void)munmap(memory, PIL_FILE_BYTES);
        return handle_fail(sim, HUBSIM_FAILED, "processor in the loop: %s", what);
    }
    pil->memory = memory;
    pil->objection = NULL;
    const processor_t processor = {.context = pil,
                                   .configure = configure,
                                   .begin = begin,
                                   .fast = fast,
                                   .finish = finish,
                                   .slow = slow,
                                   .objection = objection,
                                   .close = close_memory};
    sim->processor = processor;
    sim->has_processor = true;
    return HUBSIM_OK;
}
