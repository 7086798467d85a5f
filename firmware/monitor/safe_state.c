/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/safe_state.h"

#include "config/bases.h"
#include "config/pack_share.h"
#include "core/divide.h"
#include "core/q15.h"
#include "core/scaled.h"
#include "core/sqrt3.h"
#include "monitor/short_exit.h"

enum {
    LAST_CODE = 4095, /* of 4096 */
    MOST_mA = 10000000,
    SLOW_RHO = 11 /* rho^2 has 7 bits beside 24 of its fraction */
};

/* One speed and temperature: EMF, and the ratios that the equations are written in, made by the
 * first of short circuit and conducting diodes. */
typedef struct {
    int32_t flux_nWb;
    int32_t emf_mV; /* w psi, peak phase */
    bool has_ratios;
    int32_t infinite_mA; /* psi / L_d: the short circuit's current at high speed */
    int32_t stall_mNm;   /* 3/2 p psi^2 / L_d: twice the largest torque of the short circuit */
    int32_t rho_q24;     /* R / (w L_d), at most 64 */
    int32_t slow_q24;    /* its inverse where it is above SLOW_RHO, else 0 */
    int32_t sigma_q24;   /* L_q / L_d */
} machine_t;

static int32_t share_of(int32_t whole, int32_t share_q24)
{
    return q_saturate64(((int64_t)whole * share_q24) >> 24);
}

/* Magnets are as cold as the winding, or, while that is warm, at the reference temperature: a
 * winding warms long before them, and what is cold is cold throughout. */
static machine_t machine_at(const config_t *config, const measured_t *now, int32_t speed_mrad_s)
{
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, q_abs(speed_mrad_s));
    const int32_t share_q24 = bases_share_at_q24(config, config->motor.flux_coefficient_ppm_K,
                                                 now->winding_temperature_cC);
    const int32_t flux_nWb = share_of(config->motor.flux_linkage_nWb, q_max(share_q24, SCALED_ONE));
    const machine_t out = {.flux_nWb = flux_nWb,
                           .emf_mV = q_saturate64(divide_by_billion(w_mrad_s * flux_nWb))};
    return out;
}

/* psi / L_d, nWb / nH = A, rounded down: in two steps of 32 bits up to 4 mH. */
static int32_t infinite_mA(uint32_t flux_nWb, uint32_t l_nH)
{
    const uint64_t rest = (uint64_t)(flux_nWb % l_nH) * 1000U;
    const uint32_t part_mA = rest <= UINT32_MAX ? (uint32_t)rest / l_nH : (uint32_t)(rest / l_nH);
    return q_saturate64((int64_t)(flux_nWb / l_nH) * 1000 + part_mA);
}

static void make_ratios(machine_t *m, const config_t *config, const measured_t *now,
                        int32_t bound_mrad_s)
{
    if (m->has_ratios) {
        return;
    }
    const config_motor_t *motor = &config->motor;
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, q_abs(bound_mrad_s));
    const int32_t x_uOhm = q_saturate64(divide_by_million(w_mrad_s * motor->d_inductance_nH));
    const int32_t r_uOhm = bases_at_winding_temperature(config, motor->phase_resistance_uOhm,
                                                        now->winding_temperature_cC);
    m->infinite_mA =
        infinite_mA((uint32_t)m->flux_nWb, (uint32_t)q_divisor(motor->d_inductance_nH));
    const int64_t flux_uA_Wb = divide_by_million((int64_t)m->flux_nWb * m->infinite_mA);
    m->stall_mNm = q_saturate64(divide_by_thousand(flux_uA_Wb * 3 / 2 * motor->pole_pairs));
    m->rho_q24 = scaled_ratio(r_uOhm, q_max(x_uOhm, 1));
    m->slow_q24 = m->rho_q24 > SLOW_RHO * SCALED_ONE ? scaled_ratio(x_uOhm, q_max(r_uOhm, 1)) : 0;
    m->sigma_q24 = motor->q_inductance_nH == motor->d_inductance_nH
                       ? SCALED_ONE
                       : scaled_ratio(motor->q_inductance_nH, q_divisor(motor->d_inductance_nH));
    m->has_ratios = true;
}

static int32_t square_q24(int32_t x_q24)
{
    return q_saturate64(((int64_t)x_q24 * x_q24) >> 24);
}

/* x below 2^38: 128^2. */
static int32_t root_q24(int64_t x_q24)
{
    return scaled_root(x_q24 * (INT64_C(1) << 24));
}

/* The same where R is large, to the second order of 1/rho: I / I_infinite is (1 + c/2)/rho, the
 * torque (1 + c)/rho, c = (sigma^2 - 2 sigma)/rho^2. */
static steady_state_t slow_short(const machine_t *m, const measured_t *now)
{
    const int32_t sigmas_q24 =
        q_saturate64((int64_t)square_q24(m->sigma_q24) - 2 * (int64_t)m->sigma_q24);
    const int32_t c_q24 = share_of(sigmas_q24, square_q24(m->slow_q24));
    const steady_state_t out = {
        .torque_mNm = share_of(m->stall_mNm, share_of(m->slow_q24, SCALED_ONE + c_q24)),
        .current_mA = share_of(m->infinite_mA, share_of(m->slow_q24, SCALED_ONE + c_q24 / 2)),
        .charging_mA = 0,
        .bus_mV = now->bus_voltage_mV,
    };
    return out;
}

