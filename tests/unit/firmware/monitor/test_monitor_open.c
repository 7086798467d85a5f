/* SPDX-License-Identifier: Apache-2.0 */
/* A phase wire or a switch that is open. The currents of a broken star are written down per phase:
 * what one phase cannot carry, the other two do not either. */
#include "monitor/monitor_open.h"

#include <math.h>

#include "monitor_case.h"
#include "paper_vehicle.h"
#include "unity.h"

#define TURN_RAD 6.283185307179586

enum { LENGTH_PU = 12000, LIGHT_PU = 2000 };

typedef struct {
    double a, b, c;
} star_t;

typedef star_t (*path_t)(star_t wanted);

static monitor_open_state_t state;
static int32_t length_pu; /* of the reference */
static int32_t edge_pu;

static void begin(void)
{
    const monitor_open_state_t fresh = {.suspected = false};
    state = fresh;
}

void setUp(void)
{
    begin();
    length_pu = LENGTH_PU;
    edge_pu = 0;
}

void tearDown(void) {}

static reason_t step(dq_t sampled_pu, dq_t reference_pu, uint16_t theta_turn, int32_t sum_pu)
{
    const monitor_case_t in = {.report = {.sample = {.theta_turn = theta_turn},
                                          .i_pu = dq16_of(sampled_pu),
                                          .current_sum_pu = sum_pu,
                                          .bridge = BRIDGE_PWM}};
    return monitor_open_step(&state, measured_of(&in), reference_pu, edge_pu);
}

static reason_t step_off(void)
{
    const monitor_case_t in = {.report = {.bridge = BRIDGE_OFF}};
    const dq_t none = {0, 0};
    return monitor_open_step(&state, measured_of(&in), none, 0);
}

static star_t healthy(star_t i)
{
    return i;
}

static star_t wire_b_open(star_t i)
{
    const double through = (i.a - i.c) / 2.0;
    const star_t out = {through, 0.0, -through};
    return out;
}

/* Shunts in legs a and c only, whose gains differ by a tenth; b is what they do not add up to. */
static star_t wire_b_open_beside_wrong_gains(star_t i)
{
    const star_t out = wire_b_open(i);
    const star_t read = {1.05 * out.a, 0.95 * out.a - 1.05 * out.a, 0.95 * out.c};
    return read;
}

/* No current into the motor from leg a. */
static star_t high_switch_a_open(star_t i)
{
    const double through = (i.b - i.c) / 2.0;
    const star_t out = {0.0, through, -through};
    return i.a > 0.0 ? out : i;
}

static star_t no_path(star_t i)
{
    (void)i;
    const star_t out = {0.0, 0.0, 0.0};
    return out;
}

/* q current of the reference turns with the rotor: phase a is -sin. */
static star_t wanted_at(double angle_rad)
{
    const star_t out = {-length_pu * sin(angle_rad), -length_pu * sin(angle_rad - TURN_RAD / 3),
                        -length_pu * sin(angle_rad + TURN_RAD / 3)};
    return out;
}

static dq_t park(star_t i, double angle_rad)
{
    const double alpha = i.a;
    const double beta = (i.b - i.c) / sqrt(3.0);
    const dq_t out = {
        .d = (int32_t)lround(alpha * cos(angle_rad) + beta * sin(angle_rad)),
        .q = (int32_t)lround(beta * cos(angle_rad) - alpha * sin(angle_rad)),
    };
    return out;
}

static const dq_t REFERENCE = {.d = 0, .q = LENGTH_PU};

static uint16_t theta_of(double turn)
{
    return (uint16_t)lround(65535.0 * (turn - floor(turn)));
}

static bool step_at(path_t path, double turn, double share)
{
    const double angle_rad = TURN_RAD * (turn - floor(turn));
    star_t i = path(wanted_at(angle_rad));
    i.a *= share;
    i.b *= share;
    i.c *= share;
    const dq_t reference = {.d = 0, .q = length_pu};
    return step(park(i, angle_rad), reference, theta_of(turn), 0) != REASON_NONE;
}

