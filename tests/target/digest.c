/* SPDX-License-Identifier: Apache-2.0 */
#include "digest.h"

static uint32_t rotated(uint32_t x, unsigned left)
{
    return (x << left) | (x >> (32U - left));
}

/* MurmurHash3 (Appleby, 32 bits): for a given state another word gives another state. */
static void add_unsigned(digest_t *digest, uint32_t value)
{
    const uint32_t mixed = rotated(value * 0xCC9E2D51U, 15) * 0x1B873593U;
    digest->state = rotated(digest->state ^ mixed, 13) * 5U + 0xE6546B64U;
    digest->words++;
}

static void add(digest_t *digest, int32_t value)
{
    add_unsigned(digest, (uint32_t)value);
}

static void add_flag(digest_t *digest, bool is_set)
{
    add(digest, is_set ? 1 : 0);
}

static void add_pair(digest_t *digest, q_pair_t x)
{
    add(digest, q_pair_x(x));
    add(digest, q_pair_y(x));
}

static void add_dq(digest_t *digest, dq_t x)
{
    add(digest, x.d);
    add(digest, x.q);
}

void digest_begin(digest_t *digest)
{
    digest->state = 0;
    digest->words = 0;
}

static void add_period(digest_t *digest, const foc_period_t *period)
{
    const rotor_out_t *rotor = &period->rotor;
    add(digest, rotor->theta_turn);
    add_dq(digest, dq_of(period->i_reference_pu));
    add(digest, period->voltage.unsaturated_d_q25 >> 10);
    add(digest, period->voltage.unsaturated_q_q25 >> 10);
    add(digest, period->v_dc_pu);
}

static void add_report(digest_t *digest, const fast_report_t *report)
{
    add(digest, report->sequence);
    add_unsigned(digest, report->sums.i_d_pu);
    add_unsigned(digest, report->sums.i_q_pu);
    add_unsigned(digest, report->sums.power_pu);
    add_unsigned(digest, report->sums.v_dc_pu);
    add_dq(digest, dq_of(report->i_pu));
    add_dq(digest, dq_of(report->u_pu));
    add(digest, report->voltage_use_q15);
    add_flag(digest, report->voltage_limited);
    add_flag(digest, report->adc_saturated);
    add(digest, report->current_sum_pu);
    add(digest, report->wrong_current_sensor);
    add_flag(digest, report->current_undetermined);
    add(digest, report->i_d_weakening_pu);
    for (int x = 0; x < SENSE_PHASES; x++) {
        add(digest, report->offset_q4[x]);
    }
    add_flag(digest, report->offsets_done);
    add(digest, report->speed_q32);
    add_flag(digest, report->sensor_valid);
    add(digest, report->observer.speed_q32);
    add(digest, report->observer.theta_turn);
    add_dq(digest, dq_of(report->observer.flux_q14));
    add(digest, report->observer.sensor_turn);
    add_flag(digest, report->observer.acquired);
    add(digest, report->rotor_faults);
    add(digest, report->quadrant_transitions);
    add(digest, report->quadrant_step);
    add_unsigned(digest, report->idle_alpha_pu);
    add_unsigned(digest, report->idle_beta_pu);
    add(digest, (int32_t)report->trip);
    add(digest, (int32_t)report->bridge);
}

void digest_fast(digest_t *digest, const fast_output_t *out, const controller_fast_t *fast)
{
    fast_report_t report;
    controller_fast_report(fast, &report);
    for (int x = 0; x < 3; x++) {
        add(digest, out->compare_counts[x]);
    }
    add(digest, (int32_t)out->bridge);
    add_period(digest, foc_latest(&fast->foc));
    add_report(digest, &report);
}

static void add_gains(digest_t *digest, const pi_gains_t *gains)
{
    add(digest, gains->proportional_q10);
    add(digest, gains->integral_q15);
    add(digest, gains->anti_windup_q15);
}

static void add_setpoint(digest_t *digest, const fast_setpoint_t *setpoint)
{
    const current_tuning_t *tuning = &setpoint->tuning;
    add(digest, setpoint->sequence);
    add_dq(digest, setpoint->i_reference_pu);
    add(digest, setpoint->i_d_sampling_correction_pu);
    add_gains(digest, &tuning->d);
    add_gains(digest, &tuning->q);
    add(digest, tuning->w_l_d_q10);
    add(digest, tuning->w_l_q_q10);
    add(digest, tuning->forward_d_q25);
    add(digest, tuning->forward_q_q25);
    add_pair(digest, tuning->advance.v);
    add(digest, setpoint->dead_time_slope.alpha_q8);
    add(digest, setpoint->dead_time_slope.beta_q8);
    add_pair(digest, setpoint->observer.volt);
    add_pair(digest, setpoint->observer.minus_resistance);
    add_pair(digest, setpoint->observer.minus_leak);
    add_pair(digest, setpoint->observer.minus_inductance);
    add(digest, setpoint->observer.lead_turn);
    add_flag(digest, setpoint->observer.used);
    add_flag(digest, setpoint->calibrate_offsets);
    add_flag(digest, setpoint->torque_enabled);
    add_flag(digest, setpoint->clear_trip);
    add_flag(digest, setpoint->release_break);
    add(digest, (int32_t)setpoint->safe_bridge);
    add_unsigned(digest, setpoint->least_square);
}

void digest_slow(digest_t *digest, const slow_output_t *out, const fast_setpoint_t *setpoint)
{
    add(digest, out->motor_torque_command_mNm);
    add(digest, out->motor_torque_estimate_mNm);
    add(digest, out->motor_torque_uncertainty_mNm);
    add(digest, out->hydraulic_torque_mNm);
    add(digest, out->electric_brake_available_mNm);
    add(digest, out->electric_brake_ahead_mNm);
    add(digest, out->drive_available_mNm);
    add(digest, out->drive_ahead_mNm);
    add(digest, out->speed_mrad_s);
    add(digest, out->i_d_mA);
    add(digest, out->i_q_mA);
    add(digest, out->bus_voltage_mV);
    add(digest, out->bus_current_mA);
    add(digest, (int32_t)out->torque_reason);
    add(digest, (int32_t)out->available_reason);
    add(digest, (int32_t)out->ahead_reason);
    add(digest, (int32_t)out->drive_available_reason);
    add(digest, (int32_t)out->drive_ahead_reason);
    add(digest, (int32_t)out->waits_for);
    add(digest, (int32_t)out->hydraulic_reason);
    add(digest, (int32_t)out->fault_reason);
    add(digest, (int32_t)out->warning_reason);
    add(digest, (int32_t)out->mode);
    add(digest, (int32_t)out->direction);
    add_flag(digest, out->hydraulic_valid);
    add_flag(digest, out->stop_lamp);
    add_flag(digest, out->standstill);
    add_setpoint(digest, setpoint);
}

uint32_t digest_end(const digest_t *digest)
{
    uint32_t x = digest->state ^ digest->words;
    x = (x ^ (x >> 16)) * 0x85EBCA6BU;
    x = (x ^ (x >> 13)) * 0xC2B2AE35U;
    return x ^ (x >> 16);
}
