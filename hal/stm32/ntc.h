/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ntc.h: temperature of a 10 kOhm, B = 3380 K thermistor in a divider with 10 kOhm, from a 12-bit
 * code.
 *
 *     R(T) = 10 kOhm exp(B (1/T - 1/298.15 K)),   code = 4096 R / (R + 10 kOhm)
 *
 * by linear interpolation over 64 equal steps of the code: within 0.7 C of the formula between -40
 * and 130 C, within 1.5 C up to 150 C, up to 4.6 C too high beyond. Pure; tested on the host
 * against the formula.
 */
#ifndef STM32_NTC_H
#define STM32_NTC_H

#include <stdint.h>

/* code: thermistor to ground; give 4096 - code where it hangs on the supply. Codes that mean a
 * broken or shorted sensor give `broken_cC`: beyond -40 C, and beyond 196 C, 156 Ohm, so that a
 * winding beyond its limit is seen for what it is. */
int32_t ntc_temperature_cC(int32_t code, int32_t broken_cC);

/* The code that a divider with 10 kOhm would show for the thermistor that gives `code` in one with
 * `ground_Ohm` to ground, at most 100 kOhm; the thermistor hangs on the supply. Code 0: 4096. */
int32_t ntc_code_of_divider(int32_t code, int32_t ground_Ohm);

#endif
