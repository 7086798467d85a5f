/* SPDX-License-Identifier: Apache-2.0 */
#include "errors.hpp"

#include <algorithm>
#include <cmath>

#include "measure.hpp"
#include "twin.hpp"

namespace {

using twin::ONE;
using twin::vector;
using twin::Vector2d;
using twin::Vector3d;

// Alpha is exact. Twice beta is rounded down, then beta to the nearest; the constant is off by 0.09
// of 2^-17, 0.03 LSB of beta.
Measured sense(int64_t count)
{
    Random random(7);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        uint16_t codes[3];
        int32_t on[3];
        int32_t offset[3];
        for (int x = 0; x < 3; x++) {
            codes[x] = static_cast<uint16_t>(random.any(0, 4095));
            on[x] = random.any(0, 16384 << 16);
            offset[x] = random.any(1024 * 16, 3072 * 16);
        }
        largest.see(vector(kernel_sense(codes, offset, on)) - twin::sense(codes, offset, on));
    }
    return {"sense_step", largest.value, 0.53, "LSB"};
}

// One rounding of the whole sum; what is realised inside the circle is the same number.
Measured wanted_voltage(int64_t count)
{
    Random random(10);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const kernel_tuning_t plain = any_tuning(random);
        const pair_t integrator = any_integrators(random);
        const pair_t reference = inside_circle(random);
        const pair_t i = measured_dq(random);
        const kernel_voltage_t out = kernel_current_loop(integrator, &plain, reference, i);
        const twin::Voltage exact = twin::current_loop(
            vector(integrator) / ONE, twin::Tuning(plain), vector(reference), vector(i));
        largest.see(vector(out.wanted) - exact.wanted);
    }
    return {"current_controller_step", largest.value, 1.0, "LSB"};
}

// Of one axis, by the firmware's own wanted and applied voltage: exact, as long as the error by
// itself does not fill the integrator. What is missing counts up to four units.
double integrator_error(double before, const twin::Gains &gains, double error, int32_t wanted,
                        int32_t realised, int32_t after_q30)
{
    const double with_error = before + gains.integral * error;
    if (std::abs(with_error) >= ONE - 1.0) {
        return 0.0;
    }
    const double missing = std::clamp(realised - wanted, -131072, 131071);
    return after_q30 / ONE - std::clamp(with_error + gains.anti_windup * missing, -ONE, ONE);
}

Measured integrators(int64_t count)
{
    Random random(9);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const kernel_tuning_t plain = any_tuning(random);
        const twin::Tuning tuning(plain);
        const pair_t before = any_integrators(random);
        const pair_t reference = inside_circle(random);
        const pair_t i = measured_dq(random);
        const Vector2d error = twin::saturated(vector(reference) - vector(i));
        const kernel_voltage_t out = kernel_current_loop(before, &plain, reference, i);
        largest.see(integrator_error(before.x / ONE, tuning.d, error.x(), out.wanted.x,
                                     out.realised.x, out.integrator_q30.x));
        largest.see(integrator_error(before.y / ONE, tuning.q, error.y(), out.wanted.y,
                                     out.realised.y, out.integrator_q30.y));
    }
    return {"current_controller_step, integrators", largest.value, 1e-4, "LSB"};
}

// The first leg is rounded by half a count at most, the second follows it within a half, the third
// the mean of both within a half: three quarters between the last two. alpha_counts is rounded:
// half a unit of it is a quarter of a count at full length.
Measured line_voltages(int64_t count, int32_t period, const char *name, double bound)
{
    Random random(11);
    Largest largest;
    const kernel_svpwm_t svpwm = kernel_svpwm_init(period, period / 20, period / 50, HIGHEST);
    for (int64_t n = 0; n < count; n++) {
        const pair_t u = inside_circle(random);
        const Vector3d on = vector(kernel_svpwm(&svpwm, u, {0, 0, 0}));
        largest.see(twin::lines(on) - twin::modulate(vector(u), svpwm.beta_counts));
    }
    return {name, largest.value, bound, "counts"};
}

// The paper's vehicle with its numbers as they were when the table was written, so that a new
// configuration does not move it.
config_t papers_vehicle()
{
    config_t config = CONFIG_LU2013;
    config.drive.current_full_scale_mA = 165000;
    config.drive.voltage_full_scale_mV = 61800;
    config.drive.pwm_frequency_Hz = 20000;
    config.drive.min_pulse_ns = 1500;
    config.drive.dead_time_ns = 1000;
    config.drive.diode_drop_mV = 0;
    config.current_loop.proportional_d_pu_q16 = 51313;
    config.current_loop.proportional_q_pu_q16 = 51313;
    config.current_loop.integral_d_pu_q24 = 267909;
    config.current_loop.integral_q_pu_q24 = 267909;
    config.current_loop.inductance_d_pu_q16 = 104443;
    config.current_loop.inductance_q_pu_q16 = 104443;
    config.current_loop.flux_pu_q16 = 169907;
    config.current_loop.modulation_limit_pu_q15 = 28835;
    config.current_loop.max_current_pu_q15 = 14895;
    config.current_loop.dead_time_zone_pu_q15 = 138;
    return config;
}

