/* SPDX-License-Identifier: Apache-2.0 */
#include "circuit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace circuit {

namespace {

constexpr int STEPS = 60;
constexpr double FEASIBLE = 1e-9;

// Two currents and at most two active constraints.
constexpr int UNKNOWNS = 4;
using System = Eigen::Matrix<double, UNKNOWNS, UNKNOWNS>;
using Unknowns = Eigen::Matrix<double, UNKNOWNS, 1>;

// Gaussian elimination with full pivoting of the first `count` equations. Unknowns that they do not
// determine are zero. In plain loops: the compiler needs twenty seconds for Eigen's decomposition.
Unknowns solution(System a, Unknowns b, int count)
{
    int place[UNKNOWNS] = {0, 1, 2, 3}; // of each column
    int rank = 0;
    double largest = 0.0;
    for (; rank < count; rank++) {
        int row = rank, column = rank;
        for (int r = rank; r < count; r++) {
            for (int c = rank; c < count; c++) {
                if (std::abs(a(r, c)) > std::abs(a(row, column))) {
                    row = r;
                    column = c;
                }
            }
        }
        const double pivot = std::abs(a(row, column));
        largest = std::max(largest, pivot);
        if (!(pivot > largest * count * std::numeric_limits<double>::epsilon())) {
            break;
        }
        for (int c = 0; c < count; c++) {
            std::swap(a(rank, c), a(row, c));
        }
        std::swap(b[rank], b[row]);
        for (int r = 0; r < count; r++) {
            std::swap(a(r, rank), a(r, column));
        }
        std::swap(place[rank], place[column]);
        for (int r = rank + 1; r < count; r++) {
            const double factor = a(r, rank) / a(rank, rank);
            for (int c = rank + 1; c < count; c++) {
                a(r, c) -= factor * a(rank, c);
            }
            b[r] -= factor * b[rank];
        }
    }
    Unknowns x = Unknowns::Zero();
    for (int r = rank - 1; r >= 0; r--) {
        double rest = b[r];
        for (int c = r + 1; c < rank; c++) {
            rest -= a(r, c) * x[place[c]];
        }
        x[place[r]] = rest / a(r, r);
    }
    return x;
}

// A form of y where y = slope x + offset.
Form substituted(const Form &form, const Matrix2d &slope, const Vector2d &offset)
{
    Form out;
    out.square = slope.transpose() * form.square * slope;
    out.linear = slope.transpose() * (2.0 * form.square * offset + form.linear);
    out.constant = offset.dot(form.square * offset) + form.linear.dot(offset) + form.constant;
    return out;
}

Form square_of_length(double factor)
{
    Form out;
    out.square = factor * Matrix2d::Identity();
    return out;
}

// Newton's method for the point at which the gradients balance and the active constraints are zero.
std::optional<Vector2d> stationary(const Form &objective, const std::vector<const Form *> &active,
                                   const Vector2d &start, double scale)
{
    const int count = static_cast<int>(active.size());
    Vector2d x = start;
    double multipliers[2] = {0.0, 0.0};
    const double size =
        std::abs(objective(start)) + objective.gradient(start).norm() * scale + 1e-300;
    for (int step = 0; step < STEPS; step++) {
        System system = System::Zero();
        Unknowns rest = Unknowns::Zero();
        Matrix2d curvature = objective.curvature(x) / size;
        Vector2d balance = objective.gradient(x) / size;
        for (int k = 0; k < count; k++) {
            const Form &constraint = *active[static_cast<size_t>(k)];
            const Vector2d gradient = constraint.gradient(x);
            curvature += multipliers[k] * constraint.curvature(x);
            balance += multipliers[k] * gradient;
            rest[2 + k] = -constraint(x);
            for (int axis = 0; axis < 2; axis++) {
                system(axis, 2 + k) = system(2 + k, axis) = scale * gradient[axis];
            }
        }
        for (int axis = 0; axis < 2; axis++) {
            system(axis, 0) = scale * scale * curvature(axis, 0);
            system(axis, 1) = scale * scale * curvature(axis, 1);
            rest[axis] = -scale * balance[axis];
        }
        const Unknowns move = solution(system, rest, 2 + count);
        const double length = std::hypot(move[0], move[1]);
        if (!move.allFinite() || length > 1e3) {
            return std::nullopt;
        }
        x += scale * Vector2d(move[0], move[1]);
        for (int k = 0; k < count; k++) {
            multipliers[k] += move[2 + k];
        }
        if (length < 1e-13) {
            return rest.norm() < 1e-9 ? std::optional<Vector2d>(x) : std::nullopt;
        }
    }
    return std::nullopt;
}

std::vector<std::vector<size_t>> subsets(size_t count, size_t most)
{
    std::vector<std::vector<size_t>> out = {{}};
    for (size_t a = 0; a < count && most >= 1; a++) {
        out.push_back({a});
        for (size_t b = a + 1; b < count && most >= 2; b++) {
            out.push_back({a, b});
        }
    }
    return out;
}

} // namespace

