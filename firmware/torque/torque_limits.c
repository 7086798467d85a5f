/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/torque_limits.h"

#include "config/bases.h"
#include "core/divide.h"
#include "core/q15.h"
#include "torque/current_setpoint.h"
#include "torque/feasible_torque.h"
#include "torque/foldback.h"
#include "torque/loss_maps.h"

enum {
    SPEED_FADE_DIVISOR = 32, /* driving torque fades out over this last part of the speed range */
    NEGLIGIBLE_POWER_DIVISOR = 1000, /* of the largest power: less than the inverter itself burns */
    HALVINGS = 6,                    /* of the range in which a limit is looked for */
    LINES = 1, /* drawn through the ends of what is left, before the last one */
    NO_LIMIT_mNm = INT32_MAX
};

static int32_t own_share_mA(const config_t *config, int32_t pack_limit_mA, int32_t configured_mA)
{
    return q_min(q_max(pack_limit_mA, 0) / config->battery.driven_wheels, configured_mA);
}

/* Power that |current| of this motor's share means at the present bus voltage, mW. */
static int32_t power_mW(int32_t current_mA, int32_t voltage_mV)
{
    return q_saturate64(divide_by_thousand((int64_t)current_mA * voltage_mV));
}

/* One motor in one direction of power. */
typedef struct {
    const config_t *config;
    const motor_model_t *model;
    int32_t i_d_weakening_mA;
    int32_t sign; /* of the torque: forward driving 1, forward braking -1 */
    feasible_torque_t by_voltage;
} side_t;

/* What grows with the torque and has a limit. */
typedef enum { BURDEN_CURRENT_SQUARE, BURDEN_DRAWN_POWER, BURDEN_RETURNED_POWER } burden_t;

/* Voltage of the axes' difference, mV. */
static int64_t saliency_mV(const motor_model_t *model, int32_t current_mA)
{
    const int64_t difference_uOhm = (int64_t)model->reactance_d_uOhm - model->reactance_q_uOhm;
    return q_saturate64(divide_by_million(q_saturate64(difference_uOhm) * (int64_t)current_mA));
}

/*
 * Power that may come back on top of the model's because hall sensors leave the angle open: an edge
 * is seen up to a period late and taken for half a period old, so the angle is uncertain by w T/2.
 * Currents turned by a small angle d have i_d - i_q d and i_q + i_d d, and 3/2 w [psi i_q + (L_d -
 * L_q) i_d i_q] changes by 3/2 w [psi i_d + (L_d - L_q) (i_d^2 - i_q^2)] d It matters where field
 * weakening makes i_d large.
 */
static int64_t uncertain_mW(const side_t *side, motor_current_t i)
{
    const config_t *config = side->config;
    const motor_model_t *model = side->model;
    if (config->rotor.sensor != CONFIG_ROTOR_HALL) {
        return 0;
    }
    const int64_t w_abs_mrad_s = q_abs(bases_electrical_mrad_s(config, model->speed_mrad_s));
    const int64_t angle_urad = q_saturate64(w_abs_mrad_s * 500 / config->drive.pwm_frequency_Hz);
    const int64_t across_uW =
        (model->emf_mV + saliency_mV(model, i.d_mA)) * i.d_mA - saliency_mV(model, i.q_mA) * i.q_mA;
    const int64_t across_mW = q_saturate64(divide_by_thousand(across_uW) * 3 / 2);
    return divide_by_million((across_mW < 0 ? -across_mW : across_mW) * angle_urad);
}

static int64_t burden_of(const side_t *side, burden_t burden, int32_t torque_mNm)
{
    const motor_current_t i = current_setpoint_unlimited(
        side->config, side->model, torque_mNm * side->sign, side->i_d_weakening_mA);
    if (burden == BURDEN_CURRENT_SQUARE) {
        return (int64_t)i.d_mA * i.d_mA + (int64_t)i.q_mA * i.q_mA;
    }
    const int64_t power_mW = motor_model_power_mW(side->model, i);
    return burden == BURDEN_DRAWN_POWER ? power_mW : uncertain_mW(side, i) - power_mW;
}

/* Where between two torques, one within the limit and one beyond it, a line through both burdens
 * meets the limit. */
typedef struct {
    int32_t low_mNm, high_mNm;
    int64_t low, high;
} bracket_t;

static int32_t on_the_line(const bracket_t *b, int64_t limit)
{
    /* Both differences made to fit into 32 bits. */
    const int64_t scale = (b->high - b->low) / INT32_MAX + 1;
    const int32_t above = (int32_t)((b->high - b->low) / scale);
    return b->low_mNm +
           q_scale(b->high_mNm - b->low_mNm, (int32_t)((limit - b->low) / scale), above);
}

/*
 * The torque up to which a burden stays within its limit, NO_LIMIT_mNm if that is all the way up to
 * bound_mNm. For burdens that grow from from_mNm, where they are smallest, to the bound. A line
 * lies above a burden with growing slope, so the torque found is on the safe side; at a kink the
 * other way the next line mends what the last one missed.
 */
