/* SPDX-License-Identifier: Apache-2.0 */
#include "tuning.h"

#include "config/bases.h"
#include "core/q15.h"
#include "core/scaled.h"
#include "core/sqrt3.h"

enum {
    LOWEST_BUS_PU = 2048, /* 1/16 */
    ADVANCE_HALF_PERIODS = 3,
    LARGEST_COUPLING_Q10 = 16383, /* 16 */
    LARGEST_SLOPE_Q8 = 65000      /* times a vector of length 1.007: below 2^31 */
};

/* gain (volts per unit, `bits` fraction bits) * factor (Q22) with `out` fraction bits. */
static int64_t scaled(int32_t gain, unsigned bits, int32_t factor_q22, unsigned out)
{
    return ((int64_t)gain * factor_q22) >> (bits + 22U - out);
}

static int32_t share_of(int32_t share_q24, int32_t x)
{
    return q_saturate64(((int64_t)x * share_q24) >> 24);
}

static int32_t gain_within(int64_t x, int32_t largest)
{
    return q_clamp(q_saturate64(x), 1, largest);
}

/* w L, Q40, rounded to Q10. */
static int32_t coupling_q10(int64_t reactance_q40)
{
    const int32_t reactance_q10 = q_saturate64((reactance_q40 + (1 << 29)) >> 30);
    return q_clamp(reactance_q10, -LARGEST_COUPLING_Q10, LARGEST_COUPLING_Q10);
}

static pi_gains_t axis_gains(int32_t proportional_q16, int32_t integral_q24, int32_t factor_q22)
{
    const int64_t proportional_q10 = (scaled(proportional_q16, 16, factor_q22, 11) + 1) >> 1;
    const int64_t integral_q15 = scaled(integral_q24, 24, factor_q22, 15);
    /* k_i / k_p does not depend on the bus voltage: Q24 over Q20 is Q4, times 2^24. */
    const int32_t anti_windup_q28 = scaled_ratio(integral_q24, proportional_q16 * 16);
    const pi_gains_t gains = {
        .proportional_q10 = gain_within(proportional_q10, PI_LARGEST_PROPORTIONAL_Q10),
        .integral_q15 = gain_within(integral_q15, PI_LARGEST_INTEGRAL_Q15),
        .anti_windup_q15 = gain_within(anti_windup_q28 >> 13, PI_LARGEST_ANTI_WINDUP_Q15),
    };
    return gains;
}

/* Without saliency one axis has the gains of the other. */
static bool axes_differ(const config_current_loop_t *loop)
{
    return loop->inductance_q_pu_q16 != loop->inductance_d_pu_q16 ||
           loop->proportional_q_pu_q16 != loop->proportional_d_pu_q16 ||
           loop->integral_q_pu_q24 != loop->integral_d_pu_q24;
}

current_tuning_t current_tuning(const config_t *config, int32_t modulation_limit_q15,
                                int32_t v_dc_pu, int32_t speed_q32, int32_t winding_temperature_cC)
{
    /* Volts per unit to modulation: V_base / (limit u_dc / sqrt 3) = sqrt 3 / (limit v_dc_pu). */
    const int32_t circle_q27 =
        (int32_t)(((int64_t)q_clamp(v_dc_pu, LOWEST_BUS_PU, 32768) * modulation_limit_q15) >> 3);
    const int32_t factor_q22 = scaled_ratio(SQRT3_Q25, circle_q27);
    const config_current_loop_t *loop = &config->current_loop;
    const int32_t winding_q24 = bases_share_at_q24(
        config, config->motor.resistance_coefficient_ppm_K, winding_temperature_cC);
    /* Speed in units of its base, 1/16 turn per period = 2^28 in Q32; kept to 24 fraction bits. */
    const int32_t speed_q24 = speed_q32 >> 4;
    const int64_t l_d_q16 = scaled(loop->inductance_d_pu_q16, 16, factor_q22, 16);
    const int64_t psi_q16 = scaled(loop->flux_pu_q16, 16, factor_q22, 16);
    const uint16_t advance_turn = (uint16_t)(((int64_t)speed_q32 * ADVANCE_HALF_PERIODS) >> 17);
    current_tuning_t tuning = {
        .d = axis_gains(loop->proportional_d_pu_q16, share_of(winding_q24, loop->integral_d_pu_q24),
                        factor_q22),
        .w_l_d_q10 = coupling_q10(l_d_q16 * speed_q24),
        .forward_q_q25 = q_clamp(q_saturate64((psi_q16 * speed_q24) >> 15), -(1 << 28), 1 << 28),
        .advance = angle_rotation(advance_turn),
    };
    tuning.q = tuning.d;
    tuning.w_l_q_q10 = tuning.w_l_d_q10;
    if (axes_differ(loop)) {
        const int64_t l_q_q16 = scaled(loop->inductance_q_pu_q16, 16, factor_q22, 16);
        tuning.q = axis_gains(loop->proportional_q_pu_q16,
                              share_of(winding_q24, loop->integral_q_pu_q24), factor_q22);
        tuning.w_l_q_q10 = coupling_q10(l_q_q16 * speed_q24);
    }
    return tuning;
}

/* The zone is configured for the middle of the battery's range and proportional to v_dc + 2 V_f;
 * here twice both. */
dead_time_slope_t dead_time_slope_at(const config_t *config, int32_t v_dc_pu)
{
    const int32_t twice_pu = 2 * q_clamp(v_dc_pu, LOWEST_BUS_PU, 32768);
    const int32_t twice_v_dc_mV = q15_product(twice_pu, config->drive.voltage_full_scale_mV);
    const int32_t twice_drops_mV = 4 * config->drive.diode_drop_mV;
    const int32_t middle_mV =
        config->battery.min_voltage_mV + config->battery.max_voltage_mV + twice_drops_mV;
    const int32_t share_q24 = scaled_ratio(middle_mV, q_divisor(twice_v_dc_mV + twice_drops_mV));
    const int32_t alpha_q8 = q_min(
        share_q24 / q_divisor(2 * config->current_loop.dead_time_zone_pu_q15), LARGEST_SLOPE_Q8);
    const dead_time_slope_t out = {
        .alpha_q8 = alpha_q8,
        .beta_q8 = (int32_t)(((uint32_t)alpha_q8 * SQRT3_2_Q15 + (1U << 14)) >> 15),
    };
    return out;
}
