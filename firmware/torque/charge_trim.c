/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/charge_trim.h"

#include "core/q15.h"

enum {
    MOST_mA = 2000000,
    CODES_LOG2 = 12 /* of the converter that measures the currents */
};

/* Half of 3/2 R I^2, over the voltage: mA^2 uOhm / 10^6 = uW, and uW / mV = mA. */
static int32_t half_copper_mA(const config_t *config)
{
    const config_motor_t *motor = &config->motor;
    const int64_t squared = (int64_t)motor->max_phase_current_mA * motor->max_phase_current_mA;
    const int64_t copper_uW = squared / 1000 * motor->phase_resistance_uOhm / 4000 * 3;
    return q_min(q_saturate64(copper_uW / q_divisor(config->battery.max_voltage_mV)), MOST_mA);
}

void charge_trim_init(charge_trim_state_t *state, const config_t *config)
{
    const charge_trim_state_t fresh = {.most_mA = half_copper_mA(config)};
    *state = fresh;
}

/* The largest charge that a message with any delay, behind any filter up to the configured one, may
 * show of the motor. */
static int32_t message_mA(charge_trim_state_t *state, const config_battery_t *battery,
                          int32_t charge_mA)
{
    if (charge_mA >= state->message_mA) {
        state->message_mA = charge_mA;
        state->hold_ms = CHARGE_TRIM_MESSAGE_ms;
    } else if (state->hold_ms > 0) {
        state->hold_ms--;
    } else {
        const int32_t fall_mA =
            (state->message_mA - charge_mA) / q_divisor(battery->current_filter_ms);
        state->message_mA -= q_max(fall_mA, 1);
    }
    return state->message_mA;
}

/* What the battery's own current shows of the bridge: at most that it loses nothing. */
static int32_t by_pack_mA(charge_trim_state_t *state, const motor_model_t *model,
                          const measured_t *now, motor_point_t flowing)
{
    const config_battery_t *battery = &model->config->battery;
    const bool shown =
        now->battery->current_given && !measured_battery_open(now) && battery->driven_wheels == 1;
    if (!shown) {
        filter_reset(&state->pack, 0, CHARGE_TRIM_PACK_LOG2);
        return 0;
    }
    const int32_t lost_mA =
        q_clamp(motor_model_switching_current_mA(model, flowing, now->bus_voltage_mV), 0, MOST_mA);
    const int32_t own_mA =
        filter_step(&state->own, q_limit(now->bus_current_mA, MOST_mA), CHARGE_TRIM_OWN_LOG2);
    const int32_t charged_mA = -q_limit(now->battery->current_mA, MOST_mA);
    const int32_t beyond_mA = charged_mA - message_mA(state, battery, -own_mA - lost_mA);
    return filter_step(&state->pack, q_clamp(beyond_mA, 0, lost_mA), CHARGE_TRIM_PACK_LOG2);
}

/* A wheel that slows down returns less in proportion, whatever torque its model is wrong by. */
static void follow_speed(charge_trim_state_t *state, int32_t speed_mrad_s)
{
    const int32_t speed_abs_mrad_s = q_abs(speed_mrad_s);
    const int32_t slower_mrad_s =
        q_max(q_saturate16(state->speed_abs_mrad_s - speed_abs_mrad_s), 0);
    const int32_t share_q16 =
        (int32_t)(((uint32_t)slower_mrad_s << 16) / (uint32_t)q_max(state->speed_abs_mrad_s, 1));
    state->terminals_q8_mA -= (int32_t)(((int64_t)state->terminals_q8_mA * share_q16) >> 16);
    state->speed_abs_mrad_s = speed_abs_mrad_s;
}

/* Rises with what is charged, and falls slowly: the torque follows a line that rises slowly, so
 * that i_d stays on the current circle. */
static int32_t terminals_mA(charge_trim_state_t *state, int32_t error_mA)
{
    const int32_t away_q8 = q_limit(error_mA, state->most_mA) * 256 - state->terminals_q8_mA;
    state->terminals_q8_mA +=
        away_q8 >> (away_q8 > 0 ? CHARGE_TRIM_RISE_LOG2 : CHARGE_TRIM_FALL_LOG2);
    return state->terminals_q8_mA >> 8;
}

int32_t charge_trim_step(charge_trim_state_t *state, const motor_model_t *model,
                         const measured_t *now, motor_point_t flowing)
{
    const int32_t resolution_mA = model->config->drive.current_full_scale_mA >> CODES_LOG2;
    const int32_t measured_mA = q_limit(now->bus_current_mA, MOST_mA);
    const bool shown = state->braking && measured_switching(now);
    follow_speed(state, model->speed_mrad_s);
    const int32_t error_mA = shown ? state->commanded_mA - measured_mA : 0;
    return terminals_mA(state, error_mA) + by_pack_mA(state, model, now, flowing) + resolution_mA;
}

void charge_trim_commanded(charge_trim_state_t *state, const motor_model_t *model,
                           current_setpoint_t current, bool braking, int32_t bus_mV)
{
    state->braking = braking;
    if (braking) {
        const motor_current_t i = {.d_mA = current.i_d_mA, .q_mA = current.i_q_mA};
        const motor_point_t at = motor_model_point(model, i);
        state->commanded_mA = q_limit(motor_model_bus_current_mA(model, at, bus_mV), MOST_mA);
    }
}