static int32_t torque_within(const side_t *side, burden_t burden, int64_t limit, int32_t from_mNm,
                             int32_t bound_mNm)
{
    bracket_t b = {.low_mNm = from_mNm,
                   .high_mNm = bound_mNm,
                   .low = 0,
                   .high = burden_of(side, burden, bound_mNm)};
    if (b.high <= limit) {
        return NO_LIMIT_mNm;
    }
    b.low = burden_of(side, burden, from_mNm);
    if (b.low >= limit) {
        return from_mNm;
    }
    for (int n = 0; n < HALVINGS + LINES; n++) {
        const int32_t torque_mNm =
            n < HALVINGS ? b.low_mNm + (b.high_mNm - b.low_mNm) / 2 : on_the_line(&b, limit);
        const int64_t here = burden_of(side, burden, torque_mNm);
        if (here <= limit) {
            b.low_mNm = torque_mNm;
            b.low = here;
        } else {
            b.high_mNm = torque_mNm;
            b.high = here;
        }
    }
    return on_the_line(&b, limit);
}

static int32_t power_torque_mNm(const config_t *config, const motor_model_t *model)
{
    const int32_t speed_abs_mrad_s = q_abs(model->speed_mrad_s);
    /* mW / (mrad/s) = N m */
    return speed_abs_mrad_s > 0 ? q_scale(config->motor.max_power_mW, 1000, speed_abs_mrad_s)
                                : NO_LIMIT_mNm;
}

/* The torque of this side up to which the voltage suffices; 0 where it does not even for nothing.
 */
static int32_t voltage_torque_mNm(const side_t *side)
{
    return side->sign > 0 ? side->by_voltage.highest_mNm : -side->by_voltage.lowest_mNm;
}

static void tighten_common(limit_t *limit, const side_t *side, const torque_limits_input_t *in)
{
    const config_motor_t *motor = &side->config->motor;
    limit_tighten(limit, power_torque_mNm(side->config, side->model), REASON_MAX_POWER);
    const int64_t most_mA = motor->max_phase_current_mA;
    limit_tighten(
        limit, torque_within(side, BURDEN_CURRENT_SQUARE, most_mA * most_mA, 0, limit->torque_mNm),
        REASON_PHASE_CURRENT);
    limit_tighten(limit, voltage_torque_mNm(side), REASON_VOLTAGE);
    limit_derate(limit,
                 limit_fade_q15(in->winding_temperature_cC, motor->derate_winding_temperature_cC,
                                motor->max_winding_temperature_cC),
                 REASON_WINDING_TEMPERATURE);
    limit_derate(limit,
                 limit_fade_q15(in->switch_temperature_cC,
                                side->config->drive.derate_switch_temperature_cC,
                                side->config->drive.max_switch_temperature_cC),
                 REASON_SWITCH_TEMPERATURE);
    if (!in->rotor_valid) {
        limit_tighten(limit, 0, REASON_ROTOR_UNCERTAIN);
    }
}

/* No limit is looked for beyond what the motor may give anyway. */
static int32_t search_bound_mNm(const config_t *config, const motor_model_t *model)
{
    return q_min(config->motor.max_torque_mNm, power_torque_mNm(config, model));
}

/* What the motor is asked for now, as a torque of this side. */
static int32_t asked_mNm(const side_t *side, const torque_limits_input_t *in)
{
    return q_max(q_clamp(in->command_mNm, -INT32_MAX, INT32_MAX) * side->sign, 0);
}

/* Power that this motor may draw or return at the present voltage, with the end of that range in
 * mind, and why no more. */
typedef struct {
    int32_t power_mW;
    reason_t reason;
} allowance_t;

/* burden: of the power that is limited. Where the bus has no voltage there is no current in its
 * power. */
static allowance_t allowance(const side_t *side, burden_t burden, const torque_limits_input_t *in,
                             int32_t most_mA, int32_t bms_mA, bool near, int32_t inside_mV)
{
    const config_battery_t *battery = &side->config->battery;
    const foldback_t foldback = {
        .most_mA = most_mA,
        .width_mV = battery->max_voltage_mV - battery->foldback_voltage_mV,
        .span_mV = battery->max_voltage_mV - battery->min_voltage_mV,
    };
    const int64_t now_mW = burden_of(side, burden, asked_mNm(side, in));
    const int32_t now_mA =
        in->bus_voltage_mV > 0 ? q_saturate64(now_mW * 1000 / in->bus_voltage_mV) : 0;
    const int32_t by_voltage_mA = foldback_current_mA(&foldback, near, inside_mV, now_mA);
    const int32_t by_bms_mA = own_share_mA(side->config, bms_mA, most_mA);
    const bool drawn = burden == BURDEN_DRAWN_POWER;
    const reason_t by_current = drawn ? REASON_DISCHARGE_CURRENT : REASON_CHARGE_CURRENT;
    const allowance_t out = {
        .power_mW = q_max(power_mW(q_min(by_voltage_mA, by_bms_mA), in->bus_voltage_mV), 0),
        .reason = by_voltage_mA < by_bms_mA
                      ? (drawn ? REASON_BUS_VOLTAGE_LOW : REASON_BUS_VOLTAGE_HIGH)
                      : by_current,
    };
    return out;
}

