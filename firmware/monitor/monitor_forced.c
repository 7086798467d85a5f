/* SPDX-License-Identifier: Apache-2.0 */
#include "config/bases.h"
#include "core/divide.h"
#include "core/q15.h"
#include "monitor/monitor.h"

/* Braking torque that no current within the limits may prevent: all of it where even the largest
 * demagnetising current may leave more voltage than the bus has. Coarse: it contains what the
 * torque limits count on (README, Natural torque). */
int32_t monitor_forced_torque_mNm(const config_t *config, int32_t speed_mrad_s,
                                  int32_t bus_voltage_mV)
{
    const config_motor_t *motor = &config->motor;
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, q_abs(speed_mrad_s));
    const int64_t weakening_mA =
        bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15);
    const int64_t weakened_nWb =
        motor->flux_linkage_nWb - divide_by_thousand(weakening_mA * motor->d_inductance_nH);
    const int64_t left_mV = divide_by_billion(w_mrad_s * (weakened_nWb > 0 ? weakened_nWb : 0)) +
                            divide_by_million(weakening_mA * motor->phase_resistance_uOhm) * 3 / 2;
    const config_current_loop_t *loop = &config->current_loop;
    const int32_t share_q15 =
        q_scale(loop->modulation_limit_pu_q15,
                loop->modulation_target_pu_q15 - loop->modulation_reserve_pu_q15, 32768);
    const int64_t used_mV = q_scale(q_max(bus_voltage_mV, 0), share_q15, 32768);
    return left_mV * 1732 > used_mV * 1000 * 7 / 8 ? motor->max_torque_mNm : 0;
}
