/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/current_expectation.h"

#include "monitor/monitor.h"

static int64_t product(dq_t a, dq_t b)
{
    return (int64_t)a.d * b.d + (int64_t)a.q * b.q;
}

static int64_t smaller(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

uint32_t current_expectation(const config_t *config, dq_t reference_pu, dq_t before_pu,
                             bool switching)
{
    const int32_t most_pu = config->current_loop.max_current_pu_q15;
    const int64_t most_square = most_pu * most_pu / 16;
    const int64_t shorter =
        smaller(product(reference_pu, reference_pu), product(before_pu, before_pu));
    const int64_t square = smaller(product(reference_pu, before_pu), shorter) / 16;
    const bool distinct = square >= (int64_t)4 * MONITOR_DEAD_SQUARE;
    return switching && distinct ? (uint32_t)smaller(square, most_square) : 0U;
}
