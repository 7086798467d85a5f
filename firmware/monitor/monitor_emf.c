/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_emf.h"

#include "config/bases.h"
#include "core/divide.h"
#include "core/q15.h"

/* At 4 U the error of e turns it by less than 15 degrees: DERIVATIONS.md, Angle check. */
enum {
    MARGIN = 4,
    MOST_CURRENT_mA = 10000000,
    MOST_MISSING_Q20 = 1 << 19,
    TURN_urad = 6283186 /* of mrad/s in a millisecond */
};

static const int64_t NV_PER_MV = 1000000;

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static int64_t magnitude(int64_t x)
{
    return x < 0 ? -x : x;
}

/* mrad/s * nH = 1e-6 uOhm, with the sign of the speed. */
static int32_t reactance_uOhm(int64_t w_mrad_s, int32_t inductance_nH)
{
    return q_saturate64(divide_by_million(w_mrad_s * inductance_nH));
}

typedef struct {
    int64_t across_nV, along_nV;  /* e, along: in the direction of w psi */
    int64_t emf_nV, uncertain_nV; /* |w psi| at the reference temperature, U */
    int32_t x_d_uOhm, x_q_uOhm;   /* magnitudes, as the currents */
    int32_t d_mA, q_mA;
} view_t;

/* Two thirds of the dead times' share: ns * Hz = 1e-9, in 1e-6 of the bus voltage. */
static int64_t dead_time_nV(const config_t *config, const measured_t *now)
{
    const int64_t two_thirds = config->drive.dead_time_ns * config->drive.pwm_frequency_Hz / 1500;
    return two_thirds * now->bus_voltage_mV;
}

static view_t view_of(const config_t *config, const measured_t *now)
{
    const config_motor_t *motor = &config->motor;
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, now->speed_mrad_s);
    const int64_t emf_nV = divide_by_thousand(w_mrad_s * motor->flux_linkage_nWb);
    const int32_t x_d_uOhm = reactance_uOhm(w_mrad_s, motor->d_inductance_nH);
    const int32_t x_q_uOhm = motor->q_inductance_nH == motor->d_inductance_nH
                                 ? x_d_uOhm
                                 : reactance_uOhm(w_mrad_s, motor->q_inductance_nH);
    const int32_t i_d_mA = q_limit(now->latest_i_d_mA, MOST_CURRENT_mA);
    const int32_t i_q_mA = q_limit(now->latest_i_q_mA, MOST_CURRENT_mA);

    /* uOhm * mA = nV. |i_d| + |i_q| is never less than |i|. */
    const int64_t r_uOhm = motor->phase_resistance_uOhm;
    const int64_t e_d_nV =
        now->latest_u_d_mV * NV_PER_MV - (r_uOhm * i_d_mA - (int64_t)x_q_uOhm * i_q_mA);
    const int64_t e_q_nV =
        now->latest_u_q_mV * NV_PER_MV - (r_uOhm * i_q_mA + (int64_t)x_d_uOhm * i_d_mA);
    const int32_t x_uOhm = q_max(q_abs(x_d_uOhm), q_abs(x_q_uOhm));
    const int32_t i_mA = q_abs(i_d_mA) + q_abs(i_q_mA);
    const int64_t half_uOhm = (uint32_t)motor->phase_resistance_uOhm / 2U + (uint32_t)x_uOhm / 4U;
    const int64_t uncertain_nV = half_uOhm * i_mA + dead_time_nV(config, now);
    const view_t out = {
        .across_nV = e_d_nV,
        .along_nV = emf_nV >= 0 ? e_q_nV : -e_q_nV,
        .emf_nV = magnitude(emf_nV),
        .uncertain_nV = larger(uncertain_nV, NV_PER_MV),
        .x_d_uOhm = q_abs(x_d_uOhm),
        .x_q_uOhm = q_abs(x_q_uOhm),
        .d_mA = q_abs(i_d_mA),
        .q_mA = q_abs(i_q_mA),
    };
    return out;
}

/* U_q, of the component along the q axis alone: DERIVATIONS.md, Angle check. */
static int64_t uncertain_along_nV(const view_t *view, const config_t *config, const measured_t *now)
{
    /* |i| <= larger + smaller / 2; an angle error turns the difference of the axes' voltages. */
    const int32_t size_mA = (q_max(view->d_mA, view->q_mA) + view->d_mA + view->q_mA) / 2;
    const int64_t uncertain_nV = (int64_t)(config->motor.phase_resistance_uOhm / 2) * view->q_mA +
                                 (int64_t)(view->x_d_uOhm / 4) * view->d_mA +
                                 (int64_t)(q_abs(view->x_q_uOhm - view->x_d_uOhm) / 4) * size_mA +
                                 dead_time_nV(config, now);
    return larger(uncertain_nV, NV_PER_MV);
}

/* Share of the expected EMF, at most a half; of millivolts. */
static int32_t missing_q20(int64_t apart_nV, int64_t expected_nV)
{
    const int64_t lacking_mV = divide_by_million(-apart_nV); /* below 2^37 */
    const int64_t expected_mV = larger(divide_by_million(expected_nV), 1);
    return q_clamp(q_saturate64(lacking_mV * (1 << 20) / expected_mV), 0, MOST_MISSING_Q20);
}