/* Milliseconds until the phase is named; -1: not within `most`. */
static int time_to_name(path_t path, double begin_turn, double turns_per_ms, int most)
{
    begin();
    for (int ms = 1; ms <= most; ms++) {
        if (step_at(path, begin_turn + turns_per_ms * ms, 1.0)) {
            return ms;
        }
    }
    return -1;
}

/* At 100 Hz a half wave is 5 ms, of which the reference is above half of its peak for 3.3; an open
 * wire has one of either sign, so three samples of one sign within a turn and a bit. */
void test_open_wire_is_named_within_a_turn_from_any_angle(void)
{
    for (int k = 0; k < 24; k++) {
        const int ms = time_to_name(wire_b_open, k / 24.0, 0.1, 20);
        TEST_ASSERT_GREATER_OR_EQUAL_INT(3, ms);
        TEST_ASSERT_LESS_OR_EQUAL_INT(11, ms);
    }
}

void test_open_wire_is_named_beside_gains_that_differ_by_a_tenth(void)
{
    for (int k = 0; k < 24; k++) {
        const int ms = time_to_name(wire_b_open_beside_wrong_gains, k / 24.0, 0.1, 20);
        TEST_ASSERT_GREATER_OR_EQUAL_INT(3, ms);
        TEST_ASSERT_LESS_OR_EQUAL_INT(11, ms);
    }
}

void test_open_switch_is_named_in_its_half_wave(void)
{
    for (int k = 0; k < 24; k++) {
        const int ms = time_to_name(high_switch_a_open, k / 24.0, 0.1, 20);
        TEST_ASSERT_GREATER_OR_EQUAL_INT(3, ms);
        TEST_ASSERT_LESS_OR_EQUAL_INT(11, ms);
    }
}

/* 6 % of the range, 52 Hz: named before an observer, deceived by the voltage of a leg that has no
 * current, contradicts the rotor's sensor 8 ms later. */
void test_open_switch_of_a_small_current_is_named_in_its_half_wave(void)
{
    length_pu = LIGHT_PU;
    for (int k = 0; k < 24; k++) {
        const int ms = time_to_name(high_switch_a_open, 0.5 - 0.052 * k / 24.0, 0.052, 20);
        TEST_ASSERT_GREATER_OR_EQUAL_INT(3, ms);
        TEST_ASSERT_LESS_OR_EQUAL_INT(8, ms);
        TEST_ASSERT_EQUAL_INT(-1, time_to_name(healthy, k / 24.0, 0.052, 100));
    }
}

/* 5 Hz: 30 degrees are 17 ms, half a turn until the half wave comes 100 ms. */
void test_open_phase_of_a_slow_rotor_is_named_by_the_angle_it_stays_at_zero(void)
{
    TEST_ASSERT_LESS_OR_EQUAL_INT(22, time_to_name(wire_b_open, 0.1, 0.005, 400));
    TEST_ASSERT_LESS_OR_EQUAL_INT(120, time_to_name(high_switch_a_open, 0.5, 0.005, 400));
}

/* All speeds from standstill to 1 kHz, also those at which every sample meets a phase's zero, and
 * currents shorter than the reference. */
void test_healthy_phases_are_never_named(void)
{
    for (int speed = 0; speed <= 1000; speed++) {
        for (int begin = 0; begin < 4; begin++) {
            TEST_ASSERT_EQUAL_INT(-1, time_to_name(healthy, begin / 16.0, speed / 1000.0, 40));
            TEST_ASSERT_FALSE(state.suspected);
        }
    }
    for (int ms = 0; ms < 1000; ms++) {
        TEST_ASSERT_FALSE(step_at(healthy, 0.07 * ms, 0.3));
    }
}

