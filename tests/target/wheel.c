/* SPDX-License-Identifier: Apache-2.0 */
#include "wheel.h"

#include "config/bases.h"
#include "core/angle.h"

enum { DECAY_LOG2 = 6, GAIN_LOG2 = 3, CODE_MID = 2048, CODE_MAX = 4095 };

uint32_t wheel_random(wheel_t *wheel)
{
    wheel->random = wheel->random * 1664525U + 1013904223U;
    return wheel->random >> 16;
}

static int32_t noise(wheel_t *wheel)
{
    return (int32_t)(wheel_random(wheel) % (wheel->noise_codes + 1U)) - wheel->noise_codes / 2;
}

static uint16_t code(int32_t value)
{
    return (uint16_t)q_clamp(value, 0, CODE_MAX);
}

/* 2048 counts an electrical turn, an index eight counts long every 23 turns. */
static encoder_input_t encoder(const wheel_t *wheel)
{
    const uint32_t count = (wheel->turns << 11) + (wheel->angle_q32 >> 21);
    const encoder_input_t in = {
        .count = (uint16_t)count,
        .index_count = (uint16_t)(wheel->turns << 11),
        .index = wheel->turns % 23U == 0 && (wheel->angle_q32 >> 21) < 8U,
    };
    return in;
}

fast_input_t wheel_sample(wheel_t *wheel)
{
    static const uint8_t HALL_OF_SECTOR[6] = {5, 1, 3, 2, 6, 4};
    const int32_t a = wheel->winding_code_q8[0] / 256;
    const int32_t b = wheel->winding_code_q8[1] / 256;
    const fast_input_t in = {
        .phase_current_code = {code(CODE_MID + a + noise(wheel)), code(CODE_MID + b + noise(wheel)),
                               code(CODE_MID - a - b + noise(wheel))},
        .bus_voltage_code = code(wheel->bus_code + noise(wheel)),
        .rotor_angle_turn = (uint16_t)(wheel->angle_q32 >> 16),
        .hall_state = HALL_OF_SECTOR[((uint64_t)wheel->angle_q32 * 6U) >> 32],
        .encoder = encoder(wheel),
        .power_stage_fault = false,
    };
    return in;
}

/* EMF of a phase in compare counts: grows with speed, a quarter of the period at one 128th of a
 * turn per PWM period. */
static int32_t emf_counts(const wheel_t *wheel, const config_t *config, uint16_t phase_turn)
{
    const uint16_t theta = (uint16_t)((wheel->angle_q32 >> 16) - phase_turn);
    const int32_t peak = q_clamp(wheel->speed_q32 / (1 << 15), -2000, 2000) *
                         bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz) / 4096;
    return -(int32_t)angle_sincos(theta).sin * peak / 32768;
}

void wheel_step(wheel_t *wheel, const config_t *config, const fast_output_t *out)
{
    const int32_t star =
        (out->compare_counts[0] + out->compare_counts[1] + out->compare_counts[2]) / 3;
    for (int x = 0; x < 2; x++) {
        const int32_t applied = out->bridge == BRIDGE_PWM ? out->compare_counts[x] - star : 0;
        const int32_t drop = applied - emf_counts(wheel, config, (uint16_t)(x * 21845));
        const int32_t now = wheel->winding_code_q8[x];
        const int32_t pushed = out->bridge == BRIDGE_OFF ? 0 : drop * (1 << GAIN_LOG2);
        wheel->winding_code_q8[x] =
            q_clamp(now - now / (1 << DECAY_LOG2) + pushed, -1000 * 256, 1000 * 256);
    }
    const uint32_t before_q32 = wheel->angle_q32;
    wheel->angle_q32 += (uint32_t)wheel->speed_q32;
    if (wheel->speed_q32 > 0 && wheel->angle_q32 < before_q32) {
        wheel->turns++;
    } else if (wheel->speed_q32 < 0 && wheel->angle_q32 > before_q32) {
        wheel->turns--;
    }
}
