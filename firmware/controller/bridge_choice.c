/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/bridge_choice.h"

#include "core/q15.h"
#include "monitor/safe_state.h"

enum { MOST_CURRENT_mA = 10000000 };

void bridge_choice_init(bridge_choice_state_t *state)
{
    const bridge_choice_state_t fresh = {.idle_steps = 0};
    *state = fresh;
}

static uint16_t counted(uint16_t steps, bool condition)
{
    return condition ? (uint16_t)q_min(steps + 1, UINT16_MAX) : (uint16_t)0;
}

/* Switching begins only from a current that it can control. */
static bool current_controllable(const config_t *config, const measured_t *now)
{
    const int64_t most_mA = config->motor.max_phase_current_mA;
    const int64_t d_mA = q_limit(now->latest_i_d_mA, MOST_CURRENT_mA);
    const int64_t q_mA = q_limit(now->latest_i_q_mA, MOST_CURRENT_mA);
    return d_mA * d_mA + q_mA * q_mA <= most_mA * most_mA;
}

/* Without demand the open bridge makes no torque. Opening keeps a sixteenth of the voltage. */
static bool may_coast(const safe_state_t *safe, int32_t phase_voltage_mV, bool open, bool wanted)
{
    const int32_t limit_mV = phase_voltage_mV - (open ? 0 : phase_voltage_mV / 16);
    return !wanted && safe->bridge == BRIDGE_OFF && safe->torque_mNm == 0 &&
           safe->emf_mV < limit_mV;
}

static bool coasts(bridge_choice_state_t *state, const config_t *config, const safe_state_t *safe,
                   int32_t phase_voltage_mV, bool open, bool wanted)
{
    const int32_t delay_ms = config->modes.coast_delay_ms;
    state->idle_steps = counted(state->idle_steps, may_coast(safe, phase_voltage_mV, open, wanted));
    return delay_ms > 0 && state->idle_steps >= (open ? 1 : delay_ms);
}

/* Of PWM, freewheel and short circuit the one with the least torque. PWM, which may be forced to
 * brake as well, is left where no current holds the voltage, or where the safe state brakes with
 * half as much. */
static bool pwm_is_worse(const current_setpoint_t *current, int32_t safe_torque_mNm, bool switching)
{
    return !current->feasible ||
           (switching ? current->forced_mNm / 2 : current->forced_mNm) > safe_torque_mNm;
}

static bool torque_lost(bridge_choice_state_t *state, bool worse)
{
    state->infeasible_steps = counted(state->infeasible_steps, worse);
    if (state->infeasible_steps >= BRIDGE_CHOICE_INFEASIBLE_STEPS ||
        (worse && state->return_steps > 0)) {
        state->return_steps = BRIDGE_CHOICE_RETURN_STEPS;
    } else if (state->return_steps > 0) {
        state->return_steps--;
    }
    return state->return_steps > 0;
}

/* Where no other brake is commanded and no demand arrives any more, a short circuit takes over as
 * soon as it brakes with what is kept, where the motor is permitted less than both. It stays as
 * long as it brakes with more than that: its torque needs neither the rotor's angle nor the sign of
 * its speed, of which the blend-out makes none. */
static bool short_circuit_holds(const config_t *config, const measured_t *now,
                                const monitored_t *watch, const torque_output_t *torque)
{
    const int32_t kept_mNm = torque->kept_mNm;
    const int32_t controlled_mNm = torque->available.torque_mNm;
    if (config->brake.max_hydraulic_torque_mNm > 0 || kept_mNm <= 0) {
        return false;
    }
    const int32_t speed_mrad_s = now->angle_valid ? q_abs(now->speed_mrad_s) : watch->bound_mrad_s;
    const steady_state_t shorted = safe_state_short(config, now, speed_mrad_s);
    const bool enough = shorted.torque_mNm >= q_min(kept_mNm, controlled_mNm);
    const bool begins = shorted.torque_mNm <= kept_mNm && controlled_mNm < kept_mNm;
    return enough && (begins || bridge_is_short(now->report->bridge)) &&
           shorted.current_mA <= config->motor.max_phase_current_mA;
}

bridge_mode_t bridge_choice_step(bridge_choice_state_t *state, const config_t *config,
                                 const measured_t *now, const monitored_t *watch,
                                 const torque_output_t *torque, const torque_enable_t *enable,
                                 bool demanded, findings_t *findings)
{
    const safe_state_t *safe = &watch->safe;
    const bool switching = measured_switching(now);
    const bool enabled = torque_enable_any(*enable);
    const bool drags = torque_command_is_against(torque->command_mNm, now->speed_mrad_s) &&
                       q_abs(torque->command_mNm) <= torque->coasting_mNm;
    const bool wanted = demanded || (torque->command_mNm != 0 && !drags);
    const bool idle = coasts(state, config, safe, torque->phase_voltage_mV,
                             now->report->bridge == BRIDGE_OFF, wanted);
    const bool lost =
        torque_lost(state, pwm_is_worse(&torque->current, safe->torque_mNm, switching));
    findings_set(findings, FINDING_FORCED_TORQUE,
                 enabled && (lost || torque->current.forced_mNm > 0));
    if (!enabled) {
        return safe->bridge;
    }
    if (short_circuit_holds(config, now, watch, torque)) {
        return BRIDGE_SHORT;
    }
    const bool rests = idle && now->angle_by == ANGLE_BY_OBSERVER && !switching;
    if (!now->angle_valid && !rests) {
        return BRIDGE_PWM;
    }
    const bool can_switch = !lost && (switching || current_controllable(config, now));
    return can_switch && !idle ? BRIDGE_PWM : safe->bridge;
}
