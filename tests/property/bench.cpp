#include "bench.hpp"

#include <algorithm>
#include <cmath>

namespace bench {

namespace {

constexpr int SUBSTEPS = 10;

Vector3d phases_of(const Vector2d &dq, double theta)
{
    Vector3d out;
    for (int x = 0; x < 3; x++) {
        const double angle = theta - 2.0 * PI / 3.0 * x;
        out[x] = dq.x() * std::cos(angle) - dq.y() * std::sin(angle);
    }
    return out;
}

Vector2d dq_of(const Vector3d &phases, double theta)
{
    Vector2d out = Vector2d::Zero();
    for (int x = 0; x < 3; x++) {
        const double angle = theta - 2.0 * PI / 3.0 * x;
        out += 2.0 / 3.0 * phases[x] * Vector2d(std::cos(angle), -std::sin(angle));
    }
    return out;
}

uint16_t code_of(double x, bool quantised)
{
    const double code = std::clamp(x, 0.0, 4095.0);
    return static_cast<uint16_t>(quantised ? std::lround(code) : std::lround(code));
}

} // namespace

Plant plant_of(const config_t &config, double winding_temperature_C, double v_dc_V, double speed_rpm)
{
    const config_motor_t &motor = config.motor;
    const double rise_K = winding_temperature_C - motor.reference_temperature_cC / 100.0;
    Plant plant{};
    plant.resistance_ohm =
        motor.phase_resistance_uOhm * 1e-6 * (1.0 + motor.resistance_coefficient_ppm_K * 1e-6 * rise_K);
    plant.d_inductance_H = motor.d_inductance_nH * 1e-9;
    plant.q_inductance_H = motor.q_inductance_nH * 1e-9;
    plant.flux_Wb = motor.flux_linkage_nWb * 1e-9;
    plant.v_dc_V = v_dc_V;
    plant.speed_rad_s = speed_rpm / 60.0 * 2.0 * PI * motor.pole_pairs;
    return plant;
}

Bench::Bench(const config_t &config, const Plant &plant_parameters)
    : plant(plant_parameters), config_(config), loop_(loop_new(&config), &loop_free),
      period_s_(1.0 / config.drive.pwm_frequency_Hz), current_base_A_(config.drive.current_full_scale_mA * 1e-3)
{
}

void Bench::set_reference(double i_d_A, double i_q_A)
{
    loop_set_reference(loop_.get(), static_cast<int32_t>(std::lround(i_d_A / current_base_A_ * 32768.0)),
                       static_cast<int32_t>(std::lround(i_q_A / current_base_A_ * 32768.0)));
}

Vector3d Bench::phase_currents() const
{
    return phases_of(i_, theta_);
}

Vector2d Bench::derivative(const Vector2d &i, double theta) const
{
    Vector3d leg_V = (duty_.array() - 0.5) * plant.v_dc_V;
    if (plant.dead_time_s > 0.0) {
        const double lost_V = plant.dead_time_s / period_s_ * plant.v_dc_V;
        // The lost voltage cannot carry a current beyond zero: within one period it takes away this much.
        const double zone_A = lost_V * period_s_ / plant.q_inductance_H;
        const Vector3d current = phases_of(i, theta);
        for (int x = 0; x < 3; x++) {
            leg_V[x] -= lost_V * std::clamp(current[x] / zone_A, -1.0, 1.0);
        }
    }
    const Vector2d u = dq_of(leg_V, theta);
    const double w = plant.speed_rad_s;
    return {(u.x() - plant.resistance_ohm * i.x() + w * plant.q_inductance_H * i.y()) / plant.d_inductance_H,
            (u.y() - plant.resistance_ohm * i.y() - w * (plant.d_inductance_H * i.x() + plant.flux_Wb)) /
                plant.q_inductance_H};
}

void Bench::integrate()
{
    const double h = period_s_ / SUBSTEPS;
    for (int n = 0; n < SUBSTEPS; n++) {
        if (bridge_on_) {
            const double half_turned = theta_ + plant.speed_rad_s * h / 2.0;
            const double turned = theta_ + plant.speed_rad_s * h;
            const Vector2d k1 = derivative(i_, theta_);
            const Vector2d k2 = derivative(i_ + h / 2.0 * k1, half_turned);
            const Vector2d k3 = derivative(i_ + h / 2.0 * k2, half_turned);
            const Vector2d k4 = derivative(i_ + h * k3, turned);
            i_ += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        } else {
            i_.setZero(); // below the rectifying speed a bridge that is off carries nothing
        }
        theta_ = std::fmod(theta_ + plant.speed_rad_s * h, 2.0 * PI);
    }
}

loop_output_t Bench::step(bool run)
{
    sampled_ = i_;
    const Vector3d phase = phase_currents();
    loop_input_t in{};
    for (int x = 0; x < 3; x++) {
        in.phase_code[x] = code_of(2048.0 + phase[x] / current_base_A_ * 2048.0, plant.quantised);
    }
    in.bus_code = code_of(plant.v_dc_V / (config_.drive.voltage_full_scale_mV * 1e-3) * 4096.0, plant.quantised);
    const double turns = theta_ / (2.0 * PI);
    in.rotor_angle_turn = static_cast<uint16_t>(std::lround((turns - std::floor(turns)) * 65536.0) & 0xFFFF);
    const int sector = static_cast<int>(std::floor((turns - std::floor(turns)) * 6.0)) % 6;
    static const uint8_t HALL[6] = {5, 1, 3, 2, 6, 4};
    in.hall_state = HALL[sector];

    const loop_output_t out = loop_step(loop_.get(), &in, run);
    duty_ = next_duty_;
    bridge_on_ = bridge_next_;
    for (int x = 0; x < 3; x++) {
        next_duty_[x] = static_cast<double>(out.compare_counts[x]) / config_.drive.pwm_period_counts;
    }
    bridge_next_ = run;
    integrate();
    return out;
}

void Bench::run(int periods, bool regulate)
{
    for (int n = 0; n < periods; n++) {
        step(regulate);
    }
}

double Bench::mean_torque_Nm(int periods, bool regulate)
{
    double sum = 0.0;
    for (int n = 0; n < periods; n++) {
        step(regulate);
        sum += 1.5 * config_.motor.pole_pairs *
               (plant.flux_Wb + (plant.d_inductance_H - plant.q_inductance_H) * i_.x()) * i_.y();
    }
    return sum / periods;
}

} // namespace bench
