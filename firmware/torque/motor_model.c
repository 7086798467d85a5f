/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/motor_model.h"

#include "config/bases.h"
#include "core/divide.h"
#include "core/q15.h"

enum { PPM = 1000000, FRICTION_FULL_MRAD_S = 500 };

/* Beyond what any accepted configuration means, and small enough that no product below leaves 64
 * bits. */
enum {
    MOST_CURRENT_mA = 10000000,   /* 10 kA */
    MOST_TORQUE_mNm = 1000000000, /* 1 MNm */
    MOST_FRICTION_mNm = 500000000,
    MOST_VOLTAGE_mV = 500000000 /* 500 kV */
};
static const int64_t MOST_FLUX_nWb =
    INT64_C(10000000000); /* 10 Wb: 3/2 * 60 * 10 Wb * 10 kA is 9.0e18 pNm */

static int64_t clamp64(int64_t x, int64_t most)
{
    return x > most ? most : (x < -most ? -most : x);
}

static int32_t divide_saturated(int64_t a, int64_t b)
{
    return q_saturate64(a / b);
}

static int32_t friction_at(const config_motor_t *motor, int32_t speed_mrad_s)
{
    const int64_t viscous_mNm =
        divide_by_million((int64_t)motor->viscous_friction_uNm_s * speed_mrad_s);
    const int32_t share_mrad_s = q_clamp(speed_mrad_s, -FRICTION_FULL_MRAD_S, FRICTION_FULL_MRAD_S);
    const int64_t coulomb_mNm =
        (int64_t)motor->friction_torque_mNm * share_mrad_s / FRICTION_FULL_MRAD_S;
    return (int32_t)clamp64(viscous_mNm + coulomb_mNm, MOST_FRICTION_mNm);
}

motor_model_t motor_model_at(const config_t *config, int32_t speed_mrad_s,
                             int32_t winding_temperature_cC)
{
    const config_motor_t *motor = &config->motor;
    const int64_t w_mrad_s = bases_electrical_mrad_s(config, speed_mrad_s);
    const int64_t w_abs_mrad_s = w_mrad_s < 0 ? -w_mrad_s : w_mrad_s;
    const int32_t flux_nWb = bases_flux_nWb(config, winding_temperature_cC);
    motor_model_t model = {
        .speed_mrad_s = speed_mrad_s,
        .winding_temperature_cC = winding_temperature_cC,
        .flux_nWb = flux_nWb,
        .emf_mV = q_saturate64(divide_by_billion(w_mrad_s * flux_nWb)),
        .iron_current_mA = 0,
        .cross_d_ppm = 0,
        .cross_q_ppm = 0,
        .one_plus_a2_ppm = PPM,
        /* mrad/s * nH = 1e-6 uOhm */
        .reactance_d_uOhm = q_saturate64(divide_by_million(w_mrad_s * motor->d_inductance_nH)),
        .reactance_q_uOhm = q_saturate64(divide_by_million(w_mrad_s * motor->q_inductance_nH)),
        .resistance_uOhm = bases_at_winding_temperature(config, motor->phase_resistance_uOhm,
                                                        winding_temperature_cC),
        .friction_mNm = friction_at(motor, speed_mrad_s),
    };
    const int64_t iron_uOhm =
        (int64_t)motor->iron_loss_resistance_mOhm * 1000 +
        divide_by_million(w_abs_mrad_s * motor->iron_loss_resistance_slope_nOhm_s);
    if (iron_uOhm > 0) {
        model.iron_current_mA = divide_saturated((int64_t)model.emf_mV * PPM, iron_uOhm);
        /* mrad/s * nH over uOhm, times 1e6, is ppm. */
        model.cross_d_ppm = divide_saturated(w_mrad_s * motor->d_inductance_nH, iron_uOhm);
        model.cross_q_ppm = divide_saturated(w_mrad_s * motor->q_inductance_nH, iron_uOhm);
        const int64_t a2_ppm = divide_by_million((int64_t)model.cross_d_ppm * model.cross_q_ppm);
        model.one_plus_a2_ppm = q_saturate64(PPM + a2_ppm);
    }
    return model;
}

/* What the iron branch leaves of terminal currents, or of one of them and i_qt. */
typedef struct {
    int64_t d_mA, q_mA;
} torque_current_t;

/* What i_d leaves in the q axis' iron branch, (w L_d / R_i) i_d. */
static int64_t cross_d_mA(const motor_model_t *model, int32_t i_d_mA)
{
    return divide_by_million((int64_t)model->cross_d_ppm * i_d_mA);
}

static int64_t direct_torque_current_mA(const motor_model_t *model, int32_t i_d_mA, int64_t i_qt_mA)
{
    return clamp64(i_d_mA + divide_by_million(model->cross_q_ppm * i_qt_mA), MOST_CURRENT_mA);
}

