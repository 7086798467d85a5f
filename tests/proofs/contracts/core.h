/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of core, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* core/divide.h */
POST(divide_by_thousand, (x < 0 || result >= 0) && (x > 0 || result <= 0))
POST(divide_by_thousand, is_within(result, INT64_MIN / 1000, INT64_MAX / 1000))
POST(divide_by_thousand, is_within(x - result * 1000, -999, 999) && (x < 0 || result * 1000 <= x))

POST(divide_by_million, (x < 0 || result >= 0) && (x > 0 || result <= 0))
POST(divide_by_million, is_within(result, INT64_MIN / 1000000, INT64_MAX / 1000000))
POST(divide_by_million, is_within(x - result * 1000000, -999999, 999999))

POST(divide_by_billion, (x < 0 || result >= 0) && (x > 0 || result <= 0))
POST(divide_by_billion, is_within(result, INT64_MIN / 1000000000, INT64_MAX / 1000000000))
POST(divide_by_billion, is_within(x - result * 1000000000, -999999999, 999999999))

/* core/fade.h */
PRE(fade_q15, is_within(full, -8000000, 8000000) && is_within(none, -8000000, 8000000))
POST(fade_q15, result >= 0 && result <= Q15_ONE)
POST(fade_q15, (full <= none ? x > full : x < full) || result == Q15_ONE)
POST(fade_q15, x == full || (full <= none ? x < none : x > none) || result == 0)

/* core/findings.h */
POST(findings_fault, result == FINDING_COUNT || (is_within((int)result, 0, FINDING_BUS_JUMPED - 1)
     && findings_bit_set(findings, result)))
POST(findings_fault, result != FINDING_COUNT || every(i, (int)FINDING_BUS_JUMPED,
     !findings_bit_set(findings, i)))

POST(findings_warning, result == FINDING_COUNT || (is_within((int)result, FINDING_BUS_JUMPED,
     FINDING_COUNT - 1) && findings_bit_set(findings, result)))

/* core/grid.h */
POST(grid_interpolate, !is_within(fraction_q20, 0, GRID_WHOLE_Q20) || !grid_values_hold(a, b) ||
     is_within(result, q_min(a, b), q_max(a, b)))

POST(grid_weights, !is_within(x_q20, 0, GRID_WHOLE_Q20) || !is_within(y_q20, 0, GRID_WHOLE_Q20) ||
     !is_within(lsb_log2, 0, 15) || (grid_weights_hold(result) && result.shift == 15 - lsb_log2))

POST(grid_weighted, !grid_weights_hold(*weights) || !grid_entries_hold(at_00, at_10, at_01, at_11)
     || is_within(result, grid_lsb(*weights) * LEAST_OF(at_00, at_10, at_01, at_11),
     grid_lsb(*weights) * MOST_OF(at_00, at_10, at_01, at_11)))

/* core/q15.h */
POST(q15_share_of, share_q15 < 0 || (value >= 0 ? is_within(result, 0, value) : is_within(result,
     value, 0)))
POST(q15_share_of, share_q15 != 0 || result == 0)

PRE(q_scale, c != 0)
POST(q_scale, a < 0 || b < 0 || c < 0 || result >= 0)
POST(q_scale, a > 0 || b < 0 || c < 0 || result <= 0)
POST(q_scale, a < 0 || b > 0 || c < 0 || result <= 0)
POST(q_scale, b < 0 || b > c || (a >= 0 ? result <= a : result >= a))
POST(q_scale, a < 0 || a > c || (b >= 0 ? result <= b : result >= b))
POST(q_scale, b != c || result == a)

/* core/scaled.h */
PRE(scaled_multiply, is_within((int64_t)a * b, 1 - (INT64_C(1) << 55), (INT64_C(1) << 55) - 1))
POST(scaled_multiply, (a < 0 || b < 0 || result >= 0) && (a > 0 || b > 0 || result >= 0))
POST(scaled_multiply, (a < 0 || b > 0 || result <= 0) && (b < 0 || a > 0 || result <= 0))
POST(scaled_multiply, q_abs(b) > SCALED_ONE || is_within(result, -q_abs(a), q_abs(a)))
POST(scaled_multiply, q_abs(a) > SCALED_ONE || is_within(result, -q_abs(b), q_abs(b)))
POST(scaled_multiply, q_abs(b) > 4 * SCALED_ONE || q_abs(a) > 1 << 28 || q_abs(result) <= 4 *
     q_abs(a))
POST(scaled_multiply, q_abs(a) > 4 * SCALED_ONE || q_abs(b) > 1 << 28 || q_abs(result) <= 4 *
     q_abs(b))
POST(scaled_multiply, b != SCALED_ONE || result == a)

PRE(scaled_ratio, d > 0)
POST(scaled_ratio, (n < 0 || result >= 0) && (n > 0 || result <= 0) && q_abs(result) <= 1 << 30)
POST(scaled_ratio, q_abs(n) > d || q_abs(result) <= SCALED_ONE)
POST(scaled_ratio, q_abs(n) / 8 >= d || q_abs(result) <= 8 * SCALED_ONE)
POST(scaled_ratio, q_abs(n) >= d || d > SCALED_ONE || q_abs(result) < SCALED_ONE)

PRE(scaled_root, x < INT64_C(1) << 62)
POST(scaled_root, result >= 0 && (x > 0 || result == 0))

PRE(scaled_constant, value >= 0 && is_within(divisor, 1, (INT64_C(1) << 62) - 1))
PRE(scaled_constant, is_within(shift, -96, 96))
POST(scaled_constant, is_within(result, 0, 1 << 30) && (value > 0 || result == 0))
