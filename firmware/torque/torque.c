/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/torque.h"

#include "core/q15.h"
#include "core/scaled.h"
#include "core/sqrt3.h"
#include "motor/flux_map.h"
#include "motor/motor_model.h"
#include "motor/torque_uncertainty.h"
#include "torque/closing_voltage.h"

enum {
    MOST_DRAG_mNm = 100000000, /* as a demand is bounded */
    MOST_CURRENT_mA = 10000000
};

void torque_init(torque_state_t *state, const config_t *config)
{
    motor_constants_init(&state->motor, config);
    demand_init(&state->demand);
    charge_trim_init(&state->trim, config);
    torque_limits_init(&state->limits, &state->table);
    brake_blending_init(&state->blending, config);
    road_init(&state->road, config);
    hill_hold_init(&state->hold);
    torque_command_init(&state->command);
    stop_lamp_init(&state->lamp);
    available_ahead_init(&state->ahead);
    const motor_current_t none = {.d_mA = 0, .q_mA = 0};
    state->setpoint = none;
    state->uncertainty_mNm = 0;
}

hill_hold_kept_t torque_hold(const torque_state_t *state)
{
    return hill_hold_keep(&state->hold, state->demand.engaged);
}

void torque_start_hold(torque_state_t *state, hill_hold_kept_t kept)
{
    state->demand.engaged = kept.direction;
    hill_hold_resume(&state->hold, &kept);
}

/* Reason shown on CAN, shell and log: that of the table's tightest line, braking side while
 * braking, else driving side. Without one, that of lift-off braking, phase current, voltage, torque
 * rate, or of what withdraws the demand. */
static reason_t shown_reason(const demand_t *demand, const brake_blending_out_t *split,
                             const lift_off_t *lift_off, const torque_command_out_t *limited,
                             const current_setpoint_t *current, bool voltage_limited)
{
    reason_t reason = demand->brake_torque_mNm > 0 && split->reason != REASON_NONE
                          ? split->reason
                          : limited->reason;
    if (current->limited && (reason == REASON_NONE || reason == REASON_TORQUE_RATE)) {
        return REASON_PHASE_CURRENT;
    }
    reason = reason == REASON_NONE ? lift_off->reason : reason;
    if (reason == REASON_NONE && voltage_limited) {
        return REASON_VOLTAGE;
    }
    return reason == REASON_NONE ? demand->reason : reason;
}

/* Of braking, of lift-off below the blend-out speed, and of the hold, which the other two count
 * for. */
static int32_t hydraulic_command_mNm(const config_t *config, const brake_blending_out_t *split,
                                     const lift_off_t *lift_off, int32_t hold_mNm)
{
    const int32_t braking_mNm = q_add(split->hydraulic_mNm, lift_off->hydraulic_mNm);
    return q_min(q_max(braking_mNm, hold_mNm), config->brake.max_hydraulic_torque_mNm);
}

/* Before standstill the hold brakes the wheel as its driver asks. One that stands is held beside
 * the demand: should it roll, the motor does not count on the brake that has failed. */
static int32_t hydraulic_apart_mNm(const torque_state_t *state, const brake_blending_out_t *split,
                                   const lift_off_t *lift_off, int32_t added_mNm,
                                   int32_t own_path_mNm)
{
    const int32_t apart_mNm = q_max(own_path_mNm - split->hydraulic_mNm, lift_off->hydraulic_mNm);
    return state->hold.holds ? added_mNm : q_min(q_max(apart_mNm, 0), added_mNm);
}

/* True where speed and torques show the road: no wheel slips, no sensor is wrong. */
static bool road_is_seen(const torque_limits_t *table, const measured_t *now,
                         const torque_enable_t *enable)
{
    const reason_t reason = enable->reason;
    const bool healthy = reason == REASON_NONE || reason == REASON_TORQUE_ENABLE ||
                         reason == REASON_HYDRAULIC_FEEDBACK ||
                         (reason >= REASON_HYDRAULIC_WEAK && reason <= REASON_HYDRAULIC_LATE);
    return now->angle_valid && healthy &&
           table->braking[TORQUE_LINE_ABS].torque_mNm == FEASIBLE_UNBOUNDED;
}

