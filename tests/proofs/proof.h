/* SPDX-License-Identifier: Apache-2.0 */
/*
 * proof.h: what every proof uses. A proof is a function without arguments; its inputs are
 * nondet_*() values, which the model checker (CBMC) takes to be every value of the type at once.
 * ASSUME says what the header under proof demands of its caller, PROMISE what it promises; that
 * nothing overflows, shifts too far or leaves an array is checked besides.
 *
 * With PROOF_EXPECT_REACHED only one thing is claimed: that the end of the proof is never reached.
 * The checker must find a way there. A proof whose assumptions contradict each other proves
 * nothing, and that is how it is found out.
 */
#ifndef PROOF_H
#define PROOF_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

#define ASSUME(condition) __CPROVER_assume(condition)

#ifdef PROOF_EXPECT_REACHED
#define PROMISE(condition) ((void)(condition))
#define PROOF_END() assert(0 && "the end of the proof is reached")
#else
#define PROMISE(condition) assert(condition)
#define PROOF_END() ((void)0)
#endif

int16_t nondet_int16(void);
uint16_t nondet_uint16(void);
uint8_t nondet_uint8(void);
int32_t nondet_int32(void);
uint32_t nondet_uint32(void);
int64_t nondet_int64(void);
bool nondet_bool(void);

/* Any value of lowest .. highest. */
static inline int32_t any_within(int32_t lowest, int32_t highest)
{
    const int32_t x = nondet_int32();
    ASSUME(x >= lowest && x <= highest);
    return x;
}

#endif