static torque_current_t torque_current(const motor_model_t *model, motor_current_t i)
{
    const int64_t net_q_mA = (int64_t)i.q_mA - model->iron_current_mA - cross_d_mA(model, i.d_mA);
    const int64_t i_qt_mA = clamp64(net_q_mA * PPM / model->one_plus_a2_ppm, MOST_CURRENT_mA);
    const torque_current_t out = {.d_mA = direct_torque_current_mA(model, i.d_mA, i_qt_mA),
                                  .q_mA = i_qt_mA};
    return out;
}

/* The magnets' flux and what saliency adds to it. */
static int64_t flux_nWb_at(const motor_model_t *model, const config_motor_t *motor, int64_t i_dt_mA)
{
    const int64_t saliency_nH = (int64_t)motor->d_inductance_nH - motor->q_inductance_nH;
    if (saliency_nH == 0) {
        return model->flux_nWb;
    }
    return clamp64(model->flux_nWb + divide_by_thousand(saliency_nH * i_dt_mA), MOST_FLUX_nWb);
}

static int32_t shaft_torque_mNm(const motor_model_t *model, const config_t *config,
                                torque_current_t i_t)
{
    /* p * nWb * mA = 1e-12 Nm */
    const int64_t torque_pNm = INT64_C(3) * config->motor.pole_pairs *
                               flux_nWb_at(model, &config->motor, i_t.d_mA) / 2 * i_t.q_mA;
    return (int32_t)clamp64(divide_by_billion(torque_pNm) - model->friction_mNm, MOST_TORQUE_mNm);
}

int32_t motor_model_torque_mNm(const motor_model_t *model, const config_t *config,
                               motor_current_t i)
{
    return shaft_torque_mNm(model, config, torque_current(model, i));
}

int32_t motor_model_torque_of_i_qt_mNm(const motor_model_t *model, const config_t *config,
                                       int32_t i_d_mA, int32_t i_qt_mA)
{
    const int64_t within_mA = clamp64(i_qt_mA, MOST_CURRENT_mA);
    const torque_current_t i_t = {.d_mA = direct_torque_current_mA(model, i_d_mA, within_mA),
                                  .q_mA = within_mA};
    return shaft_torque_mNm(model, config, i_t);
}

int32_t motor_model_current_q_mA(const motor_model_t *model, const config_t *config,
                                 int32_t torque_mNm, int32_t i_d_mA)
{
    const config_motor_t *motor = &config->motor;
    const int64_t airgap_mNm = (int64_t)torque_mNm + model->friction_mNm;
    const int64_t least_flux_nWb = model->flux_nWb / 4;
    /* Each pass leaves that share of the error which (w L_q / R_i) i_qt takes of the flux, below a
     * tenth in any motor worth its iron. What does not change i_dt any more changes nothing. */
    const int passes = motor->d_inductance_nH == motor->q_inductance_nH ? 1 : 4;
    int64_t i_qt_mA = 0;
    int64_t last_i_dt_mA = INT64_MAX;
    for (int pass = 0; pass < passes; pass++) {
        const int64_t i_dt_mA = direct_torque_current_mA(model, i_d_mA, i_qt_mA);
        if (i_dt_mA == last_i_dt_mA) {
            break;
        }
        last_i_dt_mA = i_dt_mA;
        const int64_t exact_nWb = flux_nWb_at(model, motor, i_dt_mA);
        const int64_t flux_nWb = exact_nWb > least_flux_nWb ? exact_nWb : least_flux_nWb;
        i_qt_mA = clamp64(airgap_mNm * 1000000000 / (INT64_C(3) * motor->pole_pairs * flux_nWb / 2),
                          MOST_CURRENT_mA);
    }
    return q_saturate64(divide_by_million(i_qt_mA * model->one_plus_a2_ppm) +
                        model->iron_current_mA + cross_d_mA(model, i_d_mA));
}

/* uOhm * mA = 1e-6 mV. Each product below 2^31 * 10^7, so that three of them stay inside 64 bits.
 */
static int32_t voltage_mV(int64_t sum_1e_6mV, int64_t emf_mV)
{
    return (int32_t)clamp64(divide_by_million(sum_1e_6mV) + emf_mV, MOST_VOLTAGE_mV);
}

motor_voltage_t motor_model_voltage(const motor_model_t *model, motor_current_t i)
{
    const torque_current_t i_t = torque_current(model, i);
    const int64_t d_mA = clamp64(i.d_mA, MOST_CURRENT_mA);
    const int64_t q_mA = clamp64(i.q_mA, MOST_CURRENT_mA);
    const motor_voltage_t out = {
        .d_mV = voltage_mV(model->resistance_uOhm * d_mA - model->reactance_q_uOhm * i_t.q_mA, 0),
        .q_mV = voltage_mV(model->resistance_uOhm * q_mA + model->reactance_d_uOhm * i_t.d_mA,
                           model->emf_mV),
    };
    return out;
}

int32_t motor_model_power_mW(const motor_model_t *model, motor_current_t i)
{
    const motor_voltage_t u = motor_model_voltage(model, i);
    /* mV * mA = 1e-3 mW, below 10^9 * 2^31 each */
    return q_saturate64(
        divide_by_thousand(((int64_t)u.d_mV * i.d_mA + (int64_t)u.q_mV * i.q_mA) * 3 / 2));
}
