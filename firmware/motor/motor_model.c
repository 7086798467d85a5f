/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/motor_model.h"

#include "core/q15.h"
#include "motor/flux_map.h"

enum {
    MOST_b = 1 << 26, /* of any coefficient: products and sums stay within 32 bits */
    MOST_CURRENT_b = MOTOR_MODEL_MOST_CURRENT_b,
    LARGEST_RISE_cK = 100000,
    LEAST_FLUX_b = 4 /* a quarter of it divides */
};

static int32_t within_b(int32_t x)
{
    return q_saturate27(x);
}

/* Against the rotation: Coulomb friction fades in over the first half radian a second. */
static int32_t friction_b(const motor_constants_t *k, int32_t w_b, int32_t speed_abs_mrad_s)
{
    const int64_t coulomb_q8_b =
        (int64_t)k->coulomb_step_q8_b * q_min(speed_abs_mrad_s, MOTOR_MODEL_FRICTION_FULL_MRAD_S);
    return within_b(q_saturate64((coulomb_q8_b >> 8) + scaled_multiply(k->viscous_b, w_b)));
}

/* Clamped to at least a tenth of the reference value, also with a broken thermistor. */
static int32_t at_temperature_b(int32_t reference_b, int32_t rise_q16_b, int32_t rise_cK)
{
    const int32_t change_b = (int32_t)(((int64_t)rise_q16_b * rise_cK) >> 16);
    return q_clamp(reference_b + change_b, reference_b / 10, MOST_b);
}

/* psi, L_d and L_q. */
typedef struct {
    int32_t flux_b, d_b, q_b;
    int32_t slope_flux_b, slope_saliency_b;
} flux_t;

static flux_t of_constants(const motor_constants_t *k, int32_t rise_cK)
{
    const int32_t flux_b =
        q_max(at_temperature_b(k->flux_b, -k->flux_fall_b, rise_cK), LEAST_FLUX_b);
    const flux_t out = {.flux_b = flux_b,
                        .d_b = k->inductance_d_b,
                        .q_b = k->inductance_q_b,
                        .slope_flux_b = flux_b,
                        .slope_saliency_b = within_b(k->inductance_d_b - k->inductance_q_b)};
    return out;
}

/* 2^58 / 10^9, and 2^68 / 10^12: a nWb and a nH in binary scales by a multiplication and a shift.
 */
static int32_t flux_of_nWb(const motor_constants_t *k, int32_t flux_nWb)
{
    return within_b(q_saturate64(((int64_t)flux_nWb * 288230376) >> k->flux_unit_shift));
}

static int32_t inductance_of_nH(const motor_constants_t *k, int32_t inductance_nH)
{
    return q_clamp(q_saturate64(((int64_t)inductance_nH * 295147905) >> k->inductance_unit_shift),
                   1, MOST_b);
}

/* DERIVATIONS.md, Saturated iron: the tangent along i_d and the chord along i_q. */
static flux_t of_map(const motor_constants_t *k, const config_t *config, int32_t shift_mA,
                     motor_current_t at)
{
    /* Below the first point the chord is the same everywhere. */
    const int32_t i_q_mA = q_max(q_abs(at.q_mA), q_max(config->flux_map.q_step_mA / 4, 1));
    const flux_map_point_t map =
        flux_map_at(config, at.d_mA + shift_mA, at.q_mA < 0 ? -i_q_mA : i_q_mA);
    const int32_t i_d_b = motor_model_current_b(k, at.d_mA);
    const int32_t i_q_b = motor_model_current_b(k, i_q_mA);
    const int32_t d_b = inductance_of_nH(k, map.d_nH);
    const int32_t flux_d_b = flux_of_nWb(k, map.d_nWb);
    const int32_t flux_q_b = q_abs(flux_of_nWb(k, map.q_nWb));
    const int32_t cross_b = inductance_of_nH(k, q_abs(map.cross_nH));
    const int32_t cross_q_b = scaled_multiply(map.cross_nH < 0 ? -cross_b : cross_b, i_q_b);
    const int32_t active_b = flux_d_b + (at.q_mA < 0 ? -cross_q_b : cross_q_b) -
                             scaled_multiply(inductance_of_nH(k, map.q_nH), i_d_b);
    const int32_t chord_b = q_clamp(scaled_ratio(flux_q_b, q_max(i_q_b, 1)), 1, MOST_b);
    const int32_t turned = scaled_ratio(
        scaled_multiply(map.cross_nH < 0 ? -cross_b : cross_b, i_d_b), q_max(i_q_b, 1));
    const int32_t slope_b = within_b(d_b - chord_b - (at.q_mA < 0 ? -turned : turned));
    const flux_t out = {
        .flux_b = q_clamp(flux_d_b - scaled_multiply(d_b, i_d_b), LEAST_FLUX_b, MOST_b),
        .d_b = d_b,
        .q_b = chord_b,
        .slope_flux_b = q_clamp(active_b - scaled_multiply(slope_b, i_d_b), LEAST_FLUX_b, MOST_b),
        .slope_saliency_b = slope_b,
    };
    return out;
}

