/* SPDX-License-Identifier: Apache-2.0 */
// What must hold for every input, whatever the numbers: limits, signs, rotations, and that what is
// reported happened.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <cmath>

#include "bench.hpp"
#include "measure.hpp"

namespace {

using twin::ONE;
using twin::vector;
using twin::Vector2d;
using twin::Vector3d;

#ifdef HUBFOC_SLOW_BUILD
constexpr int COUNT = 50000;
#else
constexpr int COUNT = 2000000;
#endif

pair_t negated(pair_t x)
{
    return {-x.x, -x.y};
}

// The paper's vehicle at a random bus voltage and speed, with the currents it may meet.
struct Situation {
    kernel_loop_t loop{};
    kernel_tuning_t tuning{};
    pair_t reference{};
    uint16_t codes[3]{};
    uint16_t theta{};
};

const config_t &config = CONFIG_LU2013;

Situation random_situation(Random &random)
{
    Situation s;
    s.loop.dead_time = kernel_dead_time_init(&config);
    s.loop.svpwm = kernel_svpwm_init(config.drive.pwm_period_counts, config.drive.min_pulse_counts,
                                     s.loop.dead_time.full_counts,
                                     config.current_loop.modulation_limit_pu_q15);
    s.tuning = kernel_tuning(&config, s.loop.svpwm.modulation_limit_q15, random.even(23860, 30754),
                             random.even(-52700000, 52700000));
    s.reference = inside_circle(random, config.current_loop.max_current_pu_q15);
    s.theta = any_angle(random);
    s.loop.integrator_q30 = {random.even(-(1 << 29), 1 << 29), random.even(-(1 << 29), 1 << 29)};
    const Vector3d i = twin::phases(
        twin::inverse_park(vector(inside_circle(random, 20000.0)), twin::radians(s.theta)));
    for (int x = 0; x < 3; x++) {
        s.loop.offset_q4[x] = 2048 * 16;
        s.codes[x] = static_cast<uint16_t>(std::lround(2048.0 + i[x] / 16.0));
        s.loop.on_q16[x] = random.even(0, config.drive.pwm_period_counts) * 65536;
    }
    return s;
}

Vector3d on_counts(const kernel_loop_t &loop)
{
    return {static_cast<double>(loop.on_q16[0] >> 16), static_cast<double>(loop.on_q16[1] >> 16),
            static_cast<double>(loop.on_q16[2] >> 16)};
}

} // namespace

TEST_CASE("the voltage limiter never lengthens, never flips a sign, leaves d alone and touches "
          "nothing inside the circle")
{
    Random random(101);
    for (int n = 0; n < COUNT; n++) {
        const kernel_tuning_t tuning = any_tuning(random);
        const kernel_voltage_t out = kernel_current_loop(
            any_integrators(random), &tuning, inside_circle(random), measured_dq(random));
        const Vector2d wanted = vector(out.wanted);
        const Vector2d realised = vector(out.realised);
        REQUIRE(realised.norm() <= ONE + 1.0);
        REQUIRE(std::abs(realised.x()) <= std::abs(wanted.x()));
        REQUIRE(std::abs(realised.y()) <= std::abs(wanted.y()));
        REQUIRE(realised.x() * wanted.x() >= 0.0);
        REQUIRE(realised.y() * wanted.y() >= 0.0);
        if (out.wanted.x >= LOWEST && out.wanted.x <= HIGHEST) {
            REQUIRE(out.realised.x == out.wanted.x);
        }
        // The interpolated root is at most 0.8 % short where the circle is not steep: inside 0.97
        // nothing is touched.
        if (wanted.norm() < 0.97 * ONE) {
            REQUIRE(realised == wanted);
        }
    }
}

TEST_CASE("a vector that only q overfills keeps its d component: its angle turns towards d, never "
          "past an axis")
{
    Random random(102);
    for (int n = 0; n < COUNT; n++) {
        const kernel_tuning_t tuning = any_tuning(random);
        const kernel_voltage_t out = kernel_current_loop(
            any_integrators(random), &tuning, inside_circle(random), measured_dq(random));
        const Vector2d wanted = vector(out.wanted);
        const Vector2d realised = vector(out.realised);
        const double cross = realised.x() * wanted.y() -
                             realised.y() * wanted.x(); // sine of the angle turned, signed
        if (std::abs(wanted.x()) <= ONE && wanted.x() != 0.0) {
            REQUIRE(cross * wanted.x() * wanted.y() >= 0.0);
            REQUIRE(realised.dot(wanted) >= 0.0);
        }
    }
}

