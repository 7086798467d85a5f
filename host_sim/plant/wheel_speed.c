/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/wheel_speed.h"

#include <math.h>

#include "plant/numbers.h"
#include "plant/vectors.h"

/* The last edge of a step; edges > 0. */
static double edge_s(double before, double after, double time_s, double step_s)
{
    const double last = after > before ? floor(after) : floor(after) + 1.0;
    return time_s - step_s * (1.0 - (last - before) / (after - before));
}

/* No edge: the wheel cannot be faster than a tooth in the time since the last one, and at last it
 * counts as standing. */
static void wait(const wheel_speed_params_t *params, wheel_speed_t *ring, double pitch_rad,
                 double time_s)
{
    const double passed_s = time_s - ring->stamp_s;
    const double most = passed_s > 0.0 ? pitch_rad / passed_s : ring->speed_rad_s;
    ring->speed_rad_s = plant_min(ring->speed_rad_s, most);
    if (passed_s > 0.0 && most <= params->lowest_rad_per_s) {
        ring->speed_rad_s = 0.0;
        ring->has_stamp = false;
    }
}

double wheel_speed_step(const wheel_speed_params_t *params, wheel_speed_t *ring, double turned_rad,
                        double speed_rad_s, double time_s, double step_s, bool dead)
{
    const double teeth = floor(params->teeth);
    if (dead || params->dead > 0.5) {
        ring->has_stamp = false;
        ring->speed_rad_s = 0.0;
        return 0.0;
    }
    if (teeth < 1.0) {
        ring->speed_rad_s = fabs(speed_rad_s);
        return ring->speed_rad_s;
    }
    const double pitch_rad = PLANT_TWO_PI / teeth;
    const double before = ring->tooth;
    const double after = before + turned_rad / pitch_rad;
    const double edges = fabs(floor(after) - floor(before));
    ring->tooth = after - floor(after);
    if (edges > 0.0) {
        const double exact_s = edge_s(before, after, time_s, step_s);
        const double stamp_s =
            params->clock_s > 0.0 ? floor(exact_s / params->clock_s) * params->clock_s : exact_s;
        const double between_s = stamp_s - ring->stamp_s;
        if (ring->has_stamp && between_s > 0.0) {
            const double speed = edges * pitch_rad / between_s;
            ring->speed_rad_s = speed > params->lowest_rad_per_s ? speed : 0.0;
        }
        ring->stamp_s = stamp_s;
        ring->has_stamp = true;
    } else {
        wait(params, ring, pitch_rad, time_s);
    }
    return ring->speed_rad_s;
}