/* What flows across the EMF less than the terminal currents; the fluxes are those of the latter. */
static motor_current_t torque_currents(const motor_constants_t *k, const config_t *config,
                                       int32_t shift_mA, motor_current_t at, int32_t w_b,
                                       int32_t conductance)
{
    const flux_map_point_t map = flux_map_at(config, at.d_mA + shift_mA, at.q_mA);
    const int32_t v_d_b = scaled_multiply(w_b, flux_of_nWb(k, map.q_nWb));
    const int32_t v_q_b = scaled_multiply(w_b, flux_of_nWb(k, map.d_nWb));
    const int32_t d_b = q_saturate26(scaled_multiply(v_d_b, conductance));
    const int32_t q_b = q_saturate26(scaled_multiply(v_q_b, conductance));
    const motor_current_t out = {.d_mA = at.d_mA + motor_model_current_mA(k, d_b),
                                 .q_mA = at.q_mA - motor_model_current_mA(k, q_b)};
    return out;
}

/* 1 / R_i; 0: no iron loss. */
static int32_t conductance_at(const motor_constants_t *k, int32_t w_b)
{
    const int64_t iron_q16_b = k->iron_q16_b + (((int64_t)w_b * k->iron_slope_q16_b) >> 24);
    if (iron_q16_b <= 0) {
        return 0;
    }
    /* 2^40 / R_i, for all terms of the iron loss. */
    const uint32_t inverse_q32 = UINT32_MAX / (uint32_t)q_saturate64(iron_q16_b);
    return (int32_t)(inverse_q32 < (MOST_b >> 8) ? inverse_q32 << 8 : MOST_b);
}

static flux_t flux_around(const motor_constants_t *k, const config_t *config, int32_t w_b,
                          int32_t conductance, int32_t winding_temperature_cC,
                          motor_current_t around)
{
    const int32_t most_mA = 2 * config->motor.max_phase_current_mA;
    const int32_t shift_mA = flux_map_shift_mA(config, winding_temperature_cC);
    const motor_current_t within = {.d_mA = q_limit(around.d_mA, most_mA),
                                    .q_mA = q_limit(around.q_mA, most_mA)};
    const motor_current_t at =
        conductance > 0 ? torque_currents(k, config, shift_mA, within, w_b, conductance) : within;
    return of_map(k, config, shift_mA, at);
}

/* All that follows from the fluxes. */
static inline void set_flux(motor_model_t *m, const flux_t *flux, int32_t conductance)
{
    const int32_t w_b = m->speed_b;
    m->inductance_d_b = flux->d_b;
    m->inductance_q_b = flux->q_b;
    m->flux_b = flux->flux_b;
    m->saliency_b = within_b(flux->d_b - flux->q_b);
    m->slope_flux_b = flux->slope_flux_b;
    m->slope_saliency_b = flux->slope_saliency_b;
    m->reactance_d_b = within_b(scaled_multiply(w_b, flux->d_b));
    m->reactance_q_b = within_b(scaled_multiply(w_b, flux->q_b));
    if (m->saliency_b == 0) {
        m->x_per_airgap_q23 =
            scaled_multiply(m->constants->torque_inverse_q24, scaled_ratio(1 << 23, m->flux_b));
    }
    m->emf_b = within_b(scaled_multiply(w_b, m->flux_b));
    if (conductance > 0) {
        m->cross_d = within_b(scaled_multiply(m->reactance_d_b, conductance));
        m->cross_q = within_b(scaled_multiply(m->reactance_q_b, conductance));
        m->iron_current_b = q_min(scaled_multiply(m->emf_b, conductance), MOST_CURRENT_b);
        m->one_plus_a2 = q_min(SCALED_ONE + scaled_multiply(m->cross_d, m->cross_q), MOST_b);
        m->inverse_one_plus_a2 = scaled_ratio(SCALED_ONE, m->one_plus_a2);
        m->flux_per_x = scaled_multiply(m->saliency_b, m->cross_q);
    }
    m->voltage_q_b = within_b(m->emf_b + scaled_multiply(m->resistance_b, m->iron_current_b));
    m->voltage_q_per_x =
        within_b(scaled_dot(m->resistance_b, m->one_plus_a2, m->reactance_d_b, m->cross_q));
    m->voltage_q_per_d = within_b(m->reactance_d_b + scaled_multiply(m->resistance_b, m->cross_d));
}

