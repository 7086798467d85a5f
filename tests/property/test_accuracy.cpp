/* SPDX-License-Identifier: Apache-2.0 */
// What the current and the torque are in the steady state: offsets, dead time, and what is left of
// them.
#include <algorithm>
#include <cmath>
#include <complex>

#include "bench.hpp"
#include "property.hpp"

namespace {

using bench::Bench;
using bench::Mode;
using bench::paper_config;
using bench::Plant;
using bench::SETTLE_PERIODS;
using bench::Vector2d;
using bench::Vector3d;

struct Error {
    double mean_A = 0.0;
    double largest_A = 0.0;
};

Error error_of(Bench &bench, int periods, const Vector2d &reference)
{
    Vector2d sum = Vector2d::Zero();
    Error out;
    for (int n = 0; n < periods; n++) {
        bench.step();
        const Vector2d error = bench.current() - reference;
        sum += error;
        out.largest_A = std::max(out.largest_A, error.norm());
    }
    out.mean_A = (sum / periods).norm();
    return out;
}

// Amplitudes of a phase current's harmonics over one mechanical turn.
struct Harmonics {
    double first_A, fifth_A, seventh_A;
    double mean_torque_Nm;
};

Harmonics harmonics(const config_t &config, const Plant &plant, double i_q_A)
{
    Bench bench(config, plant, 0.0);
    bench.run(SETTLE_PERIODS, Mode::off);
    bench.set_reference(0.0, i_q_A);
    bench.run(3000);
    // 50 r/min: 23 electrical turns in 24 000 periods.
    const int periods = static_cast<int>(std::lround(config.motor.pole_pairs * 2.0 * bench::PI /
                                                     (plant.speed_rad_s * bench.period_s())));
    std::complex<double> sum[3] = {};
    double torque = 0.0;
    for (int n = 0; n < periods; n++) {
        const double theta = bench.theta();
        const double current = bench.phase_currents()[0];
        const int order[3] = {1, 5, 7};
        for (int k = 0; k < 3; k++) {
            sum[k] += current * std::polar(2.0 / periods, -order[k] * theta);
        }
        bench.step();
        torque += bench.torque_Nm() / periods;
    }
    return {std::abs(sum[0]), std::abs(sum[1]), std::abs(sum[2]), torque};
}

constexpr double SPEED_RPM = 50.0;
constexpr double CURRENT_A = 10.0;

// The regulator alone against the square wave of one phase's lost voltage, 4/pi of it over the
// order. In the rotor frame both orders are the sixth, where the regulator and the winding oppose
// (R + jwL)(1 + k_p/(jwL)).
double expected_without_compensation_A(const config_t &config, const Plant &plant, int order)
{
    const double lost_V =
        plant.dead_time_s * 20e3 * (plant.v_dc_V + 2.0 * plant.diode_forward_voltage_V);
    const double sixth = 6.0 * plant.speed_rad_s;
    const std::complex<double> reactance(0.0, sixth * plant.q_inductance_H);
    const double base_ohm = config.drive.voltage_full_scale_mV /
                            static_cast<double>(config.drive.current_full_scale_mA);
    const double k_p = config.current_loop.proportional_q_pu_q16 / 65536.0 * base_ohm;
    const std::complex<double> opposes =
        (plant.resistance_ohm + plant.switch_resistance_ohm + reactance) * (1.0 + k_p / reactance);
    return 4.0 / bench::PI * lost_V / order / std::abs(opposes);
}

} // namespace

static void test_calibrated_current_is_right_to_half_a_per_cent_of_full_scale_at_any_speed()
{
    // Each sensor up to 2 % of 165 A beside its zero. Without calibration that is what the current
    // is wrong by.
    const config_t config = paper_config(true);
    const double allowed_A = 0.005 * config.drive.current_full_scale_mA * 1e-3;
    const Vector3d offsets[] = {
        {0.02, -0.015, 0.0173}, {-0.02, -0.02, 0.02}, {0.0007, 0.02, -0.01}};
    for (const Vector3d &offset : offsets) {
        for (const double speed_rpm : {0.0, 50.0, 300.0, 450.0}) {
            for (const double i_q_A : {0.0, 10.0, -40.0}) {
                Plant plant = bench::with_bridge(bench::plant_of(config, 120.0, 53.0, speed_rpm));
                plant.sensor_offset = offset;
                const auto run = [&](bool calibrate) {
                    Bench bench(config, plant, 0.4);
                    if (calibrate) {
                        bench.calibrate();
                    }
                    bench.set_reference(0.0, i_q_A);
                    bench.run(SETTLE_PERIODS, Mode::off);
                    bench.run(2000);
                    return error_of(bench, 4000, {0.0, i_q_A});
                };
                SHOW(speed_rpm);
                SHOW(i_q_A);
                const Error error = run(true);
                CHECK(error.mean_A <= allowed_A);
                CHECK(error.largest_A <= allowed_A);
                CHECK(run(false).largest_A > allowed_A);
            }
        }
    }
}

