/* SPDX-License-Identifier: Apache-2.0 */
/*
 * circuit.hpp: a drive's steady state as quadratic forms of its two terminal currents, and their
 * constrained minima.
 *
 * Written from the circuit laws alone, as a measure for the closed forms and searches of
 * tools/regen_table and for the tables that the firmware reads. Peak phase quantities (A, V, Wb),
 * mechanical rad/s, N m, W; motor signs. With i_t the current that the iron-loss branch leaves,
 *
 *     i = i_t + v / R_i        v = X i_t + e        u = R i + v        X = omega [0 -L_q; L_d 0]
 *     e = omega (0, psi)
 *
 * is a linear system, solved as one; torque, powers, |i|^2 and |u|^2 are then quadratic in i, but
 * for the bridge's loss that goes with |i|. What is smallest under limits is found by Newton's
 * method on the conditions of Karush, Kuhn and Tucker of every set of limits that can be met
 * exactly, from many starting points.
 */
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "optimum_values.hpp"

namespace circuit {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double PI = 3.14159265358979323846;

// x' square x + linear' x + constant + length |x|
struct Form {
    Matrix2d square = Matrix2d::Zero();
    Vector2d linear = Vector2d::Zero();
    double constant = 0.0;
    double length = 0.0;

    double operator()(const Vector2d &x) const;
    Vector2d gradient(const Vector2d &x) const;
    Matrix2d curvature(const Vector2d &x) const;
};

Form operator*(double factor, const Form &form);
Form operator+(const Form &a, const Form &b);
Form operator+(const Form &form, double constant);

// A drive at a mechanical speed and a winding temperature. The argument of every form is (i_d,
// i_q).
class Circuit {
  public:
    Circuit(const values::Drive &drive, double speed_rad_s, double winding_temperature_C);

    Form torque_Nm;
    Form dc_power_W;
    Form copper_W;
    Form iron_W;
    Form inverter_W;
    Form current_square_A2;
    Form voltage_square_V2;

    Vector2d voltage_V(const Vector2d &i) const { return voltage_slope_ * i + voltage_offset_; }
    double direction() const { return direction_; } // of rotation

    // (0, i_q) of most returned power; nothing if no torque returns any.
    std::optional<Vector2d> best_without_d_current() const;
    // (0, i_q) of a torque, the root next to the iron-loss current.
    std::optional<Vector2d> of_torque_without_d_current(double torque_Nm) const;

  private:
    Matrix2d voltage_slope_;
    Vector2d voltage_offset_;
    double direction_;
    double iron_current_A_;
    double current_scale_A_;
};

// Battery at the sum of all motors' power: current by fixed-point iteration of u_b = u_oc - R i_b.
struct Pack {
    double current_A, chemical_W, loss_W;
};
Pack pack(const values::Drive &drive, double power_W);

// Smallest value of `objective` where every `atMost` is <= 0 and every `zero` is 0; nothing if
// there is no such point. scale: size of the currents. Constraints are of order one where they are
// broken by as much as they allow.
struct Minimum {
    Vector2d at;
    double value;
};
std::optional<Minimum> minimum(const Form &objective, const std::vector<Form> &atMost,
                               const std::vector<Form> &zero, double scale, int starts);

} // namespace circuit
