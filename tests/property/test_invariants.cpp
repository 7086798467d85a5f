/* SPDX-License-Identifier: Apache-2.0 */
// What must hold for every input, whatever the numbers: limits, signs, rotations, and that what is
// reported happened.
#include <cmath>

#include "bench.hpp"
#include "measure.hpp"
#include "property.hpp"

namespace {

constexpr int32_t HALF = 16384;       // of the circle
constexpr int32_t WEAKENING = -32256; // 63/64 of it

using twin::ONE;
using twin::vector;
using twin::Vector2d;
using twin::Vector3d;

#ifdef HUBFOC_SLOW_BUILD
constexpr int COUNT = 50000;
#else
constexpr int COUNT = 2000000;
#endif

pair_t mirror_of(pair_t x)
{
    return {x.x, -x.y};
}

// The paper's vehicle at a random bus voltage and speed, with the currents it may meet.
struct Situation {
    kernel_loop_t loop{};
    kernel_tuning_t tuning{};
    pair_t reference{};
    uint16_t codes[3]{};
    uint16_t theta{};
};

std::string text(const Situation &s)
{
    using property::text;
    return "codes " + text(Vector3d(s.codes[0], s.codes[1], s.codes[2])) + " angle " +
           text(s.theta) + " reference " + text(s.reference) + " integrator " +
           text(s.loop.integrator_q30) + " tuning " + text(s.tuning) + " on-times " +
           text(Vector3d(s.loop.on_q16[0], s.loop.on_q16[1], s.loop.on_q16[2]));
}

const config_t &config = CONFIG_LU2013;

Situation random_situation(Random &random)
{
    Situation s;
    s.loop.dead_time = kernel_dead_time_init(&config);
    s.loop.svpwm = kernel_svpwm_init(kernel_pwm_period_counts(&config),
                                     kernel_min_pulse_counts(&config), s.loop.dead_time.full_counts,
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
        s.loop.on_q16[x] = random.even(0, kernel_pwm_period_counts(&config)) * 65536;
    }
    return s;
}

Vector3d on_counts(const kernel_loop_t &loop)
{
    return {static_cast<double>(loop.on_q16[0] >> 16), static_cast<double>(loop.on_q16[1] >> 16),
            static_cast<double>(loop.on_q16[2] >> 16)};
}

} // namespace

static void test_voltage_limiter_never_lengthens_never_flips_a_sign_and_keeps_d_or_half_of_it()
{
    Random random(101);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const kernel_tuning_t tuning = any_tuning(random);
        const pair_t integrator = any_integrators(random);
        const pair_t reference = inside_circle(random);
        const pair_t i = measured_dq(random);
        const kernel_voltage_t out = kernel_current_loop(integrator, &tuning, reference, i);
        const Vector2d wanted = vector(out.wanted);
        const Vector2d realised = vector(out.realised);
        SHOW(tuning);
        SHOW(integrator);
        SHOW(reference);
        SHOW(i);
        SHOW(wanted);
        SHOW(realised);
        CHECK(realised.norm() <= ONE + 1.0);
        CHECK(std::abs(realised.x()) <= std::abs(wanted.x()));
        CHECK(std::abs(realised.y()) <= std::abs(wanted.y()));
        CHECK(realised.x() * wanted.x() >= 0.0);
        CHECK(realised.y() * wanted.y() >= 0.0);
        // Of a d voltage beyond a half that strengthens the field q may take the rest, and of one
        // that weakens it all beyond 63/64 of the circle.
        if (out.wanted.x <= HALF) {
            CHECK(out.realised.x == std::max(out.wanted.x, WEAKENING));
        } else if (out.wanted.x > HALF) {
            CHECK(out.realised.x > 0.99 * HALF);
        }
        // The interpolated root is at most 0.8 % short where the circle is not steep: inside 0.97
        // nothing is touched.
        if (wanted.norm() < 0.97 * ONE) {
            CHECK(realised == wanted);
        }
    }
}

static void test_vector_that_only_q_overfills_turns_towards_d_and_never_past_an_axis()
{
    Random random(102);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const kernel_tuning_t tuning = any_tuning(random);
        const pair_t integrator = any_integrators(random);
        const pair_t reference = inside_circle(random);
        const pair_t i = measured_dq(random);
        const kernel_voltage_t out = kernel_current_loop(integrator, &tuning, reference, i);
        const Vector2d wanted = vector(out.wanted);
        const Vector2d realised = vector(out.realised);
        SHOW(tuning);
        SHOW(integrator);
        SHOW(reference);
        SHOW(i);
        SHOW(wanted);
        SHOW(realised);
        const double cross = realised.x() * wanted.y() -
                             realised.y() * wanted.x(); // sine of the angle turned, signed
        if (wanted.x() >= WEAKENING && wanted.x() <= HALF && wanted.x() != 0.0) {
            CHECK(cross * wanted.x() * wanted.y() >= 0.0);
            CHECK(realised.dot(wanted) >= 0.0);
        }
    }
}