TEST_CASE("the reference limiter keeps d and its sign, gives q what the circle leaves and touches "
          "nothing inside")
{
    Random random(110);
    const double most = config.current_loop.max_current_pu_q15;
    config_t firmware = bench::paper_config(true);
    firmware.current_loop.field_weakening_current_pu_q15 =
        0; // what the voltage asks for is not in question
    loop_t *loop = loop_new(&firmware);
    loop_input_t still{};
    for (uint16_t &code : still.phase_code) {
        code = 2048;
    }
    still.bus_code = 3513; // 53 V
    for (int n = 0; n < COUNT / 4; n++) {
        const pair_t wanted = {random.any(LOWEST, HIGHEST), random.any(LOWEST, HIGHEST)};
        loop_step(loop, &still, false);
        loop_set_reference(loop, wanted.x, wanted.y);
        Vector2d limited;
        for (int period = 0; period < 3; period++) { // also while a change is shaped
            const loop_output_t out = loop_step(loop, &still, true);
            limited = Vector2d(out.reference_d_pu, out.reference_q_pu);
            REQUIRE(limited.norm() <= most + 1.0);
        }
        REQUIRE(limited.x() == std::clamp<double>(wanted.x, -most, most));
        REQUIRE(limited.y() * wanted.y >= 0.0);
        REQUIRE(std::abs(limited.y()) <= std::abs(wanted.y));
        // The interpolated root is at most 0.8 % short where the circle is not steep.
        if (vector(wanted).norm() < 0.97 * most) {
            REQUIRE(limited == vector(wanted));
        }
        // With d alone the angle is kept; with q alone too.
        if (wanted.x == 0 || wanted.y == 0) {
            REQUIRE(limited.x() * wanted.y == limited.y() * wanted.x);
        }
    }
    loop_free(loop);
}

TEST_CASE("compare values of any vector in the circle with any trim keep the shortest pulse on "
          "either side")
{
    Random random(103);
    for (int n = 0; n < COUNT; n++) {
        const int32_t period = random.any(256, 16384);
        const int32_t min_pulse = random.any(0, period / 5);
        const int32_t trim = random.any(0, period / 8);
        const kernel_svpwm_t svpwm =
            kernel_svpwm_init(period, min_pulse, trim, random.any(8192, 32767));
        const triple_t on = kernel_svpwm(
            &svpwm, inside_circle(random, ONE),
            {random.any(-32768, 32767), random.any(-32768, 32767), random.any(-32768, 32767)});
        for (const int32_t count : {on.a, on.b, on.c}) {
            REQUIRE(count >= min_pulse);
            REQUIRE(count <= period - min_pulse);
        }
    }
}

TEST_CASE("what the regulators are told was realised is what the compare values make")
{
    // Unless a pulse is clamped, and none is: the line voltages less the trim are the realised
    // vector at the advanced angle.
    Random random(104);
    const double period = config.drive.pwm_period_counts;
    for (int n = 0; n < COUNT; n++) {
        Situation s = random_situation(random);
        kernel_loop_t after = s.loop;
        const kernel_loop_out_t out = kernel_loop(&after, &s.tuning, s.codes, s.theta, s.reference);
        const double applied =
            twin::radians(s.theta) + std::atan2(s.tuning.advance.y, s.tuning.advance.x);
        const Vector3d trim = twin::dead_time(twin::inverse_park(vector(s.reference), applied),
                                              s.loop.dead_time.full_counts,
                                              config.current_loop.dead_time_zone_pu_q15);
        const Vector2d ab = twin::clarke(on_counts(after) - trim);
        const double unit = s.loop.svpwm.modulation_limit_q15 / ONE * period / std::sqrt(3.0) / ONE;
        const Vector2d made = twin::park(ab, applied) / unit;
        // One count of a leg is 2/3 of a count of the vector, with the rounding of the voltage one
        // count. Inside the zone every LSB of the turned reference is some share of a count of
        // trim, and its rounding is one and a half.
        const double counts_per_lsb = static_cast<double>(s.loop.dead_time.full_counts) /
                                      config.current_loop.dead_time_zone_pu_q15;
        REQUIRE((made - vector(out.voltage.realised)).norm() <=
                (1.0 + 1.5 * counts_per_lsb) / unit);
    }
}

TEST_CASE("turning rotor and currents together turns the voltage with them")
{
    // By a third of a turn the phases are only renamed: the line voltages are the same, one place
    // further.
    Random random(105);
    for (int n = 0; n < COUNT; n++) {
        const Situation s = random_situation(random);
        Situation turned = s;
        turned.theta = static_cast<uint16_t>(s.theta + 21845U); // 65 536/3 less a third of an LSB
        for (int x = 0; x < 3; x++) {
            turned.codes[(x + 1) % 3] = s.codes[x];
            turned.loop.on_q16[(x + 1) % 3] = s.loop.on_q16[x];
        }
        kernel_loop_t after = s.loop;
        kernel_loop_t after_turned = turned.loop;
        const kernel_loop_out_t out = kernel_loop(&after, &s.tuning, s.codes, s.theta, s.reference);
        const kernel_loop_out_t out_turned = kernel_loop(
            &after_turned, &turned.tuning, turned.codes, turned.theta, turned.reference);
        // A tie of on-times is broken by the phase's name, so the reconstructed phase may differ
        // there.
        const bool tie = s.loop.on_q16[0] == s.loop.on_q16[1] ||
                         s.loop.on_q16[1] == s.loop.on_q16[2] ||
                         s.loop.on_q16[2] == s.loop.on_q16[0];
        if (!tie) {
            REQUIRE((vector(out_turned.i_dq) - vector(out.i_dq)).norm() <= 2.0 * 3.7 + 1.0);
            const Vector3d lines = twin::lines(on_counts(after));
            const Vector3d lines_turned = twin::lines(on_counts(after_turned));
            const bool limited =
                vector(out.voltage.wanted) != vector(out.voltage.realised) ||
                vector(out_turned.voltage.wanted) != vector(out_turned.voltage.realised);
            if (!limited) {
                // Twice the largest error of the step, 2.1 counts (test_errors), in whole counts.
                REQUIRE((Vector3d(lines_turned[1], lines_turned[2], lines_turned[0]) - lines)
                            .cwiseAbs()
                            .maxCoeff() <= 4.0);
            }
        }
    }
}

