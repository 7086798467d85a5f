/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Square root and quotients of the slow loop: no sum wraps, not even an unsigned one, and the
 * constants are those of the theorem. That root and quotients are exact follows from that by the
 * derivations in isqrt.c and divide.c; the checker cannot handle 64-bit products.
 */
#include "core/isqrt.h"
#include "proof.h"

#include "divide.c"

void prove_isqrt(void)
{
    const uint64_t x = (uint64_t)nondet_int64();
    const uint64_t root = isqrt64(x);
    PROVE(x != 0 || root == 0);
    PROOF_END();
}

void prove_upper_product(void)
{
    const uint64_t a = (uint64_t)nondet_int64();
    const uint64_t b = (uint64_t)nondet_int64();
    const uint64_t upper = upper_product(a, b);
    PROVE(a != 0 || upper == 0);
    PROOF_END();
}

/* 0 < m n - 2^(64 + s) < n < 2^(s + 1). */
static void check_reciprocal(reciprocal64_t reciprocal, uint64_t n)
{
    const unsigned __int128 product = (unsigned __int128)reciprocal.multiplier * n;
    const unsigned __int128 power = (unsigned __int128)1 << (64U + reciprocal.shift);
    PROVE(product > power && product - power < n);
    PROVE(n >> reciprocal.shift == 1U);
}

void prove_reciprocals(void)
{
    check_reciprocal(BY_THOUSAND, 1000);
    check_reciprocal(BY_MILLION, 1000000);
    check_reciprocal(BY_BILLION, 1000000000);
    PROOF_END();
}
