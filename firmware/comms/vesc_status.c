/* SPDX-License-Identifier: Apache-2.0 */
#include "comms/vesc_status.h"

#include "core/isqrt.h"
#include "core/q15.h"

enum {
    STEP_mA = 100,
    STEP_mV = 100,
    STEP_cC = 10,
    TEMPERATURE_LOWEST = -2000, /* in steps, as in the protocol of our own */
    TEMPERATURE_NOT_AVAILABLE = 3000,
    STEP_uC = 360000, /* 0.1 mAh */
    DUTY_PERMILLE = 1000
};

enum { SPEED_rpm_e9 = 9549297 /* 1 mrad/s in 1e-9/min */, TURN_urad = 6283185 };

static int64_t nearest(int64_t value, int64_t step)
{
    return (value + (value < 0 ? -step : step) / 2) / step;
}

static int64_t within(int64_t value, int64_t lowest, int64_t highest)
{
    const int64_t most = value < highest ? value : highest;
    return most > lowest ? most : lowest;
}

/* Big endian. */
static void put(uint8_t *first, uint32_t bytes, uint32_t value)
{
    for (uint32_t k = 0; k < bytes; k++) {
        first[k] = (uint8_t)(value >> 8U * (bytes - 1U - k));
    }
}

static void put32(uint8_t *first, int64_t value)
{
    put(first, 4, (uint32_t)(int32_t)within(value, INT32_MIN, INT32_MAX));
}

static void put16(uint8_t *first, int64_t value)
{
    put(first, 2, (uint32_t)(int32_t)within(value, INT16_MIN, INT16_MAX));
}

static int64_t length(int64_t d, int64_t q)
{
    return isqrt64((uint64_t)(d * d + q * q));
}

static void put_status(uint8_t data[8], const vesc_status_values_t *in)
{
    const int64_t speed_mrad_s = (int64_t)in->speed_mrad_s * in->pole_pairs;
    const int64_t current = nearest(length(in->i_d_mA, in->i_q_mA), STEP_mA);
    const int64_t duty = nearest(length(in->u_pu.d, in->u_pu.q) * DUTY_PERMILLE, Q15_ONE + 1);
    const bool brakes = (int64_t)in->speed_mrad_s * in->i_q_mA < 0;
    put32(&data[0], nearest(speed_mrad_s * SPEED_rpm_e9, 1000000000));
    put16(&data[4], brakes ? -current : current);
    put16(&data[6], in->u_pu.q < 0 ? -duty : duty);
}

static int64_t temperature(int32_t temperature_cC)
{
    return within(nearest(temperature_cC, STEP_cC), TEMPERATURE_LOWEST, TEMPERATURE_NOT_AVAILABLE);
}

static void put_charge(uint8_t data[8], const vesc_status_values_t *in)
{
    put32(&data[0], (int64_t)(in->drawn_uC / STEP_uC));
    put32(&data[4], (int64_t)(in->returned_uC / STEP_uC));
}

/* 10 J are 250/9 steps of 0.36 J. */
static void put_energy(uint8_t data[8], const vesc_status_values_t *in)
{
    put32(&data[0], (int64_t)in->drawn_10J * 250 / 9);
    put32(&data[4], (int64_t)in->returned_10J * 250 / 9);
}

static void put_temperatures(uint8_t data[8], const vesc_status_values_t *in)
{
    put16(&data[0], temperature(in->temperature.switch_cC));
    put16(&data[2], temperature(in->temperature.winding_cC));
    put16(&data[4], nearest(in->bus_current_mA, STEP_mA));
    put16(&data[6], 0);
}

static void put_turns(uint8_t data[8], const vesc_status_values_t *in)
{
    put32(&data[0], nearest(in->turned_urad * in->pole_pairs * 6, TURN_urad));
    put16(&data[4], nearest(in->bus_voltage_mV, STEP_mV));
    put16(&data[6], 0);
}

uint32_t vesc_status_identifier(vesc_status_kind_t kind, uint8_t controller_id)
{
    static const uint8_t PACKET[VESC_STATUS_KINDS] = {9, 14, 15, 16, 27};
    return (uint32_t)PACKET[kind] << 8 | controller_id;
}

vesc_status_frame_t vesc_status_frame(vesc_status_kind_t kind, uint8_t controller_id,
                                      const vesc_status_values_t *values)
{
    vesc_status_frame_t out = {.identifier = vesc_status_identifier(kind, controller_id)};
    switch (kind) {
    case VESC_STATUS:
        put_status(out.data, values);
        break;
    case VESC_STATUS_2:
        put_charge(out.data, values);
        break;
    case VESC_STATUS_3:
        put_energy(out.data, values);
        break;
    case VESC_STATUS_4:
        put_temperatures(out.data, values);
        break;
    case VESC_STATUS_5:
        put_turns(out.data, values);
        break;
    case VESC_STATUS_KINDS:
    default:
        break;
    }
    return out;
}