motor_model_t motor_model_around(const motor_constants_t *constants, const config_t *config,
                                 int32_t speed_mrad_s, int32_t winding_temperature_cC,
                                 motor_current_t around)
{
    const motor_constants_t *k = constants;
    const config_motor_t *motor = &config->motor;
    const int64_t w_mrad_s = (int64_t)q_abs(speed_mrad_s) * motor->pole_pairs;
    const int32_t w_b = q_min(scaled_shift(q_saturate64(w_mrad_s), k->speed_shift), MOST_CURRENT_b);
    const int32_t rise_cK = q_limit(
        q_subtract(winding_temperature_cC, motor->reference_temperature_cC), LARGEST_RISE_cK);
    const int32_t conductance = conductance_at(k, w_b);
    const flux_t flux = flux_map_present(config) ? flux_around(k, config, w_b, conductance,
                                                               winding_temperature_cC, around)
                                                 : of_constants(k, rise_cK);
    motor_model_t m = {
        .constants = k,
        .config = config,
        .speed_mrad_s = speed_mrad_s,
        .winding_temperature_cC = winding_temperature_cC,
        .speed_b = w_b,
        .resistance_b = at_temperature_b(k->resistance_b, k->resistance_rise_b, rise_cK),
        .one_plus_a2 = SCALED_ONE,
        .inverse_one_plus_a2 = SCALED_ONE,
        .friction_b = friction_b(k, w_b, q_abs(speed_mrad_s)),
    };
    set_flux(&m, &flux, conductance);
    return m;
}

void motor_model_move(motor_model_t *model, motor_current_t around)
{
    if (flux_map_present(model->config)) {
        const int32_t conductance = conductance_at(model->constants, model->speed_b);
        const flux_t flux = flux_around(model->constants, model->config, model->speed_b,
                                        conductance, model->winding_temperature_cC, around);
        set_flux(model, &flux, conductance);
    }
}

motor_model_t motor_model_at(const motor_constants_t *constants, const config_t *config,
                             int32_t speed_mrad_s, int32_t winding_temperature_cC)
{
    const motor_current_t none = {.d_mA = 0, .q_mA = 0};
    return motor_model_around(constants, config, speed_mrad_s, winding_temperature_cC, none);
}

motor_current_t motor_model_current(const motor_model_t *model, motor_point_t at)
{
    const motor_constants_t *k = model->constants;
    const motor_current_t out = {.d_mA = motor_model_current_mA(k, at.d_b),
                                 .q_mA = motor_model_current_mA(k, motor_model_i_q_b(model, at))};
    return out;
}

/* Magnet flux plus the reluctance term (L_d - L_q) i_dt. */
static int32_t flux_at_b(const motor_model_t *model, int32_t d_b, int32_t x_b)
{
    if (model->saliency_b == 0) {
        return model->flux_b;
    }
    /* Below 2^28, so that the product stays below 2^30. */
    const int32_t i_dt_b = d_b + scaled_multiply(model->cross_q, x_b);
    return within_b(model->flux_b + scaled_multiply(model->saliency_b, i_dt_b));
}

int32_t motor_model_airgap_b(const motor_model_t *model, motor_point_t at)
{
    return scaled_multiply(scaled_multiply(flux_at_b(model, at.d_b, at.x_b), at.x_b),
                           model->constants->torque_factor_q24);
}

int32_t motor_model_x_of_airgap_b(const motor_model_t *model, int32_t airgap_b, int32_t d_b)
{
    if (model->saliency_b == 0) {
        const int64_t x_b = ((int64_t)airgap_b * model->x_per_airgap_q23) >> 23;
        return q_saturate26(q_saturate64(x_b));
    }
    /* (flux + change x) x = per_pole: the root that is zero at zero torque. */
    const int32_t per_pole_b = scaled_multiply(airgap_b, model->constants->torque_inverse_q24);
    const int32_t least_b = model->flux_b >> 2;
    const int32_t flux_b = q_max(flux_at_b(model, d_b, 0), least_b);
    const int32_t root_b =
        scaled_root((int64_t)flux_b * flux_b + 4 * (int64_t)model->flux_per_x * per_pole_b);
    const int32_t twice_b = q_max(flux_b + root_b, 2 * least_b);
    return q_saturate26(scaled_ratio(per_pole_b, twice_b >> 1));
}

