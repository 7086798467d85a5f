/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/torque.h"

#include "core/q15.h"
#include "motor/motor_model.h"

void torque_init(torque_state_t *state, const config_t *config)
{
    motor_constants_init(&state->motor, config);
    demand_init(&state->demand);
    torque_limits_init(&state->limits, &state->table);
    brake_blending_init(&state->blending, config);
    hill_hold_init(&state->hold);
    torque_command_init(&state->command);
    stop_lamp_init(&state->lamp);
    available_ahead_init(&state->ahead);
}

/* Reason shown on CAN, shell and log: that of the table's tightest line, braking side while
 * braking, else driving side. Without one, that of lift-off braking, phase current, voltage, torque
 * rate, or of what withdraws the demand. */
static reason_t shown_reason(const demand_t *demand, const brake_blending_out_t *split,
                             const lift_off_t *lift_off, const torque_command_out_t *limited,
                             const current_setpoint_t *current, bool voltage_limited)
{
    reason_t reason =
        demand->brake_mNm > 0 && split->reason != REASON_NONE ? split->reason : limited->reason;
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
    const int32_t braking_mNm =
        q_saturate64((int64_t)split->hydraulic_mNm + lift_off->hydraulic_mNm);
    return q_min(q_max(braking_mNm, hold_mNm), config->brake.max_hydraulic_torque_mNm);
}

static demand_input_t demand_input(const torque_input_t *in)
{
    const demand_input_t out = {
        .drive_mNm = in->drive_torque_mNm,
        .brake_mNm = in->brake_torque_mNm,
        .age_ms = in->demand_age_ms,
        .direction = in->direction,
        .abs_active = in->abs_active,
        .standstill = in->standstill,
        .speed_mrad_s = in->speed_mrad_s,
        .reason = in->demand_reason,
    };
    return out;
}

/* True where speed and motor torque tell what the hydraulic brake makes: no wheel slips, no sensor
 * is wrong. */
static bool hydraulic_is_seen(const torque_limits_t *table, const torque_input_t *in)
{
    const reason_t reason = in->torque_enable.reason;
    const bool healthy = reason == REASON_NONE || reason == REASON_TORQUE_ENABLE ||
                         reason == REASON_HYDRAULIC_FEEDBACK ||
                         (reason >= REASON_HYDRAULIC_WEAK && reason <= REASON_HYDRAULIC_LATE);
    return in->rotor_valid && healthy &&
           table->braking[TORQUE_LINE_ABS].torque_mNm == FEASIBLE_UNBOUNDED;
}

/* Whose lines bound the demand of this step: of a driving demand against the rotation, by a wheel
 * that rolls back, those of braking. */
static side_t demanded_side(const demand_t *demand, int32_t speed_mrad_s)
{
    const bool brakes = demand->brake_mNm > 0 || demand->lift_off_mNm > 0;
    return brakes || torque_command_is_against(demand->drive_mNm, speed_mrad_s) ? SIDE_BRAKING
                                                                                : SIDE_DRIVING;
}

/* The inputs of each part have a function of their own, so that they share the stack. */
static void step_limits(torque_state_t *state, const feasible_set_t *set, const torque_input_t *in,
                        const demand_t *demand, motor_point_t flowing)
{
    const torque_limits_input_t limited_by = {
        .demanded = demanded_side(demand, in->speed_mrad_s),
        .brake_demand_mNm = demand->brake_mNm,
        .bus_voltage_mV = in->bus_voltage_mV,
        .battery_voltage_mV = in->battery_voltage_mV,
        .bus_current_mA = motor_model_bus_current_mA(set->model, flowing, in->bus_voltage_mV),
        .bms_charge_current_mA = in->bms_charge_current_mA,
        .bms_discharge_current_mA = in->bms_discharge_current_mA,
        .bms_charge_peak_mA = in->bms_charge_peak_mA,
        .switch_temperature_cC = in->switch_temperature_cC,
        .rotor_valid = in->rotor_valid,
        .abs_active = in->abs_active,
        .abs_share_percent = in->abs_share_percent,
        .torque_enable = in->torque_enable,
    };
    torque_limits_step(&state->limits, set, &limited_by, &state->table);
}

static brake_blending_out_t blend(torque_state_t *state, const config_t *config,
                                  const torque_input_t *in, const demand_t *demand,
                                  int32_t achieved_mNm)
{
    static const hydraulic_feedback_t NO_REPORT = {.age_ms = UINT32_MAX};
    const brake_blending_input_t braking = {
        .demand_mNm = demand->brake_mNm,
        .speed_mrad_s = in->speed_mrad_s,
        .motor_command_mNm = state->command.command_mNm,
        .motor_growth_mNm = torque_command_growth_mNm(config, in->voltage_use_q15),
        .motor_achieved_mNm = achieved_mNm,
        .short_mNm = in->short_mNm,
        .hydraulic = *(demand->hydraulic_valid ? &in->hydraulic : &NO_REPORT),
        .watched = hydraulic_is_seen(&state->table, in) && demand->hydraulic_valid,
        .acknowledged = in->acknowledged,
        .bridge_open = in->bridge_open,
        .handed_over = demand->handed_over,
        .torque_enable = in->torque_enable,
    };
    return brake_blending_step(&state->blending, config, &state->table, &braking);
}