static bool step_beside(double lag_turn, double turn, double share)
{
    const double angle_rad = TURN_RAD * (turn - floor(turn));
    const star_t whole = wanted_at(angle_rad - TURN_RAD * lag_turn);
    const star_t i = {share * whole.a, share * whole.b, share * whole.c};
    const dq_t reference = {.d = 0, .q = length_pu};
    return step(park(i, angle_rad), reference, theta_of(turn), 0) != REASON_NONE;
}

/* A phase that is judged is wanted 30 degrees from its zero or further. A healthy vector has less
 * than a sixth of the others there within atan(0.866 / 5.5) = 8.9 degrees: 21 from the reference,
 * whatever its length. */
void test_healthy_current_within_20_degrees_of_its_reference_is_not_named(void)
{
    static const double SHARE[] = {1.0, 0.6, 0.3, 0.12};
    for (int sample = 0; sample < 4 * 360; sample++) {
        const double turn = (sample / 4) / 360.0;
        for (int side = -1; side <= 1; side += 2) {
            setUp();
            for (int ms = 0; ms < 4; ms++) {
                const bool named = step_beside(side * 20.0 / 360.0, turn, SHARE[sample % 4]);
                TEST_ASSERT_FALSE(named || state.suspected);
            }
        }
    }
}

/* Leg a is stuck: phases b and c share its current, with the same sign. One that has a quarter of
 * the other carries a fifth of leg a's and is not open; one that has an eighth, a ninth, looks like
 * it. The reference wants its peak in phase b. */
void test_phase_that_carries_a_fifth_of_a_stuck_leg_is_not_named(void)
{
    static const star_t STUCK[] = {{-10000.0, 2000.0, 8000.0}, {-9000.0, 1000.0, 8000.0}};
    const double angle_rad = TURN_RAD / 12.0; /* -sin(30 - 120 degrees) is 1 */
    for (int k = 0; k < 2; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            setUp();
            const star_t i = {sign * STUCK[k].a, sign * STUCK[k].b, sign * STUCK[k].c};
            const dq_t reference_pu = {.d = 0, .q = sign * LENGTH_PU};
            reason_t named = REASON_NONE;
            for (int ms = 0; ms < 10; ms++) {
                named = step(park(i, angle_rad), reference_pu, 65536 / 12, 0);
            }
            TEST_ASSERT_EQUAL_INT(k == 1 ? REASON_PHASE_OPEN : REASON_NONE, named);
        }
    }
}

/* Dead sensors, open drivers: another check's. */
void test_three_phases_without_a_current_are_no_open_phase(void)
{
    for (int speed = 0; speed <= 300; speed++) {
        TEST_ASSERT_EQUAL_INT(-1, time_to_name(no_path, 0.1, speed / 1000.0, 40));
    }
}

void test_bridge_that_does_not_switch_has_no_open_phase_and_forgets(void)
{
    (void)step_at(wire_b_open, 0.1, 1.0);
    (void)step_at(wire_b_open, 0.2, 1.0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step_off());
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_EQUAL_UINT8(0, state.missing[x][0] + state.missing[x][1]);
        TEST_ASSERT_EQUAL_UINT16(0, state.turned[x]);
    }
}

static bool step_with(double current_turn, double turn)
{
    const double angle_rad = TURN_RAD * (turn - floor(turn));
    const dq_t sampled_pu = park(wanted_at(TURN_RAD * current_turn), angle_rad);
    return step(sampled_pu, REFERENCE, theta_of(turn), 0) != REASON_NONE;
}

/* A wheel that hangs on a slope where a phase passes its zero, after it has crept through 12
 * degrees; then its hall sensors report an edge, the angle jumps, and for one sample the currents
 * stay where they were. */
