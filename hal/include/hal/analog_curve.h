/* SPDX-License-Identifier: Apache-2.0 */
/*
 * analog_curve.h: temperature of a sensor in a divider, from its 12-bit code.
 *
 * By linear interpolation over equal steps of the code; what kind of sensor and which divider it is
 * decides who makes the points (tools/regen_table). Pure; tested on the host.
 */
#ifndef HAL_ANALOG_CURVE_H
#define HAL_ANALOG_CURVE_H

#include <stdint.h>

/* Reported for a temperature sensor that is broken or not connected: above any active limit, so
 * that the derating makes the torque zero, but below 300 C, which in the configuration means that
 * the limit is off. */
enum { ANALOG_TEMPERATURE_BROKEN_cC = 29999 };

enum { ANALOG_CURVE_STEP_LOG2 = 6 };

/* lowest to highest: codes of a sensor that is whole, at most 4031; none where they are crossed. */
typedef struct {
    const int16_t *point_cC; /* at code 0, 64 .. 4032 */
    int32_t lowest_code, highest_code;
} analog_curve_t;

/* Hundredths of a degree Celsius, or ANALOG_TEMPERATURE_BROKEN_cC. Any code. */
static inline int32_t analog_curve_cC(const analog_curve_t *curve, int32_t code)
{
    if (code < curve->lowest_code || code > curve->highest_code) {
        return ANALOG_TEMPERATURE_BROKEN_cC;
    }
    const int16_t *point_cC = &curve->point_cC[code >> ANALOG_CURVE_STEP_LOG2];
    const int32_t share = code & ((1 << ANALOG_CURVE_STEP_LOG2) - 1);
    return point_cC[0] + (point_cC[1] - point_cC[0]) * share / (1 << ANALOG_CURVE_STEP_LOG2);
}

#endif