/* What the wheel brakes with at zero current, iron loss and bearings, where a bridge without a
 * demand opens. Elsewhere PWM holds it at zero torque. */
static int32_t coasting_mNm(const motor_model_t *model, const monitored_t *watch,
                            int32_t phase_voltage_mV)
{
    const safe_state_t *safe = &watch->safe;
    const bool opens = model->config->modes.coast_delay_ms > 0 && safe->bridge == BRIDGE_OFF &&
                       safe->torque_mNm == 0 && safe->emf_mV < phase_voltage_mV;
    if (!opens) {
        return 0;
    }
    const motor_point_t open = {.d_b = 0, .x_b = motor_model_x_of_i_q_b(model, 0, 0)};
    const int32_t drag_b = model->friction_b - motor_model_airgap_b(model, open);
    return q_clamp(scaled_shift(drag_b, -model->constants->torque_shift), 0, MOST_DRAG_mNm);
}

/* What the motor adds to its part of a small demand: with D demanded and the coasting torque C both
 * brakes make max(D, C + D/2). Zero current keeps every deferrable line; what is more than that
 * stays within all of them. */
static int32_t beside_coasting_mNm(const demand_t *demand, const brake_blending_out_t *split,
                                   int32_t electric_mNm, int32_t coasting_mNm)
{
    const int32_t demanded_mNm = q_add(demand->brake_torque_mNm, demand->lift_off_mNm);
    const int32_t added_mNm = q_max(coasting_mNm - demanded_mNm / 2, 0);
    const int32_t most_mNm =
        q_min(q_max(coasting_mNm, split->available.torque_mNm), split->hard_mNm);
    const bool lifts_off = demand->lift_off_mNm > 0;
    const int32_t wanted_mNm = q_max(electric_mNm + added_mNm, lifts_off ? coasting_mNm : 0);
    return q_max(q_min(wanted_mNm, most_mNm), electric_mNm) - electric_mNm;
}

/* Of both brakes; after braking, of what coasting does until the bridge opens. */
static torque_command_out_t motor_command(torque_state_t *state, const config_t *config,
                                          const measured_t *now, const last_t *last,
                                          const torque_enable_t *enable, const demand_t *demand,
                                          const motor_now_t *motor,
                                          const brake_blending_out_t *split, int32_t lift_off_mNm)
{
    const int32_t electric_mNm = split->electric_mNm + lift_off_mNm;
    const bool braked = torque_command_is_against(last->torque_command_mNm, now->speed_mrad_s) &&
                        demand->drive_torque_mNm == 0 && state->demand.lost_ms == 0 &&
                        !motor->bridge_open;
    const bool brakes = demand->brake_torque_mNm > 0 || demand->lift_off_mNm > 0 || braked;
    const int32_t added_mNm =
        brakes && demand->hydraulic_valid
            ? beside_coasting_mNm(demand, split, electric_mNm, motor->coasting_mNm)
            : 0;
    const motor_braking_t braking = {
        .electric_mNm = electric_mNm + added_mNm,
        .uncovered_mNm = q_add(q_add(split->uncovered_mNm, lift_off_mNm), added_mNm),
        .rise_mNm = split->rise_mNm,
    };
    return torque_command_step(&state->command, config, &state->table, now,
                               last->torque_command_mNm, enable, demand, &braking,
                               motor->bridge_open);
}

/* What a vehicle without another brake keeps of a lost demand. */
static int32_t kept_mNm(const torque_state_t *state, const config_t *config, const demand_t *demand)
{
    const bool kept = config->driver.no_other_brake != 0 && state->demand.lost_ms > 0;
    return kept ? q_add(demand->brake_torque_mNm, demand->lift_off_mNm) : 0;
}

/* Into the bus, the diodes' voltage against the current. Diodes that conduct in pulses, just above
 * the EMF limit, carry less than the model of the open bridge has. */
