/* SPDX-License-Identifier: Apache-2.0 */
#include "observer_tuning.h"

#include "config/bases.h"
#include "core/angle.h"
#include "core/q15.h"
#include "core/scaled.h"
#include "foc/observer_design.h"

enum { LARGEST_RESISTANCE_Q15 = 8191, LEAK_SHARE = 32, LEAST_LEAK_Q24 = 1 << 15 };

static int32_t cotangent_q24(int32_t leak_q24)
{
    return scaled_ratio(leak_q24 / 2, SCALED_ONE - leak_q24 / 2);
}

observer_constants_t observer_constants(const config_t *config, int32_t modulation_limit_q15)
{
    const int32_t leak_q24 = observer_design_leak_q24(config);
    const observer_constants_t out = {
        .resistance_q15 = observer_design_resistance_q15(config),
        .volt_q15 = observer_design_volt_q15(config, modulation_limit_q15),
        .flux_q14 = observer_design_flux_q14(config),
        .start = {.leak_q24 = leak_q24, .cotangent_q24 = cotangent_q24(leak_q24)},
        .follows_speed = config->motor.q_inductance_nH > config->motor.d_inductance_nH / 8 * 9,
    };
    return out;
}

/* |w| T/2 in radians of a speed below a quarter turn per period. pi/256: turns in Q32 to half the
 * angle in Q24. */
static int32_t half_angle_q24(int32_t speed_q32)
{
    const int32_t size_q32 = q_abs(q_clamp(speed_q32, -(1 << 30), 1 << 30));
    return (int32_t)((ANGLE_PI_Q24 * size_q32) >> 32);
}

/* tan(w T/2): h + h^3/3. */
static int32_t tangent_q24(int32_t speed_q32)
{
    const int32_t h_q24 = half_angle_q24(speed_q32);
    const int32_t cube_q24 = scaled_multiply(scaled_multiply(h_q24, h_q24), h_q24);
    return h_q24 + cube_q24 / 3;
}

/* atan of a ratio 0 .. 1, turns in Q16: r (1/8 + (1 - r)(0.2447 + 0.0663 r)/(2 pi)), error 0.1
 * degrees. */
static int32_t arctangent_turn(int32_t ratio_q24)
{
    const int32_t slope_turn = 2552 + scaled_multiply(692, ratio_q24);
    const int32_t factor_turn = 8192 + scaled_multiply(slope_turn, SCALED_ONE - ratio_q24);
    return scaled_multiply(factor_turn, ratio_q24);
}

void observer_leak_step(observer_leak_t *leak, const observer_constants_t *constants,
                        int32_t speed_q32, bool acquired)
{
    if (!constants->follows_speed || !acquired) {
        *leak = constants->start;
        return;
    }
    const int32_t wanted_q24 =
        q_clamp(half_angle_q24(speed_q32), LEAST_LEAK_Q24, constants->start.leak_q24);
    leak->leak_q24 += (wanted_q24 - leak->leak_q24) / LEAK_SHARE;
    leak->cotangent_q24 = cotangent_q24(leak->leak_q24);
}

uint16_t observer_lead_turn(const observer_leak_t *leak, int32_t speed_q32)
{
    const int32_t along_q24 = tangent_q24(speed_q32);
    const int32_t across_q24 = leak->cotangent_q24;
    const int32_t size_turn =
        across_q24 <= along_q24
            ? arctangent_turn(scaled_ratio(across_q24, along_q24))
            : ANGLE_QUARTER_TURN - arctangent_turn(scaled_ratio(along_q24, across_q24));
    return (uint16_t)(speed_q32 >= 0 ? size_turn : -size_turn);
}

int32_t observer_expected_flux_q14(const observer_constants_t *constants, uint16_t lead_turn)
{
    return (constants->flux_q14 * angle_sincos(lead_turn).cos) >> 15;
}

observer_tuning_t observer_tuning(const observer_constants_t *constants, const winding_t *winding,
                                  const observer_leak_t *leak, const config_t *config,
                                  int32_t v_dc_pu, uint16_t lead_turn,
                                  int32_t winding_temperature_cC)
{
    const int32_t volt_q15 = q15_product(constants->volt_q15, q_clamp(v_dc_pu, 0, 32768));
    const int32_t resistance_q15 = q_min(
        bases_at_winding_temperature(config, constants->resistance_q15, winding_temperature_cC),
        LARGEST_RESISTANCE_Q15);
    const int32_t leak_q16 = (leak->leak_q24 + (1 << 7)) >> 8;
    const observer_tuning_t out = {
        .volt = q_pair(volt_q15, volt_q15),
        .minus_resistance = q_pair(-resistance_q15, -resistance_q15),
        .minus_leak = q_pair(-leak_q16, -leak_q16),
        .minus_inductance = q_pair(-winding->chord_q_q15, -winding->chord_q_q15),
        .lead_turn = lead_turn,
    };
    return out;
}
