/* SPDX-License-Identifier: Apache-2.0 */
/*
 * comms/xcp.c: the one check between an address of the tool and memory. For every address, count
 * and region it says what sums in 64 bits say, which cannot wrap.
 */
#include "xcp.c"

#include "proof.h"

void prove_xcp_is_within(void)
{
    const uint32_t first = nondet_uint32();
    const uint32_t count = nondet_uint32();
    const uint32_t begin = nondet_uint32();
    const uint32_t size = nondet_uint32();
    const bool inside =
        first >= begin && (uint64_t)first + count <= (uint64_t)begin + (uint64_t)size;
    PROVE(is_within(first, count, begin, size) == inside);
    PROOF_END();
}
