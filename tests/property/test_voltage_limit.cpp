/* SPDX-License-Identifier: Apache-2.0 */
// Large steps, which the bus voltage limits: against the least time in which any regulator could
// make them.
//
// With i_d held at zero the least time follows from i_q' = (u_q - R i_q - w psi)/L with u_q at the
// end of what the circle leaves beside u_d = -w L i_q. Without that condition the equations are
// linear and the circle is a disc, so what can be reached within t is a disc too: around e^(-at)
// i_0 - (j w psi/L)(1 - e^(-at))/a, a = R/L + jw, with the radius (U/R)(1 - e^(-Rt/L)). Its radius
// reaches the target at the time that no controller can beat, whatever it does with i_d.
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

constexpr double TO_A = -60.0;
constexpr double BAND_A = 6.0; // arrived: within a tenth of the step
constexpr double DT_s = 2e-7;
constexpr double FOREVER_s = 0.05;

double resistance_ohm(const Plant &plant)
{
    return plant.resistance_ohm + plant.switch_resistance_ohm;
}

// Lower bound for any controller, from standstill of the current.
double least_time_s(const Plant &plant, double circle_V)
{
    const double inductance = plant.q_inductance_H;
    const double rate = resistance_ohm(plant) / inductance;
    const Complex a(rate, plant.speed_rad_s);
    for (double t = 0.0; t < FOREVER_s; t += DT_s) {
        const Complex centre = -Complex(0.0, plant.speed_rad_s * plant.flux_Wb / inductance) *
                               (1.0 - std::exp(-a * t)) / a;
        const double radius = circle_V / resistance_ohm(plant) * (1.0 - std::exp(-rate * t));
        if (std::abs(Complex(0.0, TO_A) - centre) <= radius + BAND_A) {
            return t;
        }
    }
    return FOREVER_s;
}

// With i_d held at zero.
double least_time_along_q_s(const Plant &plant, double circle_V)
{
    double i_q = 0.0;
    for (double t = 0.0; t < FOREVER_s; t += DT_s) {
        if (i_q <= TO_A + BAND_A) {
            return t;
        }
        const double u_d = plant.speed_rad_s * plant.q_inductance_H * i_q;
        const double u_q = -std::sqrt(std::max(circle_V * circle_V - u_d * u_d, 0.0));
        i_q += DT_s / plant.q_inductance_H *
               (u_q - resistance_ohm(plant) * i_q - plant.speed_rad_s * plant.flux_Wb);
    }
    return FOREVER_s;
}

struct Arrival {
    int sample = -1;
    int limited = 0;
    double beyond = 0.0; // the step, share of it
    double circle_V = 0.0;
};

Arrival step(const config_t &config, const Plant &plant)
{
    Bench bench(config, plant, 0.3);
    bench.set_reference(0.0, 0.0);
    bench.run(SETTLE_PERIODS, Mode::off);
    bench.run(1000);
    bench.set_reference(0.0, TO_A);
    Arrival out;
    for (int n = 0; n < 1000; n++) {
        const loop_output_t out_of_loop = bench.step();
        out.circle_V = out_of_loop.modulation_limit_q15 / 32768.0 * plant.v_dc_V / std::sqrt(3.0);
        out.limited += out_of_loop.limited ? 1 : 0;
        out.beyond = std::max(out.beyond, bench.i_q() / TO_A - 1.0);
        if (out.sample < 0 && (bench.current() - Vector2d(0.0, TO_A)).norm() <= BAND_A) {
            out.sample = n;
        }
    }
    return out;
}

// The sample at which a current has arrived that was free to from the first voltage on, one period
// after the sample.
int sample_after(double seconds, double period_s)
{
    return static_cast<int>(std::ceil(1.0 + seconds / period_s));
}

// 1 - exp(-w (n - 1.5) T) is within a tenth of the step from here on.
int designed_sample(const config_t &config)
{
    const double pole =
        2.0 * bench::PI * config.current_loop.bandwidth_Hz / config.drive.pwm_frequency_Hz;
    return static_cast<int>(std::ceil(1.5 + std::log(std::abs(TO_A) / BAND_A) / pole));
}

Plant plant_at(const config_t &config, double winding_C, double speed_rpm, double v_dc_V,
               bool real_bridge)
{
    const Plant plant = bench::plant_of(config, winding_C, v_dc_V, speed_rpm);
    return real_bridge ? bench::with_bridge(plant) : plant;
}

} // namespace

static void
test_voltage_limited_step_arrives_within_two_periods_of_the_least_time_without_overshoot()
{
    // Turning backwards, so that the back-EMF stands against the step: the regulator asks for up
    // to 22.1 V + 17.6 V, the circle has 23.9 V to 30.8 V. What the voltage would allow sooner than
    // the design answers, the design decides.
    int limited = 0;
    for (const bool real_bridge : {false, true}) {
        for (const double winding_C : {25.0, 120.0}) {
            for (const double speed_rpm : {-300.0, -350.0, -400.0, -450.0}) {
                for (const double v_dc_V : {45.0, 53.0, 58.0}) {
                    const config_t config = paper_config(real_bridge);
                    const Plant plant = plant_at(config, winding_C, speed_rpm, v_dc_V, real_bridge);
                    const Arrival arrival = step(config, plant);
                    const double along_q_s = least_time_along_q_s(plant, arrival.circle_V);
                    if (along_q_s >= FOREVER_s) {
                        continue; // -450 r/min and 45 V: there is no voltage for -60 A with i_d = 0
                    }
                    const int least = sample_after(along_q_s, 50e-6);
                    SHOW(winding_C);
                    SHOW(speed_rpm);
                    SHOW(v_dc_V);
                    SHOW(real_bridge);
                    CHECK(arrival.limited > 0);
                    CHECK(arrival.sample <= std::max(least, designed_sample(config)) + 2);
                    CHECK(arrival.sample >=
                          sample_after(least_time_s(plant, arrival.circle_V), 50e-6));
                    CHECK(arrival.beyond <= 0.05);
                    limited += least > designed_sample(config) ? 1 : 0;
                }
            }
        }
    }
    CHECK(limited >= 20); // most of these really were a matter of voltage
}

static void test_braking_step_is_not_limited_and_takes_the_designed_time()
{
    // The back-EMF helps: 0.293 Ohm * 60 A = 17.6 V less up to 22.1 V.
    for (const double speed_rpm : {0.0, 50.0, 300.0, 450.0}) {
        for (const double v_dc_V : {45.0, 53.0, 58.0}) {
            const config_t config = paper_config(true);
            const Arrival arrival = step(config, plant_at(config, 120.0, speed_rpm, v_dc_V, true));
            SHOW(speed_rpm);
            SHOW(v_dc_V);
            CHECK(arrival.limited == 0);
            CHECK(std::abs(arrival.sample - designed_sample(config)) <= 1);
            CHECK(arrival.beyond <= 0.05);
        }
    }
}

static void test_integral_gain_sixteen_times_too_large_overshoots()
{
    config_t config = paper_config(false);
    config.current_loop.integral_q_pu_q24 *= 16;
    CHECK(step(config, plant_at(config, 25.0, -350.0, 45.0, false)).beyond > 0.05);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(
        test_voltage_limited_step_arrives_within_two_periods_of_the_least_time_without_overshoot);
    RUN_TEST(test_braking_step_is_not_limited_and_takes_the_designed_time);
    RUN_TEST(test_integral_gain_sixteen_times_too_large_overshoots);
    return UNITY_END();
}
