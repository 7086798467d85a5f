/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/shunts.h"

#include <math.h>
#include <stdbool.h>

#include "plant/numbers.h"

enum { LEGS = 3 };

void shunts_follow(shunts_t *shunts, int leg, double driven_a, double duration_s, double settling_s)
{
    shunts->output_a[leg] += (driven_a - shunts->output_a[leg]) * -expm1(-duration_s / settling_s);
}

typedef struct {
    double duty[LEGS], begin_a[LEGS], end_a[LEGS];
} legs_t;

static legs_t legs_of(const shunts_period_t *p)
{
    const legs_t out = {.duty = {p->duty.a, p->duty.b, p->duty.c},
                        .begin_a = {p->begin_a.a, p->begin_a.b, p->begin_a.c},
                        .end_a = {p->end_a.a, p->end_a.b, p->end_a.c}};
    return out;
}

/* A leg's current in the middle of an interval. */
static double current_a(const legs_t *legs, int x, double from_s, double to_s, double whole_s)
{
    return legs->begin_a[x] + (legs->end_a[x] - legs->begin_a[x]) * 0.5 * (from_s + to_s) / whole_s;
}

void shunts_pwm(shunts_t *shunts, const shunts_period_t *period, double until_s, double settling_s)
{
    const legs_t legs = legs_of(period);
    const double t = period->period_s;
    for (int x = 0; x < LEGS; x++) {
        const double d = plant_clamp(legs.duty[x], 0.0, 1.0);
        /* In dead time the diodes decide: current into the motor comes through the low one. */
        const bool into = current_a(&legs, x, 0.0, until_s, until_s) > 0.0;
        double up_s = 0.5 * t * (1.0 - d) + (into ? period->dead_s : 0.0);
        double down_s = 0.5 * t * (1.0 + d) + (into ? 0.0 : period->dead_s);
        if (d <= 0.0 || up_s >= down_s) {
            up_s = t;
            down_s = t;
        } else if (d >= 1.0) {
            up_s = 0.0;
            down_s = t;
        }
        up_s = plant_min(up_s, until_s);
        down_s = plant_min(down_s, until_s);
        shunts_follow(shunts, x, current_a(&legs, x, 0.0, up_s, until_s), up_s, settling_s);
        shunts_follow(shunts, x, 0.0, down_s - up_s, settling_s);
        shunts_follow(shunts, x, current_a(&legs, x, down_s, until_s, until_s), until_s - down_s,
                      settling_s);
    }
}

void shunts_short(shunts_t *shunts, const shunts_period_t *period, double until_s,
                  double settling_s)
{
    const legs_t legs = legs_of(period);
    for (int x = 0; x < LEGS; x++) {
        shunts_follow(shunts, x, current_a(&legs, x, 0.0, until_s, until_s), until_s, settling_s);
    }
}

void shunts_off(shunts_t *shunts, const shunts_period_t *period, double until_s, double settling_s)
{
    const legs_t legs = legs_of(period);
    for (int x = 0; x < LEGS; x++) {
        const double driven_a = plant_max(current_a(&legs, x, 0.0, until_s, until_s), 0.0);
        shunts_follow(shunts, x, driven_a, until_s, settling_s);
    }
}