void test_healthy_phases_of_a_wheel_that_hangs_at_a_hall_edge_are_not_named(void)
{
    static const double JUMP[] = {-1.0 / 6.0, -1.0 / 12.0, 1.0 / 12.0, 1.0 / 6.0};
    for (int zero = 0; zero < 6; zero++) {
        for (int j = 0; j < 4; j++) {
            setUp();
            double turn = 0.0;
            for (int ms = 0; ms <= 120; ms++) {
                turn = zero / 6.0 + (ms - 60) / 3600.0;
                TEST_ASSERT_FALSE(step_with(turn, turn));
            }
            for (int ms = 0; ms < 50; ms++) {
                TEST_ASSERT_FALSE(step_with(turn, turn));
            }
            TEST_ASSERT_FALSE(step_with(turn, turn + JUMP[j]));
            for (int ms = 0; ms < 50; ms++) {
                TEST_ASSERT_FALSE(step_with(turn + JUMP[j], turn + JUMP[j]));
            }
        }
    }
}

/* A reference of 8.7 % of the range that turns by 21 degrees a millisecond; the current that a
 * misplaced hall edge makes drags the vector back by up to half of its length, so that phase a
 * stays near its zero for three samples. Of a phase that carries none they are evidence. */
void test_current_of_a_misplaced_hall_edge_leaves_a_healthy_phase_at_zero(void)
{
    static const double WANTED_deg[] = {-28.0, -7.0, 14.0, 35.0, 56.0};
    static const double CURRENT_deg[] = {-28.0, -5.0, 1.0, 6.0, 28.0};
    length_pu = 2840;
    for (int k = 0; k < 2; k++) {
        begin();
        edge_pu = k == 0 ? 0 : 1400;
        bool named = false;
        for (int n = 0; n < 5; n++) {
            named |=
                step_beside((WANTED_deg[n] - CURRENT_deg[n]) / 360.0, WANTED_deg[n] / 360.0, 1.0);
        }
        TEST_ASSERT_EQUAL(k == 0, named);
    }
}

/* By the reference likewise: one below 2798 or 3400, whose peak is 3233. */
void test_a_reference_below_twice_the_current_of_an_edge_is_not_judged(void)
{
    length_pu = 3233;
    edge_pu = 1399;
    const double peak_turn = 0.25 - 1.0 / 12.0;
    TEST_ASSERT_EQUAL_INT(3, time_to_name(wire_b_open, peak_turn + 1.0 / 3.0, 0.02, 6));
    edge_pu = 1700;
    TEST_ASSERT_EQUAL_INT(-1, time_to_name(wire_b_open, peak_turn + 1.0 / 3.0, 0.02, 6));
}

/* lu2013 at 21.3 V: 21.3 V/16 over 0.808 61.8 V/165 A is 4.40 A. */
void test_current_of_a_hall_edge_is_its_voltage_over_the_proportional_gain(void)
{
    config_t config = paper_vehicle();
    const measured_t now = {.latest_u_q_mV = -21300};
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    TEST_ASSERT_INT32_WITHIN(3, 873, monitor_open_edge_pu(&config, &now));
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    TEST_ASSERT_EQUAL_INT32(0, monitor_open_edge_pu(&config, &now));
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    TEST_ASSERT_EQUAL_INT32(0, monitor_open_edge_pu(&config, &now));
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    config.current_loop.proportional_d_pu_q16 = 1;
    TEST_ASSERT_EQUAL_INT32(MONITOR_OPEN_MOST_EDGE_PU, monitor_open_edge_pu(&config, &now));
}

/* The d-axis reference falls and comes back while the rotor turns, so that a phase keeps near its
 * zero through 45 degrees: recorded from a vehicle that lets its charging current go. */
