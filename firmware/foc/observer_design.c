/* SPDX-License-Identifier: Apache-2.0 */
#include "foc/observer_design.h"

#include "config/flux_largest.h"
#include "core/q15.h"
#include "core/sqrt3.h"

enum {
    LEAK_PER_SPEED = 4,      /* lambda over the lowest speed in use */
    LEAST_LEAK_rad_s = 400,  /* settles within 5 ms */
    MOST_LEAK_Q24 = 1 << 21, /* lambda T: 1/8 */
    MOST_STEP_Q15 = 8191     /* flux of one period, share of the full scale: 1/4 */
};

/* nH * mA = 1e-12 Wb. */
static int64_t current_nWb(const config_t *config)
{
    return (int64_t)config->motor.q_inductance_nH * config->drive.current_full_scale_mA / 1000;
}

/* 2 psi for the magnets and for errors, 5/4 of the largest L_q I_base for the current. */
static int64_t full_scale_nWb(const config_t *config)
{
    const int64_t largest_nH =
        q_max(config->motor.q_inductance_nH, config_flux_map_largest_nH(config));
    const int64_t largest_nWb = largest_nH * config->drive.current_full_scale_mA / 1000;
    return INT64_C(2) * config->motor.flux_linkage_nWb + largest_nWb * 5 / 4;
}

/* flux over the full scale. */
static int32_t share_q15(const config_t *config, int64_t flux_nWb, int32_t most_q15)
{
    const int64_t full_nWb = full_scale_nWb(config);
    return q_min(q_saturate64((flux_nWb * 32768 + full_nWb / 2) / full_nWb), most_q15);
}

int32_t observer_design_leak_q24(const config_t *config)
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

int32_t observer_design_resistance_q15(const config_t *config)
{
    /* Winding and one switch, as for the current controller. uOhm * mA = nV. */
    const int64_t resistance_uOhm =
        (int64_t)config->motor.phase_resistance_uOhm + config->drive.loss_resistance_uOhm;
    const int64_t drop_nV = resistance_uOhm * config->drive.current_full_scale_mA;
    return share_q15(config, drop_nV / config->drive.pwm_frequency_Hz, MOST_STEP_Q15 / 2);
}

int32_t observer_design_volt_q15(const config_t *config, int32_t modulation_limit_q15)
{
    const int64_t period_nWb =
        (int64_t)config->drive.voltage_full_scale_mV * 1000000 / config->drive.pwm_frequency_Hz;
    const int64_t circle_nWb = period_nWb * modulation_limit_q15 / 32768;
    const int64_t phase_nWb = circle_nWb * INVERSE_SQRT3_Q15 / 32768;
    return share_q15(config, phase_nWb, MOST_STEP_Q15);
}

int32_t observer_design_inductance_q15(const config_t *config)
{
    return share_q15(config, current_nWb(config), INT16_MAX);
}

int32_t observer_design_flux_q14(const config_t *config)
{
    return share_q15(config, config->motor.flux_linkage_nWb, INT16_MAX) / 2;
}
