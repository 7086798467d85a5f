/* SPDX-License-Identifier: Apache-2.0 */
/*
 * limits.hpp: what bounds braking besides the circuit, as constraints for circuit::minimum.
 */
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "circuit.hpp"

namespace limits {

using circuit::Circuit;
using circuit::Form;
using values::Drive;

inline double torque_limit_Nm(const Drive &drive, double speed_rad_s)
{
    return std::min(drive.max_torque_Nm, drive.max_power_W / std::max(std::abs(speed_rad_s), 1e-9));
}

// Braking torque at most as strong as a limit, and no driving torque; the sign is that of the
// rotation.
inline std::vector<Form> braking_limits(const Drive &drive, const Circuit &at, double strongest_Nm)
{
    const Form forward = at.direction() / drive.max_torque_Nm * at.torque_Nm;
    return {-1.0 * forward + -strongest_Nm / drive.max_torque_Nm, forward};
}

inline std::vector<Form> joined(std::vector<Form> a, const std::vector<Form> &b)
{
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

} // namespace limits