// The paper's vehicle: 84 counts, and the two slopes of its zone in 1/256 LSB per LSB, rounded
// down.
Measured dead_time(int64_t count)
{
    Random random(12);
    Largest largest;
    const config_t config = papers_vehicle();
    const kernel_dead_time_t dead_time = kernel_dead_time_init(&config);
    const double zone = config.current_loop.dead_time_zone_pu_q15;
    for (int64_t n = 0; n < count; n++) {
        const pair_t i = n % 2 == 0 ? inside_circle(random) : inside_circle(random, 1.2 * zone);
        largest.see(vector(kernel_dead_time(dead_time, i)) / ONE * dead_time.full_counts -
                    twin::dead_time(vector(i), dead_time.full_counts, zone));
    }
    /* The share is rounded once. Each slope is kept to half a unit, which moves the zero of a phase
     * in a long vector; and their common factor, the slope of the zone, is rounded down. */
    const double slope = 1.0 * dead_time.slope_alpha_q8;
    const double bound =
        dead_time.full_counts * (1.0 / ONE + 0.71 * ONE / (slope * zone) + 1.0 / slope);
    return {"modulation_dead_time", largest.value, bound, "counts"};
}

// Four periods of one product of a squared voltage that was rounded once.
Measured field_weakening(int64_t count)
{
    Random random(13);
    Largest largest;
    for (int64_t n = 0; n < count; n++) {
        const int32_t gain = random.any(0, HIGHEST);
        const pair_t wanted = inside_circle(random);
        const int32_t before_q28 = -random.any(0, 1 << 27);
        const double margin = 30760.0 - vector(wanted).squaredNorm() / ONE;
        const double exact =
            std::clamp(4.0 * before_q28 + 4.0 * gain * std::clamp(margin, -32768.0, 32767.0),
                       -32767.0 * ONE, 0.0);
        largest.see((4.0 * kernel_field_weakening(before_q28, wanted, gain, HIGHEST) - exact) /
                    ONE);
    }
    return {"field_weakening_step", largest.value, 4.0, "LSB"};
}

// From codes and angle to line voltages with the tuning of the paper's vehicle between 45 and 58 V
// up to 640 r/min, where the circle does not bite. The angle's error reaches the current as in
// "phases to dq"; the proportional gain, up to 3 here, multiplies it, the way back adds that of the
// voltage; the modulator adds its own.
Measured whole_loop(int64_t count)
{
    Random random(14);
    Largest largest;
    const config_t config = papers_vehicle();
    kernel_loop_t loop{};
    loop.dead_time = kernel_dead_time_init(&config);
    loop.svpwm =
        kernel_svpwm_init(kernel_pwm_period_counts(&config), kernel_min_pulse_counts(&config),
                          loop.dead_time.full_counts, config.current_loop.modulation_limit_pu_q15);
    for (int64_t n = 0; n < count; n++) {
        const int32_t v_dc = random.even(23860, 30754); // 45 to 58 V
        const kernel_tuning_t tuning = kernel_tuning(&config, loop.svpwm.modulation_limit_q15, v_dc,
                                                     random.even(-52700000, 52700000));
        const uint16_t theta = any_angle(random);
        const pair_t reference = inside_circle(random, config.current_loop.max_current_pu_q15);
        uint16_t codes[3];
        const Vector3d i = twin::phases(twin::inverse_park(
            vector(reference) + vector(inside_circle(random, 3000.0)), twin::radians(theta)));
        for (int x = 0; x < 3; x++) {
            loop.offset_q4[x] = random.even(2000 * 16, 2100 * 16);
            codes[x] = static_cast<uint16_t>(
                std::clamp(std::lround((i[x] + loop.offset_q4[x]) / 16.0), 1L, 4094L));
            loop.on_q16[x] = random.even(0, kernel_pwm_period_counts(&config)) * 65536;
        }
        loop.integrator_q30 = {random.even(-(1 << 28), 1 << 28), random.even(-(1 << 28), 1 << 28)};
        kernel_loop_t after = loop;
        const twin::Loop exact =
            twin::loop(loop, twin::Tuning(tuning), codes, theta, vector(reference),
                       config.current_loop.dead_time_zone_pu_q15);
        const kernel_loop_out_t out = kernel_loop(&after, &tuning, codes, theta, reference);
        if (out.voltage.wanted.x == out.voltage.realised.x &&
            out.voltage.wanted.y == out.voltage.realised.y &&
            exact.voltage.wanted == exact.voltage.realised) {
            const triple_t on = {after.on_q16[0] >> 16, after.on_q16[1] >> 16,
                                 after.on_q16[2] >> 16};
            largest.see(twin::lines(vector(on)) - exact.line_counts);
        }
    }
    return {"foc_current_step", largest.value, 4.0, "counts"};
}

} // namespace

std::vector<Measured> measure_loop(int64_t count)
{
    return {sense(count),
            wanted_voltage(count),
            integrators(count),
            dead_time(count),
            field_weakening(count),
            line_voltages(count, 4200, "modulation_step, 4 200 counts", 1.0),
            line_voltages(count, 16384, "modulation_step, 16 384 counts", 1.0),
            whole_loop(count)};
}
