/* SPDX-License-Identifier: Apache-2.0 */
// The torques between which the voltage suffices (motor/feasible_torque.h) of the shipped
// configurations, against the largest and least torque that the circuit laws (circuit.hpp) allow
// inside the voltage circle with i_d anywhere down to what field weakening reaches.
//
// With the iron branch torque and |u|^2 are quadratic forms of (i_d, i_q). For each i_d on a fine
// grid the circle leaves an interval of i_q, whose ends are the roots of a quadratic equation.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "circuit.hpp"
#include "property.hpp"
#include "tables.h"

namespace {

using circuit::Circuit;
using circuit::Vector2d;
using values::Drive;

constexpr int STEPS_OF_D = 400;
constexpr int SPEEDS = 24;
constexpr double ROUNDING = 1.5e-3; // of the largest torque: motor_model.h, and 3 mV of the voltage

const config_t &config_of(const Drive &drive)
{
    const std::string name = drive.name;
    return name == "ebike36v"  ? CONFIG_EBIKE36V
           : name == "ipm400v" ? CONFIG_IPM400V
           : name == "lu2013"  ? CONFIG_LU2013
                               : CONFIG_SCOOTER48V;
}

struct Range {
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -std::numeric_limits<double>::infinity();
    bool exists() const { return lowest <= highest; }
};

void widen(Range &range, double torque_Nm)
{
    range.lowest = std::min(range.lowest, torque_Nm);
    range.highest = std::max(range.highest, torque_Nm);
}

// Torques at the ends of what the circle leaves of i_q beside one i_d.
Range beside(const Circuit &at, double i_d_A, double phase_V)
{
    const Vector2d offset = at.voltage_V(Vector2d(i_d_A, 0.0));
    const Vector2d slope = at.voltage_V(Vector2d(i_d_A, 1.0)) - offset;
    const double a = slope.squaredNorm();
    const double b = slope.dot(offset);
    const double c = offset.squaredNorm() - phase_V * phase_V;
    Range out;
    if (b * b >= a * c) {
        const double root = std::sqrt(b * b - a * c);
        widen(out, at.torque_Nm(Vector2d(i_d_A, (-b - root) / a)));
        widen(out, at.torque_Nm(Vector2d(i_d_A, (-b + root) / a)));
    }
    return out;
}

Range reachable(const Circuit &at, double weakest_d_A, double phase_V)
{
    Range out;
    for (int n = 0; n <= STEPS_OF_D; n++) {
        const Range here = beside(at, weakest_d_A * n / STEPS_OF_D, phase_V);
        if (here.exists()) {
            widen(out, here.lowest);
            widen(out, here.highest);
        }
    }
    return out;
}

void compare(const Drive &drive, double temperature_C, double bus_V, double direction)
{
    const config_t &config = config_of(drive);
    const double phase_V =
        0.97 * config.current_loop.modulation_limit_pu_q15 / 32768.0 * bus_V / std::sqrt(3.0);
    for (int n = 1; n <= SPEEDS; n++) {
        const double speed = direction * 1.2 * drive.max_speed_rad_s * n / SPEEDS;
        const Circuit at(drive, speed, temperature_C);
        const tables_voltage_t limit =
            tables_voltage_limit(&config, static_cast<int32_t>(std::lround(1e3 * speed)),
                                 static_cast<int32_t>(std::lround(1e2 * temperature_C)),
                                 static_cast<int32_t>(std::lround(1e3 * phase_V)));
        const double weakest_A = 1e-3 * limit.weakest_d_mA;
        SHOW(drive.name);
        SHOW(temperature_C);
        SHOW(bus_V);
        SHOW(speed);
        const double rounding_Nm = ROUNDING * drive.max_torque_Nm;
        // No more than its own i_d lets through, to a rounding ...
        const Range own = beside(at, weakest_A, phase_V);
        if (!own.exists()) {
            const double friction_Nm =
                direction * (drive.friction_Nm +
                             drive.viscous_Nm_s * std::abs(speed)); // no torque at the shaft
            CHECK(std::abs(1e-3 * limit.highest_mNm - friction_Nm) < 2e-2);
            CHECK(std::abs(1e-3 * limit.lowest_mNm - friction_Nm) < 2e-2);
            continue;
        }
        // At each end with the i_d of the map where that goes further than field weakening. Beyond
        // zero no torque is left on a side.
        const double friction_Nm =
            direction * (drive.friction_Nm + drive.viscous_Nm_s * std::abs(speed));
        const auto end_d_A = [&](int32_t airgap_mNm) {
            const tables_current_t i =
                tables_currents(&config, static_cast<int32_t>(std::lround(1e3 * speed)),
                                static_cast<int32_t>(std::lround(1e2 * temperature_C)), airgap_mNm);
            return std::min(weakest_A,
                            std::max(1e-3 * i.d_mA, -1e-3 * config.motor.max_phase_current_mA));
        };
        const double high_d_A = end_d_A(limit.highest_mNm);
        const double low_d_A = end_d_A(limit.lowest_mNm);
        const double high_Nm = 1e-3 * limit.highest_mNm;
        const double low_Nm = 1e-3 * limit.lowest_mNm;
        const double far_Nm = 2.0 * drive.max_torque_Nm; // clamped beyond
        if (high_Nm <= far_Nm) {
            CHECK(high_Nm <= std::max(beside(at, high_d_A, phase_V + 0.02).highest, friction_Nm) +
                                 rounding_Nm);
        }
        if (low_Nm >= -far_Nm) {
            CHECK(low_Nm >=
                  std::min(beside(at, low_d_A, phase_V + 0.02).lowest, friction_Nm) - rounding_Nm);
        }
        const Range high = beside(at, high_d_A, phase_V - 0.02);
        const Range low = beside(at, low_d_A, phase_V - 0.02);
        if (high.exists()) {
            CHECK(high_Nm >= std::min(high.highest, far_Nm) - rounding_Nm);
        }
        if (low.exists()) {
            CHECK(low_Nm <= std::max(low.lowest, -far_Nm) + rounding_Nm);
        }
        // ... and where it matters no other i_d lets more through than 1 % of the largest torque.
        const Range any = reachable(at, weakest_A, phase_V);
        const double most_Nm = drive.max_torque_Nm;
        CHECK(std::min(1e-3 * limit.highest_mNm, most_Nm) >=
              std::min(any.highest, most_Nm) - 0.01 * most_Nm);
        CHECK(std::max(1e-3 * limit.lowest_mNm, -most_Nm) <=
              std::max(any.lowest, -most_Nm) + 0.01 * most_Nm);
    }
}

} // namespace

static void test_voltage_limit_of_every_shipped_drive_is_what_the_circuit_laws_leave()
{
    for (int d = 0; d < values::SHIPPED; d++) {
        const Drive &drive = values::DRIVES[d];
        const config_battery_t &battery = config_of(drive).battery;
        for (const double temperature_C : {-20.0, 25.0, 120.0}) {
            for (const double share : {0.0, 0.5, 1.0}) {
                const double bus_V =
                    1e-3 * (battery.min_voltage_mV +
                            share * (battery.max_voltage_mV - battery.min_voltage_mV));
                compare(drive, temperature_C, bus_V, 1.0);
                compare(drive, temperature_C, bus_V, -1.0);
            }
        }
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_voltage_limit_of_every_shipped_drive_is_what_the_circuit_laws_leave);
    return UNITY_END();
}