/* I / I_infinite of the short circuit, and its torque over 3/2 p psi^2/L_d:
 * sqrt(rho^2 + sigma^2)/(rho^2 + sigma), rho times the square of that. */
static steady_state_t shorted_at(machine_t *m, const config_t *config, const measured_t *now,
                                 int32_t bound_mrad_s)
{
    make_ratios(m, config, now, bound_mrad_s);
    if (m->rho_q24 > SLOW_RHO * SCALED_ONE) {
        return slow_short(m, now);
    }
    const int64_t rho2 = square_q24(m->rho_q24);
    const int64_t sigma2 = square_q24(m->sigma_q24);
    const int32_t y_q24 =
        scaled_ratio(root_q24(rho2 + sigma2), q_max(q_saturate64(rho2 + m->sigma_q24), 1));
    const steady_state_t out = {
        .torque_mNm = share_of(share_of(m->stall_mNm, m->rho_q24), square_q24(y_q24)),
        .current_mA = share_of(m->infinite_mA, y_q24),
        .charging_mA = 0,
        .bus_mV = now->bus_voltage_mV,
    };
    return out;
}

steady_state_t safe_state_short(const config_t *config, const measured_t *now, int32_t bound_mrad_s)
{
    machine_t m = machine_at(config, now, bound_mrad_s);
    return shorted_at(&m, config, now, bound_mrad_s);
}

/* I / I_infinite on the diodes at u = U/E below one. L_d = L_q:
 * (rho^2 + 1) y^2 + 2 rho u y + u^2 - 1 = 0; otherwise without resistance. DERIVATIONS.md, The safe
 * state. */
static int32_t rectified_q24(const machine_t *m, int32_t u_q24)
{
    const int32_t u2 = square_q24(u_q24);
    if (m->sigma_q24 == SCALED_ONE) {
        const int32_t one_rho2 = q_saturate64((int64_t)SCALED_ONE + square_q24(m->rho_q24));
        const int32_t root = root_q24((int64_t)one_rho2 - u2);
        return scaled_ratio(q_max(root - share_of(m->rho_q24, u_q24), 0), q_divisor(one_rho2));
    }
    const int64_t sigma2 = square_q24(m->sigma_q24);
    const int64_t u2_sigma2 = (u2 * sigma2) >> 24;
    const int64_t b = sigma2 - 2 * ((u2 * (int64_t)m->sigma_q24) >> 24);
    const int64_t under_root = ((b * b) >> 24) + 4 * (((SCALED_ONE - u2) * u2_sigma2) >> 24);
    const int32_t half = (int32_t)((b + root_q24(under_root)) >> 1);
    const int32_t gamma2 = scaled_ratio((int32_t)u2_sigma2, q_max(half, 1));
    return scaled_ratio(root_q24(gamma2 + sigma2),
                        q_divisor(q_saturate64((int64_t)gamma2 + m->sigma_q24)));
}

/* The bus voltage that the diodes see: a sensor at the end of its range shows a lower bound. */
static bool bus_is_known(const config_t *config, int32_t bus_mV)
{
    return (int64_t)bus_mV * 4096 < (int64_t)config->drive.voltage_full_scale_mV * LAST_CODE;
}

/* A bus below its trip has no battery any more, whatever the last message says. */
static bool battery_may_hold(const config_t *config, int32_t bus_mV)
{
    return bus_is_known(config, bus_mV) && bus_mV >= config->battery.undervoltage_trip_mV;
}

/* Diodes that rectify the EMF into the bus. Zero torque and current where it does not reach. */
static steady_state_t freewheel_at(machine_t *m, const config_t *config, const measured_t *now,
                                   int32_t bound_mrad_s, bool battery_gone, int32_t bus_voltage_mV)
{
    const int32_t drops_mV = 2 * config->drive.diode_drop_mV;
    const bool fixed_bus = !battery_gone && battery_may_hold(config, bus_voltage_mV);
    steady_state_t out = {.bus_mV = bus_voltage_mV};
    /* Line to line, sqrt(3) w psi. */
    const int64_t line_uV = (int64_t)m->emf_mV * 1732;
    const int64_t reached_mV = (int64_t)q_max(bus_voltage_mV, 0) + drops_mV;
    if (line_uV < (reached_mV + 1) * 1000) {
        return out;
    }
    if (!fixed_bus) { /* nothing takes a current: the capacitors settle at the EMF */
        out.bus_mV = q_saturate64(divide_by_thousand(line_uV)) - drops_mV;
        return out;
    }
    make_ratios(m, config, now, bound_mrad_s);
    const int32_t u_mV = q_scale(bus_voltage_mV + drops_mV, INVERSE_SQRT3_Q16, 65536);
    const int32_t u_q24 = scaled_ratio(u_mV, m->emf_mV);
    const int32_t y_q24 = rectified_q24(m, u_q24);
    const int32_t ry_u = q_saturate64((int64_t)share_of(m->rho_q24, y_q24) + u_q24);
    out.torque_mNm = share_of(m->stall_mNm, share_of(ry_u, y_q24));
    out.current_mA = share_of(m->infinite_mA, y_q24);
    out.charging_mA = q_scale(out.current_mA, SQRT3_2_Q15, 32768);
    return out;
}