static int32_t charging_mA(const measured_t *now, const monitored_t *watch)
{
    const int64_t d_mA = q_limit(now->i_d_mA, MOST_CURRENT_mA);
    const int64_t q_mA = q_limit(now->i_q_mA, MOST_CURRENT_mA);
    const int32_t measured_mA = q_scale(scaled_root(d_mA * d_mA + q_mA * q_mA), SQRT3_2_Q15, 32768);
    return q_min(measured_mA, safe_state_charging_mA(&watch->safe));
}

/* That PWM has, or would have if it took over from diodes that charge the battery. */
static int32_t phase_voltage_mV(const config_t *config, const measured_t *now,
                                const monitored_t *watch, const torque_enable_t *enable)
{
    const bool takes_over = !measured_switching(now) && safe_state_charging_mA(&watch->safe) > 0 &&
                            torque_enable_any(*enable);
    return takes_over ? closing_voltage_mV(config, now->phase_voltage_mV, now->bus_voltage_mV,
                                           charging_mA(now, watch))
                      : now->phase_voltage_mV;
}

/* Share of the current that flows unseen, where the hydraulic brake makes what the motor is not
 * commanded for it: the alarm may be false. */
static int32_t missing_q15(const config_t *config, const monitored_t *watch)
{
    const bool filled =
        config->driver.no_other_brake == 0 && config->brake.max_hydraulic_torque_mNm > 0;
    return filled ? watch->current_missing_q15 : 0;
}

/* The driving torque is made by a current that is larger than it looks. */
static demand_t seen_demand(demand_t demand, int32_t current_missing_q15)
{
    const int32_t less_mNm = q15_product(demand.drive_torque_mNm, current_missing_q15);
    demand.drive_torque_mNm -= less_mNm;
    demand.reason =
        less_mNm != 0 && demand.reason == REASON_NONE ? REASON_CURRENT_GAIN : demand.reason;
    return demand;
}

/* The inputs of the table have a function of their own, so that they share the stack. */
static void step_limits(torque_state_t *state, motor_model_t *model, feasible_set_t *set,
                        const measured_t *now, const torque_enable_t *enable,
                        const demand_t *demand, motor_point_t flowing, int32_t current_missing_q15,
                        const findings_t *findings)
{
    const bool contradicts = findings_present(findings, FINDING_BUS_CONTRADICTED) ||
                             findings_present(findings, FINDING_FLUX_HIGH);
    const torque_limits_input_t limited_by = {
        .brake_torque_mNm = demand->brake_torque_mNm,
        /* Behind an open contactor it limits what is zero already. */
        .battery_voltage_mV = contradicts ? now->battery->voltage_mV : 0,
        .charge_beyond_mA = charge_trim_step(&state->trim, model, now, flowing),
        .current_missing_q15 = current_missing_q15,
    };
    torque_limits_step(&state->limits, model, set, now, enable, &limited_by, &state->table);
}

/* What is lost of the flux is missing in the torque; the hydraulic brake makes up for it. */
static motor_now_t motor_now(const config_t *config, const measured_t *now,
                             const monitored_t *watch, int32_t modelled_mNm, int32_t coasting_mNm)
{
    const int32_t lost_q15 = watch->flux_missing_q15;
    const int32_t lost_mNm =
        lost_q15 > 0 ? q_scale(modelled_mNm, q_min(lost_q15, 1 << 14), 1 << 15) : 0;
    const bool shorted = bridge_is_short(now->report->bridge) && now->angle_valid;
    const motor_now_t out = {
        .achieved_mNm = modelled_mNm - lost_mNm,
        .short_mNm = shorted ? watch->safe.torque_mNm : 0,
        .coasting_mNm = coasting_mNm,
        .growth_mNm = torque_command_growth_mNm(config, now->report->voltage_use_q15),
        .missing_q15 = missing_q15(config, watch),
        /* Without any angle there is no torque that could ramp out. */
        .bridge_open =
            !measured_switching(now) || (now->sensor_wrong && now->angle_by == ANGLE_BY_SENSOR),
    };
    return out;
}

