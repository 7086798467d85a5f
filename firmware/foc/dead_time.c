#include "foc/dead_time.h"

enum { LARGEST_SLOPE_Q8 = 65000 }; /* times a vector of length one, and its rounding, stays below 2^31 */

dead_time_t dead_time_init(const config_t *config)
{
    const config_drive_t *drive = &config->drive;
    /* t_d as a share of the PWM period, times the counts of the full swing. */
    const int64_t share_1e9 = (int64_t)drive->dead_time_ns * drive->pwm_frequency_Hz;
    const int64_t counts = (share_1e9 * drive->pwm_period_counts + 500000000) / 1000000000;
    const int32_t slope_q8 = q_min(8388608 / config->current_loop.dead_time_zone_pu_q15, LARGEST_SLOPE_Q8);
    const dead_time_t out = {
        .full_counts = q_saturate64(counts),
        .slope_alpha_q8 = slope_q8,
        .slope_beta_q8 = (int32_t)(((uint32_t)slope_q8 * TRANSFORMS_SQRT3_2_Q15 + (1U << 14)) >> 15),
    };
    return out;
}