double Form::operator()(const Vector2d &x) const
{
    return x.dot(square * x) + linear.dot(x) + constant + length * x.norm();
}

Vector2d Form::gradient(const Vector2d &x) const
{
    const double norm = x.norm();
    const Vector2d along = norm > 0.0 ? Vector2d(length / norm * x) : Vector2d(Vector2d::Zero());
    return (square + square.transpose()) * x + linear + along;
}

Matrix2d Form::curvature(const Vector2d &x) const
{
    const double norm = x.norm();
    Matrix2d out = square + square.transpose();
    if (length != 0.0 && norm > 0.0) {
        const Vector2d unit = x / norm;
        out += length / norm * (Matrix2d::Identity() - unit * unit.transpose());
    }
    return out;
}

Form operator*(double factor, const Form &form)
{
    Form out;
    out.square = factor * form.square;
    out.linear = factor * form.linear;
    out.constant = factor * form.constant;
    out.length = factor * form.length;
    return out;
}

Form operator+(const Form &a, const Form &b)
{
    Form out;
    out.square = a.square + b.square;
    out.linear = a.linear + b.linear;
    out.constant = a.constant + b.constant;
    out.length = a.length + b.length;
    return out;
}

Form operator+(const Form &form, double constant)
{
    Form out = form;
    out.constant += constant;
    return out;
}

Circuit::Circuit(const values::Drive &drive, double speed_rad_s, double winding_temperature_C)
    : direction_(speed_rad_s < 0.0 ? -1.0 : 1.0), current_scale_A_(drive.max_current_A)
{
    const double rise_K = winding_temperature_C - drive.reference_temperature_C;
    const double resistance = drive.resistance_ohm * (1.0 + drive.resistance_per_K * rise_K);
    const double flux = drive.flux_Wb * (1.0 + drive.flux_per_K * rise_K);
    const double omega = drive.pole_pairs * speed_rad_s;
    const double iron_S = 1.0 / (drive.iron_ohm + drive.iron_ohm_s * std::abs(omega));

    Matrix2d reactance;
    reactance << 0.0, -omega * drive.q_inductance_H, omega * drive.d_inductance_H, 0.0;
    const Vector2d emf(0.0, omega * flux);
    const Matrix2d slope = (Matrix2d::Identity() + iron_S * reactance).inverse();
    const Vector2d offset = slope * (-iron_S * emf);
    const Matrix2d inner_slope = reactance * slope;
    const Vector2d inner_offset = reactance * offset + emf;
    voltage_slope_ = resistance * Matrix2d::Identity() + inner_slope;
    voltage_offset_ = inner_offset;
    iron_current_A_ = iron_S * omega * flux;

    const double saliency = drive.d_inductance_H - drive.q_inductance_H;
    Form of_torque_current;
    of_torque_current.square << 0.0, 0.5 * saliency, 0.5 * saliency, 0.0;
    of_torque_current.linear << 0.0, flux;
    torque_Nm = substituted(1.5 * drive.pole_pairs * of_torque_current, slope, offset);
    copper_W = square_of_length(1.5 * resistance);
    iron_W = substituted(square_of_length(1.5 * iron_S), inner_slope, inner_offset);
    current_square_A2 = square_of_length(1.0);
    voltage_square_V2 = substituted(square_of_length(1.0), voltage_slope_, voltage_offset_);

    // Conduction by switches and, during the dead time, by diodes; switching loss in proportion to
    // current.
    const double dead = 2.0 * drive.dead_time_s * drive.pwm_Hz;
    inverter_W = square_of_length(1.5 * (drive.switch_ohm * (1.0 - dead) + drive.diode_ohm * dead));
    inverter_W.length = 6.0 / PI * drive.diode_V * dead +
                        3.0 / PI * drive.pwm_Hz * (drive.turn_on_J_per_A + drive.turn_off_J_per_A);

    Form terminal; // 1.5 u' i
    terminal.square = 0.75 * (voltage_slope_ + voltage_slope_.transpose());
    terminal.linear = 1.5 * voltage_offset_;
    dc_power_W = terminal + inverter_W;
}

