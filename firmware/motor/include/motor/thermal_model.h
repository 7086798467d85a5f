/* SPDX-License-Identifier: Apache-2.0 */
/*
 * thermal_model.h: temperatures of winding and switches estimated from their losses, beside or in
 * place of a sensor. Two lumps of heat capacity in a row each; DERIVATIONS.md, Thermal model.
 *
 *     C1 dT1/dt = P1 - (T1 - T2)/R1                      winding, switches
 *     C2 dT2/dt = P2 + (T1 - T2)/R1 - (T2 - T_a)/R2      housing, heat sink
 *
 * P1 of the winding is its copper loss, P2 the iron loss; P1 of the switches is the bridge's loss.
 * Slow loop: the squared current is summed every millisecond, a row advances every 64 ms.
 */
#ifndef MOTOR_THERMAL_MODEL_H
#define MOTOR_THERMAL_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

enum { THERMAL_MODEL_STEP_MS = 64 };

/* One row. Temperatures in hundredths of a degree Celsius, 2^16. */
typedef struct {
    int32_t inner_q16, outer_q16, ambient_q16;
    /* Made once: hundredths of a kelvin a milliwatt of one step adds, 2^16; shares of a difference
     * of temperature that one step levels out, 2^30. */
    int32_t inner_per_mW_q16, outer_per_mW_q16;
    int32_t inner_share_q30, outer_gain_q30, ambient_share_q30;
    /* Of the steady state, made once: mW that a row leads away for each hundredth of a kelvin from
     * its limit to the ambient, 2^16; the share of P2 that this takes away, 2^15. */
    int32_t steady_mW_cK_q16, outer_share_q15;
    bool known; /* the row is configured */
} thermal_lumps_t;

typedef struct {
    thermal_lumps_t winding, switches;
    int64_t square_sum; /* of the current vector's length, mA^2, in this step */
    int32_t length_sum; /* of the length, mA */
    /* Of the 64 ms before, until the rows have taken their heat. */
    int64_t square; /* mean of the square, 2^12 mA^2 */
    int32_t mean_mA;
    int32_t iron_mW;
    /* mA^2 of each mW of copper loss at motor.max_winding_temperature; the current that winding and
     * switches bear for ever, peak phase. */
    int32_t square_per_mW;
    int32_t winding_lasting_mA, switch_lasting_mA;
    uint16_t steps; /* of the present 64 ms */
    bool heat_due;
    bool started;
} thermal_model_state_t;

/* Divides; once at start. */
void thermal_model_init(thermal_model_state_t *state, const config_t *config);

/* First step: every lump at warmest_cC, at least monitor.coldest_ambient; the ambient likewise, at
 * most monitor.warmest_ambient. */
void thermal_model_start(thermal_model_state_t *state, const config_t *config, int32_t warmest_cC);

/* i_d_mA, i_q_mA: means of the millisecond, peak phase; speed mechanical, signed. Any values. What
 * comes once in 64 steps is spread over the first four of the next ones: iron loss, winding,
 * switches, lasting currents. */
void thermal_model_step(thermal_model_state_t *state, const config_t *config, int32_t i_d_mA,
                        int32_t i_q_mA, int32_t speed_mrad_s);

/* The estimate of a row's inner and outer lump, -327 to 327 degC. */
static inline int32_t thermal_model_inner_cC(const thermal_lumps_t *row)
{
    return row->inner_q16 >> 16;
}

static inline int32_t thermal_model_outer_cC(const thermal_lumps_t *row)
{
    return row->outer_q16 >> 16;
}

#endif