static void test_compensation_halves_fifth_and_seventh_harmonic_and_keeps_torque_to_one_per_cent()
{
    const config_t without = paper_config(false);
    const config_t with = paper_config(true);
    const double rated_Nm = with.motor.rated_torque_mNm * 1e-3;
    for (const double v_dc_V : {45.0, 53.0, 58.0}) {
        for (const double winding_C : {25.0, 120.0}) {
            for (const double i_q_A : {CURRENT_A, -CURRENT_A}) {
                const Plant plant =
                    bench::with_bridge(bench::plant_of(with, winding_C, v_dc_V, SPEED_RPM));
                const Harmonics off = harmonics(without, plant, i_q_A);
                const Harmonics on = harmonics(with, plant, i_q_A);
                SHOW(v_dc_V);
                SHOW(winding_C);
                SHOW(i_q_A);
                // The wave is no square: within its zone around zero the lost voltage follows the
                // current.
                const double fifth_A = expected_without_compensation_A(without, plant, 5);
                const double seventh_A = expected_without_compensation_A(without, plant, 7);
                CHECK(std::abs(off.fifth_A - fifth_A) <= 0.35 * fifth_A);
                CHECK(std::abs(off.seventh_A - seventh_A) <= 0.35 * seventh_A);
                CHECK(on.fifth_A <= 0.5 * off.fifth_A);
                CHECK(on.seventh_A <= 0.5 * off.seventh_A);
                CHECK(std::abs(on.first_A - CURRENT_A) <= 0.01 * CURRENT_A);
                const double ideal_Nm = 1.5 * with.motor.pole_pairs * plant.flux_Wb * i_q_A;
                CHECK(std::abs(on.mean_torque_Nm - ideal_Nm) <= 0.01 * rated_Nm);
                CHECK(std::abs(off.mean_torque_Nm - ideal_Nm) <= 0.01 * rated_Nm);
            }
        }
    }
}

static void
test_compensation_with_dead_time_and_zone_thirty_per_cent_wrong_still_halves_the_harmonics()
{
    // Switching times differ from the timer's dead time, and the ripple of the PWM moves the zone.
    for (const double dead_time_s : {0.7e-6, 1.3e-6}) {
        for (const double zone : {0.5, 2.0}) {
            config_t with = paper_config(true);
            with.current_loop.dead_time_zone_pu_q15 =
                static_cast<int32_t>(with.current_loop.dead_time_zone_pu_q15 * zone);
            Plant plant = bench::with_bridge(bench::plant_of(with, 25.0, 53.0, SPEED_RPM));
            plant.dead_time_s = dead_time_s;
            const Harmonics off = harmonics(paper_config(false), plant, CURRENT_A);
            const Harmonics on = harmonics(with, plant, CURRENT_A);
            SHOW(dead_time_s);
            SHOW(zone);
            CHECK(on.fifth_A <= 0.5 * off.fifth_A);
            CHECK(on.seventh_A <= 0.5 * off.seventh_A);
        }
    }
}

static void test_power_estimate_is_copper_loss_plus_torque_times_speed()
{
    // From the realised voltage and the measured current, mean of a millisecond. Right to the
    // voltage that reaches the motor (40 mV: codes of the bus, counts, the advance) times the
    // current, and to the current's codes (a half) times the voltage.
    for (const bool real_bridge : {false, true}) {
        const config_t config = paper_config(real_bridge);
        for (const double speed_rpm : {-300.0, 0.0, 50.0, 300.0, 450.0}) {
            for (const double v_dc_V : {53.0, 58.0}) {
                for (const Vector2d &reference :
                     {Vector2d(0.0, 30.0), Vector2d(0.0, -40.0), Vector2d(-20.0, -10.0)}) {
                    Plant plant = bench::plant_of(config, 80.0, v_dc_V, speed_rpm);
                    plant = real_bridge ? bench::with_bridge(plant) : plant;
                    Bench bench(config, plant, 0.4);
                    bench.set_reference(reference.x(), reference.y());
                    bench.run(SETTLE_PERIODS, Mode::off);
                    bench.run(2000);
                    loop_output_t out{};
                    double estimate_W = 0.0;
                    double torque_Nm = 0.0;
                    double copper_W = 0.0;
                    constexpr int PERIODS = 4000;
                    for (int n = 0; n < PERIODS; n++) {
                        out = bench.step();
                        const double circle_V =
                            out.modulation_limit_q15 / 32768.0 * v_dc_V / std::sqrt(3.0);
                        estimate_W += 1.5 * circle_V * bench.current_base_A() * out.power_pu /
                                      32768.0 / PERIODS;
                        torque_Nm += bench.torque_Nm() / PERIODS;
                        copper_W += 1.5 * (plant.resistance_ohm + plant.switch_resistance_ohm) *
                                    bench.current().squaredNorm() / PERIODS;
                    }
                    const double shaft_W = torque_Nm * plant.speed_rad_s / config.motor.pole_pairs;
                    const double voltage_V =
                        std::abs(plant.speed_rad_s) * plant.flux_Wb + 0.05 * reference.norm();
                    const double allowed_W = 1.5 * (0.04 * reference.norm() + 0.04 * voltage_V);
                    SHOW(speed_rpm);
                    SHOW(v_dc_V);
                    SHOW(real_bridge);
                    SHOW(reference.x());
                    SHOW(reference.y());
                    CHECK(std::abs(estimate_W - (copper_W + shaft_W)) <= allowed_W);
                }
            }
        }
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_calibrated_current_is_right_to_half_a_per_cent_of_full_scale_at_any_speed);
    RUN_TEST(test_compensation_halves_fifth_and_seventh_harmonic_and_keeps_torque_to_one_per_cent);
    RUN_TEST(
        test_compensation_with_dead_time_and_zone_thirty_per_cent_wrong_still_halves_the_harmonics);
    RUN_TEST(test_power_estimate_is_copper_loss_plus_torque_times_speed);
    return UNITY_END();
}
