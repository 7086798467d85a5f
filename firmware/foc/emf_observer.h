/* SPDX-License-Identifier: Apache-2.0 */
/*
 * emf_observer.h: rotor angle and speed from applied voltage and sampled current, without a rotor
 * sensor, once per PWM period while the bridge switches. Stator frame (DERIVATIONS.md, EMF
 * observer):
 *
 *     psi += T (u - R i) - lambda T x,     x = psi - L_q i,     angle of x by a tracking loop
 *
 * x is the active flux, high-pass filtered at lambda: it leads the rotor by atan(lambda / w), which
 * the slow loop computes. Neither the flux linkage nor an integrator's offset enters the angle.
 *
 * The tracking loop is fast for the first 3.3 ms after a start, so that the angle is within 16
 * degrees after 5 ms. Below the configured speed the result is noise: the slow loop judges it
 * (angle_choice.h).
 */
#ifndef FOC_EMF_OBSERVER_H
#define FOC_EMF_OBSERVER_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/angle.h"
#include "core/fast_messages.h"
#include "core/frames.h"
#include "core/scaled.h"
#include "foc/state.h"

enum {
    EMF_OBSERVER_ACQUIRE_PERIODS = 4, /* between two emf_observer_acquire() */
    EMF_OBSERVER_CAPTURE_PERIODS = 8, /* 5 to 8 after a start x shows its octant */
    EMF_OBSERVER_AXIS_SHARE = 2       /* 2^15 * 2 pi / 2^16 turns = 3.1 times |x| of 1/2 .. 1 */
};

/* config: accepted by config_validate(). Divides. */
void emf_observer_init(emf_observer_t *observer, const config_t *config);

/* The rotor's angle at the next sample: that of x less its lead. */
static inline uint16_t emf_observer_rotor_turn(const emf_observer_t *observer,
                                               const observer_tuning_t *tuning)
{
    return (uint16_t)((observer->theta_q32 >> 16) - tuning->lead_turn);
}

/* The acquisition is complete. */
static inline bool emf_observer_acquired(const emf_observer_t *observer)
{
    return observer->periods >= observer->acquisition_periods;
}

/* Bridge not switching: the next period is a start. */
void emf_observer_reset(emf_observer_t *observer);

/* Once in four periods. In the acquisition: sets the angle to the octant of x once that shows, and
 * at the end lowers the gains. */
void emf_observer_acquire(emf_observer_t *observer);

/*
 * One period. u: voltage that acts from this sample to the next one, modulation units, inside the
 * unit circle; i: sampled current; tuning: of the setpoint. Afterwards theta_q32 is the angle of x
 * at the next sample.
 *
 * The angle error is taken against the nearest of 256 directions, less the angle from it times the
 * middle of |x|'s range: at most 0.26 degrees are left (DERIVATIONS.md, EMF observer).
 */
Q_TARGET_INLINE void emf_observer_step(emf_observer_t *restrict observer, ab16_t u, ab16_t i,
                                       const observer_tuning_t *restrict tuning)
{
    const uint32_t theta_q32 = observer->theta_q32;
    const int32_t speed_q32 = observer->speed_q32;
    const int32_t alpha_q30 = observer->alpha_q30;
    const int32_t beta_q30 = observer->beta_q30;
    const q_pair_t inductance = q_pair_load(&tuning->minus_inductance);
    const q_pair_t leak = q_pair_load(&tuning->minus_leak);
    const q_pair_t volt = q_pair_load(&tuning->volt);
    const q_pair_t resistance = q_pair_load(&tuning->minus_resistance);

    const int32_t x_alpha_q30 = q_pair_mac_x(alpha_q30, inductance, i.v);
    const int32_t x_beta_q30 = q_pair_mac_y(beta_q30, inductance, i.v);
    const q_pair_t x = Q_PAIR_SHIFTED(x_alpha_q30, 16, x_beta_q30);
    const int32_t driven_alpha_q30 = q_pair_mac_x(alpha_q30, volt, u.v);
    const int32_t driven_beta_q30 = q_pair_mac_y(beta_q30, volt, u.v);
    const int32_t left_alpha_q30 = q_pair_mac_x(driven_alpha_q30, resistance, i.v);
    const int32_t left_beta_q30 = q_pair_mac_y(driven_beta_q30, resistance, i.v);
    const int32_t next_alpha_q30 = q_saturate31(q_pair_mac_x(left_alpha_q30, leak, x));
    const int32_t next_beta_q30 = q_saturate31(q_pair_mac_y(left_beta_q30, leak, x));
    observer->x.v = x;
    observer->alpha_q30 = next_alpha_q30;
    observer->beta_q30 = next_beta_q30;

    /* The sine of the angle error, times |x| scaled by a power of two into 1/2 .. 1. */
    const uint32_t halvings = scaled_leading_zeros(q_pair_square(x) | 1U) >> 1;
    const q_pair_t axis = q_pair_load(&ANGLE_TABLE[theta_q32 >> 24]);
    const int32_t across_q15 = q_pair_cross(axis, x) >> (16U - halvings);
    const int32_t from_axis = (int32_t)(theta_q32 >> 16 & 255U) - 128;
    const int32_t error_q15 = across_q15 - EMF_OBSERVER_AXIS_SHARE * from_axis;
    const int32_t turned_q32 = speed_q32 + error_q15 * observer->gains.proportional;
    const int32_t next_q32 = q_saturate31(speed_q32 + error_q15 * observer->gains.integral);
    observer->theta_q32 = theta_q32 + (uint32_t)turned_q32;
    observer->speed_q32 = next_q32;
}

#endif
