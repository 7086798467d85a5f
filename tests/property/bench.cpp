/* SPDX-License-Identifier: Apache-2.0 */
#include "bench.hpp"
#include "kernels.h"

#include <algorithm>
#include <cmath>

namespace bench {

namespace {

constexpr int SUBSTEPS = 10;
const double SQRT3_2 = std::sqrt(3.0) / 2.0;

Vector3d phases(const Vector2d &ab)
{
    return {ab.x(), -0.5 * ab.x() + SQRT3_2 * ab.y(), -0.5 * ab.x() - SQRT3_2 * ab.y()};
}

Vector2d clarke(const Vector3d &abc)
{
    return {(2.0 * abc[0] - abc[1] - abc[2]) / 3.0, (abc[1] - abc[2]) / std::sqrt(3.0)};
}

Vector2d to_stator(const Vector2d &dq, double cos, double sin)
{
    return {cos * dq.x() - sin * dq.y(), sin * dq.x() + cos * dq.y()};
}

double limited(double x)
{
    return x > 1.0 ? 1.0 : x < -1.0 ? -1.0 : x;
}

uint16_t code_of(double x)
{
    return static_cast<uint16_t>(std::lround(std::clamp(x, 0.0, 4095.0)));
}

} // namespace

Plant plant_of(const config_t &config, double winding_temperature_C, double v_dc_V,
               double speed_rpm)
{
    const config_motor_t &motor = config.motor;
    const double rise_K = winding_temperature_C - motor.reference_temperature_cC / 100.0;
    Plant plant{};
    plant.resistance_ohm = motor.phase_resistance_uOhm * 1e-6 *
                           (1.0 + motor.resistance_coefficient_ppm_K * 1e-6 * rise_K);
    plant.winding_C = winding_temperature_C;
    plant.d_inductance_H = motor.d_inductance_nH * 1e-9;
    plant.q_inductance_H = motor.q_inductance_nH * 1e-9;
    plant.flux_Wb = motor.flux_linkage_nWb * 1e-9;
    plant.v_dc_V = v_dc_V;
    plant.speed_rad_s = speed_rpm / 60.0 * 2.0 * PI * motor.pole_pairs;
    return plant;
}

Plant with_bridge(Plant plant)
{
    plant.dead_time_s = 1e-6;
    plant.diode_forward_voltage_V = 0.8;
    plant.switch_resistance_ohm = 3.3e-3;
    return plant;
}

config_t paper_config(bool dead_time_compensation)
{
    config_t config = CONFIG_LU2013;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    if (!dead_time_compensation) {
        config.drive.dead_time_ns = 0;
    }
    return config;
}

config_t with_finer_converter(config_t config, int32_t factor)
{
    config_current_loop_t &loop = config.current_loop;
    config.drive.current_full_scale_mA /= factor;
    for (int32_t *per_ampere :
         {&loop.proportional_d_pu_q16, &loop.proportional_q_pu_q16, &loop.integral_d_pu_q24,
          &loop.integral_q_pu_q24, &loop.inductance_d_pu_q16, &loop.inductance_q_pu_q16}) {
        *per_ampere /= factor;
    }
    for (int32_t *ampere : {&loop.max_current_pu_q15, &loop.field_weakening_gain_pu_q15,
                            &loop.field_weakening_current_pu_q15, &loop.dead_time_zone_pu_q15}) {
        *ampere = std::min(*ampere * factor, 32767);
    }
    return config;
}

Bench::Bench(const config_t &config, const Plant &plant_parameters, double theta_rad)
    : plant(plant_parameters), config_(config), loop_(loop_new(&config), &loop_free),
      period_s_(1.0 / config.drive.pwm_frequency_Hz),
      current_base_A_(config.drive.current_full_scale_mA * 1e-3), theta_(theta_rad)
{
    loop_set_winding_temperature(loop_.get(),
                                 static_cast<int32_t>(std::lround(plant.winding_C * 100.0)));
}

void Bench::set_reference(double i_d_A, double i_q_A)
{
    loop_set_reference(loop_.get(),
                       static_cast<int32_t>(std::lround(i_d_A / current_base_A_ * 32768.0)),
                       static_cast<int32_t>(std::lround(i_q_A / current_base_A_ * 32768.0)));
}

void Bench::calibrate()
{
    loop_calibrate_offsets(loop_.get(), true);
    run(1100, Mode::off); // 1024 samples and some
    loop_calibrate_offsets(loop_.get(), false);
}

Vector3d Bench::phase_currents() const
{
    return phases(to_stator(i_, std::cos(theta_), std::sin(theta_)));
}

double Bench::torque_Nm() const
{
    return 1.5 * config_.motor.pole_pairs *
           (plant.flux_Wb + (plant.d_inductance_H - plant.q_inductance_H) * sampled_.x()) *
           sampled_.y();
}

// Runge-Kutta of fourth order in scalars: with sanitizers each access to a vector is a checked
// call, and this takes most of the time of the tests.
void Bench::integrate()
{
    if (mode_ == Mode::off) {
        i_.setZero(); // below the rectifying speed a bridge that is off carries nothing
        theta_ = std::fmod(theta_ + plant.speed_rad_s * period_s_, 2.0 * PI);
        return;
    }
    const double h = period_s_ / SUBSTEPS;
    const double w = plant.speed_rad_s, L_d = plant.d_inductance_H, L_q = plant.q_inductance_H;
    const double resistance = plant.resistance_ohm + plant.switch_resistance_ohm;
    const double emf = w * plant.flux_Wb;
    const Vector2d u =
        mode_ == Mode::pwm ? Vector2d(plant.v_dc_V * clarke(duty_)) : Vector2d::Zero();
    const double u_alpha = u.x(), u_beta = u.y();
    // In both dead intervals of a period a diode conducts: the leg misses half of them at the bus,
    // and the diode's drop. This cannot carry a current beyond zero: within one period it takes
    // away `zone_A`.
    const double dead_share = mode_ == Mode::pwm ? plant.dead_time_s / period_s_ : 0.0;
    const double lost_V = dead_share * (plant.v_dc_V + 2.0 * plant.diode_forward_voltage_V);
    const double zone_A = lost_V * period_s_ / L_q;
    double i_d = i_.x(), i_q = i_.y(), theta = theta_;
    for (int n = 0; n < SUBSTEPS; n++) {
        double rate_d = 0.0, rate_q = 0.0, sum_d = 0.0, sum_q = 0.0, cos = 1.0, sin = 0.0;
        for (int stage = 0; stage < 4; stage++) {
            const double after = stage == 0 ? 0.0 : stage == 3 ? h : h / 2.0;
            if (stage != 2) { // which is at the time of stage 1
                cos = std::cos(theta + w * after);
                sin = std::sin(theta + w * after);
            }
            const double d = i_d + after * rate_d, q = i_q + after * rate_q;
            double alpha = u_alpha, beta = u_beta;
            if (lost_V > 0.0) {
                const double a = cos * d - sin * q, b = SQRT3_2 * (sin * d + cos * q);
                const double lost[3] = {lost_V * limited(a / zone_A),
                                        lost_V * limited((b - 0.5 * a) / zone_A),
                                        lost_V * limited((-b - 0.5 * a) / zone_A)};
                alpha -= (2.0 * lost[0] - lost[1] - lost[2]) / 3.0;
                beta -= (lost[1] - lost[2]) / (2.0 * SQRT3_2);
            }
            rate_d = (cos * alpha + sin * beta - resistance * d + w * L_q * q) / L_d;
            rate_q = (cos * beta - sin * alpha - resistance * q - w * L_d * d - emf) / L_q;
            const double weight = stage == 1 || stage == 2 ? h / 3.0 : h / 6.0;
            sum_d += weight * rate_d;
            sum_q += weight * rate_q;
        }
        i_d += sum_d;
        i_q += sum_q;
        theta = std::fmod(theta + w * h, 2.0 * PI);
    }
    i_ = {i_d, i_q};
    theta_ = theta;
}

loop_output_t Bench::step(Mode mode)
{
    sampled_ = i_;
    const Vector3d phase = phase_currents();
    loop_input_t in{};
    for (int x = 0; x < 3; x++) {
        in.phase_code[x] =
            code_of(2048.0 + (phase[x] / current_base_A_ + plant.sensor_offset[x]) * 2048.0);
    }
    in.bus_code = code_of(plant.v_dc_V / (config_.drive.voltage_full_scale_mV * 1e-3) * 4096.0);
    const double turns = theta_ / (2.0 * PI);
    in.rotor_angle_turn =
        static_cast<uint16_t>(std::lround((turns - std::floor(turns)) * 65536.0) & 0xFFFF);
    const int sector = static_cast<int>(std::floor((turns - std::floor(turns)) * 6.0)) % 6;
    static const uint8_t HALL[6] = {5, 1, 3, 2, 6, 4};
    in.hall_state = HALL[sector];

    const loop_output_t out = loop_step(loop_.get(), &in, mode == Mode::pwm);
    duty_ = next_duty_;
    mode_ = next_mode_;
    for (int x = 0; x < 3; x++) {
        next_duty_[x] =
            static_cast<double>(out.compare_counts[x]) / kernel_pwm_period_counts(&config_);
    }
    next_mode_ = mode;
    integrate();
    return out;
}

void Bench::run(int periods, Mode mode)
{
    for (int n = 0; n < periods; n++) {
        step(mode);
    }
}

} // namespace bench
