/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/dead_time.h"

#include "config/bases.h"

enum {
    LARGEST_SLOPE_Q8 = 65000, /* times a vector of length 1.007 stays below 2^31 */
    LOWEST_BUS_PU = 2048      /* 1/16 */
};

/* The zone of the configuration is that of the battery's middle voltage, and goes with v_dc + 2
 * V_f; here twice of both. */
static dead_time_slope_t slope_at(const config_t *config, int64_t twice_v_dc_mV)
{
    const int64_t twice_drops_mV = INT64_C(4) * config->drive.diode_drop_mV;
    const int64_t middle_mV =
        (int64_t)config->battery.min_voltage_mV + config->battery.max_voltage_mV + twice_drops_mV;
    const int64_t zone_pu_mV =
        config->current_loop.dead_time_zone_pu_q15 * (twice_v_dc_mV + twice_drops_mV);
    const int32_t alpha_q8 =
        q_min(q_saturate64(8388608 * middle_mV / zone_pu_mV), LARGEST_SLOPE_Q8);
    const dead_time_slope_t out = {
        .alpha_q8 = alpha_q8,
        .beta_q8 = (int32_t)(((uint32_t)alpha_q8 * TRANSFORMS_SQRT3_2_Q15 + (1U << 14)) >> 15),
    };
    return out;
}

dead_time_slope_t dead_time_slope_at(const config_t *config, int32_t v_dc_pu)
{
    const int32_t twice_pu = 2 * q_clamp(v_dc_pu, LOWEST_BUS_PU, 32768);
    return slope_at(config, q_scale(twice_pu, config->drive.voltage_full_scale_mV, 32768));
}

dead_time_t dead_time_init(const config_t *config)
{
    const config_drive_t *drive = &config->drive;
    /* What is lost as a share of the bus voltage, times the counts of the full swing: t_d f (1 + 2
     * V_f/v_dc) period. */
    const int64_t counts =
        (bases_dead_time_share_1e9(config) * drive->pwm_period_counts + 500000000) / 1000000000;
    const int64_t twice_middle_mV =
        (int64_t)config->battery.min_voltage_mV + config->battery.max_voltage_mV;
    const dead_time_t out = {
        .full_counts = q_saturate64(counts),
        .slope = slope_at(config, twice_middle_mV),
    };
    return out;
}
