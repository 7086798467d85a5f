#include "foc/rotor.h"

#include "core/angle.h"
#include "core/q15.h"

void rotor_init(rotor_state_t *state, const config_t *config)
{
    const rotor_pll_t zero = {0};
    state->pll = zero;
    hall_init(&state->hall, config);
}

void rotor_pll_step(rotor_pll_t *pll, const config_t *config, uint16_t angle_turn)
{
    if (!pll->started) {
        pll->started = true;
        pll->theta_q32 = (uint32_t)angle_turn << 16;
    }
    pll->theta_q32 += (uint32_t)pll->speed_q32;
    const int32_t error_turn = angle_difference(angle_turn, (uint16_t)(pll->theta_q32 >> 16));
    /* error in turn Q16 times a gain in Q16 is Q32; times a gain in Q24 is Q40. */
    pll->theta_q32 += (uint32_t)q_saturate64((int64_t)error_turn * config->rotor.pll_proportional_q16);
    pll->speed_q32 = q_saturate64(pll->speed_q32 + (((int64_t)error_turn * config->rotor.pll_integral_q24) >> 8));
}
