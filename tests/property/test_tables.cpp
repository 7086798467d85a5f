/* SPDX-License-Identifier: Apache-2.0 */
// The tables in the shipped configurations as the firmware reads them, with the currents it makes
// of a torque, against the least power the circuit laws allow (circuit.hpp).
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "limits.hpp"
#include "property.hpp"
#include "tables.h"

namespace {

using circuit::Circuit;
using circuit::Form;
using circuit::Vector2d;
using limits::braking_limits;
using limits::joined;
using limits::torque_limit_Nm;
using values::Drive;

constexpr double POWER_LOSS = 1e-3;
constexpr double CYCLE_LOSS = 2e-4;
constexpr double TORQUE = 1e-3; // of the largest: motor_model.h rounds

#ifdef HUBFOC_SLOW_BUILD
constexpr int EVERY = 8;
#else
constexpr int EVERY = 1;
#endif
constexpr int STARTS = 16;

const config_t &config_of(const Drive &drive)
{
    const std::string name = drive.name;
    return name == "ebike36v"  ? CONFIG_EBIKE36V
           : name == "ipm400v" ? CONFIG_IPM400V
           : name == "lu2013"  ? CONFIG_LU2013
                               : CONFIG_SCOOTER48V;
}

struct Made {
    double power_W, torque_Nm;
};

// What the currents mean with which the firmware makes an airgap torque.
Made made_by_firmware(const Drive &drive, const Circuit &at, double speed_rad_s,
                      double temperature_C, double torque_Nm)
{
    const tables_current_t i =
        tables_currents(&config_of(drive), static_cast<int32_t>(std::lround(1e3 * speed_rad_s)),
                        static_cast<int32_t>(std::lround(1e2 * temperature_C)),
                        static_cast<int32_t>(std::lround(1e3 * torque_Nm)));
    const Vector2d current(1e-3 * i.d_mA, 1e-3 * i.q_mA);
    return {at.dc_power_W(current), at.torque_Nm(current)};
}

// Braking torque, magnitude, that the firmware gives at most: the table's, or what is demanded or
// allowed if that is less.
double firmware_torque_Nm(const Drive &drive, double speed_rad_s, double temperature_C,
                          double strongest_Nm)
{
    const int32_t best_mNm = tables_best_braking_mNm(
        &config_of(drive), static_cast<int32_t>(std::lround(1e3 * speed_rad_s)),
        static_cast<int32_t>(std::lround(1e2 * temperature_C)));
    return std::min(1e-3 * best_mNm, strongest_Nm);
}

// Phase current clamps the torque at run time; here it only keeps a salient motor's search in
// bounds.
double search_A(const Drive &drive)
{
    return 3.0 * drive.max_current_A;
}

Form search_circle(const Drive &drive, const Circuit &at)
{
    return 1.0 / (search_A(drive) * search_A(drive)) * at.current_square_A2 + -1.0;
}

double least_braking_power_W(const Drive &drive, const Circuit &at, double strongest_Nm)
{
    const auto found = circuit::minimum(
        at.dc_power_W, joined({search_circle(drive, at)}, braking_limits(drive, at, strongest_Nm)),
        {}, search_A(drive), 6);
    return CHECK(found.has_value()) ? found->value : std::nan("");
}

double least_power_W(const Drive &drive, const Circuit &at, double torque_Nm)
{
    const Form asked_for =
        1.0 / drive.max_torque_Nm * at.torque_Nm + -torque_Nm / drive.max_torque_Nm;
    const auto found = circuit::minimum(at.dc_power_W, {search_circle(drive, at)}, {asked_for},
                                        search_A(drive), STARTS);
    return CHECK(found.has_value()) ? found->value : std::nan("");
}

// Largest share of the power that could come back and does not, from one speed to another.
double worst_loss(const Drive &drive, double temperature_C, double slowest_rad_s,
                  double fastest_rad_s)
{
    constexpr int SPEEDS = 160;
    double worst = -1.0;
    for (int n = 0; n < SPEEDS; n += EVERY) {
        const double speed =
            slowest_rad_s * std::pow(fastest_rad_s / slowest_rad_s, n / (SPEEDS - 1.0));
        const Circuit at(drive, speed, temperature_C);
        const double limit = torque_limit_Nm(drive, speed);
        const double least = least_braking_power_W(drive, at, limit);
        if (least < 0.0) {
            const double torque = firmware_torque_Nm(drive, speed, temperature_C, limit);
            const Made made = made_by_firmware(drive, at, speed, temperature_C, -torque);
            worst = std::max(worst, (made.power_W - least) / -least);
        }
    }
    return worst;
}

} // namespace

