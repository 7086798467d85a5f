/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/encoder.h"

#include <math.h>

static const double TURN_DEG = 360.0;

/* Mechanical turns from an index. */
static double shaft_turns(const encoder_params_t *params, double pole_pairs,
                          const encoder_shaft_t *shaft)
{
    return ((double)shaft->turns + shaft->theta_turn - params->index_deg / TURN_DEG) / pole_pairs;
}

encoder_shaft_t encoder_begin(const encoder_params_t *params, double pole_pairs, double theta_turn,
                              int64_t first_turn)
{
    encoder_shaft_t out = {.theta_turn = theta_turn, .turns = first_turn};
    out.shaft_turns = shaft_turns(params, pole_pairs, &out);
    return out;
}

/* What the counter shows this many counts from an index. */
static uint16_t counter(const encoder_params_t *params, const encoder_shaft_t *shaft, double counts)
{
    const int64_t shown = (int64_t)floor(counts - shaft->lost_counts);
    return (uint16_t)((uint64_t)(params->reversed > 0.5 ? -shown : shown) & 0xFFFFU);
}

encoder_sample_t encoder_read(const encoder_params_t *params, double pole_pairs,
                              encoder_shaft_t *shaft, double theta_turn)
{
    encoder_sample_t out = {.index = false};
    if (params->counts < 1.0) {
        return out;
    }
    const double step = theta_turn - shaft->theta_turn;
    shaft->turns += step < -0.5 ? 1 : (step > 0.5 ? -1 : 0);
    shaft->theta_turn = theta_turn;
    const double before = shaft->shaft_turns;
    const double now = shaft_turns(params, pole_pairs, shaft);
    shaft->shaft_turns = now;
    shaft->lost_counts += (floor(now + 0.5) - floor(before + 0.5)) * floor(params->lost_counts);

    const double width_turns = params->index_width_counts / params->counts;
    const double front = floor(now);
    const double end = floor(before - width_turns) + width_turns;
    if (front > before) {
        out.index = true;
        out.index_count = counter(params, shaft, front * params->counts);
    } else if (end > now) { /* turning back into the pulse */
        out.index = true;
        out.index_count = counter(params, shaft, end * params->counts);
    }
    out.count = counter(params, shaft, now * params->counts);
    return out;
}
