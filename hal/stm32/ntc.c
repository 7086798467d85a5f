/* SPDX-License-Identifier: Apache-2.0 */
#include "ntc.h"

enum {
    CODE_RANGE = 4096,
    DIVIDER_Ohm = 10000,
    STEP_LOG2 = 6,
    POINTS = 63,
    CODE_HOTTEST = 64,     /* the table's first point, 196.7 C */
    CODE_MINUS_40_C = 3929 /* 4096 R / (R + 10 kOhm) */
};

/* Hundredths of a degree at code 64, 128 .. 4032, from the formula in ntc.h. */
static const int16_t TEMPERATURE_cC[POINTS] = {
    // clang-format off
    19672, 15456, 13289, 11857, 10798, 9959, 9267, 8678, 8165,
    7710, 7301, 6929, 6588, 6271, 5976, 5699, 5438, 5190,
    4954, 4729, 4512, 4303, 4102, 3907, 3717, 3533, 3352,
    3176, 3003, 2833, 2665, 2500, 2336, 2174, 2013, 1853,
    1694, 1534, 1375, 1214, 1053, 891, 727, 561, 393,
    221, 46, -134, -319, -510, -708, -915, -1132, -1361,
    -1605, -1868, -2154, -2472, -2831, -3249, -3759, -4432, -5480,
    // clang-format on
};

/* R = ground (4096 - code) / code, in 4096 R / (R + 10 kOhm). */
int32_t ntc_code_of_divider(int32_t code, int32_t ground_Ohm)
{
    const int64_t thermistor = (int64_t)ground_Ohm * (CODE_RANGE - code);
    return (int32_t)(CODE_RANGE * thermistor / (thermistor + (int64_t)DIVIDER_Ohm * code));
}

int32_t ntc_temperature_cC(int32_t code, int32_t broken_cC)
{
    if (code < CODE_HOTTEST || code > CODE_MINUS_40_C) {
        return broken_cC;
    }
    const int32_t interval = (code >> STEP_LOG2) - 1;
    const int32_t fraction = code & ((1 << STEP_LOG2) - 1);
    const int32_t left = TEMPERATURE_cC[interval];
    const int32_t right = TEMPERATURE_cC[interval + 1];
    return left + (right - left) * fraction / (1 << STEP_LOG2);
}
