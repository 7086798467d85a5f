/* SPDX-License-Identifier: Apache-2.0 */
/*
 * core32 [MEMORY]: x86 with 32 bits on a 64-bit Linux, without a C library, which few machines have
 * for it. With MEMORY it executes the requests of the bench as core.c does; without, the trace
 * sequences (trace.c).
 */
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "print.h"
#ifdef CORE32_SERVES
#include "serve.h"
#endif

/* Numbers of the kernel's interface for 32 bits. */
enum {
    SYS_EXIT = 1,
    SYS_WRITE = 4,
    SYS_OPEN = 5,
    SYS_GETPPID = 64,
    SYS_YIELD = 158,
    SYS_MMAP2 = 192,
    SYS_FUTEX = 240
};
enum { READ_AND_WRITE = 2, PROTECTION = 3, SHARED = 1, STANDARD_OUTPUT = 1 };
enum { FUTEX_WAIT = 0, FUTEX_WAKE = 1, LOOKS = 2000 };

int trace_main(void);
void begin(const uint32_t *stack);
uint64_t __udivmoddi4(uint64_t n, uint64_t d, uint64_t *rest);
uint64_t __udivdi3(uint64_t n, uint64_t d);
uint64_t __umoddi3(uint64_t n, uint64_t d);
int64_t __divdi3(int64_t n, int64_t d);
int64_t __moddi3(int64_t n, int64_t d);

__asm(".globl _start\n_start: mov %esp, %eax\n and $-16, %esp\n sub $12, %esp\n push %eax\n"
      " call begin\n");

static int32_t request(int32_t number, const int32_t a[6])
{
    int32_t result;
    __asm volatile("push %%ebp\n mov 20(%%esi), %%ebp\n mov (%%esi), %%ebx\n mov 4(%%esi), %%ecx\n"
                   " mov 8(%%esi), %%edx\n mov 16(%%esi), %%edi\n mov 12(%%esi), %%esi\n"
                   " int $0x80\n pop %%ebp"
                   : "=a"(result), "+S"(a)
                   : "a"(number)
                   : "ebx", "ecx", "edx", "edi", "memory");
    return result;
}

static _Noreturn void leave(int32_t status)
{
    const int32_t a[6] = {status};
    for (;;) {
        (void)request(SYS_EXIT, a);
    }
}

void print(const char *text)
{
    int32_t length = 0;
    while (text[length] != '\0') {
        length++;
    }
    const int32_t a[6] = {STANDARD_OUTPUT, (int32_t)(intptr_t)text, length};
    (void)request(SYS_WRITE, a);
}

void *memcpy(void *to, const void *from, size_t bytes)
{
    void *at = to;
    __asm volatile("rep movsb" : "+D"(at), "+S"(from), "+c"(bytes) : : "memory");
    return to;
}

void *memset(void *to, int value, size_t bytes)
{
    void *at = to;
    __asm volatile("rep stosb" : "+D"(at), "+c"(bytes) : "a"(value) : "memory");
    return to;
}

/* 64 by 64 bits, as the compiler's own library has it, which is not there either: by words where
 * the divisor is one, else bit by bit. */
uint64_t __udivmoddi4(uint64_t n, uint64_t d, uint64_t *rest)
{
    if (d >> 32 == 0) {
        uint32_t high = (uint32_t)(n >> 32);
        uint32_t low = (uint32_t)n;
        uint32_t remainder = 0;
        __asm("divl %4" : "=a"(high), "=d"(remainder) : "0"(high), "1"(0), "r"((uint32_t)d) : "cc");
        __asm("divl %4"
              : "=a"(low), "=d"(remainder)
              : "0"(low), "1"(remainder), "r"((uint32_t)d)
              : "cc");
        *rest = remainder;
        return (uint64_t)high << 32 | low;
    }
    uint64_t quotient = 0;
    uint64_t remainder = n >> 32;
    for (int bit = 31; bit >= 0; bit--) {
        const uint64_t carry = remainder >> 63;
        remainder = remainder << 1 | (n >> bit & 1U);
        quotient <<= 1;
        if (carry != 0 || remainder >= d) {
            remainder -= d;
            quotient |= 1U;
        }
    }
    *rest = remainder;
    return quotient;
}

uint64_t __udivdi3(uint64_t n, uint64_t d)
{
    uint64_t rest;
    return __udivmoddi4(n, d, &rest);
}

uint64_t __umoddi3(uint64_t n, uint64_t d)
{
    uint64_t rest;
    (void)__udivmoddi4(n, d, &rest);
    return rest;
}

static uint64_t magnitude(int64_t x)
{
    return x < 0 ? 0U - (uint64_t)x : (uint64_t)x;
}

int64_t __divdi3(int64_t n, int64_t d)
{
    const uint64_t quotient = __udivdi3(magnitude(n), magnitude(d));
    return (int64_t)((n < 0) != (d < 0) ? 0U - quotient : quotient);
}

int64_t __moddi3(int64_t n, int64_t d)
{
    const uint64_t rest = __umoddi3(magnitude(n), magnitude(d));
    return (int64_t)(n < 0 ? 0U - rest : rest);
}

#ifdef CORE32_SERVES
/* As pil_wait() of host_sim/pil/wait.h. */
static void wait(pil_memory_t *memory)
{
    static const int32_t MOST[2] = {0, 100000000}; /* s, ns */
    const uint32_t done = atomic_load(&memory->done);
    for (int k = 0; k < LOOKS; k++) {
        if (atomic_load(&memory->posted) != done) {
            return;
        }
    }
    const int32_t waiting[6] = {(int32_t)(intptr_t)&memory->posted, FUTEX_WAIT, (int32_t)done,
                                (int32_t)(intptr_t)MOST};
    atomic_store(&memory->core_sleeps, 1);
    if (atomic_load(&memory->posted) == done) {
        (void)request(SYS_FUTEX, waiting);
    }
    atomic_store(&memory->core_sleeps, 0);
}

static int32_t serve(const char *path)
{
    const int32_t none[6] = {0};
    const int32_t opening[6] = {(int32_t)(intptr_t)path, READ_AND_WRITE};
    const int32_t file = request(SYS_OPEN, opening);
    const int32_t mapping[6] = {0, PIL_FILE_BYTES, PROTECTION, SHARED, file, 0};
    const int32_t address = file < 0 ? file : request(SYS_MMAP2, mapping);
    if (address < 0 && address > -4096) {
        print("core32: no shared memory\n");
        return 1;
    }
    pil_memory_t *memory = (pil_memory_t *)(intptr_t)address;
    const int32_t starter = request(SYS_GETPPID, none);
    pil_ready(memory);
    while (request(SYS_GETPPID, none) == starter) {
        wait(memory);
        pil_serve();
        if (atomic_load(&memory->bench_sleeps) != 0) {
            const int32_t waking[6] = {(int32_t)(intptr_t)&memory->done, FUTEX_WAKE, 1};
            (void)request(SYS_FUTEX, waking);
        }
    }
    return 0;
}
#endif

void begin(const uint32_t *stack)
{
#ifdef CORE32_SERVES
    leave(stack[0] == 2 ? serve((const char *)(uintptr_t)stack[2]) : 1);
#else
    (void)stack;
    leave(trace_main());
#endif
}
