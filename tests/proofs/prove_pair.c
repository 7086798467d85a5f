/* SPDX-License-Identifier: Apache-2.0 */
/*
 * core/pair.h against the packed instructions that a Cortex-M4 has for it (hal/cortex_m/pair.h):
 * for all inputs that the header allows, the portable function gives the components that the
 * instruction does. The instructions are modelled after their pseudocode in Arm DDI 0403 E.e, A7.7.
 */
#include "core/pair.h"
#include "proof.h"

static int32_t lower(uint32_t word)
{
    const int32_t half = (int32_t)(word & 0xFFFFU);
    return half >= 32768 ? half - 65536 : half;
}

static int32_t upper(uint32_t word)
{
    return lower(word >> 16);
}

static uint32_t packed(int32_t x, int32_t y)
{
    return ((uint32_t)x & 0xFFFFU) | ((uint32_t)y & 0xFFFFU) << 16;
}

static q_pair_t unpacked(uint32_t word)
{
    return q_pair(lower(word), upper(word));
}

static bool same(q_pair_t a, uint32_t word)
{
    return q_pair_x(a) == lower(word) && q_pair_y(a) == upper(word);
}

/* PKHBT with LSL #16 and, for a number in Q25, LSL #6. */
void prove_pair_pack(void)
{
    const int32_t x = any_within(-32768, 32767);
    const int32_t y = any_within(-32768, 32767);
    const uint32_t word = ((uint32_t)x & 0xFFFFU) | (uint32_t)y << 16;
    PROVE(same(q_pair(x, y), word));
    const int32_t y_q25 = any_within(-(1 << 25), (1 << 25) - 1);
    const uint32_t by_6 = ((uint32_t)x & 0xFFFFU) | ((uint32_t)y_q25 << 6 & 0xFFFF0000U);
    PROVE(same(q_pair_of_q25(x, y_q25), by_6));
    PROOF_END();
}

/* PKHTB with ASR #n: upper half of the first, lower half of the second shifted. */
void prove_pair_shifted(void)
{
    const int32_t y = nondet_int32();
    const int32_t x = nondet_int32();
    ASSUME(x >> 21 >= -32768 && x >> 21 <= 32767);
    const uint32_t by_21 = ((uint32_t)y & 0xFFFF0000U) | ((uint32_t)(x >> 21) & 0xFFFFU);
    PROVE(same(Q_PAIR_SHIFTED(x, 21, y), by_21));
    const uint32_t by_22 = ((uint32_t)y & 0xFFFF0000U) | ((uint32_t)(x >> 22) & 0xFFFFU);
    PROVE(same(Q_PAIR_SHIFTED(x, 22, y), by_22));
    const uint32_t by_16 = ((uint32_t)y & 0xFFFF0000U) | ((uint32_t)(x >> 16) & 0xFFFFU);
    PROVE(same(Q_PAIR_SHIFTED(x, 16, y), by_16));
    PROOF_END();
}

/* SADD16, SSUB16: modulo 2^16; QSUB16 saturates. */
void prove_pair_sums(void)
{
    const uint32_t a = nondet_uint32();
    const uint32_t b = nondet_uint32();
    const int32_t sum_x = lower(a) + lower(b);
    const int32_t sum_y = upper(a) + upper(b);
    if (sum_x >= -32768 && sum_x <= 32767 && sum_y >= -32768 && sum_y <= 32767) {
        PROVE(same(q_pair_add(unpacked(a), unpacked(b)), packed(sum_x, sum_y)));
    }
    const int32_t difference_x = lower(a) - lower(b);
    const int32_t difference_y = upper(a) - upper(b);
    if (difference_x >= -32768 && difference_x <= 32767 && difference_y >= -32768 &&
        difference_y <= 32767) {
        PROVE(
            same(q_pair_difference(unpacked(a), unpacked(b)), packed(difference_x, difference_y)));
    }
    const int32_t x =
        difference_x > 32767 ? 32767 : (difference_x < -32768 ? -32768 : difference_x);
    const int32_t y =
        difference_y > 32767 ? 32767 : (difference_y < -32768 ? -32768 : difference_y);
    PROVE(same(q_pair_subtract(unpacked(a), unpacked(b)), packed(x, y)));
    PROOF_END();
}

/* SMULWB and SMULWT give the upper 32 of a product's 48 bits, SMMLA with b 2^15 the upper word of
 * 2^32 sum + 2^15 a b: the portable functions' own expressions, as long as these do not overflow.
 */
void prove_pair_scale(void)
{
    const q_pair_t a = q_pair(any_within(-32768, 32767), any_within(-32768, 32767));
    const q_pair_t scaled = q_pair_scale(a, any_within(0, 65535));
    PROVE(q_pair_x(scaled) >= -32768 && q_pair_x(scaled) <= 32767);
    PROVE(q_pair_y(scaled) >= -32768 && q_pair_y(scaled) <= 32767);
    PROOF_END();
}

void prove_mac_q17(void)
{
    (void)q_mac_q17(any_within(-131072, 131072), any_within(-65536, 65535), any_within(0, 32767));
    PROOF_END();
}

/* SMUAD, SMUADX, SMUSD, SMUSDX, SMLABB, SMLATT compute the portable functions' own expressions
 * modulo 2^32 (DDI 0403). They agree unless these overflow, which only the excluded sum does.
 */
void prove_pair_products(void)
{
    const q_pair_t a = q_pair(any_within(-32768, 32767), any_within(-32768, 32767));
    const q_pair_t b = q_pair(any_within(-32768, 32767), any_within(-32768, 32767));
    ASSUME(q_pair_x(a) > -32768 || q_pair_y(a) > -32768);
    (void)q_pair_dot(a, b);
    (void)q_pair_re(a, b);
    (void)q_pair_im(a, b);
    (void)q_pair_cross(a, b);
    (void)q_pair_square(a);
    PROOF_END();
}
