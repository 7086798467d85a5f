/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/inverter.h"

#include "plant/numbers.h"

/* Coldest switches of a broken scenario still conduct like switches. */
static const double LEAST_SHARE = 0.05;

inverter_t inverter_model(const inverter_params_t *params, double switch_temperature_c)
{
    const double rise_k = switch_temperature_c - params->switch_reference_temperature_c;
    const double share = 1.0 + params->switch_resistance_temperature_coefficient_per_k * rise_k;
    const double switch_ohm = params->switch_resistance_ohm * plant_max(share, LEAST_SHARE);
    const double delta = 2.0 * params->dead_time_s * params->pwm_frequency_hz;
    const inverter_t out = {
        .period_s = 1.0 / params->pwm_frequency_hz,
        .dead_share = delta,
        .pwm_resistance_ohm = switch_ohm * (1.0 - delta) + params->diode_resistance_ohm * delta,
        .short_resistance_ohm = switch_ohm,
        .diode_resistance_ohm = params->diode_resistance_ohm,
        .forward_voltage_v = params->diode_forward_voltage_v,
        .switching_loss_j_per_as = 0.5 *
                                   (params->turn_on_loss_j_per_a + params->turn_off_loss_j_per_a) *
                                   params->pwm_frequency_hz,
    };
    return out;
}

static double error_v(const inverter_t *inverter, double bus_voltage_v)
{
    return inverter->dead_share * (0.5 * bus_voltage_v + inverter->forward_voltage_v);
}

double inverter_zone_a(const inverter_t *inverter, double bus_voltage_v, double amperes_per_volt)
{
    return error_v(inverter, bus_voltage_v) * amperes_per_volt;
}

inverter_drive_t inverter_drive(const inverter_t *inverter, plant_abc_t duty, double bus_voltage_v,
                                double zone_a)
{
    const plant_ab_t duties = plant_clarke(duty);
    const inverter_drive_t out = {
        .legs = {.alpha = bus_voltage_v * duties.alpha, .beta = bus_voltage_v * duties.beta},
        .opposition = {.volts = error_v(inverter, bus_voltage_v), .zone_a = zone_a},
        .shifted_v = inverter->dead_share * 0.5 * bus_voltage_v,
        .drop_v = inverter->dead_share * inverter->forward_voltage_v,
    };
    return out;
}

static inline double energy_j(plant_ab_t u, plant_ab_t charge_as)
{
    return 1.5 * (u.alpha * charge_as.alpha + u.beta * charge_as.beta);
}

inverter_flow_t inverter_pwm_flow(const inverter_t *inverter, const inverter_drive_t *drive,
                                  const pmsm_flow_t *flow)
{
    const double switching_j = inverter->switching_loss_j_per_as * flow->rectified_as;
    const inverter_flow_t out = {
        .dc_j = energy_j(drive->legs, flow->charge_as) - drive->shifted_v * flow->opposed_as +
                switching_j,
        .conduction_j = flow->series_j,
        .diode_j = drive->drop_v * flow->opposed_as,
        .switching_j = switching_j,
    };
    return out;
}

double inverter_rectifier_ceiling_v(const inverter_t *inverter, double bus_voltage_v)
{
    return (bus_voltage_v + 2.0 * inverter->forward_voltage_v) * PLANT_INV_SQRT3;
}

inverter_flow_t inverter_rectifier_flow(const inverter_t *inverter, double bus_voltage_v,
                                        const pmsm_flow_t *flow)
{
    const double dc_share = bus_voltage_v / (bus_voltage_v + 2.0 * inverter->forward_voltage_v);
    const inverter_flow_t out = {
        .dc_j = flow->source_j * dc_share,
        .conduction_j = flow->series_j,
        .diode_j = -flow->source_j * (1.0 - dc_share),
        .switching_j = 0.0,
    };
    return out;
}

inverter_flow_t inverter_short_flow(const pmsm_flow_t *flow)
{
    const inverter_flow_t out = {
        .dc_j = 0.0, .conduction_j = flow->series_j, .diode_j = 0.0, .switching_j = 0.0};
    return out;
}
