/* SPDX-License-Identifier: Apache-2.0 */
#include "sense.h"

enum { HALF_CODE = 8 };

void sense_init(sense_state_t *state, const config_drive_t *config)
{
    const int32_t stored_q4[SENSE_PHASES] = {config->offset_a_q4, config->offset_b_q4,
                                             config->offset_c_q4};
    for (int x = 0; x < SENSE_PHASES; x++) {
        state->offset_q4[x] = stored_q4[x];
        state->sum[x] = 0;
    }
    state->samples = 0;
    state->calibrated = false;
}

void sense_calibrate_restart(sense_state_t *state)
{
    state->samples = 0;
    state->calibrated = false;
    for (int x = 0; x < SENSE_PHASES; x++) {
        state->sum[x] = 0;
    }
}

void sense_calibrate_step(sense_state_t *state, const uint16_t codes[SENSE_PHASES])
{
    if (state->calibrated) {
        return;
    }
    for (int x = 0; x < SENSE_PHASES; x++) {
        state->sum[x] += (uint32_t)q_min(codes[x], SENSE_CODE_MAX);
    }
    state->samples++;
    if (state->samples == (1U << SENSE_CALIBRATION_LOG2)) {
        for (int x = 0; x < SENSE_PHASES; x++) {
            state->offset_q4[x] = (int32_t)(state->sum[x] >> (SENSE_CALIBRATION_LOG2 - 4));
        }
        state->calibrated = true;
    }
}

ab16_t sense_without(const sense_state_t *state, const uint16_t codes[SENSE_PHASES], uint8_t phase)
{
    const int32_t on_q16[SENSE_PHASES] = {phase == 0, phase == 1, phase == 2};
    return sense_step(state, codes, on_q16).i;
}

static bool at_range_end(int32_t offset_q4, int32_t i_pu)
{
    const int32_t highest = q_min(SENSE_CODE_MAX * 16 - offset_q4, Q15_ONE);
    const int32_t lowest = q_max(-offset_q4, Q15_MIN);
    return i_pu >= highest - HALF_CODE || i_pu <= lowest + HALF_CODE;
}

bool sense_adc_saturated(const int32_t offset_q4[SENSE_PHASES], abc_t i_pu)
{
    return at_range_end(offset_q4[0], i_pu.a) || at_range_end(offset_q4[1], i_pu.b) ||
           at_range_end(offset_q4[2], i_pu.c);
}
