/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Energy of an active short circuit's current, with any current, speed and bus voltage: no sum, no
 * product and no shift overflows, and no bus at its limit takes energy. In parts: each function
 * with any argument in the range that the one before gives.
 */
#include "config/bases.h"
#include "core/divide.h"
#include "core/scaled.h"
#include "monitor/short_exit.h"
#include "vectors.h"

/* Contracts of core, tested in test_contracts.py. */
static int64_t divide_by_million_by_contract(int64_t x)
{
    int64_t result;
    ASSUME((x < 0 || result >= 0) && (x > 0 || result <= 0));
    ASSUME(result >= INT64_MIN / 1000000 && result <= INT64_MAX / 1000000);
    ASSUME(x - result * 1000000 >= -999999 && x - result * 1000000 <= 999999);
    return result;
}
#define divide_by_million divide_by_million_by_contract

static int32_t scaled_ratio_by_contract(int32_t n, int32_t d)
{
    PROVE(d > 0 && n >= 0 && n <= d);
    return any_within(0, SCALED_ONE);
}
#define scaled_ratio scaled_ratio_by_contract

/* Tests at every angle (vectors.h). */
static sincos_t angle_sincos_by_contract(uint16_t theta_turn)
{
    (void)theta_turn;
    return any_angle();
}
#define angle_sincos angle_sincos_by_contract

/* Each pass of the loop over the points does the same with another angle: two of the five. */
#define SHORT_EXIT_POINTS 1
#include "short_exit.c"

/* 18 bits shifted down to 14; one more each for rounding down. */
enum { MOST_FLUX = 1 << 14 };

static config_t config;

static int32_t any_inductance(void)
{
    return any_within(100, 1000000000);
}

static bool axes_hold(const axes_t *axes)
{
    return axes->d_nH >= 100 && axes->d_nH <= 1000000000 && axes->q_nH >= 100 &&
           axes->q_nH <= 1000000000 && axes->least_nH == q_min(axes->d_nH, axes->q_nH) &&
           axes->magnets_uWb >= 0 && axes->magnets_uWb <= 2000000 && axes->d_share_q15 >= 0 &&
           axes->d_share_q15 <= 32768 && axes->q_share_q15 >= 0 && axes->q_share_q15 <= 32768;
}

static bool flux_holds(const flux_t *flux)
{
    return flux->d >= -MOST_FLUX && flux->d <= MOST_FLUX && flux->q >= -MOST_FLUX &&
           flux->q <= MOST_FLUX && flux->magnets >= 0 && flux->magnets <= MOST_FLUX &&
           q_abs(flux->d) + q_abs(flux->q) <= MOST_FLUX + 1 && flux->shift >= 0 &&
           flux->shift <= 18;
}

void prove_short_exit_axes(void)
{
    config.motor.d_inductance_nH = any_inductance();
    config.motor.q_inductance_nH = any_inductance();
    config.motor.flux_linkage_nWb = any_within(1000, 2000000000);
    const axes_t axes = axes_of(&config.motor, nondet_bool());
    PROVE(axes_hold(&axes));
    PROOF_END();
}

/* A flux linkage from any inductance and current. */
void prove_short_exit_linkage(void)
{
    const int32_t i_mA = nondet_int32();
    const int32_t out_uWb = flux_uWb(any_inductance(), i_mA);
    PROVE(out_uWb >= -MOST_uWb && out_uWb <= MOST_uWb);
    PROVE(i_mA >= 0 ? out_uWb >= 0 : out_uWb <= 0);
    PROOF_END();
}

void prove_short_exit_flux(void)
{
    axes_t axes;
    ASSUME(axes_hold(&axes));
    const short_exit_input_t in = {.i_d_mA = nondet_int32(), .i_q_mA = nondet_int32()};
    const flux_t flux = flux_of(&axes, &in);
    PROVE(flux_holds(&flux));
    PROOF_END();
}

void prove_short_exit_weighted(void)
{
    axes_t axes;
    flux_t flux;
    ASSUME(axes_hold(&axes) && flux_holds(&flux));
    const int32_t out = largest_weighted(&axes, &flux, any_within(-FASTEST_TURN, FASTEST_TURN));
    PROVE(out >= 0);
    PROOF_END();
}

void prove_short_exit_takes(void)
{
    config.drive.device_voltage_mV = any_within(1000, 2000000);
    config.drive.bus_capacitance_nF = any_within(0, 1000000000);
    const int32_t bus_mV = any_within(0, 2000000);
    const int64_t takes_mJ = bus_takes_mJ(&config, bus_mV);
    PROVE(takes_mJ >= -INT64_C(2000000001) && takes_mJ <= INT64_C(2000000001));
    PROOF_END();
}

/* short_exit_fits() itself: what it computes from these. */
void prove_short_exit_comparison(void)
{
    int64_t takes_mJ;
    ASSUME(takes_mJ >= -INT64_C(2000000001) && takes_mJ <= INT64_C(2000000001));
    const int64_t takes = takes_mJ * any_inductance();
    const int64_t bound = (takes - (takes >> 3)) >> (2 * any_within(0, 18));
    PROVE(takes_mJ > 0 || bound <= 0);
    PROOF_END();
}