static void test_tables_lose_at_most_a_thousandth_of_the_power_wherever_the_firmware_brakes()
{
    for (int k = 0; k < values::SHIPPED; k++) {
        const Drive &drive = values::DRIVES[k];
        const std::string name = drive.name;
        SHOW(name);
        for (int n = 0; n <= 16; n++) {
            const double temperature =
                drive.coldest_C + (drive.hottest_C - drive.coldest_C) * n / 16.0;
            SHOW(temperature);
            const double worst =
                worst_loss(drive, temperature, drive.handover_end_rad_s, drive.max_speed_rad_s);
            CHECK(worst <= POWER_LOSS);
            CHECK(worst >=
                  -0.1 * POWER_LOSS); // currents that beat the optimum would be a wrong optimum
        }
    }
}

namespace {

struct Sample {
    double time_s, speed_m_s;
};

// A trace of host_sim/cycles, slowed down so that a vehicle of 80 km/h would drive it as it is (the
// paper's 60/80).
std::vector<Sample> cycle(const Drive &drive, const char *name)
{
    std::ifstream file(std::string(HUBFOC_CYCLES) + "/" + name);
    const double factor = std::min(1.0, drive.max_speed_rad_s * drive.wheel_radius_m * 3.6 / 80.0);
    std::vector<Sample> out;
    for (std::string line; std::getline(file, line);) {
        std::istringstream fields(line);
        Sample sample{};
        char comma = 0;
        if (fields >> sample.time_s >> comma >> sample.speed_m_s) {
            sample.speed_m_s *= factor / 3.6;
            out.push_back(sample);
        }
    }
    return out;
}

// Shaft torque of one wheel at the middle of a step: inertia, rolling resistance, air at 20 degC.
double demand_Nm(const Drive &drive, double speed_m_s, double acceleration_m_s2)
{
    const double drag =
        0.5 * 1.2041 * drive.drag_coefficient * drive.frontal_area_m2 * speed_m_s * speed_m_s +
        drive.rolling_resistance * drive.mass_kg * 9.80665;
    return (drive.mass_kg * acceleration_m_s2 + drag) * drive.wheel_radius_m / drive.driven_wheels;
}

struct Energy {
    double least_J = 0.0, made_J = 0.0;
    double lost_share() const { return (made_J - least_J) / std::abs(least_J); }
};

struct Cycle {
    Energy driving, braking;
};

Cycle drive_cycle(const Drive &drive, double temperature_C)
{
    constexpr int PARTS = 4;
    Cycle out;
    const std::vector<Sample> trace = cycle(drive, "ece15.csv");
    CHECK(trace.size() > 10U);
    for (size_t n = 1; n < trace.size(); n++) {
        const double seconds = trace[n].time_s - trace[n - 1].time_s;
        const double acceleration = (trace[n].speed_m_s - trace[n - 1].speed_m_s) / seconds;
        for (int part = 0; part < PARTS; part++) {
            const double v = trace[n - 1].speed_m_s + acceleration * seconds * (part + 0.5) / PARTS;
            const double speed = v / drive.wheel_radius_m;
            if (speed < drive.handover_end_rad_s) {
                continue;
            }
            const Circuit at(drive, speed, temperature_C);
            const double limit = torque_limit_Nm(drive, speed);
            const double torque =
                demand_Nm(drive, v, acceleration) + drive.friction_Nm + drive.viscous_Nm_s * speed;
            Energy &energy = torque > 0.0 ? out.driving : out.braking;
            const double asked = std::min(std::abs(torque), limit);
            const double given =
                torque > 0.0 ? asked : -firmware_torque_Nm(drive, speed, temperature_C, asked);
            const Made made = made_by_firmware(drive, at, speed, temperature_C, given);
            CHECK(std::abs(made.torque_Nm - given) <= TORQUE * drive.max_torque_Nm);
            const double least =
                torque > 0.0 ? least_power_W(drive, at, made.torque_Nm)
                             : least_braking_power_W(drive, at, std::max(asked, -made.torque_Nm));
            energy.least_J += least * seconds / PARTS;
            energy.made_J += made.power_W * seconds / PARTS;
        }
    }
    return out;
}

} // namespace

static void test_tables_lose_at_most_a_fiftieth_of_a_per_cent_of_the_energy_over_the_urban_cycle()
{
    for (int k = 0; k < values::SHIPPED; k++) {
        const Drive &drive = values::DRIVES[k];
        for (const double temperature :
             {drive.coldest_C, drive.reference_temperature_C, drive.hottest_C}) {
            const std::string name = drive.name;
            SHOW(name);
            SHOW(temperature);
            const Cycle done = drive_cycle(drive, temperature);
            CHECK(done.driving.least_J > 0.0);
            CHECK(done.braking.least_J < 0.0);
            for (const Energy &energy : {done.driving, done.braking}) {
                CHECK(energy.lost_share() <= CYCLE_LOSS);
                CHECK(energy.lost_share() >= -0.05 * CYCLE_LOSS);
            }
        }
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_tables_lose_at_most_a_thousandth_of_the_power_wherever_the_firmware_brakes);
    RUN_TEST(test_tables_lose_at_most_a_fiftieth_of_a_per_cent_of_the_energy_over_the_urban_cycle);
    return UNITY_END();
}