int32_t motor_model_airgap_per_x(const motor_model_t *model, motor_point_t at)
{
    const int32_t slope_b =
        flux_at_b(model, at.d_b, at.x_b) + scaled_multiply(model->flux_per_x, at.x_b);
    return scaled_multiply(q_max(slope_b, model->flux_b >> 2), model->constants->torque_factor_q24);
}

int32_t motor_model_airgap_per_d(const motor_model_t *model, motor_point_t at)
{
    return scaled_multiply(scaled_multiply(model->saliency_b, at.x_b),
                           model->constants->torque_factor_q24);
}

int32_t motor_model_x_per_d(const motor_model_t *model, motor_point_t at)
{
    const int32_t least_b = model->flux_b >> 2;
    const int32_t slope_b = q_max(
        flux_at_b(model, at.d_b, at.x_b) + scaled_multiply(model->flux_per_x, at.x_b), least_b);
    return within_b(scaled_ratio(-scaled_multiply(model->saliency_b, at.x_b), slope_b));
}

int32_t motor_model_shaft_mNm(const motor_model_t *model, int32_t airgap_b)
{
    const int32_t along_mNm =
        scaled_shift(airgap_b - model->friction_b, -model->constants->torque_shift);
    return model->speed_mrad_s >= 0 ? along_mNm : -q_max(along_mNm, -INT32_MAX);
}

int32_t motor_model_airgap_of_shaft_b(const motor_model_t *model, int32_t shaft_mNm)
{
    const int32_t along_mNm = model->speed_mrad_s >= 0 ? shaft_mNm : -q_max(shaft_mNm, -INT32_MAX);
    const int32_t most_b = 1 << 29;
    return q_limit(scaled_shift(along_mNm, model->constants->torque_shift), most_b) +
           model->friction_b;
}

motor_point_t motor_model_point(const motor_model_t *model, motor_current_t i)
{
    const int32_t along_mA = model->speed_mrad_s >= 0 ? i.q_mA : -q_max(i.q_mA, -INT32_MAX);
    motor_point_t at = {.d_b = motor_model_current_b(model->constants, i.d_mA), .x_b = 0};
    const int32_t i_q_b = motor_model_current_b(model->constants, along_mA);
    at.x_b = q_saturate26(motor_model_x_of_i_q_b(model, i_q_b, at.d_b));
    return at;
}

int32_t motor_model_torque_mNm(const motor_model_t *model, motor_point_t at)
{
    return motor_model_shaft_mNm(model, motor_model_airgap_b(model, at));
}

/* Three halves of a power, over the bus voltage. */
static int32_t bus_current_mA(const motor_constants_t *k, int64_t power_b, int32_t bus_mV)
{
    const int32_t bus_b = q_max(scaled_shift(bus_mV, k->voltage_shift), 1);
    return motor_model_current_mA(k, scaled_ratio(q_saturate64((power_b * 3) >> 1), bus_b));
}

int32_t motor_model_bus_current_mA(const motor_model_t *model, motor_point_t at, int32_t bus_mV)
{
    const motor_constants_t *k = model->constants;
    const int32_t i_q_b = motor_model_i_q_b(model, at);
    const int32_t u_d_b =
        motor_model_u_d_b(model, at) + scaled_multiply(k->loss_resistance_b, at.d_b);
    const int32_t u_q_b =
        motor_model_u_q_b(model, at) + scaled_multiply(k->loss_resistance_b, i_q_b);
    return bus_current_mA(k, ((int64_t)u_d_b * at.d_b + (int64_t)u_q_b * i_q_b) >> 24, bus_mV);
}

int32_t motor_model_switching_current_mA(const motor_model_t *model, motor_point_t at,
                                         int32_t bus_mV)
{
    const motor_constants_t *k = model->constants;
    const int32_t magnitude_b = motor_model_magnitude_b(at.d_b, motor_model_i_q_b(model, at));
    return bus_current_mA(k, scaled_multiply(k->loss_b, magnitude_b), bus_mV);
}