/* Turning by the sensor that gives the angle of the current; 0: unknown. */
static int32_t turning_mrad_s(const measured_t *now)
{
    return now->angle_valid && now->angle_by == ANGLE_BY_SENSOR ? now->speed_mrad_s : 0;
}

static bool may_open(const config_t *config, const measured_t *now)
{
    const short_exit_input_t at = {
        .i_d_mA = now->latest_i_d_mA,
        .i_q_mA = now->latest_i_q_mA,
        .turning_mrad_s = turning_mrad_s(now),
        .bus_mV = bus_is_known(config, now->bus_voltage_mV) ? q_max(now->bus_voltage_mV, 0)
                                                            : config->drive.device_voltage_mV,
    };
    return short_exit_fits(config, &at);
}

/* Current that the battery takes from this wheel. */
static int32_t charge_current_mA(const config_t *config, const measured_t *now)
{
    return q_min(pack_share_mA(&config->battery, q_max(now->battery->charge_current_mA, 0)),
                 config->battery.max_charge_current_mA);
}

static bool freewheel_admissible(const config_t *config, const measured_t *now,
                                 const steady_state_t *off)
{
    return off->current_mA <= config->motor.max_phase_current_mA &&
           off->charging_mA <= charge_current_mA(config, now) &&
           off->bus_mV < config->drive.device_voltage_mV;
}

/* With nothing admissible the devices' voltage decides: a bus that stays below it hurts less than
 * a current that cannot be ended without raising it. */
static bool prefers_short(const config_t *config, const measured_t *now, const steady_state_t *off,
                          const steady_state_t *shorted)
{
    if (freewheel_admissible(config, now, off)) {
        return shorted->current_mA <= config->motor.max_phase_current_mA &&
               shorted->torque_mNm < off->torque_mNm;
    }
    return shorted->current_mA <= config->motor.max_phase_current_mA ||
           off->bus_mV >= config->drive.device_voltage_mV;
}

bool safe_state_short_surges(const config_t *config, const measured_t *now, int32_t bound_mrad_s,
                             const steady_state_t *freewheel)
{
    if (freewheel->current_mA > config->motor.max_phase_current_mA ||
        freewheel->bus_mV >= config->drive.device_voltage_mV) {
        return false;
    }
    const int64_t settled_mA = safe_state_short(config, now, bound_mrad_s).current_mA;
    const int64_t trip_mA =
        ((int64_t)config->monitor.overcurrent_pu_q15 * config->drive.current_full_scale_mA) >> 15;
    const int64_t d_mA = q_limit(now->latest_i_d_mA, MOST_mA) + settled_mA;
    const int64_t q_mA = q_limit(now->latest_i_q_mA, MOST_mA);
    const int64_t left_mA = trip_mA - settled_mA;
    return left_mA < 0 || d_mA * d_mA + q_mA * q_mA > left_mA * left_mA;
}

safe_state_t safe_state_shorted(const config_t *config, const measured_t *now, int32_t bound_mrad_s,
                                bridge_mode_t side)
{
    machine_t m = machine_at(config, now, bound_mrad_s);
    const safe_state_t out = {.bridge = side,
                              .emf_mV = m.emf_mV,
                              .freewheel = {.bus_mV = now->bus_voltage_mV},
                              .torque_mNm = shorted_at(&m, config, now, bound_mrad_s).torque_mNm};
    return out;
}

safe_state_t safe_state_step(const config_t *config, const measured_t *now, bridge_mode_t before,
                             int32_t bound_mrad_s, bool battery_gone)
{
    const bool was_short = bridge_is_short(before);
    machine_t m = machine_at(config, now, bound_mrad_s);
    const int32_t bus_mV =
        was_short ? q_scale(now->bus_voltage_mV, config->monitor.short_release_permille, 1000)
                  : now->bus_voltage_mV;
    const steady_state_t off = freewheel_at(&m, config, now, bound_mrad_s, battery_gone, bus_mV);
    safe_state_t out = {.bridge = BRIDGE_OFF, .emf_mV = m.emf_mV, .freewheel = off};
    const bool quiet = off.current_mA == 0 && off.bus_mV < config->drive.device_voltage_mV;
    if (quiet && !was_short) {
        return out;
    }
    const steady_state_t shorted = shorted_at(&m, config, now, bound_mrad_s);
    if (prefers_short(config, now, &off, &shorted) || (was_short && !may_open(config, now))) {
        out.bridge = BRIDGE_SHORT;
        out.torque_mNm = shorted.torque_mNm;
        return out;
    }
    if (was_short) {
        out.freewheel =
            freewheel_at(&m, config, now, bound_mrad_s, battery_gone, now->bus_voltage_mV);
    }
    out.torque_mNm = out.freewheel.torque_mNm;
    return out;
}
