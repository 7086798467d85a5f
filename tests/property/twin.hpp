/* SPDX-License-Identifier: Apache-2.0 */
/*
 * twin.hpp: the fast loop in double precision, from the equations and not from the code: what
 * every kernel would give with real numbers. Quantities keep the units of the fixed-point side (LSB
 * of Q15, counts), so that a difference is an error in LSB.
 */
#pragma once

#include <Eigen/Dense>
#include <array>

#include "kernels.h"

namespace twin {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double PI = 3.14159265358979323846;
constexpr double ONE = 32768.0;

inline Vector2d vector(pair_t x)
{
    return {static_cast<double>(x.x), static_cast<double>(x.y)};
}

inline Vector3d vector(triple_t x)
{
    return {static_cast<double>(x.a), static_cast<double>(x.b), static_cast<double>(x.c)};
}

inline double radians(double turns_q16)
{
    return turns_q16 * 2.0 * PI / 65536.0;
}

// Stator frame to phases and back, amplitude-invariant.
Vector3d phases(const Vector2d &ab);
Vector2d clarke(const Vector3d &phases);
// Into the rotor frame of an angle, and out of it.
Vector2d park(const Vector2d &ab, double angle);
// Both components, as packed vectors are.
Vector2d saturated(const Vector2d &v);
Vector2d inverse_park(const Vector2d &dq, double angle);

// Two phases measured, the one with the longest on-time worked out from them; a tie goes to the
// earlier phase. Stator frame; alpha holds 16 bits, b - c 17.
Vector2d sense(const uint16_t codes[3], const int32_t offset_q4[3], const int32_t on_q16[3]);

struct Gains {
    double proportional, integral, anti_windup;
    explicit Gains(kernel_pi_gains_t gains)
        : proportional(gains.proportional_q10 / 1024.0), integral(gains.integral_q15 / ONE),
          anti_windup(gains.anti_windup_q15 / ONE)
    {
    }
};

struct Tuning {
    Gains d, q;
    double w_l_d, w_l_q;         // modulation units
    double forward_d, forward_q; // LSB
    double advance;              // rad
    explicit Tuning(const kernel_tuning_t &tuning);
};

struct Voltage {
    Vector2d wanted, realised;
    Vector2d integrator; // afterwards, LSB
};

// Regulators, decoupling, circle with d first, self-conditioning with what was realised.
Voltage current_loop(const Vector2d &integrator, const Tuning &tuning, const Vector2d &reference,
                     const Vector2d &i);

// Line voltages ab, bc, ca in counts: one modulation unit is unit_counts between two lines.
Vector3d lines(const Vector3d &phase_counts);
Vector3d modulate(const Vector2d &u, double unit_counts);

// Trim of each phase in counts.
Vector3d dead_time(const Vector2d &i, double full_counts, double zone);

struct Loop {
    Vector2d i_dq;
    Voltage voltage;
    Vector3d line_counts;
};

// From codes to line voltages.
Loop loop(const kernel_loop_t &before, const Tuning &tuning, const uint16_t codes[3],
          double theta_turn, const Vector2d &reference, double zone);

} // namespace twin