static void test_reference_limiter_keeps_d_and_gives_q_the_rest_of_the_circle()
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
    for (int draw = 0; draw < COUNT / 4; draw++) {
        SHOW(draw);
        const pair_t wanted = {random.any(LOWEST, HIGHEST), random.any(LOWEST, HIGHEST)};
        SHOW(wanted);
        loop_step(loop, &still, false);
        loop_set_reference(loop, wanted.x, wanted.y);
        Vector2d limited;
        for (int period = 0; period < 3; period++) { // also while a change is shaped
            const loop_output_t out = loop_step(loop, &still, true);
            limited = Vector2d(out.reference_d_pu, out.reference_q_pu);
            CHECK(limited.norm() <= most + 1.0);
        }
        CHECK(limited.x() == std::clamp<double>(wanted.x, -most, most));
        CHECK(limited.y() * wanted.y >= 0.0);
        CHECK(std::abs(limited.y()) <= std::abs(wanted.y));
        // The interpolated root is at most 0.8 % short where the circle is not steep.
        if (vector(wanted).norm() < 0.97 * most) {
            CHECK(limited == vector(wanted));
        }
        // With d alone the angle is kept; with q alone too.
        if (wanted.x == 0 || wanted.y == 0) {
            CHECK(limited.x() * wanted.y == limited.y() * wanted.x);
        }
    }
    loop_free(loop);
}

static void test_compare_values_keep_the_shortest_pulse_on_either_side()
{
    Random random(103);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const int32_t period = random.any(256, 16384);
        const int32_t min_pulse = random.any(0, period / 5);
        const int32_t trim = random.any(0, period / 8);
        const int32_t limit = random.any(8192, 32767);
        const pair_t u = inside_circle(random, ONE);
        const triple_t trims = {random.any(-32768, 32767), random.any(-32768, 32767),
                                random.any(-32768, 32767)};
        SHOW(period);
        SHOW(min_pulse);
        SHOW(trim);
        SHOW(limit);
        SHOW(u);
        SHOW(trims);
        const kernel_svpwm_t svpwm = kernel_svpwm_init(period, min_pulse, trim, limit);
        const triple_t on = kernel_svpwm(&svpwm, u, trims);
        for (const int32_t count : {on.a, on.b, on.c}) {
            CHECK(count >= min_pulse);
            CHECK(count <= period - min_pulse);
        }
    }
}

static void test_voltage_reported_to_the_regulators_is_what_the_compare_values_apply()
{
    // Unless a pulse is clamped, and none is: the line voltages less the trim are the realised
    // vector at the advanced angle.
    Random random(104);
    const double period = kernel_pwm_period_counts(&config);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const Situation s = random_situation(random);
        SHOW(s);
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
        CHECK((made - vector(out.voltage.realised)).norm() <= (1.0 + 1.5 * counts_per_lsb) / unit);
    }
}

static void test_turning_rotor_and_currents_together_turns_the_voltage_with_them()
{
    // By a third of a turn the phases are only renamed: the line voltages are the same, one place
    // further.
    Random random(105);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const Situation s = random_situation(random);
        SHOW(s);
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
            CHECK((vector(out_turned.i_dq) - vector(out.i_dq)).norm() <= 2.0 * 3.7 + 1.0);
            const Vector3d lines = twin::lines(on_counts(after));
            const Vector3d lines_turned = twin::lines(on_counts(after_turned));
            const bool limited =
                vector(out.voltage.wanted) != vector(out.voltage.realised) ||
                vector(out_turned.voltage.wanted) != vector(out_turned.voltage.realised);
            if (!limited) {
                // Twice the largest error of the step, 2.1 counts (test_errors), in whole counts.
                CHECK((Vector3d(lines_turned[1], lines_turned[2], lines_turned[0]) - lines)
                          .cwiseAbs()
                          .maxCoeff() <= 4.0);
            }
        }
    }
}

static void test_current_in_the_rotor_frame_does_not_depend_on_the_rotor_angle()
{
    Random random(106);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const pair_t dq = inside_circle(random);
        const uint16_t first = any_angle(random);
        const uint16_t second = any_angle(random);
        SHOW(dq);
        SHOW(first);
        SHOW(second);
        const auto seen = [&](uint16_t theta) {
            return vector(
                kernel_park(kernel_inverse_park(dq, kernel_cos_sin(theta)), kernel_cos_sin(theta)));
        };
        CHECK((seen(first) - seen(second)).norm() <=
              8.0); // each: two rotations of up to 1.5 sqrt 2 + 1 in either component
    }
}

