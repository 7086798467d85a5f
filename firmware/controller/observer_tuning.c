/* SPDX-License-Identifier: Apache-2.0 */
#include "observer_tuning.h"

#include "config/bases.h"
#include "core/angle.h"
#include "core/q15.h"
#include "core/scaled.h"
#include "foc/foc.h"

enum { LARGEST_RESISTANCE_Q15 = 8191 };

observer_constants_t observer_constants(const config_t *config)
{
    const int32_t half_q24 = foc_observer_leak_q24(config) / 2;
    const observer_constants_t out = {
        .resistance_q15 = foc_observer_resistance_q15(config),
        .volt_q15 = foc_observer_volt_q15(config),
        .flux_q14 = foc_observer_flux_q14(config),
        .cotangent_q24 = scaled_ratio(half_q24, SCALED_ONE - half_q24),
    };
    return out;
}

/* tan(w T/2) of a speed below a quarter turn per period: h + h^3/3. pi/256: turns in Q32 to half
 * the angle in radians, Q24. */
static int32_t tangent_q24(int32_t speed_q32)
{
    const int32_t size_q32 = q_abs(q_clamp(speed_q32, -(1 << 30), 1 << 30));
    const int32_t h_q24 = (int32_t)((INT64_C(52707179) * size_q32) >> 32);
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

uint16_t observer_lead_turn(const observer_constants_t *constants, int32_t speed_q32)
{
    const int32_t along_q24 = tangent_q24(speed_q32);
    const int32_t across_q24 = constants->cotangent_q24;
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

observer_tuning_t observer_tuning(const observer_constants_t *constants, const config_t *config,
                                  int32_t v_dc_pu, uint16_t lead_turn,
                                  int32_t winding_temperature_cC)
{
    const int32_t volt_q15 = q15_product(constants->volt_q15, q_clamp(v_dc_pu, 0, 32768));
    const int32_t resistance_q15 = q_min(
        bases_at_winding_temperature(config, constants->resistance_q15, winding_temperature_cC),
        LARGEST_RESISTANCE_Q15);
    const observer_tuning_t out = {
        .volt = q_pair(volt_q15, volt_q15),
        .minus_resistance = q_pair(-resistance_q15, -resistance_q15),
        .lead_turn = lead_turn,
    };
    return out;
}