static brake_blending_out_t blend(torque_state_t *state, const config_t *config,
                                  const measured_t *now, const last_t *last, const slow_input_t *in,
                                  const torque_enable_t *enable, const demand_t *demand,
                                  const motor_now_t *motor)
{
    static const hydraulic_feedback_t NO_REPORT = {.age_ms = UINT32_MAX};
    return brake_blending_step(&state->blending, config, &state->table, now, last,
                               demand->hydraulic_valid ? &in->hydraulic : &NO_REPORT, enable,
                               demand, motor);
}

/* A lost demand leaves a held vehicle with no less than it had: its driver may have pressed the
 * pedal harder. */
static int32_t hold_command_mNm(torque_state_t *state, const config_t *config,
                                const measured_t *now, const monitored_t *watch,
                                const torque_enable_t *enable, const demand_t *demand,
                                const brake_blending_out_t *split, int32_t road_mNm,
                                int32_t command_mNm)
{
    /* An encoder counts before its index has shown the angle. */
    const bool counts = q_abs(now->sensor_mrad_s) > q_abs(now->speed_mrad_s);
    const hill_hold_wheel_t wheel = {
        .speed_mrad_s = counts ? now->sensor_mrad_s : now->speed_mrad_s,
        /* A wheel that turns while the controller starts has shown it by then. */
        .standstill = watch->standstill && now->report->offsets_done,
        .road_mNm = road_mNm,
        .command_mNm = command_mNm,
        .seen = now->angle_valid,
        .may_drive = enable->drive_q15 > 0 && state->demand.lost_ms == 0,
    };
    const int32_t hold_mNm = hill_hold_step(&state->hold, config, demand, split, &wheel);
    const bool alone = state->demand.lost_ms > 0 && hill_hold_works(&state->hold);
    return alone ? q_max(hold_mNm, state->demand.received_brake_torque_mNm) : hold_mNm;
}

/* i_q along the rotation. */
static motor_current_t along_rotation(motor_current_t i, int32_t speed_mrad_s)
{
    const motor_current_t out = {.d_mA = i.d_mA,
                                 .q_mA = speed_mrad_s >= 0 ? i.q_mA : -q_max(i.q_mA, -INT32_MAX)};
    return out;
}

/* What is to flow: the fast loop's field weakening is part of it. */
static motor_current_t setpoint_current(const config_t *config, const measured_t *now,
                                        const current_setpoint_t *current)
{
    const int32_t most_mA = config->motor.max_phase_current_mA;
    const int32_t weakening_mA = q_clamp(now->i_d_weakening_mA, -most_mA, 0);
    const motor_current_t flows = {.d_mA = current->i_d_mA + weakening_mA, .q_mA = current->i_q_mA};
    return along_rotation(flows, now->speed_mrad_s);
}

/* Of the torque at the currents that flow; its limits are those of the sensor's angle. Once a round
 * of available_ahead: it is sent every 100 ms. */
static int32_t uncertainty_mNm(torque_state_t *state, const motor_model_t *model,
                               const measured_t *now, motor_point_t flowing)
{
    if (state->ahead.step == 0) {
        state->uncertainty_mNm = torque_uncertainty_mNm(model, flowing);
    }
    const bool known = now->angle_valid && now->angle_by == ANGLE_BY_SENSOR && !now->sensor_wrong;
    return known ? q_max(state->uncertainty_mNm, 0) : INT32_MAX;
}

