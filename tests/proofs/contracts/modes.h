/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Needs (PRE) and guarantees (POST) of the functions of modes, one clause a line: a C expression
 * of the parameters; `result` is what is returned, old(expression) a value before the call.
 * contracts.py reads them together with the prototypes of the headers.
 */
/* clang-format off */

/* modes/modes.h */
POST(modes_init, state->mode == MODE_BOOT && state->fault == REASON_NONE && state->warning ==
     REASON_NONE)
POST(modes_init, slow_rise_holds(&state->braking))
POST(modes_init, !state->offsets_stored && !state->fault_persists && state->acknowledge_steps == 0)

PRE(modes_step, (unsigned)state->mode <= MODE_FAULT && slow_rise_holds(&state->braking))
PRE(modes_step, state->mode != MODE_FAULT || state->fault != REASON_NONE)
PRE(modes_step, findings_hold(findings))
PRE(modes_step, config->modes.limp_drive_share_q15 >= 0 && config->modes.limp_drive_share_q15 <=
     Q15_ONE)
POST(modes_step, (unsigned)state->mode <= MODE_FAULT && slow_rise_holds(&state->braking))
POST(modes_step, state->mode != MODE_FAULT || state->fault != REASON_NONE)
POST(modes_step, findings_hold(findings))
POST(modes_step, ((findings->present[0] ^ old(findings->present[0])) & ~ROWS_OF_MODES) == 0U)
POST(modes_step, result.mode == state->mode && result.fault == state->fault)
POST(modes_step, result.torque_enable.drive_q15 >= 0 && result.torque_enable.brake_q15 >= 0)
POST(modes_step, !torque_enable_any(result.torque_enable) || result.mode == MODE_RUN || result.mode
     == MODE_LIMP)
POST(modes_step, in->demand.enable || result.torque_enable.drive_q15 == 0)
POST(modes_step, !battery_is_lost(findings) || !torque_enable_any(result.torque_enable))
POST(modes_step, every(i, (int)FINDING_BUS_JUMPED, !findings_bit_set(findings, i)) ||
     old(state->mode) == MODE_BOOT || result.mode == MODE_FAULT)
POST(modes_step, in->config_accepted || old(state->mode) == MODE_BOOT || result.mode == MODE_FAULT)
POST(modes_step, old(state->mode) != MODE_FAULT || watch->at_rest || result.mode == MODE_FAULT)
POST(modes_step, old(state->mode) != MODE_FAULT || in->demand.brake_torque_mNm <= 0 || result.mode
     == MODE_FAULT)
POST(modes_step, !result.clear_trip || (watch->at_rest && in->demand.brake_torque_mNm <= 0))
POST(modes_step, !result.calibrate_offsets || !watch->emf_conducts)