torque_output_t torque_step(torque_state_t *state, const config_t *config, const torque_input_t *in)
{
    const motor_model_t model =
        motor_model_at(&state->motor, config, in->speed_mrad_s, in->winding_temperature_cC);
    const feasible_set_t set = feasible_set_at(&model, in->phase_voltage_mV);
    const motor_point_t flowing = motor_model_point(&model, in->current);
    /* What is lost of the flux is missing in the torque; the hydraulic brake makes up for it. */
    const int32_t modelled_mNm = motor_model_torque_mNm(&model, flowing);
    const int32_t lost_mNm =
        in->flux_missing_q15 > 0
            ? q_scale(modelled_mNm, q_min(in->flux_missing_q15, 1 << 14), 1 << 15)
            : 0;
    const int32_t achieved_mNm = modelled_mNm - lost_mNm;
    const demand_input_t demanded = demand_input(in);
    const demand_t demand = demand_step(&state->demand, config, &demanded);
    step_limits(state, &set, in, &demand, flowing);
    const brake_blending_out_t split = blend(state, config, in, &demand, achieved_mNm);
    const lift_off_t lift_off =
        lift_off_split(&state->table, demand.lift_off_mNm, split.electric_mNm);
    const torque_command_input_t wanted = {
        .torque_enable = in->torque_enable,
        .speed_mrad_s = in->speed_mrad_s,
        .voltage_use_q15 = in->voltage_use_q15,
        .drive_mNm = demand.drive_mNm,
        .electric_mNm = split.electric_mNm + lift_off.motor_mNm,
        .beside_mNm = q_saturate64((int64_t)split.beside_mNm + lift_off.motor_mNm),
        .arrived_mNm = split.arrived_mNm,
        .drive_withdrawn = demand.drive_withdrawn,
        .bridge_open = in->bridge_open,
    };
    const torque_command_out_t limited =
        torque_command_step(&state->command, config, &state->table, &wanted);
    current_setpoint_t current = loss_braking_setpoint(
        &set, &state->table.losses, limited.command_mNm,
        current_setpoint_step(&set, limited.command_mNm, in->i_d_weakening_mA));
    /* The bounds are those of the present voltage; the command follows at the torque rate. */
    current.feasible = current.feasible || limited.falling;

    const hill_hold_input_t standing = {
        .demand_mNm = demand.brake_mNm + demand.lift_off_mNm,
        .command_mNm = limited.command_mNm,
        .drive_mNm = demand.drive_mNm,
        .road_mNm = split.road_mNm,
        .speed_mrad_s = in->speed_mrad_s,
        .slower_mrad_s = split.slower_mrad_s,
        .engaged = demand.engaged,
        .standstill = in->standstill,
    };
    const int32_t hold_mNm = hill_hold_step(&state->hold, config, &standing);
    const int32_t hydraulic_mNm = hydraulic_command_mNm(config, &split, &lift_off, hold_mNm);
    /* On its own path the brake makes what was asked for, and has to let go of it afterwards. */
    const int32_t own_path_mNm = demand.hydraulic_valid ? 0 : state->demand.asked_mNm;
    brake_blending_sent(&state->blending, &split, q_max(hydraulic_mNm, own_path_mNm));

    const torque_output_t out = {
        .current = current,
        .command_mNm = limited.command_mNm,
        .estimate_mNm = achieved_mNm,
        .hydraulic_mNm = hydraulic_mNm,
        .hydraulic_reason = hold_mNm > demand.brake_mNm ? REASON_HILL_HOLD : split.hydraulic_reason,
        .hydraulic_valid = demand.hydraulic_valid,
        .available = split.available,
        .reason = shown_reason(&demand, &split, &lift_off, &limited, &current, in->voltage_limited),
        .engaged = demand.engaged,
        .stop_lamp = stop_lamp_step(&state->lamp, config, in->speed_mrad_s, demand.brake_mNm),
    };
    return out;
}

void torque_look_ahead(torque_state_t *state, const config_t *config, const torque_input_t *in)
{
    const available_ahead_input_t now = {
        .speed_mrad_s = in->speed_mrad_s,
        .phase_voltage_mV = in->phase_voltage_mV,
        .winding_temperature_cC = in->winding_temperature_cC,
        .switch_temperature_cC = in->switch_temperature_cC,
        .brake_demand_mNm = state->demand.brake_mNm,
    };
    available_ahead_step(&state->ahead, &state->motor, config, &state->table, &now);
}
