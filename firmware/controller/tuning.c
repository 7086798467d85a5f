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
    LARGEST_EMF_Q25 = 1 << 28,    /* 8 */
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

/* Of all axes at one bus voltage, speed and winding temperature. */
typedef struct {
    int32_t factor_q22;  /* volts per unit to modulation units */
    int32_t speed_q24;   /* of its base, 1/16 turn per period = 2^28 in Q32 */
    int32_t winding_q24; /* resistance over that at the reference temperature */
} conditions_t;

typedef struct {
    pi_gains_t gains;
    int32_t w_l_q10, w_flux_q25;
} axis_tuning_t;

static int32_t emf_q25(int32_t flux_pu_q16, const conditions_t *at)
{
    const int64_t flux_q16 = scaled(flux_pu_q16, 16, at->factor_q22, 16);
    return q_limit(q_saturate64((flux_q16 * at->speed_q24) >> 15), LARGEST_EMF_Q25);
}

static axis_tuning_t axis_tuning(const winding_axis_t *axis, const conditions_t *at)
{
    const int32_t integral_q24 = share_of(at->winding_q24, axis->integral_pu_q24);
    const int64_t proportional_q10 =
        (scaled(axis->proportional_pu_q16, 16, at->factor_q22, 11) + 1) >> 1;
    const int64_t integral_q15 = scaled(integral_q24, 24, at->factor_q22, 15);
    const int32_t anti_windup_q28 = share_of(at->winding_q24, axis->anti_windup_q28);
    const int64_t inductance_q16 = scaled(axis->inductance_pu_q16, 16, at->factor_q22, 16);
    const axis_tuning_t out = {
        .gains =
            {
                .proportional_q10 = gain_within(proportional_q10, PI_LARGEST_PROPORTIONAL_Q10),
                .integral_q15 = gain_within(integral_q15, PI_LARGEST_INTEGRAL_Q15),
                .anti_windup_q15 = gain_within(anti_windup_q28 >> 13, PI_LARGEST_ANTI_WINDUP_Q15),
            },
        .w_l_q10 = coupling_q10(inductance_q16 * at->speed_q24),
        .w_flux_q25 = axis->flux_pu_q16 == 0 ? 0 : emf_q25(axis->flux_pu_q16, at),
    };
    return out;
}

current_tuning_t current_tuning(const config_t *config, const winding_t *winding,
                                int32_t modulation_limit_q15, int32_t v_dc_pu, int32_t speed_q32,
                                int32_t winding_temperature_cC)
{
    /* Volts per unit to modulation: V_base / (limit u_dc / sqrt 3) = sqrt 3 / (limit v_dc_pu). */
    const int32_t circle_q27 =
        (int32_t)(((int64_t)q_clamp(v_dc_pu, LOWEST_BUS_PU, 32768) * modulation_limit_q15) >> 3);
    const conditions_t at = {
        .factor_q22 = scaled_ratio(SQRT3_Q25, circle_q27),
        .speed_q24 = speed_q32 >> 4,
        .winding_q24 = bases_share_at_q24(config, config->motor.resistance_coefficient_ppm_K,
                                          winding_temperature_cC),
    };
    const uint16_t advance_turn = (uint16_t)(((int64_t)speed_q32 * ADVANCE_HALF_PERIODS) >> 17);
    const axis_tuning_t d = axis_tuning(&winding->d, &at);
    const axis_tuning_t q = axis_tuning(&winding->q, &at);
    const current_tuning_t out = {
        .d = d.gains,
        .q = q.gains,
        .w_l_d_q10 = d.w_l_q10,
        .w_l_q_q10 = q.w_l_q10,
        .forward_d_q25 = -q.w_flux_q25,
        .forward_q_q25 = d.w_flux_q25,
        .advance = angle_rotation(advance_turn),
    };
    return out;
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
