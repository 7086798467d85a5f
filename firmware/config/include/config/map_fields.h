/* SPDX-License-Identifier: Apache-2.0 */
/*
 * map_fields.h: the lists of the sections `regen_map` and `current_map`, part of config.h. The
 * entries of a map have 16 bits: half the flash, and in the finest power of two of a milli-unit in
 * which the largest one fits, which costs less than a ten-thousandth of a per cent of the energy.
 */
#ifndef CONFIG_MAP_FIELDS_H
#define CONFIG_MAP_FIELDS_H

#include <stdint.h>

#define CONFIG_REGEN_POINTS_MAX 800 /* such as 47 speeds at 17 temperatures, or 65 at 12 */
/* such as 31 torques and 19 speeds at 2 temperatures */
#define CONFIG_CURRENT_MAP_POINTS_MAX 1178

/* clang-format off */

#define CONFIG_REGEN_MAP_FIELDS(X) \
    X(speed_points,                          2,         65,         "1", \
      "points along speed, from standstill") \
    X(speed_step_log2,                       6,         20,         "", \
      "distance of the points is 2^this mrad/s, mechanical") \
    X(temperature_points,                    2,         17,         "1", \
      "points along winding temperature") \
    X(temperature_step_log2,                 6,         15,         "", \
      "distance of the points is 2^this hundredths of a degree") \
    X(temperature_origin_cC,                 -10000,    20000,      "cC", \
      "winding temperature of the first point") \
    X(lsb_log2,                              0,         10,         "", \
      "the entries count in 2^this mNm, the finest in which the largest fits")

/* Row after row of equal temperature: torque[t * speed_points + s]; unused entries are 0. */
#define CONFIG_REGEN_MAP_ARRAY(Y) \
    Y(torque_lsb, CONFIG_REGEN_POINTS_MAX,   -32767,    32767,      "2^lsb_log2 mNm", \
      "unclamped braking torque that returns the most energy with the i_d of current_map, " \
      "magnitude; near standstill negative by extrapolation, which counts as 0")

#define CONFIG_CURRENT_MAP_FIELDS(X) \
    X(torque_points,                         3,         65,         "1", \
      "odd: points along torque in the direction of rotation, braking first; the middle " \
      "one is zero torque") \
    X(torque_step_log2,                      0,         20,         "", \
      "distance of the points is 2^this mNm at the airgap") \
    X(speed_points,                          2,         65,         "1", \
      "points along speed, from standstill") \
    X(speed_step_log2,                       6,         20,         "", \
      "distance of the points is 2^this mrad/s, mechanical") \
    X(temperature_points,                    1,         5,          "1", \
      "points along winding temperature; 1: the map does not depend on it") \
    X(temperature_step_log2,                 6,         15,         "", \
      "distance of the points is 2^this hundredths of a degree") \
    X(temperature_origin_cC,                 -10000,    20000,      "cC", \
      "winding temperature of the first point") \
    X(lsb_log2,                              0,         6,          "", \
      "the entries count in 2^this mA, the finest in which the largest fits")

/* Layer after layer of equal temperature, row after row of equal speed:
 * current_d[(w * speed_points + s) * torque_points + t]; unused entries at the end are 0. */
#define CONFIG_CURRENT_MAP_ARRAY(Y) \
    Y(current_d_lsb, CONFIG_CURRENT_MAP_POINTS_MAX, -32767, 32767, "2^lsb_log2 mA", \
      "terminal i_d of least loss, before field weakening; all 0: i_d = 0")

/* clang-format on */

#endif
