/* SPDX-License-Identifier: Apache-2.0 */
/* The modulator with the constants of modulation_of(): for every vector in the circle and every
 * dead-time correction no pulse is shorter than the minimum. */
#include "core/sqrt3.h"
#include "modulation.h"
#include "proof.h"
#include "transforms.h"

static ab_t any_vector_in_circle(void)
{
    const ab_t x = {.alpha = any_within(-32775, 32775), .beta = any_within(-32775, 32775)};
    const int32_t across = (x.beta * SQRT3_2_Q15) >> 14;
    /* sqrt 3 times the unit, doubled: the circle's tangents across the three line voltages, for a
     * vector of length 32 773.83 (SOUNDNESS.md, Lengths of vectors) and the rounding here. */
    ASSUME(2 * across <= 113534 && 2 * across >= -113534);
    ASSUME(3 * x.alpha - across <= 113534 && 3 * x.alpha - across >= -113534);
    ASSUME(3 * x.alpha + across <= 113534 && 3 * x.alpha + across >= -113534);
    return x;
}

static void prove_pulses_of(int32_t period, int32_t min_pulse, int32_t trim_counts)
{
    const modulation_t modulation = modulation_of(period, min_pulse, trim_counts, 32767);
    /* The pulse is linear in the correction, so it is shortest or longest at an end of its range.
     */
    const abc_t trim = {.a = nondet_bool() ? 32767 : -32768,
                        .b = nondet_bool() ? 32767 : -32768,
                        .c = nondet_bool() ? 32768 : -32767};
    int32_t on_q16[3];
    modulation_step(&modulation, any_vector_in_circle(), trim, on_q16);
    for (int x = 0; x < 3; x++) {
        const int32_t on = on_q16[x] >> 16;
        PROVE(on >= min_pulse && on <= period - min_pulse);
    }
}

/* The paper's vehicle. */
void prove_pulses(void)
{
    prove_pulses_of(4200, 252, 84);
    PROOF_END();
}

/* The coarsest timer with the longest pulse and trim the validator accepts. Other combinations are
 * drawn at random in tests/property. */
void prove_pulses_of_the_shortest_period(void)
{
    prove_pulses_of(256, 51, 32);
    PROOF_END();
}
