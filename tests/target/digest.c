/* SPDX-License-Identifier: Apache-2.0 */
#include "digest.h"

static void add(digest_t *digest, int32_t value)
{
    static const uint32_t TABLE[16] = {/* of four bits: the polynomial 0xEDB88320 */
                                       0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC,
                                       0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
                                       0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C,
                                       0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C};
    uint32_t crc = digest->crc ^ (uint32_t)value;
    for (int nibble = 0; nibble < 8; nibble++) {
        crc = (crc >> 4) ^ TABLE[crc & 15U];
    }
    digest->crc = crc;
}

void digest_begin(digest_t *digest)
{
    digest->crc = 0xFFFFFFFFU;
}

void digest_fast(digest_t *digest, const fast_output_t *out, const fast_report_t *report)
{
    for (int x = 0; x < 3; x++) {
        add(digest, out->compare_counts[x]);
    }
    add(digest, (int32_t)out->bridge);
    add(digest, dq_of(report->foc.current.i_pu).d);
    add(digest, dq_of(report->foc.current.i_pu).q);
    add(digest, (int32_t)(report->foc.sums.power_pu & INT32_MAX));
    add(digest, report->foc.current.rotor.speed_q32);
    add(digest, report->foc.current.rotor.theta_turn);
    add(digest, (int32_t)report->monitor.trip);
}

void digest_slow(digest_t *digest, const slow_output_t *out, const fast_setpoint_t *command)
{
    add(digest, out->motor_torque_command_mNm);
    add(digest, out->motor_torque_estimate_mNm);
    add(digest, out->hydraulic_torque_mNm);
    add(digest, out->electric_brake_available_mNm);
    add(digest, out->speed_mrad_s);
    add(digest, out->i_d_mA);
    add(digest, out->i_q_mA);
    add(digest, out->bus_voltage_mV);
    add(digest, out->bus_current_mA);
    add(digest, (int32_t)out->torque_reason);
    add(digest, (int32_t)out->available_reason);
    add(digest, (int32_t)out->fault_reason);
    add(digest, (int32_t)out->mode);
    add(digest, out->stop_lamp ? 1 : 0);
    add(digest, out->standstill ? 1 : 0);
    add(digest, command->foc.sequence);
    add(digest, command->foc.i_reference_pu.d);
    add(digest, command->foc.i_reference_pu.q);
    add(digest, command->foc.i_d_sampling_correction_pu);
    add(digest, command->foc.dead_time_slope.alpha_q8);
    add(digest, (int32_t)command->torque_enable.bridge);
}

uint32_t digest_end(const digest_t *digest)
{
    return digest->crc ^ 0xFFFFFFFFU;
}
