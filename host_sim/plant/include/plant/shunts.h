/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shunts.h: low-side shunts and their amplifiers: what a converter has in front of it when it
 * samples.
 *
 * The shunt lies between low-side switch and ground, so it carries a phase's current only while the
 * low side conducts, switch or diode, and zero while the high side does. The amplifier follows
 * with one time constant,
 *
 *     tau d(output)/dt = driven - output,        driven = i while the low side conducts, else 0,
 *
 * which is solved exactly for a driven current that is constant over an interval. A leg whose low
 * side conducts for less than some time constants before the sample reads too little; one that
 * never does reads zero. The modulation determines these legs, and the firmware chooses two of the
 * three shunts accordingly.
 */
#ifndef PLANT_SHUNTS_H
#define PLANT_SHUNTS_H

#include "plant/vectors.h"

typedef struct {
    double output_a[3]; /* what the amplifiers show, in amperes of the phase */
} shunts_t;

/* One leg's amplifier over an interval. */
void shunts_follow(shunts_t *shunts, int leg, double driven_a, double duration_s,
                   double settling_s);

/* Averaged bridge in a period: legs rise at T (1 - d) / 2 and fall at T (1 + d) / 2, as in
 * switching.h, and currents are linear over the period. */
typedef struct {
    plant_abc_t duty;
    plant_abc_t begin_a, end_a; /* phase currents at both ends of the interval */
    double period_s, dead_s;
} shunts_period_t;

/* The first until_s of a PWM period. */
void shunts_pwm(shunts_t *shunts, const shunts_period_t *period, double until_s, double settling_s);

/* All low sides closed; or all switches open, where only what flows into the motor comes through a
 * low diode. */
void shunts_short(shunts_t *shunts, const shunts_period_t *period, double until_s,
                  double settling_s);
void shunts_off(shunts_t *shunts, const shunts_period_t *period, double until_s, double settling_s);

static inline plant_abc_t shunts_output(const shunts_t *shunts)
{
    const plant_abc_t out = {
        .a = shunts->output_a[0], .b = shunts->output_a[1], .c = shunts->output_a[2]};
    return out;
}

#endif