static void test_driving_and_braking_forward_and_backward_are_mirror_images()
{
    // Seen from the other side of the wheel speed and all of the q axis change their signs;
    // roundings towards minus infinity do not.
    Random random(107);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const kernel_tuning_t tuning = any_tuning(random);
        kernel_tuning_t mirrored = tuning;
        mirrored.forward_q_q25 = -tuning.forward_q_q25;
        mirrored.w_l_d_q10 = -tuning.w_l_d_q10;
        mirrored.w_l_q_q10 = -tuning.w_l_q_q10;
        const pair_t integrator = any_integrators(random);
        const pair_t reference = inside_circle(random, ONE - 2.0);
        const pair_t i = measured_dq(random);
        // An error of full scale saturates, and -32768 has no mirror image.
        if ((vector(reference) - vector(i)).cwiseAbs().maxCoeff() > 32767.0) {
            continue;
        }
        SHOW(tuning);
        SHOW(integrator);
        SHOW(reference);
        SHOW(i);
        const kernel_voltage_t out = kernel_current_loop(integrator, &tuning, reference, i);
        const kernel_voltage_t mirror = kernel_current_loop(mirror_of(integrator), &mirrored,
                                                            mirror_of(reference), mirror_of(i));
        const auto difference_of = [](pair_t a, pair_t b) {
            return Vector2d((vector(a) - vector(mirror_of(b))).cwiseAbs());
        };
        CHECK(difference_of(out.wanted, mirror.wanted).maxCoeff() <= 3.0);
        const Vector2d difference = difference_of(out.realised, mirror.realised);
        CHECK(difference.x() <= 3.0);
        if (std::abs(out.realised.x) < 31700) {
            CHECK(difference.y() <= 3.0 * 4.0 + 3.0); // the circle's slope, |d/q| < 4 there
        }
    }
}

static void test_dead_time_compensation_has_the_sign_of_the_current_and_at_most_the_dead_time()
{
    Random random(108);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        config_t any = config;
        any.drive.dead_time_ns = random.any(0, 10000);
        any.current_loop.dead_time_zone_pu_q15 = random.any(128, 32767);
        const kernel_dead_time_t dead_time = kernel_dead_time_init(&any);
        const pair_t i = inside_circle(random);
        SHOW(any.drive.dead_time_ns);
        SHOW(any.current_loop.dead_time_zone_pu_q15);
        SHOW(i);
        const triple_t trim = kernel_dead_time(dead_time, i);
        const Vector3d current = twin::phases(vector(i));
        // Each slope is kept to half a unit of its last place, so the zero crossing of a phase lies
        // within this of its place.
        const double beside = 2.0 + 0.71 * vector(i).norm() / (2.0 * dead_time.slope_alpha_q8);
        const int32_t got[3] = {trim.a, trim.b, trim.c};
        for (int x = 0; x < 3; x++) {
            CHECK(std::abs(got[x]) <= 32768);
            if (std::abs(current[x]) > beside) {
                CHECK(got[x] * current[x] >= 0.0);
            }
        }
    }
}

static void test_field_weakening_moves_against_the_missing_voltage_and_stays_in_its_limits()
{
    Random random(109);
    for (int draw = 0; draw < COUNT; draw++) {
        SHOW(draw);
        const int32_t most = random.any(0, 32767);
        const int32_t before = -random.even(0, most) * 8192;
        const pair_t wanted = {random.any(-600000, 600000), random.any(-600000, 600000)};
        const int32_t gain = random.any(0, 32767);
        SHOW(most);
        SHOW(before);
        SHOW(wanted);
        SHOW(gain);
        const int32_t after = kernel_field_weakening(before, wanted, gain, most);
        CHECK(after <= 0);
        CHECK(after >= -most * 8192);
        if (vector(wanted).norm() > ONE) {
            CHECK(after <= before);
        }
        if (vector(wanted).norm() < 0.96 * ONE) {
            CHECK(after >= before);
        }
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_voltage_limiter_never_lengthens_never_flips_a_sign_and_keeps_d_or_half_of_it);
    RUN_TEST(test_vector_that_only_q_overfills_turns_towards_d_and_never_past_an_axis);
    RUN_TEST(test_reference_limiter_keeps_d_and_gives_q_the_rest_of_the_circle);
    RUN_TEST(test_compare_values_keep_the_shortest_pulse_on_either_side);
    RUN_TEST(test_voltage_reported_to_the_regulators_is_what_the_compare_values_apply);
    RUN_TEST(test_turning_rotor_and_currents_together_turns_the_voltage_with_them);
    RUN_TEST(test_current_in_the_rotor_frame_does_not_depend_on_the_rotor_angle);
    RUN_TEST(test_driving_and_braking_forward_and_backward_are_mirror_images);
    RUN_TEST(test_dead_time_compensation_has_the_sign_of_the_current_and_at_most_the_dead_time);
    RUN_TEST(test_field_weakening_moves_against_the_missing_voltage_and_stays_in_its_limits);
    return UNITY_END();
}
