/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/bridge_choice.h"

#include "core/q15.h"

enum { MOST_CURRENT_mA = 10000000 };

void bridge_choice_init(bridge_choice_state_t *state)
{
    const bridge_choice_state_t fresh = {.overspeed = false};
    *state = fresh;
}

static uint16_t counted(uint16_t steps, bool condition)
{
    return condition ? (uint16_t)q_min(steps + 1, UINT16_MAX) : (uint16_t)0;
}

/* Switching begins only from a current that it can control; an eighth is for the transient of
 * diodes that conduct. A short circuit's settled current, psi / L_d, is i_d alone: whole limit. */
static bool current_controllable(const config_t *config, const bridge_choice_input_t *in)
{
    const int32_t eighths = bridge_is_short(in->bridge) ? 8 : 7;
    const int64_t most_mA = (int64_t)config->motor.max_phase_current_mA * eighths / 8;
    const int64_t d_mA = q_limit(in->i_d_mA, MOST_CURRENT_mA);
    const int64_t q_mA = q_limit(in->i_q_mA, MOST_CURRENT_mA);
    return d_mA * d_mA + q_mA * q_mA <= most_mA * most_mA;
}

/* Without demand the open bridge makes no torque. Opening keeps a sixteenth of the voltage. */
static bool may_coast(const bridge_choice_input_t *in)
{
    const bool open = in->bridge == BRIDGE_OFF;
    const int32_t limit_mV = in->phase_voltage_mV - (open ? 0 : in->phase_voltage_mV / 16);
    return !in->torque_wanted && in->safe_bridge == BRIDGE_OFF && in->safe_torque_mNm == 0 &&
           in->emf_mV < limit_mV;
}

static bool coasts(bridge_choice_state_t *state, const config_t *config,
                   const bridge_choice_input_t *in)
{
    const int32_t delay_ms = config->modes.coast_delay_ms;
    state->idle_steps = counted(state->idle_steps, may_coast(in));
    return delay_ms > 0 && state->idle_steps >= (in->bridge == BRIDGE_OFF ? 1 : delay_ms);
}

/* Of three ways to let go the one with the least torque. PWM, which may be forced to brake as well,
 * is left where no current holds the voltage, or where the safe state brakes with half as much. */
static bool pwm_is_worse(const bridge_choice_input_t *in)
{
    return !in->torque_feasible ||
           (in->bridge == BRIDGE_PWM ? in->forced_mNm / 2 : in->forced_mNm) > in->safe_torque_mNm;
}

static bool torque_lost(bridge_choice_state_t *state, const bridge_choice_input_t *in)
{
    const bool worse = pwm_is_worse(in);
    state->infeasible_steps = counted(state->infeasible_steps, worse);
    if (state->infeasible_steps >= BRIDGE_CHOICE_INFEASIBLE_STEPS ||
        (worse && state->return_steps > 0)) {
        state->return_steps = BRIDGE_CHOICE_RETURN_STEPS;
    } else if (state->return_steps > 0) {
        state->return_steps--;
    }
    return state->return_steps > 0;
}

int32_t bridge_choice_phase_mV(const config_t *config, int32_t phase_mV, int32_t bus_mV,
                               int32_t charging_mA)
{
    const int64_t lift_uV = (int64_t)charging_mA * config->battery.resistance_uOhm / 1000;
    const int32_t lift_mV = q_min(q_saturate64(lift_uV / 1000), q_max(bus_mV, 1) / 2);
    const int32_t lowered_mV = phase_mV - q_scale(phase_mV, lift_mV, q_max(bus_mV, 1));
    return lowered_mV - (lowered_mV >> BRIDGE_CHOICE_HYSTERESIS_LOG2);
}

static void warn_of_overspeed(bridge_choice_state_t *state, bool lost)
{
    if (lost) {
        state->overspeed_steps = BRIDGE_CHOICE_OVERSPEED_STEPS;
    } else if (state->overspeed_steps > 0) {
        state->overspeed_steps--;
    }
    state->overspeed = state->overspeed_steps > 0;
}

bridge_mode_t bridge_choice_step(bridge_choice_state_t *state, const config_t *config,
                                 const bridge_choice_input_t *in)
{
    const bool idle = coasts(state, config, in);
    const bool lost = torque_lost(state, in);
    warn_of_overspeed(state, (lost || in->forced_mNm > 0) && in->torque_enabled);
    if (!in->torque_enabled) {
        return in->safe_bridge;
    }
    const bool rests = idle && in->observer_used && in->bridge != BRIDGE_PWM;
    if (!in->rotor_valid && !rests) {
        return BRIDGE_PWM;
    }
    const bool begins = in->bridge != BRIDGE_PWM;
    const bool can_switch = !lost && (!begins || current_controllable(config, in));
    return can_switch && !idle ? BRIDGE_PWM : in->safe_bridge;
}