torque_output_t torque_step(torque_state_t *state, const config_t *config, const measured_t *now,
                            const last_t *last, const slow_input_t *in, const monitored_t *watch,
                            const torque_enable_t *enable, findings_t *findings)
{
    const int32_t voltage_mV = phase_voltage_mV(config, now, watch, enable);
    const motor_current_t mean = {.d_mA = now->i_d_mA, .q_mA = now->i_q_mA};
    motor_model_t model =
        motor_model_around(&state->motor, config, now->speed_mrad_s, now->winding_temperature_cC,
                           along_rotation(mean, now->speed_mrad_s));
    feasible_set_t set = feasible_set_at(&model, voltage_mV);
    const motor_point_t flowing = motor_model_point(&model, mean);
    const motor_now_t motor = motor_now(config, now, watch, motor_model_torque_mNm(&model, flowing),
                                        coasting_mNm(&model, watch, voltage_mV));
    const int32_t uncertain_mNm = uncertainty_mNm(state, &model, now, flowing);
    const demand_t demand =
        seen_demand(demand_step(&state->demand, config, in, now->speed_mrad_s), motor.missing_q15);
    step_limits(state, &model, &set, now, enable, &demand, flowing, motor.missing_q15, findings);
    const brake_blending_out_t split = blend(state, config, now, last, in, enable, &demand, &motor);
    const reason_t found = brake_blending_report(&state->blending, findings);
    const lift_off_t lift_off =
        lift_off_split(&state->table, demand.lift_off_mNm, split.electric_mNm, motor.coasting_mNm);
    const torque_command_out_t limited = motor_command(state, config, now, last, enable, &demand,
                                                       &motor, &split, lift_off.motor_mNm);
    feasible_set_around(&set, &model, state->setpoint);
    current_setpoint_t current = loss_braking_setpoint(
        &set, &state->table.losses, limited.command_mNm,
        current_setpoint_step(&set, limited.command_mNm, now->i_d_weakening_mA));
    if (flux_map_present(config)) {
        state->setpoint = setpoint_current(config, now, &current);
    }
    /* The bounds are those of the present voltage; the command follows at the torque rate. */
    current.feasible = current.feasible || limited.falling;

    charge_trim_commanded(&state->trim, &model, current,
                          torque_command_is_against(limited.command_mNm, now->speed_mrad_s),
                          now->bus_voltage_mV);

    const bool seen = road_is_seen(&state->table, now, enable) && demand.hydraulic_valid;
    const int32_t road_mNm = road_step(&state->road, config, now->speed_mrad_s, motor.achieved_mNm,
                                       split.made_mNm, seen);
    const int32_t hold_mNm = hold_command_mNm(state, config, now, watch, enable, &demand, &split,
                                              road_mNm, limited.command_mNm);
    findings_set(findings, FINDING_HOLD_FAILS, hill_hold_fails(&state->hold));
    const bool hydraulic_valid = demand.hydraulic_valid || hill_hold_works(&state->hold);
    const int32_t hydraulic_mNm = hydraulic_command_mNm(config, &split, &lift_off, hold_mNm);
    /* On its own path the brake makes what was asked for, and has to let go of it afterwards. */
    const int32_t own_path_mNm = hydraulic_valid ? 0 : state->demand.received_brake_torque_mNm;
    const int32_t added_mNm = q_max(q_max(hydraulic_mNm, own_path_mNm) - split.hydraulic_mNm, 0);
    available_ahead_step(&state->ahead, &state->motor, config, &state->table, now, voltage_mV,
                         state->demand.brake_torque_mNm);

    const bool holds = hold_mNm > demand.brake_torque_mNm;
    const torque_output_t out = {
        .current = current,
        .command_mNm = limited.command_mNm,
        .coasting_mNm = motor.coasting_mNm,
        .estimate_mNm = motor.achieved_mNm,
        .uncertainty_mNm = uncertain_mNm,
        .hydraulic_mNm = hydraulic_mNm,
        .hydraulic_added_mNm = added_mNm,
        .hydraulic_apart_mNm =
            hydraulic_apart_mNm(state, &split, &lift_off, added_mNm, own_path_mNm),
        .phase_voltage_mV = voltage_mV,
        .kept_mNm = kept_mNm(state, config, &demand),
        .hydraulic_reason = holds                  ? REASON_HILL_HOLD
                            : found != REASON_NONE ? found
                                                   : split.hydraulic_reason,
        .hydraulic_valid = hydraulic_valid,
        .available = split.available,
        .available_now = state->ahead.now,
        .available_ahead = state->ahead.ahead,
        .reason = shown_reason(&demand, &split, &lift_off, &limited, &current,
                               now->report->voltage_limited),
        .engaged = demand.engaged,
        .stop_lamp =
            stop_lamp_step(&state->lamp, config, now->speed_mrad_s, demand.brake_torque_mNm),
    };
    return out;
}

const torque_limits_t *torque_limits_of(const torque_state_t *state)
{
    return &state->table;
}