std::optional<Vector2d> Circuit::best_without_d_current() const
{
    Form no_d; // i_d = 0
    no_d.linear << 1.0 / current_scale_A_, 0.0;
    const Vector2d start(0.0, -direction_ * current_scale_A_);
    const auto found = stationary(dc_power_W, {&no_d}, start, current_scale_A_);
    if (!found || (*found)[1] * direction_ >= 0.0 || dc_power_W(*found) >= 0.0) {
        return std::nullopt;
    }
    return found;
}

std::optional<Vector2d> Circuit::of_torque_without_d_current(double torque_Nm_) const
{
    Vector2d x(0.0, iron_current_A_);
    for (int step = 0; step < STEPS; step++) {
        const double move = (torque_Nm_ - torque_Nm(x)) / torque_Nm.gradient(x)[1];
        x[1] += move;
        if (std::abs(move) < 1e-13 * current_scale_A_) {
            return x;
        }
    }
    return std::nullopt;
}

Pack pack(const values::Drive &drive, double power_W)
{
    double current_A = 0.0;
    for (int step = 0; step < 1000; step++) {
        current_A = power_W / (drive.open_circuit_V - drive.pack_ohm * current_A);
    }
    return {current_A, drive.open_circuit_V * current_A, drive.pack_ohm * current_A * current_A};
}

std::optional<Minimum> minimum(const Form &objective, const std::vector<Form> &atMost,
                               const std::vector<Form> &zero, double scale, int starts)
{
    std::optional<Minimum> best;
    const auto consider = [&](const Vector2d &x) {
        const auto broken = [&](const Form &form) { return form(x) > FEASIBLE; };
        const auto off = [&](const Form &form) { return std::abs(form(x)) > FEASIBLE; };
        const double value = objective(x);
        if (std::none_of(atMost.begin(), atMost.end(), broken) &&
            std::none_of(zero.begin(), zero.end(), off) && (!best || value < best->value)) {
            best = Minimum{x, value};
        }
    };
    consider(Vector2d::Zero());
    for (const auto &subset : subsets(atMost.size(), 2 - std::min<size_t>(zero.size(), 2))) {
        std::vector<const Form *> active;
        for (const Form &form : zero) {
            active.push_back(&form);
        }
        for (const size_t index : subset) {
            active.push_back(&atMost[index]);
        }
        for (int k = 0; k < starts; k++) {
            // A spiral of starting points over the circle of that size, no two in one direction;
            // every second one close to zero current, where the switching loss has its kink.
            const double angle = 2.399963 * k + 0.1;
            const double length = scale * std::pow((k + 0.5) / starts, k % 2 == 0 ? 0.5 : 3.0);
            const auto found = stationary(
                objective, active, length * Vector2d(std::cos(angle), std::sin(angle)), scale);
            if (found) {
                consider(*found);
            }
        }
    }
    return best;
}

} // namespace circuit
