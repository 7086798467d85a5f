/*
 * bench.hpp: a permanent-magnet motor, a bridge and ideal sensors in double precision around the fast reach under test.
 *
 * Timing as on the board: currents are sampled at the beginning of a period, the compare values worked out from them act
 * during the next one. The bridge is averaged over a period; its voltage stands still in the stator frame while the rotor
 * turns. The motor is integrated by fourth-order Runge-Kutta steps of a tenth of a period, whose error is far below an
 * LSB. Every effect that is not named by a parameter is absent.
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
    double resistance_ohm;
    double d_inductance_H;
    double q_inductance_H;
    double flux_Wb;
    double v_dc_V;
    double speed_rad_s; // electrical
    double dead_time_s = 0.0;
    bool quantised = true; // converters of 12 bits; otherwise currents reach the loop with 1/16 code resolution
};

// The motor of a configuration at a winding temperature, as the plant: what the controller believes is true.
Plant plant_of(const config_t &config, double winding_temperature_C, double v_dc_V, double speed_rpm);

class Bench {
  public:
    Bench(const config_t &config, const Plant &plant);

    void set_reference(double i_d_A, double i_q_A);
    // One PWM period. Returns what the loop said; currents below are those at its sample.
    loop_output_t step(bool run = true);
    void run(int periods, bool regulate = true);

    double i_d() const { return sampled_.x(); } // of the last sample, true, A
    double i_q() const { return sampled_.y(); }
    Vector3d phase_currents() const;        // now
    double theta() const { return theta_; } // now, electrical rad
    double period_s() const { return period_s_; }
    double current_base_A() const { return current_base_A_; }
    double mean_torque_Nm(int periods, bool regulate = true);

    Plant plant; // may be changed between steps

  private:
    Vector2d derivative(const Vector2d &i, double theta) const;
    void integrate();

    config_t config_;
    std::unique_ptr<loop_t, decltype(&loop_free)> loop_;
    double period_s_;
    double current_base_A_;
    Vector2d i_ = Vector2d::Zero(); // dq, A
    Vector2d sampled_ = Vector2d::Zero();
    double theta_ = 0.0;
    Vector3d duty_ = Vector3d::Constant(0.5);
    Vector3d next_duty_ = Vector3d::Constant(0.5);
    bool bridge_on_ = false;
    bool bridge_next_ = false;
};

} // namespace bench
