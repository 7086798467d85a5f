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

void current_expectation_init(current_expectation_t *state, const config_t *config)
{
    const int32_t most_pu = config->current_loop.max_current_pu_q15;
    const current_expectation_t fresh = {.most_square = (uint32_t)(most_pu * most_pu) / 16U};
    *state = fresh;
}

uint32_t current_expectation_step(current_expectation_t *state, dq_t reference_pu, bool switching)
{
    const int64_t shorter = smaller(product(reference_pu, reference_pu),
                                    product(state->reference_pu, state->reference_pu));
    const int64_t square = smaller(product(reference_pu, state->reference_pu), shorter) / 16;
    state->reference_pu = reference_pu;
    const bool distinct = square >= (int64_t)4 * MONITOR_DEAD_SQUARE;
    return switching && distinct ? (uint32_t)smaller(square, state->most_square) : 0U;
}
