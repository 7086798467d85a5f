/* SPDX-License-Identifier: Apache-2.0 */
/*
 * measure.hpp: what the measurements of errors share.
 */
#pragma once

#include <algorithm>
#include <cmath>

#include "property.hpp"
#include "random.hpp"
#include "twin.hpp"

constexpr int32_t LOWEST = -32768;
constexpr int32_t HIGHEST = 32767;
constexpr int32_t INTEGRATOR_LOWEST = -(1 << 30);
constexpr int32_t INTEGRATOR_HIGHEST = (1 << 30) - 1;

struct Largest {
    double value = 0.0;
    void see(double error) { value = std::max(value, std::abs(error)); }
    template <typename Vector> void see(const Eigen::MatrixBase<Vector> &error)
    {
        value = std::max(value, error.cwiseAbs().maxCoeff());
    }
};

inline uint16_t any_angle(Random &random)
{
    return static_cast<uint16_t>(random.any(0, 65535));
}

// A vector of at most `most` in any direction, its full length often.
inline pair_t inside_circle(Random &random, double most = twin::ONE - 1.0)
{
    const double length = random.bits() % 4U == 0U ? most : most * std::sqrt(random.real(0.0, 1.0));
    const double angle = random.real(0.0, 2.0 * twin::PI);
    return {static_cast<int32_t>(length * std::cos(angle)),
            static_cast<int32_t>(length * std::sin(angle))};
}

// Phases within 16 bits that add up to zero.
inline triple_t balanced_phases(Random &random)
{
    for (;;) {
        const int32_t a = random.any(LOWEST, HIGHEST);
        const int32_t b = random.any(LOWEST, HIGHEST);
        const int32_t c = -(a + b);
        if (c >= LOWEST && c <= HIGHEST) {
            return {a, b, c};
        }
    }
}

// What Park makes of such phases at any angle: up to 1.15 long.
inline pair_t measured_dq(Random &random)
{
    return kernel_park(kernel_clarke(balanced_phases(random)), kernel_cos_sin(any_angle(random)));
}

inline kernel_pi_gains_t any_gains(Random &random)
{
    return {random.any(1, kernel_pi_largest_proportional_q10()),
            random.any(1, kernel_pi_largest_integral_q15()),
            random.any(1, kernel_pi_largest_anti_windup_q15())};
}

inline pair_t any_integrators(Random &random)
{
    return {random.any(INTEGRATOR_LOWEST, INTEGRATOR_HIGHEST),
            random.any(INTEGRATOR_LOWEST, INTEGRATOR_HIGHEST)};
}

// Any tuning that fits its formats; an eighth of a turn of advance is 1.5 periods at 1.3 times the
// base of speed.
inline kernel_tuning_t any_tuning(Random &random)
{
    kernel_tuning_t tuning{};
    tuning.d = any_gains(random);
    tuning.q = any_gains(random);
    tuning.w_l_d_q10 = random.any(-16383, 16383);
    tuning.w_l_q_q10 = random.any(-16383, 16383);
    tuning.forward_d_q25 = random.any(-(1 << 28), 1 << 28);
    tuning.forward_q_q25 = random.any(-(1 << 28), 1 << 28);
    tuning.advance = kernel_cos_sin(static_cast<uint16_t>(random.any(-8192, 8192)));
    return tuning;
}

// Inputs as a counterexample shows them.
inline std::string text(const pair_t &x)
{
    return property::text(twin::vector(x));
}

inline std::string text(const triple_t &x)
{
    return property::text(twin::vector(x));
}

inline std::string text(const kernel_pi_gains_t &gains)
{
    return text(triple_t{gains.proportional_q10, gains.integral_q15, gains.anti_windup_q15});
}

inline std::string text(const kernel_tuning_t &tuning)
{
    return "d " + text(tuning.d) + " q " + text(tuning.q) + " w L " +
           text(pair_t{tuning.w_l_d_q10, tuning.w_l_q_q10}) + " forward " +
           text(pair_t{tuning.forward_d_q25, tuning.forward_q_q25}) + " advance " +
           text(tuning.advance);
}
