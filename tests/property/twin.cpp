/* SPDX-License-Identifier: Apache-2.0 */
#include "twin.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace twin {

namespace {

const Eigen::Matrix<double, 3, 2> PHASES =
    (Eigen::Matrix<double, 3, 2>() << 1.0, 0.0, -0.5, std::sqrt(0.75), -0.5, -std::sqrt(0.75))
        .finished();

double saturated16(double x)
{
    return std::clamp(x, -32768.0, 32767.0);
}

} // namespace

Vector3d phases(const Vector2d &ab)
{
    return PHASES * ab;
}

Vector2d clarke(const Vector3d &phase)
{
    return 2.0 / 3.0 * (PHASES.transpose() * phase);
}

Vector2d park(const Vector2d &ab, double angle)
{
    return Eigen::Rotation2Dd(-angle) * ab;
}

Vector2d inverse_park(const Vector2d &dq, double angle)
{
    return Eigen::Rotation2Dd(angle) * dq;
}

Vector2d saturated(const Vector2d &v)
{
    return {saturated16(v.x()), saturated16(v.y())};
}

Vector2d sense(const uint16_t codes[3], const int32_t offset_q4[3], const int32_t on_q16[3])
{
    Vector3d i;
    for (int x = 0; x < 3; x++) {
        i[x] = 16.0 * codes[x] - offset_q4[x];
    }
    const int longest = static_cast<int>(std::max_element(on_q16, on_q16 + 3) - on_q16);
    i[longest] -= i.sum();
    return saturated({i[0], std::clamp(i[1] - i[2], -65536.0, 65535.0) / std::sqrt(3.0)});
}

Tuning::Tuning(const kernel_tuning_t &tuning)
    : d(tuning.d), q(tuning.q), w_l_d(tuning.w_l_d_q10 / 1024.0), w_l_q(tuning.w_l_q_q10 / 1024.0),
      forward_d(tuning.forward_d_q25 / 1024.0), forward_q(tuning.forward_q_q25 / 1024.0),
      advance(std::atan2(tuning.advance.y, tuning.advance.x))
{
}

Voltage current_loop(const Vector2d &integrator, const Tuning &tuning, const Vector2d &reference,
                     const Vector2d &i)
{
    const Vector2d error = (reference - i).unaryExpr([](double x) { return saturated16(x); });
    Voltage out;
    out.wanted.x() = tuning.d.proportional * error.x() + integrator.x() - tuning.w_l_q * i.y() +
                     tuning.forward_d;
    out.wanted.y() = tuning.q.proportional * error.y() + integrator.y() + tuning.w_l_d * i.x() +
                     tuning.forward_q;
    out.realised.x() = saturated16(out.wanted.x());
    const double most_q = std::sqrt(std::max(ONE * ONE - out.realised.x() * out.realised.x(), 0.0));
    out.realised.y() = std::clamp(out.wanted.y(), -most_q, most_q);
    const Vector2d missing = out.realised - out.wanted;
    out.integrator =
        integrator + Vector2d(tuning.d.integral * error.x() + tuning.d.anti_windup * missing.x(),
                              tuning.q.integral * error.y() + tuning.q.anti_windup * missing.y());
    out.integrator = out.integrator.cwiseMax(-ONE).cwiseMin(ONE);
    return out;
}

Vector3d lines(const Vector3d &phase_counts)
{
    return {phase_counts[0] - phase_counts[1], phase_counts[1] - phase_counts[2],
            phase_counts[2] - phase_counts[0]};
}

Vector3d modulate(const Vector2d &u, double unit_counts)
{
    return lines(phases(u)) / ONE * unit_counts / std::sqrt(3.0);
}

Vector3d dead_time(const Vector2d &i, double full_counts, double zone)
{
    return full_counts * (phases(i) / zone).cwiseMax(-1.0).cwiseMin(1.0);
}

Loop loop(const kernel_loop_t &before, const Tuning &tuning, const uint16_t codes[3],
          double theta_turn, const Vector2d &reference, double zone)
{
    const double angle = radians(theta_turn);
    Loop out;
    out.i_dq = saturated(park(sense(codes, before.offset_q4, before.on_q16), angle));
    out.voltage = current_loop(vector(before.integrator_q30) / ONE, tuning, reference, out.i_dq);
    const double applied = angle + tuning.advance;
    out.line_counts =
        modulate(inverse_park(out.voltage.realised, applied), before.svpwm.beta_counts) +
        lines(dead_time(inverse_park(reference, applied), before.dead_time.full_counts, zone));
    return out;
}

} // namespace twin