/* Halls measure the mean of up to an electrical turn. While that changes by more than an eighth
 * within a turn, as at the end of a stop, it is not the rotor's speed, and no EMF can be expected
 * of it. Other sensors measure the speed itself. */
static bool is_steady(monitor_emf_state_t *state, const config_t *config, int32_t speed_mrad_s)
{
    const int32_t speed_abs_mrad_s = q_abs(speed_mrad_s);
    const int64_t moved_mrad_s = (int64_t)speed_abs_mrad_s - state->steady_mrad_s;
    if (magnitude(moved_mrad_s) > speed_abs_mrad_s / 8) {
        state->steady_mrad_s = speed_abs_mrad_s;
        state->steady_steps = 0;
    } else if (state->steady_steps < UINT16_MAX) {
        state->steady_steps++;
    }
    return config->rotor.sensor != CONFIG_ROTOR_HALL ||
           (int64_t)state->steady_steps * bases_electrical_mrad_s(config, speed_abs_mrad_s) >=
               TURN_urad;
}

/* Steps beyond the tolerance less steps within it; below 0 weak, above strong. */
static void watch_flux(monitor_emf_state_t *state, const config_t *config, const measured_t *now,
                       const view_t *view)
{
    const int32_t share_q24 = bases_share_at_q24(config, config->motor.flux_coefficient_ppm_K,
                                                 now->winding_temperature_cC);
    /* The share with 10 bits of fraction, so that any flux fits 64 bits. */
    const int64_t expected_nV = (view->emf_nV >> 10) * (share_q24 >> 14);
    const int64_t tolerance_nV =
        divide_by_thousand(expected_nV) * config->monitor.flux_tolerance_permille;
    const int64_t apart_nV = view->along_nV - expected_nV;
    const bool beyond = magnitude(apart_nV) > tolerance_nV + uncertain_along_nV(view, config, now);
    if (beyond) {
        const int32_t step = apart_nV < 0 ? -1 : 1;
        state->flux_level = (int16_t)q_limit(state->flux_level + step, MONITOR_EMF_FLUX_STEPS);
    } else if (state->flux_level != 0 &&
               (state->flux == MONITOR_EMF_FLUX_PLAUSIBLE || magnitude(apart_nV) <= tolerance_nV)) {
        /* More uncertainty alone heals nothing. */
        state->flux_level = (int16_t)(state->flux_level - (state->flux_level < 0 ? -1 : 1));
    }
    if (state->flux != MONITOR_EMF_FLUX_WEAK) {
        state->missing_q20 = 0;
    } else if (beyond) {
        state->missing_q20 += (missing_q20(apart_nV, expected_nV) - state->missing_q20) / 64;
    }
    if (state->flux_level <= -MONITOR_EMF_FLUX_STEPS) {
        state->flux = MONITOR_EMF_FLUX_WEAK;
    } else if (state->flux_level >= MONITOR_EMF_FLUX_STEPS) {
        state->flux = MONITOR_EMF_FLUX_STRONG;
    } else if (state->flux_level == 0) {
        state->flux = MONITOR_EMF_FLUX_PLAUSIBLE;
    }
}

/* Of a step that counts against the angle. A rotor may be slower than its sensor says, or stand:
 * DERIVATIONS.md, Angle check. */
static int32_t weight_of(const view_t *view, bool steady)
{
    const int64_t half_nV = view->emf_nV / 2;
    const bool seen = magnitude(view->across_nV) >= half_nV || -view->along_nV >= half_nV;
    return steady && seen ? MONITOR_EMF_SEEN : 1;
}

/* A salient motor at full current has e within U up to any speed, and with |i_d| > psi/(L_q - L_d)
 * its observer sees no half turn: the sign of e_q shows it. Not of small currents, beside which the
 * dead time's compensation may be wrong. Not of halls that still show a speed when the wheel stands
 * or rolls back. */
static bool opposite(const view_t *view, const config_t *config, const measured_t *now, bool steady)
{
    const config_motor_t *motor = &config->motor;
    if (view->along_nV >= 0 || motor->q_inductance_nH <= motor->d_inductance_nH || !steady) {
        return false;
    }
    const int64_t least_nV = uncertain_along_nV(view, config, now);
    const int64_t reluctance_nV = (int64_t)(view->x_q_uOhm - view->x_d_uOhm) * view->d_mA;
    return reluctance_nV >= view->emf_nV / 2 && view->emf_nV >= least_nV &&
           -view->along_nV >= least_nV;
}

bool monitor_emf_step(monitor_emf_state_t *state, const config_t *config, const measured_t *now)
{
    if (!measured_switching(now) || !now->angle_valid) {
        state->level = 0;
        return false;
    }
    const view_t view = view_of(config, now);
    const bool steady = is_steady(state, config, now->speed_mrad_s);
    const bool judged =
        view.emf_nV >= MARGIN * view.uncertain_nV || opposite(&view, config, now, steady);
    const bool wrong = magnitude(view.across_nV) >= view.along_nV;
    if (judged && !wrong && steady) {
        watch_flux(state, config, now, &view);
    }
    const bool counts = judged && wrong && !now->report->voltage_limited;
    const int32_t weight = counts ? weight_of(&view, steady) : -MONITOR_EMF_SEEN;
    const int32_t most = MONITOR_EMF_SEEN * config->monitor.angle_fault_time_ms;
    state->level = (uint16_t)q_clamp(state->level + weight, 0, most);
    return state->level >= most;
}
