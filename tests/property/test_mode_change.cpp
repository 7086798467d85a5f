/* SPDX-License-Identifier: Apache-2.0 */
// Starting, stopping and shorting a motor that turns: the regulators start where the back-EMF
// already is.
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
using Complex = std::complex<double>;

constexpr double PERIOD_s = 50e-6;

double k_p_ohm(const config_t &config)
{
    const double base_ohm = config.drive.voltage_full_scale_mV /
                            static_cast<double>(config.drive.current_full_scale_mA);
    return config.current_loop.proportional_q_pu_q16 / 65536.0 * base_ohm;
}

// Largest distance of the current from a reference.
double largest_A(Bench &bench, int periods, const Vector2d &reference = Vector2d::Zero(),
                 Mode mode = Mode::pwm)
{
    double largest = 0.0;
    for (int n = 0; n < periods; n++) {
        bench.step(mode);
        largest = std::max(largest, (bench.current() - reference).norm());
    }
    return largest;
}

Bench rolling(const config_t &config, const Plant &plant, double theta)
{
    Bench bench(config, plant, theta);
    bench.set_reference(0.0, 0.0);
    bench.run(SETTLE_PERIODS, Mode::off);
    return bench;
}

// What the short drives after a time, from a current at its beginning: i' = -(R/L + jw) i - j w
// psi/L.
Complex shorted(const Plant &plant, Complex before, double time_s)
{
    const Complex a((plant.resistance_ohm + plant.switch_resistance_ohm) / plant.q_inductance_H,
                    plant.speed_rad_s);
    const Complex settled =
        -Complex(0.0, plant.speed_rad_s * plant.flux_Wb / plant.q_inductance_H) / a;
    return settled + (before - settled) * std::exp(-a * time_s);
}

} // namespace

static void test_bridge_that_starts_at_any_speed_meets_the_back_emf_with_less_than_half_an_ampere()
{
    // What is wrong with the first voltages: a code of the bus (15 mV of 53 V, 6 mV of 22 V of
    // back-EMF), the advance to 3/65 536 of a turn (6 mV), a count of each compare value (13 mV), a
    // Q11 step of the gains. 40 mV over k_p = 0.29 Ohm are 0.14 A, and the converters' codes 0.08 A
    // each.
    for (const bool real_bridge : {false, true}) {
        const config_t config = paper_config(real_bridge);
        for (const double speed_rpm : {-450.0, -50.0, 0.0, 50.0, 300.0, 450.0}) {
            for (const double v_dc_V : {53.0, 58.0}) {
                for (int position = 0; position < 7; position++) {
                    Plant plant = bench::plant_of(config, 60.0, v_dc_V, speed_rpm);
                    plant = real_bridge ? bench::with_bridge(plant) : plant;
                    Bench bench = rolling(config, plant, 0.9 * position);
                    SHOW(speed_rpm);
                    SHOW(position);
                    CHECK(largest_A(bench, 400) < 0.25);
                    bench.run(50, Mode::off);
                    CHECK(largest_A(bench, 400) < 0.25);
                }
            }
        }
    }
}

static void test_start_with_flux_thirty_per_cent_wrong_draws_what_that_voltage_drives_and_no_more()
{
    // Before the integrator has taken over, k_p alone opposes the missing 0.3 w psi; K / (z (z -
    // 1)) does not overshoot.
    const config_t config = paper_config(false);
    for (const double flux : {0.7, 1.3}) {
        for (const double speed_rpm : {50.0, 300.0, 400.0}) {
            Plant plant = bench::plant_of(config, 25.0, 58.0, speed_rpm);
            const double missing_V = 0.3 * plant.speed_rad_s * plant.flux_Wb;
            plant.flux_Wb *= flux;
            Bench bench = rolling(config, plant, 0.3);
            const double largest = largest_A(bench, 1000);
            SHOW(flux);
            SHOW(speed_rpm);
            CHECK(largest < missing_V / k_p_ohm(config) + 0.5);
            CHECK(largest >
                  0.5 * missing_V / k_p_ohm(config)); // without it there would be nothing to bound
            CHECK(largest_A(bench, 400) < 0.25);
        }
    }
}

