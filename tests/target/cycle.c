/* SPDX-License-Identifier: Apache-2.0 */
#include "cycle.h"

enum { SLOW_STEP = 0x80 };
enum { INDEX = 1, POWER_STAGE_FAULT = 2 };
enum { ENABLE = 1, ABS_ACTIVE = 2, FAULT_RESET = 4, SELFTEST_PASSED = 8, CONFIG_ACCEPTED = 16 };

static unsigned flag(bool is_set, unsigned bit)
{
    return is_set ? bit : 0U;
}

cycle_fast_t cycle_of_fast(const fast_input_t *in)
{
    const cycle_fast_t out = {
        .phase_current_code = {in->phase_current_code[0], in->phase_current_code[1],
                               in->phase_current_code[2]},
        .bus_voltage_code = in->bus_voltage_code,
        .rotor_angle_turn = in->rotor_angle_turn,
        .encoder_count = in->encoder.count,
        .encoder_index_count = in->encoder.index_count,
        .hall_state = in->hall_state,
        .flags = (uint8_t)(flag(in->encoder.index, INDEX) |
                           flag(in->power_stage_fault, POWER_STAGE_FAULT)),
    };
    return out;
}

fast_input_t cycle_fast_input(const cycle_fast_t *kept)
{
    const fast_input_t out = {
        .phase_current_code = {kept->phase_current_code[0], kept->phase_current_code[1],
                               kept->phase_current_code[2]},
        .bus_voltage_code = kept->bus_voltage_code,
        .rotor_angle_turn = kept->rotor_angle_turn,
        .encoder = {.count = kept->encoder_count,
                    .index_count = kept->encoder_index_count,
                    .index = (kept->flags & INDEX) != 0},
        .hall_state = kept->hall_state,
        .power_stage_fault = (kept->flags & POWER_STAGE_FAULT) != 0,
    };
    return out;
}

cycle_slow_t cycle_of_slow(const slow_input_t *in)
{
    const cycle_slow_t out = {
        .drive_torque_mNm = in->demand.drive_torque_mNm,
        .brake_torque_mNm = in->demand.brake_torque_mNm,
        .demand_age_ms = in->demand_age_ms,
        .flags = (uint8_t)(SLOW_STEP | flag(in->demand.enable, ENABLE) |
                           flag(in->demand.abs_active, ABS_ACTIVE) |
                           flag(in->demand.fault_reset, FAULT_RESET) |
                           flag(in->selftest_passed, SELFTEST_PASSED) |
                           flag(in->config_accepted, CONFIG_ACCEPTED)),
        .bms_charge_current_mA = in->bms.charge_current_mA,
        .bms_discharge_current_mA = in->bms.discharge_current_mA,
        .winding_temperature_cC = in->temperature.winding_cC,
        .switch_temperature_cC = in->temperature.switch_cC,
    };
    return out;
}

bool cycle_is_slow(const cycle_fast_t *unit)
{
    return (unit->flags & SLOW_STEP) != 0;
}

slow_input_t cycle_slow_input(const cycle_slow_t *kept)
{
    const slow_input_t out = {
        .demand.drive_torque_mNm = kept->drive_torque_mNm,
        .demand.brake_torque_mNm = kept->brake_torque_mNm,
        .demand_age_ms = kept->demand_age_ms,
        .bms.charge_current_mA = kept->bms_charge_current_mA,
        .bms.discharge_current_mA = kept->bms_discharge_current_mA,
        .temperature.winding_cC = kept->winding_temperature_cC,
        .temperature.switch_cC = kept->switch_temperature_cC,
        .demand.direction = DRIVE_DIRECTION_FORWARD,
        .demand.enable = (kept->flags & ENABLE) != 0,
        .demand.abs_active = (kept->flags & ABS_ACTIVE) != 0,
        .demand.fault_reset = (kept->flags & FAULT_RESET) != 0,
        .selftest_passed = (kept->flags & SELFTEST_PASSED) != 0,
        .config_accepted = (kept->flags & CONFIG_ACCEPTED) != 0,
    };
    return out;
}
