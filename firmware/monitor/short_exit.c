/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/short_exit.h"

#include "config/bases.h"
#include "core/angle.h"
#include "core/divide.h"
#include "core/q15.h"
#include "core/scaled.h"

enum {
    MOST_mA = 10000000,
    MOST_uWb = 1000000000,
    FASTEST_TURN = 65536 / 2 / SHORT_EXIT_POINTS, /* half a turn in the window */
    TURN_PER_mrad_Q18 = 342                       /* 2^18 * 65536 / (2 pi 1000) * 500e-6 / 4 */
};

/* Energy in mJ that the bus takes, C/2 (v^2 - u^2) of all but a sixteenth of the rating: 31 bits of
 * 1 F and 2 kV. */
static int64_t bus_takes_mJ(const config_t *config, int32_t bus_mV)
{
    const int64_t rating_mV = config->drive.device_voltage_mV;
    const int64_t most_mV = rating_mV - rating_mV / 16;
    const int64_t margin_V2 = divide_by_million(most_mV * most_mV - (int64_t)bus_mV * bus_mV);
    return divide_by_million(margin_V2 * config->drive.bus_capacitance_nF) / 2;
}

/* L i, nH mA = 10^-6 uWb. */
static int32_t flux_uWb(int32_t inductance_nH, int32_t i_mA)
{
    return q_limit(q_saturate64(divide_by_million((int64_t)inductance_nH * q_limit(i_mA, MOST_mA))),
                   MOST_uWb);
}

/* Flux linkages of the windings alone and of the magnets, and the smaller inductance over that of
 * each axis. */
typedef struct {
    int32_t d_nH, q_nH, least_nH;
    int32_t magnets_uWb;
    int32_t d_share_q15, q_share_q15;
} axes_t;

static axes_t axes_of(const config_motor_t *motor, bool known)
{
    const int32_t most_nH = q_max(motor->d_inductance_nH, motor->q_inductance_nH);
    axes_t out = {.d_nH = most_nH, .q_nH = most_nH};
    if (known) {
        out.d_nH = motor->d_inductance_nH;
        out.q_nH = motor->q_inductance_nH;
        out.magnets_uWb = motor->flux_linkage_nWb / 1000;
    }
    out.least_nH = q_min(out.d_nH, out.q_nH);
    out.d_share_q15 = scaled_ratio(out.least_nH, q_divisor(out.d_nH)) >> 9;
    out.q_share_q15 = scaled_ratio(out.least_nH, q_divisor(out.q_nH)) >> 9;
    return out;
}

/* Flux linkages of a current, uWb >> shift: 14 bits together with the magnets'. */
typedef struct {
    int32_t d, q, magnets;
    int32_t shift;
} flux_t;

static flux_t flux_of(const axes_t *axes, const short_exit_input_t *in)
{
    const int32_t d_uWb = flux_uWb(axes->d_nH, in->i_d_mA);
    const int32_t q_uWb = flux_uWb(axes->q_nH, in->i_q_mA);
    const uint32_t sum_uWb =
        (uint32_t)axes->magnets_uWb + (uint32_t)q_abs(d_uWb) + (uint32_t)q_abs(q_uWb);
    const int32_t shift = q_max(18 - (int32_t)scaled_leading_zeros(sum_uWb | 1U), 0);
    const flux_t out = {.d = (d_uWb + axes->magnets_uWb) >> shift,
                        .q = q_uWb >> shift,
                        .magnets = axes->magnets_uWb >> shift,
                        .shift = shift};
    return out;
}

/* least_nH (L_d i_d^2 + L_q i_q^2) in uWb^2 = mJ nH, >> 2 shift: the largest while the flux linkage
 * of the shorted windings stands still in the stator, so that it turns backwards in the rotor's
 * frame. */
static int32_t largest_weighted(const axes_t *axes, const flux_t *flux, int32_t step_turn)
{
    int32_t largest = 0;
    for (int32_t n = 0; n <= SHORT_EXIT_POINTS; n++) {
        const sincos_t turned = angle_sincos((uint16_t)(n * step_turn));
        const int32_t d = ((flux->d * turned.cos + flux->q * turned.sin) >> 15) - flux->magnets;
        const int32_t q = (flux->q * turned.cos - flux->d * turned.sin) >> 15;
        const int64_t here_q15 =
            (int64_t)(d * d) * axes->d_share_q15 + (int64_t)(q * q) * axes->q_share_q15;
        largest = q_max(largest, (int32_t)(here_q15 >> 15));
    }
    return largest;
}

bool short_exit_fits(const config_t *config, const short_exit_input_t *in)
{
    const axes_t axes = axes_of(&config->motor, in->turning_mrad_s != 0);
    const flux_t flux = flux_of(&axes, in);
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, in->turning_mrad_s);
    const int32_t step_turn =
        q_limit((int32_t)((w_mrad_s * TURN_PER_mrad_Q18) >> 18), FASTEST_TURN);
    /* 9/8 L i^2 against what the bus takes; 7/8 is below the inverse. Iron that saturates may hold
     * twice as much. */
    const bool saturates = config->flux_map.d_points != 0;
    const int64_t takes = (bus_takes_mJ(config, in->bus_mV) >> (saturates ? 1 : 0)) * axes.least_nH;
    return largest_weighted(&axes, &flux, step_turn) <= (takes - (takes >> 3)) >> (2 * flux.shift);
}