void test_reference_that_turns_against_the_rotor_leaves_a_healthy_phase_at_zero(void)
{
    static const struct {
        double theta_deg;
        star_t i;
        int32_t d_pu;
        int32_t q_pu;
    } SEEN[] = {
        {352.3, {-3265, -610, 3874}, -2892, -3042}, {358.2, {-3041, -1009, 4049}, -2919, -3045},
        {1.7, {-2785, -1362, 4146}, -2963, -3049},  {7.5, {-1233, -2177, 3409}, -628, -3032},
        {13.3, {-353, -2594, 2946}, -628, -3035},   {19.1, {255, -2849, 2595}, -628, -3039},
        {24.9, {-289, -2897, 3185}, -2547, -3060},  {30.8, {-416, -3089, 3505}, -2753, -3065},
        {36.6, {-272, -3329, 3601}, -2807, -3068},  {42.4, {16, -3552, 3536}, -2809, -3071},
        {48.2, {383, -3760, 3378}, -2821, -3074},
    };
    for (unsigned n = 0; n < sizeof SEEN / sizeof SEEN[0]; n++) {
        const double turn = SEEN[n].theta_deg / 360.0;
        const dq_t reference_pu = {.d = SEEN[n].d_pu, .q = SEEN[n].q_pu};
        TEST_ASSERT_EQUAL_INT(
            REASON_NONE, step(park(SEEN[n].i, TURN_RAD * turn), reference_pu, theta_of(turn), 0));
    }
}

/* The name that a current and the sum of the three readings give a phase that has been found open.
 * Without a reference none is judged anew. */
static reason_t name_of(dq_t sampled_pu, int32_t sum_pu)
{
    const dq_t none = {0, 0};
    setUp();
    for (int n = 0; n < MONITOR_OPEN_STEPS; n++) {
        (void)step_at(wire_b_open, 0.0, 1.0);
    }
    return step(sampled_pu, none, theta_of(0.0), sum_pu);
}

static int32_t sum_of(star_t i)
{
    return (int32_t)lround(i.a + i.b + i.c);
}

/* 1.05 i of a and -0.95 i of c are a sum of 0.1 i; the vector is i/cos 30 long, and its larger
 * component at least i/(cos 30 sqrt 2) = 0.82 i. */
void test_open_wire_beside_gains_that_differ_by_a_tenth_keeps_its_name(void)
{
    for (int k = 0; k < 240; k++) {
        const double angle_rad = TURN_RAD * k / 240.0;
        const double through = wire_b_open(wanted_at(angle_rad)).a;
        const star_t i = {1.05 * through, 0.0, -0.95 * through};
        TEST_ASSERT_EQUAL_INT(REASON_PHASE_OPEN, name_of(park(i, angle_rad), sum_of(i)));
    }
}

/* The readings of a and b alone make the vector, with c as what they do not add up to: up to
 * i/cos 30 = 1.155 of the peak long, so that a quarter is up to 0.29 of it. */
void test_sensor_that_shows_no_current_is_named_by_the_sum_of_the_readings(void)
{
    int named = 0;
    for (int k = 0; k < 240; k++) {
        const double angle_rad = TURN_RAD * k / 240.0;
        const star_t wanted = wanted_at(angle_rad);
        const star_t read = {wanted.a, 0.0, wanted.c};
        const star_t used = {wanted.a, 0.0, -wanted.a};
        if (fabs(wanted.b) > 0.3 * LENGTH_PU) {
            TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, name_of(park(used, angle_rad), sum_of(read)));
            named++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(190, named); /* 1 - 2/pi asin 0.3 = 0.81 of the turn */
}

/* More than a quarter of the larger component, whatever the signs. */
void test_sum_of_a_sensor_s_reading_is_more_than_a_quarter_of_the_current(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        const dq_t along = {sign * 8000, 100};
        const dq_t across = {-100, sign * 8000};
        TEST_ASSERT_EQUAL_INT(REASON_PHASE_OPEN, name_of(along, sign * 2000));
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, name_of(along, sign * 2001));
        TEST_ASSERT_EQUAL_INT(REASON_PHASE_OPEN, name_of(across, sign * -2000));
        TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SUM, name_of(across, sign * -2001));
    }
}

void test_phases_without_a_current_and_without_a_sum_are_no_sensor(void)
{
    const dq_t none = {0, 0};
    TEST_ASSERT_EQUAL_INT(REASON_PHASE_OPEN, name_of(none, 0));
}
