/* SPDX-License-Identifier: Apache-2.0 */
#include "winding.h"

#include "foc/observer_design.h"

winding_t winding_constants(const config_t *config)
{
    const config_current_loop_t *loop = &config->current_loop;
    const winding_t out = {
        .d = {loop->proportional_d_pu_q16, loop->integral_d_pu_q24, loop->inductance_d_pu_q16,
              loop->flux_pu_q16,
              winding_anti_windup_q28(loop->integral_d_pu_q24,
                                      q_divisor(loop->proportional_d_pu_q16))},
        .q = {loop->proportional_q_pu_q16, loop->integral_q_pu_q24, loop->inductance_q_pu_q16, 0,
              winding_anti_windup_q28(loop->integral_q_pu_q24,
                                      q_divisor(loop->proportional_q_pu_q16))},
        .chord_q_q15 = observer_design_inductance_q15(config),
    };
    return out;
}
