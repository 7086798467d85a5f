/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bms.h: what the battery management sends to the controllers: how much current the pack takes and
 * gives now.
 *
 * The smallest of what the pack is built for (battery.max_..._current_a), what its charge leaves
 * (fading over the last fade_soc to zero into a full pack and out of an empty one), what keeps
 * the settled terminal voltage within its ends, (U_end - u_oc) / (R_s + R_t), and what its
 * temperature allows (charging cold cells plates lithium: zero below coldest_charge_c,
 * everything from full_charge_c on). The message comes every period_s and counts in whole steps of
 * current, rounded towards caution. Every limit is off where its parameter is 0.
 */
#ifndef PLANT_BMS_H
#define PLANT_BMS_H

#include <stdbool.h>

#include "plant/battery.h"
#include "plant/parameter.h"
#include "plant/random.h"

/* clang-format off */
#define BMS_PARAMETERS(X) \
    X(fade_soc,          0.0,   1.0,   "1",    "charge over which the limits fade at both ends") \
    X(max_voltage_v,     0.0,   1e5,   "V", \
      "end of charge that the limit keeps; 0: not watched") \
    X(min_voltage_v,     0.0,   1e5,   "V", \
      "end of discharge that the limit keeps; 0: not watched") \
    X(temperature_c,    -60.0,  100.0, "degC", "of the cells") \
    X(coldest_charge_c, -60.0,  100.0, "degC", \
      "no charge below; not watched unless below full_charge_c") \
    X(full_charge_c,    -60.0,  100.0, "degC", "all charge from here on") \
    X(period_s,          0.0,   10.0,  "s",    "of the message; 0: every millisecond") \
    X(current_step_a,    0.0,   1e3,   "A",    "resolution of the message; 0: none") \
    X(peak_charge_a,     0.0,   1e6,   "A", \
      "charge current allowed for a short time, which the message gives too; 0: it gives none") \
    X(contactor_silent,  0.0,   1.0,   "", \
      "1: the message does not say whether the contactor is open") \
    X(voltage_silent,    0.0,   1.0,   "", \
      "1: the message does not give the pack's voltage") \
    X(current_silent,    0.0,   1.0,   "", \
      "1: the message does not give the pack's current") \
    X(current_error,    -1.0,   10.0,  "1", "gain error of the pack's current sensor") \
    X(current_offset_a, -1e4,   1e4,   "A", "its offset") \
    X(current_noise_a,   0.0,   1e4,   "A", "its standard deviation") \
    X(current_filter_s,  0.0,   10.0,  "s", "its time constant; 0: none")
/* clang-format on */

typedef struct {
    BMS_PARAMETERS(PLANT_PARAMETER_MEMBER)
} bms_params_t;

/* Magnitudes, whole pack. */
typedef struct {
    double charge_a, discharge_a;
    double peak_charge_a; /* 0: not given */
    double voltage_v;     /* at the terminals when it was sent; 0: not given */
    double current_a;     /* measured when it was sent, positive out of the pack */
    bool current_given;
} bms_limits_t;

typedef enum { BMS_NOT_REPORTED = 0, BMS_CLOSED = 1, BMS_OPEN = 2 } bms_contactor_t;

typedef struct {
    bms_limits_t sent;
    bms_contactor_t contactor; /* as sent */
    double next_s;             /* time of the next message */
    double filtered_a;         /* of the pack's current sensor */
    random_t random;           /* its noise; drawn from only where there is some */
} bms_state_t;

bms_limits_t bms_limits(const bms_params_t *params, const battery_params_t *pack,
                        const battery_state_t *battery);

/* Once a millisecond: the limits as the last message has them; state->contactor likewise. time_s
 * must not go back. */
bms_limits_t bms_step(const bms_params_t *params, bms_state_t *state, const battery_params_t *pack,
                      const battery_state_t *battery, bool contactor_open, double time_s);

#endif
