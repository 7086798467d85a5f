/* SPDX-License-Identifier: Apache-2.0 */
#include "exchange/joined.h"

#include <string.h>

/* Where a raw value lies in the array of its port. */
#define AT(name, raw, type, scale, lowest, highest, unit, text) IN_##raw,
#define OUT_AT(name, raw, type, scale, lowest, highest, unit, text) OUT_##raw,
enum { EXCHANGE_FAST_INPUTS(AT) };
enum { EXCHANGE_SLOW_INPUTS(AT) };
enum { EXCHANGE_FAST_OUTPUTS(OUT_AT) };
enum { EXCHANGE_SLOW_OUTPUTS(OUT_AT) };

void joined_init(joined_t *joined, const config_t *config)
{
    memset(joined, 0, sizeof(*joined)); /* padding too: the whole value is read when it is saved */
    joined->config = *config;
    controller_init(&joined->controller, &joined->config);
    joined->to_fast = controller_initial_setpoint(&joined->config);
}

void joined_fast(joined_t *joined, const int32_t *in, int32_t *out)
{
    const fast_input_t sampled = {
        .phase_current_code = {(uint16_t)in[IN_phase_current_code_a],
                               (uint16_t)in[IN_phase_current_code_b],
                               (uint16_t)in[IN_phase_current_code_c]},
        .bus_voltage_code = (uint16_t)in[IN_bus_voltage_code],
        .rotor_angle_turn = (uint16_t)in[IN_rotor_angle_turn],
        .encoder = {.count = (uint16_t)in[IN_encoder_count],
                    .index_count = (uint16_t)in[IN_encoder_index_count],
                    .index = in[IN_encoder_index] != 0},
        .hall_state = (uint8_t)in[IN_hall_state],
        .power_stage_fault = in[IN_power_stage_fault] != 0,
    };
    const fast_output_t done =
        controller_fast_step(&joined->controller.fast, &joined->config, &joined->to_fast, &sampled);
    out[OUT_compare_counts_a] = done.compare_counts[0];
    out[OUT_compare_counts_b] = done.compare_counts[1];
    out[OUT_compare_counts_c] = done.compare_counts[2];
    out[OUT_bridge] = (int32_t)done.bridge;
}

#define GIVE(name, raw, type, scale, lowest, highest, unit, text)                                  \
    out[OUT_##raw] = (int32_t)done.raw;

void joined_slow(joined_t *joined, const int32_t *in, int32_t *out)
{
    const slow_input_t world = {
        .demand.drive_torque_mNm = in[IN_drive_torque_mNm],
        .demand.brake_torque_mNm = in[IN_brake_torque_mNm],
        .demand_age_ms = (uint32_t)in[IN_demand_age_ms],
        .bms.charge_current_mA = in[IN_bms_charge_current_mA],
        .bms.discharge_current_mA = in[IN_bms_discharge_current_mA],
        .temperature.winding_cC = in[IN_winding_temperature_cC],
        .temperature.switch_cC = in[IN_switch_temperature_cC],
        .demand.enable = in[IN_enable] != 0,
        .demand.abs_active = in[IN_abs_active] != 0,
        .demand.fault_reset = in[IN_fault_reset] != 0,
        .selftest_passed = in[IN_selftest_passed] != 0,
        .config_accepted = in[IN_config_accepted] != 0,
    };
    fast_report_t report;
    controller_fast_report(&joined->controller.fast, &report);
    const slow_output_t done = controller_slow_step(&joined->controller.slow, &joined->config,
                                                    &report, &world, &joined->to_fast);
    EXCHANGE_SLOW_OUTPUTS(GIVE)
}
