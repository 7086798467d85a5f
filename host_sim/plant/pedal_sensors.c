/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/pedal_sensors.h"

#include "plant/numbers.h"

static double ratio(double released, double pressed, double offset, double broken, double travel)
{
    if (broken > 0.5) {
        return broken > 1.5 ? 1.0 : 0.0;
    }
    return plant_clamp(released + travel * (pressed - released) + offset, 0.0, 1.0);
}

#define RATIO(channel, travel)                                                                     \
    ratio(params->channel##_released, params->channel##_pressed, params->channel##_offset,         \
          params->channel##_broken, (travel))

pedal_sensors_t pedal_sensors_read(const pedal_sensors_params_t *params, double accelerator,
                                   double brake)
{
    const pedal_sensors_t out = {
        .accelerator_a = RATIO(accelerator_a, accelerator),
        .accelerator_b = RATIO(accelerator_b, accelerator),
        .brake_a = RATIO(brake_a, brake),
        .brake_b = RATIO(brake_b, brake),
    };
    return out;
}
