/* SPDX-License-Identifier: Apache-2.0 */
#include "frozen_currents.h"

bool frozen_currents_step(frozen_currents_t *state, const foc_period_t *latest,
                          const uint16_t codes[SENSE_PHASES])
{
    const uint32_t step_count = latest->step_count;
    int32_t unmoved = 0;
    for (int x = 0; x < SENSE_PHASES; x++) {
        unmoved += codes[x] == state->code[x] ? 1 : 0;
        state->code[x] = codes[x];
    }
    const bool comparable = step_count - state->last_step <= FROZEN_CURRENTS_GAP_PERIODS;
    state->last_step = step_count;
    if (!comparable || unmoved < FROZEN_CURRENTS_SENSORS) {
        state->begin_step = step_count;
    }
    const bool large = frozen_currents_error(latest) >> FROZEN_CURRENTS_LARGE_LOG2 != 0;
    const uint32_t enough = large ? FROZEN_CURRENTS_SHORT_PERIODS : FROZEN_CURRENTS_STAY_PERIODS;
    return step_count - state->begin_step >= enough;
}
