/* SPDX-License-Identifier: Apache-2.0 */
#include "emf_observer.h"

#include "core/q15.h"
#include "core/sqrt3.h"
#include "foc/foc.h"

/* Of the method, not of a motor: README, EMF observer. */
enum {
    LEAK_PER_SPEED = 4,       /* lambda over the lowest speed in use */
    LEAST_LEAK_rad_s = 400,   /* settles within 5 ms */
    ACQUISITION_PER_LEAK = 6, /* poles of the tracking loop over lambda: at a start */
    TRACKING_PER_LEAK = 2,
    ACQUISITION_DIVISOR = 300,  /* 3.3 ms */
    MOST_LEAK_Q24 = 1 << 21,    /* lambda T: 1/8 */
    MOST_NATURAL_Q24 = 5 << 20, /* pole times T: 0.31 */
    ERROR_TO_TURN_Q32 = 29800,  /* 2^17/(0.7 2 pi): error, 0.7 sine in Q15, to turns in Q32 */
    MOST_STEP_Q15 = 8191        /* flux of one period, share of the full scale: 1/4 */
};

/* 2 psi for the magnets and for errors, 5/4 of L_q I_base for the current. nH * mA = 1e-12 Wb. */
static int64_t full_scale_nWb(const config_t *config)
{
    const int64_t current_nWb =
        (int64_t)config->motor.q_inductance_nH * config->drive.current_full_scale_mA / 1000;
    return INT64_C(2) * config->motor.flux_linkage_nWb + current_nWb * 5 / 4;
}

/* flux over the full scale. */
static int32_t share_q15(const config_t *config, int64_t flux_nWb, int32_t most_q15)
{
    const int64_t full_nWb = full_scale_nWb(config);
    return q_min(q_saturate64((flux_nWb * 32768 + full_nWb / 2) / full_nWb), most_q15);
}

int32_t foc_observer_leak_q24(const config_t *config)
{
    const int64_t speed_mrad_s =
        (int64_t)config->rotor.observer_speed_mrad_s * config->motor.pole_pairs;
    const int64_t by_speed_mrad_s = LEAK_PER_SPEED * speed_mrad_s;
    const int32_t least_mrad_s = LEAST_LEAK_rad_s * 1000;
    const int64_t leak_mrad_s = by_speed_mrad_s > least_mrad_s ? by_speed_mrad_s : least_mrad_s;
    const int64_t leak_q24 =
        leak_mrad_s * (1 << 24) / (INT64_C(1000) * config->drive.pwm_frequency_Hz);
    return q_min(q_saturate64(leak_q24), MOST_LEAK_Q24);
}

int32_t foc_observer_resistance_q15(const config_t *config)
{
    /* Winding and one switch, as for the current controller. uOhm * mA = nV. */
    const int64_t resistance_uOhm =
        (int64_t)config->motor.phase_resistance_uOhm + config->drive.loss_resistance_uOhm;
    const int64_t drop_nV = resistance_uOhm * config->drive.current_full_scale_mA;
    return share_q15(config, drop_nV / config->drive.pwm_frequency_Hz, MOST_STEP_Q15 / 2);
}

int32_t foc_observer_volt_q15(const config_t *config, int32_t timer_Hz)
{
    const int64_t period_nWb =
        (int64_t)config->drive.voltage_full_scale_mV * 1000000 / config->drive.pwm_frequency_Hz;
    const int64_t circle_nWb = period_nWb * foc_modulation_limit_q15(config, timer_Hz) / 32768;
    const int64_t phase_nWb = circle_nWb * INVERSE_SQRT3_Q15 / 32768;
    return share_q15(config, phase_nWb, MOST_STEP_Q15);
}

int32_t foc_observer_flux_q14(const config_t *config)
{
    return share_q15(config, config->motor.flux_linkage_nWb, INT16_MAX) / 2;
}

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
    const int64_t current_nWb =
        (int64_t)config->motor.q_inductance_nH * config->drive.current_full_scale_mA / 1000;
    const int32_t inductance_q15 = share_q15(config, current_nWb, INT16_MAX);
    const int32_t leak_q24 = foc_observer_leak_q24(config);
    const emf_observer_t fresh = {
        .minus_inductance = q_pair(-inductance_q15, -inductance_q15),
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
    if (observer->periods >= observer->acquisition_periods) {
        observer->start_speed_q32 = observer->speed_q32;
    }
    observer->alpha_q30 = 0;
    observer->beta_q30 = 0;
    observer->x = zero;
    observer->u = zero;
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
    if (observer->periods >= observer->acquisition_periods) {
        return;
    }
    observer->periods += EMF_OBSERVER_ACQUIRE_PERIODS;
    if (observer->periods == EMF_OBSERVER_CAPTURE_PERIODS) {
        observer->theta_q32 = octant_q32(observer->x.v);
        observer->speed_q32 = observer->start_speed_q32;
    }
    if (observer->periods >= observer->acquisition_periods) {
        observer->gains = observer->tracking;
    }
}
