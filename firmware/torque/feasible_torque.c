/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/feasible_torque.h"

#include "config/bases.h"
#include "core/divide.h"
#include "core/isqrt.h"
#include "core/q15.h"

enum { PPM = 1000000, MOST_CURRENT_mA = 10000000, MOST_VOLTAGE_mV = 500000000 };

/* The line of voltages over i_qt. Each coefficient below 2^31 uOhm or 5e8 mV, so that two products
 * of both fit 64 bits. */
typedef struct {
    int64_t d_mV, q_mV;     /* A, B */
    int64_t d_uOhm, q_uOhm; /* X_q, C */
    int64_t length_uOhm;    /* Z, >= 1 */
} line_t;

/* What field weakening comes down to by itself, and not beyond the end of the flux. */
static int32_t weakest_d_mA(const config_t *config, const motor_model_t *model)
{
    const int32_t most_mA =
        bases_current_mA(config, config->current_loop.field_weakening_current_pu_q15);
    const int32_t whole_mA = q_scale(model->flux_nWb, 1000, config->motor.d_inductance_nH);
    return -q_min(most_mA, whole_mA);
}

static line_t line_at(const motor_model_t *model, int32_t i_d_mA)
{
    const int64_t r_uOhm = model->resistance_uOhm;
    const int64_t x_d_uOhm = model->reactance_d_uOhm;
    /* uOhm * mA = 1e-6 mV */
    const int64_t iron_mA =
        model->iron_current_mA + divide_by_million((int64_t)model->cross_d_ppm * i_d_mA);
    const int64_t q_mV =
        model->emf_mV + divide_by_million(x_d_uOhm * i_d_mA + r_uOhm * q_saturate64(iron_mA));
    const int64_t q_uOhm =
        divide_by_million(r_uOhm * model->one_plus_a2_ppm + x_d_uOhm * model->cross_q_ppm);
    line_t line = {
        .d_mV = q_clamp(q_saturate64(divide_by_million(r_uOhm * i_d_mA)), -MOST_VOLTAGE_mV,
                        MOST_VOLTAGE_mV),
        .q_mV = q_clamp(q_saturate64(q_mV), -MOST_VOLTAGE_mV, MOST_VOLTAGE_mV),
        .d_uOhm = model->reactance_q_uOhm,
        .q_uOhm = q_saturate64(q_uOhm),
    };
    const uint64_t square =
        (uint64_t)(line.d_uOhm * line.d_uOhm) + (uint64_t)(line.q_uOhm * line.q_uOhm);
    line.length_uOhm = q_max(q_saturate64((int64_t)isqrt64(square)), 1);
    return line;
}

/* mV / uOhm = 1e6 mA */
static int64_t current_mA(int64_t voltage_mV, int64_t length_uOhm)
{
    return voltage_mV * PPM / length_uOhm;
}

static int32_t torque_mNm(const config_t *config, const motor_model_t *model, int32_t i_d_mA,
                          int64_t i_qt_mA)
{
    const int32_t within_mA = q_clamp(q_saturate64(i_qt_mA), -MOST_CURRENT_mA, MOST_CURRENT_mA);
    return motor_model_torque_of_i_qt_mNm(model, config, i_d_mA, within_mA);
}

feasible_torque_t feasible_torque_at(const config_t *config, const motor_model_t *model,
                                     int32_t phase_voltage_mV)
{
    const feasible_torque_t nothing = {.lowest_mNm = 0, .highest_mNm = 0};
    const int32_t i_d_mA = weakest_d_mA(config, model);
    const line_t line = line_at(model, i_d_mA);
    const int64_t most_mV = q_clamp(phase_voltage_mV, 0, MOST_VOLTAGE_mV);
    const int64_t beside_mV =
        (line.d_mV * line.q_uOhm + line.q_mV * line.d_uOhm) / line.length_uOhm;
    if (beside_mV > most_mV || beside_mV < -most_mV) {
        return nothing;
    }
    const int64_t along_mV = (line.d_mV * line.d_uOhm - line.q_mV * line.q_uOhm) / line.length_uOhm;
    const int64_t half_mV = isqrt64((uint64_t)(most_mV * most_mV - beside_mV * beside_mV));
    const int32_t lowest_mNm =
        torque_mNm(config, model, i_d_mA, current_mA(along_mV - half_mV, line.length_uOhm));
    const int32_t highest_mNm =
        torque_mNm(config, model, i_d_mA, current_mA(along_mV + half_mV, line.length_uOhm));
    const feasible_torque_t out = {.lowest_mNm = lowest_mNm,
                                   .highest_mNm = q_max(lowest_mNm, highest_mNm)};
    return out;
}
