/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pedals_fields.h: the lists of the section `pedals`, part of config.h.
 */
#ifndef CONFIG_PEDALS_FIELDS_H
#define CONFIG_PEDALS_FIELDS_H

#include <stdint.h>

/* clang-format off */

#define CONFIG_PEDALS_FIELDS(X) \
    X(accelerator_channels,   0,   2,        "1",   "0: the driving demand comes by CAN") \
    X(brake_channels,         0,   2,        "1",   "0: the braking demand comes by CAN") \
    X(interpretation,         0,   1,        "",    "brake pedal: 0 proportional, 1 free travel") \
    X(drive_torque_mNm,       0,   20000000, "mNm", \
      "whole accelerator, wheel of share 1; default motor.max_torque_mNm") \
    X(lift_off_torque_mNm,    0,   20000000, "mNm", \
      "braking torque of the released accelerator, wheel of share 1; 0: it coasts") \
    X(lift_off_travel_q15,    328, 16384,    "1", \
      "share of the accelerator over which lift-off braking fades out; default 0.15") \
    X(brake_torque_mNm,       0,   20000000, "mNm", \
      "whole brake pedal, motor and hydraulic, wheel of share 1; default both limits' sum") \
    X(free_travel_q15,        328, 32440,    "1", \
      "share of the brake pedal that is the friction brake's free travel; default 0.3") \
    X(free_travel_torque_mNm, 0,   20000000, "mNm", \
      "braking torque at its end; default brake.electric_rated_torque_mNm") \
    X(dead_band_q15,          164, 8192,     "1",   "travel of a released pedal; default 0.05") \
    X(difference_q15,         328, 16384,    "1", \
      "of the travel: two channels farther apart are implausible; default 0.1") \
    X(fault_time_ms,          1,   1000,     "ms", \
      "qualify and heal time of a channel that is implausible or out of range; default 100") \
    X(override_q15,           0,   32768,    "1", \
      "accelerator beyond it with the brake pressed must be released; 1: never; default 0.25") \
    X(other_wheels,           0,   15,       "",    "bit of each wheel position to send Demand to")

/* Channels: accelerator a and b, brake pedal a and b; ratios are of the sensors' supply. */
#define CONFIG_PEDALS_ARRAY(Y) \
    Y(lowest_q15,      CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "below: shorted to ground, or open") \
    Y(highest_q15,     CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "above: shorted to the supply") \
    Y(released_q15,    CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "ratio at 0 % travel") \
    Y(pressed_q15,     CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "ratio at 100 % travel") \
    Y(drive_share_q15, CONFIG_WHEELS,         0, 32768, "1", "of drive and lift-off torque") \
    Y(brake_share_q15, CONFIG_WHEELS,         0, 32768, "1", "of the braking torque")

/* clang-format on */

#endif
