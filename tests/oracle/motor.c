/* SPDX-License-Identifier: Apache-2.0 */
#include "motor.h"

#include "config/bases.h"
#include "numbers.h"

enum { FASTEST_PERIODS = 16, /* in an electrical turn */ NOISE_CODES = 2, INDEX_COUNTS = 4 };
static const double FAR_COUNTS = 1e7; /* so that a count is never negative */

void motor_init(motor_t *motor, const config_t *config)
{
    const motor_t fresh = {
        .config = config,
        .period_s = 1.0 / config->drive.pwm_frequency_Hz,
        .flux_wb = config->motor.flux_linkage_nWb * 1e-9,
        .resistance_ohm = config->motor.phase_resistance_uOhm * 1e-6,
        .inductance_d_h = config->motor.d_inductance_nH * 1e-9,
        .inductance_q_h = config->motor.q_inductance_nH * 1e-9,
        .base_a = config->drive.current_full_scale_mA * 1e-3,
        .top_rad_s = config->motor.max_speed_mrad_s * 1e-3 * config->motor.pole_pairs,
        .period_counts = bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz),
        .battery_v =
            0.5e-3 * ((double)config->battery.min_voltage_mV + config->battery.max_voltage_mV),
    };
    *motor = fresh;
    motor->bus_v = motor->battery_v;
}

/* ---- the winding ---- */

typedef struct {
    double d, q;
} vector_t;

static vector_t voltage_of(const motor_t *motor, const fast_output_t *active)
{
    const double scale = motor->bus_v / motor->period_counts;
    const double a = active->compare_counts[0] * scale;
    const double b = active->compare_counts[1] * scale;
    const double c = active->compare_counts[2] * scale;
    const double alpha = (2.0 * a - b - c) / 3.0;
    const double beta = (b - c) / NUMBERS_SQRT3;
    const double cosine = numbers_cosine(motor->angle_turn);
    const double sine = numbers_sine(motor->angle_turn);
    const vector_t out = {.d = alpha * cosine + beta * sine, .q = beta * cosine - alpha * sine};
    return out;
}

/* The trapezoidal rule over a period: stable at any speed. */
static void carry_current(motor_t *motor, vector_t u_v)
{
    const double half_s = 0.5 * motor->period_s;
    const double w = motor->speed_rad_s;
    const double r_d = motor->resistance_ohm / motor->inductance_d_h * half_s;
    const double r_q = motor->resistance_ohm / motor->inductance_q_h * half_s;
    const double x_d = w * motor->inductance_q_h / motor->inductance_d_h * half_s;
    const double x_q = w * motor->inductance_d_h / motor->inductance_q_h * half_s;
    const double emf_v = w * motor->flux_wb;
    const double d = (1.0 - r_d) * motor->i_d_a + x_d * motor->i_q_a +
                     2.0 * half_s * u_v.d / motor->inductance_d_h;
    const double q = (1.0 - r_q) * motor->i_q_a - x_q * motor->i_d_a +
                     2.0 * half_s * (u_v.q - emf_v) / motor->inductance_q_h;
    const double determinant = (1.0 + r_d) * (1.0 + r_q) + x_d * x_q;
    motor->i_d_a = ((1.0 + r_q) * d + x_d * q) / determinant;
    motor->i_q_a = ((1.0 + r_d) * q - x_q * d) / determinant;
}

static void turn(motor_t *motor)
{
    const double most_rad_s = 2.0 * NUMBERS_PI / (FASTEST_PERIODS * motor->period_s);
    motor->speed_rad_s = numbers_limited(
        motor->speed_rad_s + motor->acceleration_rad_s2 * motor->period_s, most_rad_s);
    const double angle_turn =
        motor->angle_turn + motor->speed_rad_s * motor->period_s / (2.0 * NUMBERS_PI);
    motor->turns += angle_turn >= 1.0 ? 1 : angle_turn < 0.0 ? -1 : 0;
    motor->angle_turn = numbers_fraction(angle_turn);
}

/* The battery, or the capacitors alone. */
static void supply(motor_t *motor, bool battery_open)
{
    const double power_w = 1.5 * motor->i_q_a * motor->speed_rad_s * motor->flux_wb;
    if (battery_open) {
        motor->bus_v -= numbers_limited(2e-4 * power_w, 0.02 * motor->bus_v);
        return;
    }
    const double ohm = motor->config->battery.resistance_uOhm * 1e-6;
    const double settled_v = motor->battery_v - ohm * power_w / (motor->bus_v + 1.0);
    motor->bus_v += 0.02 * (settled_v - motor->bus_v);
}

void motor_step(motor_t *motor, const fast_output_t *active, bool battery_open)
{
    const double line_v = numbers_size(motor->speed_rad_s) * motor->flux_wb * NUMBERS_SQRT3;
    const vector_t shorted = {.d = 0.0, .q = 0.0};
    if (active->bridge == BRIDGE_PWM) {
        carry_current(motor, voltage_of(motor, active));
    } else if (active->bridge != BRIDGE_OFF || line_v > motor->bus_v) {
        carry_current(motor, shorted);
    } else {
        motor->i_d_a *= 0.5;
        motor->i_q_a *= 0.5;
    }
    turn(motor);
    supply(motor, battery_open);
}

/* ---- the sensors ---- */

uint16_t motor_code(double x)
{
    return (uint16_t)numbers_within(x, 0, MOTOR_CODE_MOST);
}

static uint8_t hall_state(const motor_t *motor)
{
    static const uint8_t OF_SECTOR[6] = {5, 1, 3, 2, 6, 4};
    return OF_SECTOR[(int)(motor->angle_turn * 6.0) % 6];
}

static encoder_input_t encoder(const motor_t *motor)
{
    const int32_t a_turn = motor->config->rotor.encoder_counts;
    const double shaft_turn =
        ((double)motor->turns + motor->angle_turn) / motor->config->motor.pole_pairs;
    const int64_t counts = (int64_t)(shaft_turn * a_turn + FAR_COUNTS * a_turn);
    const uint16_t count =
        (uint16_t)(motor->config->rotor.encoder_reversed != 0 ? -counts : counts);
    const encoder_input_t out = {
        .count = count,
        .index_count = count,
        .index = a_turn > 0 && counts % a_turn < INDEX_COUNTS,
    };
    return out;
}

fast_input_t motor_sampled(const motor_t *motor, random_t *random)
{
    const double scale = MOTOR_CODE_MID / motor->base_a;
    const double cosine = numbers_cosine(motor->angle_turn);
    const double sine = numbers_sine(motor->angle_turn);
    const double alpha = (motor->i_d_a * cosine - motor->i_q_a * sine) * scale;
    const double beta = (motor->i_d_a * sine + motor->i_q_a * cosine) * scale;
    const double phase[3] = {alpha, -0.5 * alpha + 0.5 * NUMBERS_SQRT3 * beta,
                             -0.5 * alpha - 0.5 * NUMBERS_SQRT3 * beta};
    fast_input_t out = {
        .rotor_angle_turn = numbers_turn16(motor->angle_turn),
        .encoder = encoder(motor),
        .hall_state = hall_state(motor),
    };
    for (int x = 0; x < 3; x++) {
        const int32_t noise = random_between(random, -NOISE_CODES, NOISE_CODES);
        out.phase_current_code[x] = motor_code(MOTOR_CODE_MID + phase[x] + noise);
    }
    const double bus = motor->bus_v * 4096e3 / motor->config->drive.voltage_full_scale_mV;
    out.bus_voltage_code = motor_code(bus + random_between(random, -NOISE_CODES, NOISE_CODES));
    return out;
}
