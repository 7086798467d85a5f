/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bench.hpp: a permanent-magnet motor, a bridge and sensors in double precision around the fast
 * reach under test.
 *
 * Timing as on the board: currents are sampled at the beginning of a period, the compare values
 * worked out from them act during the next one, and so does the bridge mode. The bridge is averaged
 * over a period; its voltage is constant in the stator frame while the rotor turns. Converters
 * have 12 bits. The motor is integrated by fourth-order Runge-Kutta steps of a tenth of a period,
 * whose error is far below an LSB. Every effect that is not named by a parameter is absent.
 */
#pragma once

#include <Eigen/Dense>
#include <memory>

#include "loop.h"

namespace bench {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double PI = 3.14159265358979323846;

struct Plant {
    double resistance_ohm; // winding
    double winding_C;      // what the thermistor says
    double d_inductance_H;
    double q_inductance_H;
    double flux_Wb;
    double v_dc_V;
    double speed_rad_s; // electrical
    double dead_time_s = 0.0;
    double diode_forward_voltage_V = 0.0;
    double switch_resistance_ohm = 0.0;
    Vector3d sensor_offset = Vector3d::Zero(); // of the three current sensors, share of full scale
};

// The motor of a configuration at a winding temperature, as the plant: parameters equal to those of
// the controller, ideal switches.
Plant plant_of(const config_t &config, double winding_temperature_C, double v_dc_V,
               double speed_rpm);
// The same with the paper's bridge (tools/motors/lu2013.toml): 1 us of dead time, 0.8 V diodes, 3.3
// mOhm switches.
Plant with_bridge(Plant plant);

// The paper's configuration with an absolute angle, so that only the current loop is in question;
// without compensation its dead time and diode drop are zero.
config_t paper_config(bool dead_time_compensation);

// The same firmware behind a current converter of a `factor` times smaller range: its gains in
// volts per ampere stay, the rounding of the converter shrinks.
config_t with_finer_converter(config_t config, int32_t factor);

enum class Mode { off, pwm, shorted };

constexpr int SETTLE_PERIODS =
    2000; // 100 ms: the angle's tracking loop (50 Hz, damping 1) forgets where it started

class Bench {
  public:
    Bench(const config_t &config, const Plant &plant, double theta_rad = 0.0);

    void set_reference(double i_d_A, double i_q_A);
    // One PWM period. Returns what the loop said; currents below are those at its sample.
    loop_output_t step(Mode mode = Mode::pwm);
    void run(int periods, Mode mode = Mode::pwm);
    // Offsets of the current sensors, with the bridge off.
    void calibrate();

    double i_d() const { return sampled_.x(); } // of the last sample, true, A
    double i_q() const { return sampled_.y(); }
    Vector2d current() const { return sampled_; }
    Vector3d phase_currents() const;        // now
    double theta() const { return theta_; } // now, electrical rad
    double period_s() const { return period_s_; }
    double current_base_A() const { return current_base_A_; }
    double torque_Nm() const; // at the last sample

    Plant plant; // may be changed between steps

  private:
    void integrate();

    config_t config_;
    std::unique_ptr<loop_t, decltype(&loop_free)> loop_;
    double period_s_;
    double current_base_A_;
    Vector2d i_ = Vector2d::Zero(); // dq, A
    Vector2d sampled_ = Vector2d::Zero();
    double theta_;
    Vector3d duty_ = Vector3d::Constant(0.5);
    Vector3d next_duty_ = Vector3d::Constant(0.5);
    Mode mode_ = Mode::off;
    Mode next_mode_ = Mode::off;
};

} // namespace bench