static void test_current_of_a_short_is_taken_over_without_growing_and_decays_as_designed()
{
    const config_t config = paper_config(true);
    const double pole = 2.0 * bench::PI * config.current_loop.bandwidth_Hz * PERIOD_s;
    for (const double speed_rpm : {25.0, 50.0, 100.0, -100.0}) {
        for (const int periods : {3, 20, 60, 2000}) {
            const Plant plant = bench::with_bridge(bench::plant_of(config, 25.0, 53.0, speed_rpm));
            Bench bench = rolling(config, plant, 0.5);
            bench.run(200);
            bench.run(1, Mode::shorted); // asked for; the bridge follows a period later
            const Vector2d before = bench.current();
            bench.run(periods, Mode::shorted);
            bench.step();
            const Vector2d at_change = bench.current();
            const Complex expected = shorted(plant, {before.x(), before.y()}, periods * PERIOD_s);
            SHOW(speed_rpm);
            SHOW(periods);
            CHECK(std::abs(expected - Complex(at_change.x(), at_change.y())) < 0.3);
            // One more period of the short until the first voltage acts; from then on it only
            // shrinks.
            const double one_more = std::abs(shorted(plant, expected, PERIOD_s));
            CHECK(largest_A(bench, 1000) < std::max(at_change.norm(), one_more) + 0.5);

            Bench again = rolling(config, plant, 0.5);
            again.run(periods, Mode::shorted);
            const int within_a_tenth = static_cast<int>(std::ceil(1.5 + std::log(10.0) / pole)) + 2;
            again.run(within_a_tenth);
            CHECK(largest_A(again, 400) < 0.1 * one_more + 0.5);
        }
    }
}

static void test_every_bridge_mode_change_under_load_keeps_the_current_bounded()
{
    const config_t config = paper_config(true);
    for (const double i_q_A : {-40.0, 20.0}) {
        for (const double speed_rpm : {50.0, 100.0}) {
            const Plant plant = bench::with_bridge(bench::plant_of(config, 60.0, 53.0, speed_rpm));
            const double short_A =
                std::abs(Complex(0.0, plant.speed_rad_s * plant.flux_Wb) /
                         Complex(plant.resistance_ohm + plant.switch_resistance_ohm,
                                 plant.speed_rad_s * plant.q_inductance_H));
            Bench bench = rolling(config, plant, 0.5);
            const Vector2d reference(0.0, i_q_A);
            bench.set_reference(0.0, i_q_A);
            SHOW(i_q_A);
            SHOW(speed_rpm);
            CHECK(largest_A(bench, 400, Vector2d::Zero()) < 1.1 * std::abs(i_q_A));
            // |i| <= |settled| (1 - e^...) + what was there: never more than twice the one and once
            // the other.
            CHECK(largest_A(bench, 400, Vector2d::Zero(), Mode::shorted) <
                  2.0 * short_A + 1.1 * std::abs(i_q_A));
            const double at_change = bench.current().norm();
            CHECK(largest_A(bench, 400, Vector2d::Zero()) <
                  std::max(at_change, std::abs(i_q_A)) * 1.05 + 0.5);
            CHECK((bench.current() - reference).norm() < 0.5);
            bench.run(2, Mode::off);
            CHECK(largest_A(bench, 50, Vector2d::Zero(), Mode::off) == 0.0);
            CHECK(largest_A(bench, 400, Vector2d::Zero()) < 1.1 * std::abs(i_q_A));
            CHECK((bench.current() - reference).norm() < 0.5);
        }
    }
}

static void test_start_without_the_back_emf_feed_forward_draws_a_current_surge()
{
    config_t config = paper_config(false);
    config.current_loop.flux_pu_q16 = 1;
    const Plant plant = bench::plant_of(config, 60.0, 53.0, 300.0);
    Bench bench = rolling(config, plant, 0.3);
    CHECK(largest_A(bench, 400) > 0.7 * plant.speed_rad_s * plant.flux_Wb / k_p_ohm(config));
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_bridge_that_starts_at_any_speed_meets_the_back_emf_with_less_than_half_an_ampere);
    RUN_TEST(test_start_with_flux_thirty_per_cent_wrong_draws_what_that_voltage_drives_and_no_more);
    RUN_TEST(test_current_of_a_short_is_taken_over_without_growing_and_decays_as_designed);
    RUN_TEST(test_every_bridge_mode_change_under_load_keeps_the_current_bounded);
    RUN_TEST(test_start_without_the_back_emf_feed_forward_draws_a_current_surge);
    return UNITY_END();
}
