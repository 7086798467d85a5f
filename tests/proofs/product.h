/* SPDX-License-Identifier: Apache-2.0 */
/*
 * product.h: a product of two numbers of 32 bits, in place of a * b where the solvers do not finish
 * (lemmas.py): any function of the factors with the product's sign and largest magnitude.
 */
#ifndef PRODUCT_H
#define PRODUCT_H

#include "proof.h"

int64_t __CPROVER_uninterpreted_product(int64_t a, int64_t b);

static inline int64_t product(int64_t a, int64_t b)
{
    const int64_t limit = INT64_C(1) << 31;
    const int64_t out = __CPROVER_uninterpreted_product(a, b);
    if (a >= -limit && a <= limit && b >= -limit && b <= limit) {
        const int64_t most = (a < 0 ? -a : a) * limit;
        ASSUME(out >= -most && out <= most);
        ASSUME(!((a >= 0 && b >= 0) || (a <= 0 && b <= 0)) || out >= 0);
        ASSUME(!((a >= 0 && b <= 0) || (a <= 0 && b >= 0)) || out <= 0);
    }
    return out;
}

#endif