TEST_CASE("the current in the rotor frame does not depend on where the rotor stands")
{
    Random random(106);
    for (int n = 0; n < COUNT; n++) {
        const pair_t dq = inside_circle(random);
        const uint16_t first = any_angle(random);
        const uint16_t second = any_angle(random);
        const auto seen = [&](uint16_t theta) {
            return vector(
                kernel_park(kernel_inverse_park(dq, kernel_cos_sin(theta)), kernel_cos_sin(theta)));
        };
        REQUIRE((seen(first) - seen(second)).norm() <=
                8.0); // each: two rotations of up to 1.5 sqrt 2 + 1 in either component
    }
}

TEST_CASE("driving and braking, forward and backward are mirror images")
{
    // All currents, references, voltages and the speed change their signs; roundings towards minus
    // infinity do not.
    Random random(107);
    for (int n = 0; n < COUNT; n++) {
        const kernel_tuning_t tuning = any_tuning(random);
        kernel_tuning_t mirrored = tuning;
        mirrored.forward_d_q25 = -tuning.forward_d_q25;
        mirrored.forward_q_q25 =
            -tuning
                 .forward_q_q25; // speed and flux seen from the other side; w L i keeps its factor
        const pair_t integrator = any_integrators(random);
        const pair_t reference = inside_circle(random, ONE - 2.0);
        const pair_t i = measured_dq(random);
        // An error of full scale saturates, and -32768 has no mirror image.
        if ((vector(reference) - vector(i)).cwiseAbs().maxCoeff() > 32767.0) {
            continue;
        }
        const kernel_voltage_t out = kernel_current_loop(integrator, &tuning, reference, i);
        const kernel_voltage_t mirror =
            kernel_current_loop(negated(integrator), &mirrored, negated(reference), negated(i));
        REQUIRE((vector(out.wanted) + vector(mirror.wanted)).cwiseAbs().maxCoeff() <= 3.0);
        const Vector2d difference = (vector(out.realised) + vector(mirror.realised)).cwiseAbs();
        REQUIRE(difference.x() <= 3.0);
        if (std::abs(out.realised.x) < 31700) {
            REQUIRE(difference.y() <= 3.0 * 4.0 + 3.0); // the circle's slope, |d/q| < 4 there
        }
    }
}

TEST_CASE(
    "the compensation of dead time has the sign of the current and never more than the dead time")
{
    Random random(108);
    for (int n = 0; n < COUNT; n++) {
        config_t any = config;
        any.drive.dead_time_ns = random.any(0, 10000);
        any.current_loop.dead_time_zone_pu_q15 = random.any(128, 32767);
        const kernel_dead_time_t dead_time = kernel_dead_time_init(&any);
        const pair_t i = inside_circle(random);
        const triple_t trim = kernel_dead_time(dead_time, i);
        const Vector3d current = twin::phases(vector(i));
        // Each slope is kept to half a unit of its last place, so the zero crossing of a phase lies
        // within this of its place.
        const double beside = 2.0 + 0.71 * vector(i).norm() / (2.0 * dead_time.slope_alpha_q8);
        const int32_t got[3] = {trim.a, trim.b, trim.c};
        for (int x = 0; x < 3; x++) {
            REQUIRE(std::abs(got[x]) <= 32768);
            if (std::abs(current[x]) > beside) {
                REQUIRE(got[x] * current[x] >= 0.0);
            }
        }
    }
}

TEST_CASE("field weakening moves against the missing voltage and stays between its limits")
{
    Random random(109);
    for (int n = 0; n < COUNT; n++) {
        const int32_t most = random.any(0, 32767);
        const int32_t before = -random.even(0, most) * 8192;
        const pair_t wanted = {random.any(-600000, 600000), random.any(-600000, 600000)};
        const int32_t after = kernel_field_weakening(before, wanted, random.any(0, 32767), most);
        REQUIRE(after <= 0);
        REQUIRE(after >= -most * 8192);
        if (vector(wanted).norm() > ONE) {
            REQUIRE(after <= before);
        }
        if (vector(wanted).norm() < 0.96 * ONE) {
            REQUIRE(after >= before);
        }
    }
}
