/* SPDX-License-Identifier: Apache-2.0 */
#include "core/isqrt.h"

/*
 * One binary digit of the root at a time, from above. Let r be the digits found so far, and 2^k the
 * next one's weight:
 *     bit = 4^k,   root = r 2^(k + 1),   x = the argument less r^2,   x < 2 root + 4 bit
 * The last says that the argument is below (r + 2^(k + 1))^2. The digit belongs to the root if the
 * remainder x is at least (r + 2^k)^2 - r^2 = r 2^(k + 1) + 4^k = root + bit. Then the new
 * remainder is x - root - bit < root + 3 bit and the next root is (r + 2^k) 2^k = root/2 + bit;
 * else x < root + bit, and it is root/2. Either way the next x is below 2 root + 4 bit again, with
 * the next bit a quarter. After the last digit root is r, and x < 2 r + 1: the argument is below (r
 * + 1)^2.
 */
uint32_t isqrt64(uint64_t x)
{
    uint64_t root = 0;
    uint64_t bit = UINT64_C(1) << 62;
    while (bit > x) {
        bit >>= 2;
    }
    for (; bit != 0; bit >>= 2) {
        if (x >= root + bit) {
            x -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return (uint32_t)root;
}
