/* SPDX-License-Identifier: Apache-2.0 */
/*
 * proof.h: macros and inputs of the proofs. A proof is a function without arguments; its inputs are
 * nondet_*() values, for which the model checker (CBMC) considers every value of the type.
 * ASSUME states a precondition of the function under proof, PROVE a postcondition. The checker also
 * proves that no arithmetic overflows, no shift is too wide and no array index is out of bounds.
 *
 * With PROOF_EXPECT_REACHED the only assertion is that the end of the proof is never reached, and
 * the checker must refute it. This detects assumptions that contradict each other, with which every
 * postcondition would hold. One possible input refutes it: PROOF_EXAMPLE narrows the search to
 * such, in addition to the assumptions, where the checker would search for long.
 */
#ifndef PROOF_H
#define PROOF_H

#include <assert.h>
#include <stdbool.h>
#include <stdint.h>

#define ASSUME(condition) __CPROVER_assume(condition)

#ifdef PROOF_EXPECT_REACHED
#define PROVE(condition) ((void)(condition))
#define PROOF_END() assert(0 && "the end of the proof is reached")
#define PROOF_EXAMPLE(condition) ASSUME(condition)
#else
#define PROVE(condition) assert(condition)
#define PROOF_END() ((void)0)
#define PROOF_EXAMPLE(condition) ((void)0)
#endif

int16_t nondet_int16(void);
uint16_t nondet_uint16(void);
uint8_t nondet_uint8(void);
int32_t nondet_int32(void);
uint32_t nondet_uint32(void);
int64_t nondet_int64(void);
bool nondet_bool(void);

/* Any value from `lowest` to `highest`. */
static inline int32_t any_within(int32_t lowest, int32_t highest)
{
    const int32_t x = nondet_int32();
    ASSUME(x >= lowest && x <= highest);
    return x;
}

#endif
