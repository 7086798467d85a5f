#include "foc/dead_time.h"

#include "config/bases.h"

enum {
    LARGEST_SLOPE_Q8 = 65000, /* times a vector of length one, and its rounding, stays below 2^31 */
    SLOWEST_LAG_Q15 = 2048    /* 1/16: less would leave more than 16 LSB undone, an eighth of the narrowest zone */
};

static const int64_t TWO_PI_Q24 = 105414357;

/* 1 - exp(-x) is x / (1 + x/2) within 2 % for x up to 1/2, the most a current loop is designed for. */
static int32_t lag_q15(const config_t *config)
{
    const int64_t x_q24 = config->current_loop.bandwidth_Hz * TWO_PI_Q24 / config->drive.pwm_frequency_Hz;
    return q_clamp((int32_t)((x_q24 << 15) / ((1 << 24) + x_q24 / 2)), SLOWEST_LAG_Q15, Q15_ONE);
}

dead_time_t dead_time_init(const config_t *config)
{
    const config_drive_t *drive = &config->drive;
    /* What is lost as a share of the bus voltage, times the counts of the full swing: t_d f (1 + 2 V_f/v_dc) period. */
    const int64_t counts = (bases_dead_time_share_1e9(config) * drive->pwm_period_counts + 500000000) / 1000000000;
    const int32_t slope_q8 = q_min(8388608 / config->current_loop.dead_time_zone_pu_q15, LARGEST_SLOPE_Q8);
    const dead_time_t out = {
        .full_counts = q_saturate64(counts),
        .slope_alpha_q8 = slope_q8,
        .slope_beta_q8 = (int32_t)(((uint32_t)slope_q8 * TRANSFORMS_SQRT3_2_Q15 + (1U << 14)) >> 15),
        .lag_q15 = lag_q15(config),
    };
    return out;
}

/* What a change leaves to be done after what has begun of it. */
static int32_t left_of(int32_t change)
{
    return change - (change >> DEAD_TIME_BEGUN_LOG2);
}

void dead_time_follow(dead_time_t *dead_time, dq_t reference)
{
    dead_time->behind_pu.d += left_of(reference.d - dead_time->reference_pu.d);
    dead_time->behind_pu.q += left_of(reference.q - dead_time->reference_pu.q);
    dead_time->reference_pu = reference;
}

void dead_time_rest(dead_time_t *dead_time)
{
    const dq_t nothing = {.d = 0, .q = 0};
    dead_time->reference_pu = nothing;
    dead_time->behind_pu = nothing;
}
