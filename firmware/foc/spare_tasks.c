/* SPDX-License-Identifier: Apache-2.0 */
#include "spare_tasks.h"

#include "current_controller.h"
#include "emf_observer.h"
#include "field_weakening.h"
#include "frozen_currents.h"
#include "rotor.h"

/* The next period's field-weakening current. A change of it re-applies the setpoint, also when it
 * has just returned to zero. */
static void weaken_field(foc_state_t *state, const config_t *config)
{
    const dq_t voltage = voltage_unsaturated(&state->period.voltage);
    const int32_t margin_q15 = field_weakening_margin_q15(&state->weakening, voltage);
    if (margin_q15 < 0 || state->weakening.current_q28 != 0) {
        field_weakening_step(&state->weakening, margin_q15,
                             config->current_loop.field_weakening_gain_pu_q15,
                             config->current_loop.field_weakening_current_pu_q15);
        state->sequence = FOC_NO_SETPOINT;
    }
}

bool spare_tasks_run(foc_state_t *state, const config_t *config, const uint16_t codes[SENSE_PHASES])
{
    frozen_currents_t *const frozen = &state->current.frozen;
    const uint32_t step_count = state->spare_step++;
    if (rotor_at_hall_edge(&state->rotor)) {
        return false;
    }
    if (frozen_currents_due(&state->period) &&
        step_count - frozen->last_step >= SPARE_TASKS_PERIODS - 1U) {
        return frozen_currents_step(frozen, &state->period, codes);
    }
    state->spare_step = spare_tasks_next(step_count);
    weaken_field(state, config);
    emf_observer_acquire(&state->observer);
    return false;
}
