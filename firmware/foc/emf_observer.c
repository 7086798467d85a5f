/* SPDX-License-Identifier: Apache-2.0 */
#include "emf_observer.h"

#include "core/q15.h"
#include "foc/observer_design.h"

/* Of the method, not of a motor: DERIVATIONS.md, EMF observer. */
enum {
    ACQUISITION_PER_LEAK = 6, /* poles of the tracking loop over lambda: at a start */
    TRACKING_PER_LEAK = 2,
    ACQUISITION_DIVISOR = 300,  /* 3.3 ms */
    MOST_NATURAL_Q24 = 5 << 20, /* pole times T: 0.31 */
    ERROR_TO_TURN_Q32 = 29800   /* 2^17/(0.7 2 pi): error, 0.7 sine in Q15, to turns in Q32 */
};

static observer_gains_t tracking_gains(int32_t natural_q24)
{
    const int32_t within_q24 = q_min(natural_q24, MOST_NATURAL_Q24);
    const int64_t square_q24 = ((int64_t)within_q24 * within_q24) >> 24;
    const int64_t proportional = ((int64_t)within_q24 * 2 * ERROR_TO_TURN_Q32) >> 24;
    const int64_t integral = (square_q24 * ERROR_TO_TURN_Q32) >> 24;
    const observer_gains_t out = {.proportional = (int32_t)proportional,
                                  .integral = q_max((int32_t)integral, 1)};
    return out;
}

void emf_observer_init(emf_observer_t *observer, const config_t *config)
{
    const int32_t leak_q24 = observer_design_leak_q24(config);
    const emf_observer_t fresh = {
        .acquisition = tracking_gains(leak_q24 * ACQUISITION_PER_LEAK),
        .tracking = tracking_gains(leak_q24 * TRACKING_PER_LEAK),
        .acquisition_periods = (uint32_t)config->drive.pwm_frequency_Hz / ACQUISITION_DIVISOR,
    };
    *observer = fresh;
    emf_observer_reset(observer);
}

void emf_observer_reset(emf_observer_t *observer)
{
    const ab16_t zero = {.v = q_pair(0, 0)};
    if (emf_observer_acquired(observer)) {
        observer->start_speed_q32 = observer->speed_q32;
    }
    observer->alpha_q30 = 0;
    observer->beta_q30 = 0;
    observer->x = zero;
    observer->theta_q32 = 0;
    observer->speed_q32 = 0;
    observer->gains = observer->acquisition;
    observer->periods = 0;
}

/* Middle of the octant of a vector. */
static uint32_t octant_q32(q_pair_t x)
{
    const int32_t alpha = q_pair_x(x);
    const int32_t beta = q_pair_y(x);
    const bool upright = q_abs(beta) > q_abs(alpha);
    const uint32_t first_q32 = upright ? 3U << 28 : 1U << 28;
    const uint32_t half_q32 = alpha >= 0 ? first_q32 : (1U << 31) - first_q32;
    return beta >= 0 ? half_q32 : 0U - half_q32;
}

void emf_observer_acquire(emf_observer_t *observer)
{
    if (emf_observer_acquired(observer)) {
        return;
    }
    observer->periods += EMF_OBSERVER_ACQUIRE_PERIODS;
    if (observer->periods == EMF_OBSERVER_CAPTURE_PERIODS) {
        observer->theta_q32 = octant_q32(observer->x.v);
        observer->speed_q32 = observer->start_speed_q32;
    }
    if (emf_observer_acquired(observer)) {
        observer->gains = observer->tracking;
    }
}