static allowance_t drawn_allowance(const side_t *side, const torque_limits_input_t *in)
{
    const config_battery_t *battery = &side->config->battery;
    const int64_t inside_mV = (int64_t)in->bus_voltage_mV - battery->min_voltage_mV;
    return allowance(side, BURDEN_DRAWN_POWER, in, battery->max_discharge_current_mA,
                     in->bms_discharge_current_mA, in->voltage_low, q_saturate64(inside_mV));
}

static allowance_t returned_allowance(const side_t *side, const torque_limits_input_t *in)
{
    const config_battery_t *battery = &side->config->battery;
    const int64_t inside_mV = (int64_t)battery->max_voltage_mV - in->bus_voltage_mV;
    return allowance(side, BURDEN_RETURNED_POWER, in, battery->max_charge_current_mA,
                     in->bms_charge_current_mA, in->voltage_high, q_saturate64(inside_mV));
}

static limit_t driving_limit(const side_t *side, const torque_limits_input_t *in)
{
    const config_t *config = side->config;
    limit_t limit = limit_init(config->motor.max_torque_mNm, REASON_MAX_TORQUE);
    const allowance_t drawn = drawn_allowance(side, in);
    limit_tighten(&limit,
                  torque_within(side, BURDEN_DRAWN_POWER, drawn.power_mW, 0,
                                search_bound_mNm(config, side->model)),
                  drawn.reason);
    const int32_t top_mrad_s = config->motor.max_speed_mrad_s;
    limit_derate(&limit,
                 limit_fade_q15(q_abs(side->model->speed_mrad_s),
                                top_mrad_s - top_mrad_s / SPEED_FADE_DIVISOR, top_mrad_s),
                 REASON_MAX_SPEED);
    tighten_common(&limit, side, in);
    return limit;
}

/* optimal_mNm: shaft torque that returns the most, up to which the returned power grows. */
static limit_t regenerating_limit(const side_t *side, const torque_limits_input_t *in,
                                  int32_t optimal_mNm)
{
    const config_t *config = side->config;
    limit_t limit = limit_init(config->motor.max_torque_mNm, REASON_MAX_TORQUE);
    const int32_t bound_mNm = search_bound_mNm(config, side->model);
    const int32_t best_mNm = q_clamp(optimal_mNm, 0, bound_mNm);
    const int32_t negligible_mW = config->motor.max_power_mW / NEGLIGIBLE_POWER_DIVISOR;
    /* Where even the best torque returns next to nothing the battery's limit has nothing to limit.
     * Without this, a full battery would forbid the torque that holds a vehicle which begins to
     * roll back on a slope. */
    if (burden_of(side, BURDEN_RETURNED_POWER, best_mNm) > negligible_mW) {
        const allowance_t returned = returned_allowance(side, in);
        limit_tighten(&limit,
                      torque_within(side, BURDEN_RETURNED_POWER, returned.power_mW, 0, best_mNm),
                      returned.reason);
    }
    /* Beyond the best torque less and less comes back, and in the end the battery pays for braking,
     * too. */
    const allowance_t drawn = drawn_allowance(side, in);
    limit_tighten(&limit,
                  torque_within(side, BURDEN_DRAWN_POWER, q_max(drawn.power_mW, negligible_mW),
                                best_mNm, bound_mNm),
                  drawn.reason);
    tighten_common(&limit, side, in);
    return limit;
}

torque_limits_t torque_limits_step(const config_t *config, const motor_model_t *model,
                                   const torque_limits_input_t *in)
{
    const int32_t forward = model->speed_mrad_s >= 0 ? 1 : -1;
    const feasible_torque_t by_voltage = feasible_torque_at(config, model, in->phase_voltage_mV);
    const side_t driving = {config, model, in->i_d_weakening_mA, forward, by_voltage};
    const side_t braking = {config, model, in->i_d_weakening_mA, -forward, by_voltage};
    const int32_t airgap_mNm =
        loss_maps_torque_mNm(config, model->speed_mrad_s, in->winding_temperature_cC);
    const int32_t optimal_mNm = airgap_mNm + q_abs(model->friction_mNm);
    torque_limits_t out = {
        .driving = driving_limit(&driving, in),
        .regenerating = regenerating_limit(&braking, in, optimal_mNm),
    };
    out.optimal = out.regenerating;
    limit_tighten(&out.optimal, optimal_mNm, REASON_LOSS_OPTIMUM);
    return out;
}
