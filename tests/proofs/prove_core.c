/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of core: results inside their ranges for every argument their headers allow. */
#include "core/angle.h"
#include "core/circle.h"
#include "core/filter.h"
#include "core/grid.h"
#include "core/q15.h"
#include "core/ramp.h"
#include "core/reciprocal.h"
#include "proof.h"

void prove_q15(void)
{
    const int32_t x = nondet_int32();
    const int16_t saturated = q15_saturate(x);
    PROVE(x < Q15_MIN || x > Q15_ONE || saturated == x);
    PROVE(x >= Q15_MIN || saturated == Q15_MIN);
    PROVE(x <= Q15_ONE || saturated == Q15_ONE);
    PROVE(q_saturate31(x) >= -1073741824 && q_saturate31(x) <= 1073741823);
    PROVE(q_abs(x) >= 0);
    const int32_t most = any_within(0, INT32_MAX);
    const int32_t limited = q_limit(x, most);
    PROVE(limited >= -most && limited <= most);
    PROVE(limited == x || (x > most && limited == most) || (x < -most && limited == -most));
    PROOF_END();
}

void prove_q15_slow(void)
{
    const int32_t value = nondet_int32();
    const int16_t share_q15 = nondet_int16();
    const int32_t share = q15_share_of(value, share_q15);
    PROVE(value != 0 || share == 0);
    const int64_t x = nondet_int64();
    const int32_t saturated = q_saturate64(x);
    PROVE(saturated == x || x > INT32_MAX || x < INT32_MIN);
    const int32_t other = nondet_int32();
    PROVE(q_add(value, other) == q_saturate64((int64_t)value + other));
    PROVE(q_subtract(value, other) == q_saturate64((int64_t)value - other));
    PROOF_END();
}

void prove_angle(void)
{
    const uint16_t theta = nondet_uint16();
    const sincos_t out = angle_sincos(theta);
    PROVE(out.sin >= -32768 && out.sin <= 32768);
    PROVE(out.cos >= -32768 && out.cos <= 32768);
    PROOF_END();
}

void prove_angle_difference(void)
{
    const uint16_t a = nondet_uint16();
    const uint16_t b = nondet_uint16();
    const int32_t difference = angle_difference(b, a);
    PROVE((uint16_t)((int32_t)a + difference + 65536) == b);
    PROOF_END();
}

void prove_circle(void)
{
    const int32_t x = any_within(-32768, 32768);
    const int32_t y = circle_other_q15(x);
    PROVE(y >= 0 && y <= 32767); /* accuracy: tested for every x in tests/unit */
    PROOF_END();
}

void prove_circle_of_any_radius(void)
{
    const int32_t radius = any_within(164, Q15_ONE);
    /* As circle_init() computes it: the reciprocal, rounded up. */
    circle_t circle;
    circle.radius_q15 = radius;
    circle.inverse_q14 = any_within((1 << 29) / Q15_ONE, (1 << 29) / 164 + 1);
    ASSUME((int64_t)circle.inverse_q14 * radius > (1 << 29) &&
           (int64_t)(circle.inverse_q14 - 1) * radius <= (1 << 29));
    const int32_t x = any_within(-Q15_ONE, Q15_ONE);
    ASSUME(x >= -radius && x <= radius);
    const int32_t y = circle_other(&circle, x);
    PROVE(y >= 0 && y <= radius);
    PROOF_END();
}

void prove_reciprocal(void)
{
    const uint16_t n = nondet_uint16();
    const uint32_t half = UINT32_C(1) << 31;
    const uint32_t one_of_n = reciprocal_scale(half, n);
    PROVE(one_of_n >= 32768U && one_of_n <= half);
    const uint32_t x = nondet_uint32();
    const uint32_t quotient = reciprocal_scale(x, n);
    PROVE(quotient <= x);
    PROOF_END();
}

void prove_grid(void)
{
    const int32_t points = any_within(2, 65);
    const int32_t step_log2 = any_within(0, 20);
    const grid_position_t at = grid_locate(nondet_int32(), points, step_log2);
    PROVE(at.index >= 0 && at.index <= points - 2);
    PROVE(at.fraction_q20 >= 0 && at.fraction_q20 <= GRID_WHOLE_Q20);
    const int32_t largest = (1 << 30) - 1;
    const int32_t a = any_within(-largest, largest);
    const int32_t b = any_within(-largest, largest);
    PROVE(grid_interpolate(a, b, 0) == a && grid_interpolate(a, b, GRID_WHOLE_Q20) == b);
    (void)grid_interpolate(a, b, any_within(0, GRID_WHOLE_Q20));
    PROOF_END();
}

void prove_filter_and_ramp(void)
{
    const unsigned shift = nondet_uint8() & 15U;
    const int32_t most = ((1 << 30) - 1) >> shift;
    filter_t filter;
    filter_reset(&filter, any_within(-most, most), shift);
    const int32_t x = any_within(-most, most);
    for (int n = 0; n < 2; n++) {
        const int32_t y = filter_step(&filter, x, shift);
        PROVE(y >= -most - 1 && y <= most);
    }
    const int32_t value = nondet_int32();
    const int32_t target = nondet_int32();
    const int32_t step = any_within(0, INT32_MAX);
    const int32_t next = ramp_step(value, target, step);
    PROVE(target >= value ? (next >= value && next <= target) : (next <= value && next >= target));
    PROVE((int64_t)next - value <= step && (int64_t)value - next <= step);
    PROOF_END();
}
