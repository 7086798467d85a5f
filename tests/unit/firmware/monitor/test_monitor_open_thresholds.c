/* SPDX-License-Identifier: Apache-2.0 */
/* The thresholds of the open phase, in currents of a stator frame that are written down. */
#include "monitor/monitor_open.h"

#include <math.h>

#include "monitor_case.h"
#include "unity.h"

#define TURN_RAD 6.283185307179586

static monitor_open_state_t state;

void setUp(void)
{
    const monitor_open_state_t fresh = {.suspected = false};
    state = fresh;
}

void tearDown(void) {}

static bool step(dq_t sampled_pu, dq_t reference_pu, uint16_t theta_turn)
{
    const monitor_case_t in = {.report = {.sample = {.theta_turn = theta_turn},
                                          .i_pu = dq16_of(sampled_pu),
                                          .bridge = BRIDGE_PWM}};
    return monitor_open_step(&state, measured_of(&in), reference_pu, 0) != REASON_NONE;
}

/* ---- a reference without a current ----
 *
 * At the angle zero d is phase a, and phases b and c are -d/2 +- 0.866 q. The reference wants -r in
 * phase a, which carries -x; phase c carries 0.866 q + x/2, the largest of the others. At the angle
 * zero the numbers are exact for negative d and q. */

typedef struct {
    int32_t r, x, q;
} currents_t;

static bool step_with(const currents_t *i, int32_t sign, uint16_t theta_turn)
{
    const dq_t sampled_pu = {.d = sign * -i->x, .q = sign * -i->q};
    const dq_t reference_pu = {.d = sign * -i->r, .q = 0};
    return step(sampled_pu, reference_pu, theta_turn);
}

/* The step in which it is named, 0: not in ten. */
static int named_in(const currents_t *i)
{
    setUp();
    for (int n = 1; n <= 10; n++) {
        if (step_with(i, 1, 0)) {
            return n;
        }
    }
    return 0;
}

/* Above and below each threshold; phase a takes a current of the reference's sign. */
static const struct {
    currents_t missing, not_missing;
} THRESHOLDS[] = {
    {{2400, 599, 16384}, {2400, 600, 16384}},     /* a quarter of the reference */
    {{20000, 644, 4096}, {20000, 645, 4096}},     /* a sixth of 3548 + 322, which is 645 */
    {{20000, 2578, 16384}, {20000, 2579, 16384}}, /* of 14189 + 1289: 2579 and 4 of 6 parts */
    {{2560, 134, 846}, {2560, 134, 847}},         /* others 800, which is none, and 801 */
    {{2560, 10, 22}, {2560, 10, 21}},             /* others 25 and 24, as of dead sensors */
    {{1280, 100, 16384}, {1279, 100, 16384}},     /* a reference that is judged */
};

void test_thresholds_of_a_missing_current_are_exact(void)
{
    for (unsigned k = 0; k < sizeof THRESHOLDS / sizeof THRESHOLDS[0]; k++) {
        TEST_ASSERT_EQUAL_INT(MONITOR_OPEN_STEPS, named_in(&THRESHOLDS[k].missing));
        TEST_ASSERT_EQUAL_INT(0, named_in(&THRESHOLDS[k].not_missing));
    }
}

/* Half of the reference flows; between a quarter and a half nothing is known, and against it. */
void test_only_a_current_of_half_the_reference_begins_the_count_anew(void)
{
    static const currents_t MISSING = {2400, 0, 16384};
    const currents_t between[] = {{2400, 1201, 16384}, {2400, 1200, 16384}, {2400, -1500, 16384}};
    for (int k = 0; k < 3; k++) {
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            setUp();
            TEST_ASSERT_FALSE(step_with(&MISSING, sign, 0));
            TEST_ASSERT_FALSE(state.suspected);
            TEST_ASSERT_FALSE(step_with(&MISSING, sign, 0));
            TEST_ASSERT_TRUE(state.suspected);
            TEST_ASSERT_FALSE(step_with(&between[k], sign, 0));
            TEST_ASSERT_EQUAL_INT(k != 0, step_with(&MISSING, sign, 0));
        }
    }
}

/* ---- a phase at zero of a rotor that turns ---- */

static dq_t rotor_frame(double alpha_pu, double beta_pu, uint16_t theta_turn)
{
    const double angle_rad = theta_turn * TURN_RAD / 65536.0;
    const dq_t out = {
        .d = (int32_t)lround(alpha_pu * cos(angle_rad) + beta_pu * sin(angle_rad)),
        .q = (int32_t)lround(beta_pu * cos(angle_rad) - alpha_pu * sin(angle_rad)),
    };
    return out;
}

/* Nothing in phase a, where more than a quarter of 8000 is wanted, and less than half of what is
 * wanted in the others. */
static bool step_at_zero(uint16_t theta_turn)
{
    return step(rotor_frame(0.0, 8000.0, theta_turn), rotor_frame(2050.0, 8000.0, theta_turn),
                theta_turn);
}

/* The step in which it is named while the rotor turns by `step_turn` a millisecond, 0: never. */
static int zero_named_in(int32_t step_turn)
{
    setUp();
    for (int n = 1; n <= 40; n++) {
        if (step_at_zero((uint16_t)(n * step_turn))) {
            return n;
        }
    }
    return 0;
}

/* 5461 of 65 536, three samples, and less than 10 923 from one to the next; both directions. */
void test_angle_and_samples_that_name_a_phase_at_zero_are_exact(void)
{
    static const int32_t CASES[][2] = {{1000, 7},  {2730, 4},  {2731, 3}, {8000, 3},
                                       {10922, 3}, {10923, 0}, {0, 0}};
    for (int k = 0; k < 7; k++) {
        TEST_ASSERT_EQUAL_INT(CASES[k][1], zero_named_in(CASES[k][0]));
        TEST_ASSERT_EQUAL_INT(CASES[k][1], zero_named_in(-CASES[k][0]));
    }
}

/* The step of the angle changes by 3641 or by one more: two samples do not count. */
void test_samples_after_a_jump_of_the_angle_do_not_count(void)
{
    for (int32_t jump = 3641; jump <= 3642; jump++) {
        setUp();
        uint16_t theta_turn = 0;
        for (int n = 0; n < 4; n++) { /* 3 * 100 */
            theta_turn = (uint16_t)(theta_turn + 100);
            TEST_ASSERT_FALSE(step_at_zero(theta_turn));
        }
        /* A step of 100 + jump, one of 100 again: its change is a jump as well. */
        theta_turn = (uint16_t)(theta_turn + 100 + jump);
        TEST_ASSERT_FALSE(step_at_zero(theta_turn));
        TEST_ASSERT_EQUAL_UINT8(jump > 3641 ? MONITOR_OPEN_JUMP_STEPS : 0, state.unsettled);
        TEST_ASSERT_EQUAL_UINT16(jump > 3641 ? 300 : 400 + jump, state.turned[0]);
        theta_turn = (uint16_t)(theta_turn + 100);
        TEST_ASSERT_FALSE(step_at_zero(theta_turn));
        TEST_ASSERT_EQUAL_UINT8(jump > 3641 ? MONITOR_OPEN_JUMP_STEPS : 0, state.unsettled);
        for (int n = 1; n <= 4; n++) {
            theta_turn = (uint16_t)(theta_turn + 100);
            TEST_ASSERT_FALSE(step_at_zero(theta_turn));
            const int counted = n < MONITOR_OPEN_JUMP_STEPS ? 0 : n - MONITOR_OPEN_JUMP_STEPS + 1;
            TEST_ASSERT_EQUAL_UINT16(jump > 3641 ? 300 + 100 * counted : 500 + jump + 100 * n,
                                     state.turned[0]);
        }
    }
}

/* ---- a phase at zero at the angle zero: exact numbers ---- */

/* A rotor that stands: phase a carries -x, phase c 0.866 q + x/2, and phase a is to carry more. */
static void stand(int32_t x, int32_t q)
{
    const dq_t sampled_pu = {.d = -x, .q = -q};
    const dq_t reference_pu = {.d = -2050, .q = -16384};
    (void)step(sampled_pu, reference_pu, 0);
}

/* Beside at least 2049, which is 0.866 q + 5, and below an eighth: 0.866 * 4096 + 236 is 3784. */
void test_a_phase_is_at_zero_below_an_eighth_of_the_others_current(void)
{
    static const int32_t CASES[][3] = {
        {10, 2359, 0}, {10, 2360, 1}, {472, 4096, 1}, {473, 4096, 0}};
    for (int k = 0; k < 4; k++) {
        setUp();
        stand(CASES[k][0], CASES[k][1]);
        TEST_ASSERT_EQUAL_UINT8(CASES[k][2], state.zeros[0]);
    }
}

/* Beside currents below that: half of them. */
void test_the_current_of_a_phase_between_two_samples_at_zero_is_exact(void)
{
    for (int32_t x = 1024; x <= 1025; x++) {
        setUp();
        stand(0, 8192);
        stand(x, 100);
        TEST_ASSERT_EQUAL_UINT8(x == 1024 ? 1 : 0, state.zeros[0]);
    }
}

/* For more samples than a count of 8 bits and more turns than an angle of 16 bits hold. */
void test_a_phase_stays_named_for_as_long_as_it_is_at_zero(void)
{
    for (int n = 1; n <= 400; n++) {
        const bool named = step_at_zero((uint16_t)(n * 3000));
        TEST_ASSERT_EQUAL_INT(n >= MONITOR_OPEN_STEPS, named);
    }
    TEST_ASSERT_EQUAL_UINT16(MONITOR_OPEN_TURN, state.turned[0]);
    TEST_ASSERT_EQUAL_UINT8(MONITOR_OPEN_STEPS, state.zeros[0]);
    TEST_ASSERT_EQUAL_UINT8(2, state.steps_known);
    TEST_ASSERT_TRUE(step_at_zero((uint16_t)(400 * 3000))); /* a rotor that stops */
    TEST_ASSERT_TRUE(step_at_zero((uint16_t)(400 * 3000)));
}

/* ---- how long it lasts ---- */

/* More samples than a count of 8 bits holds; the first count is of current out of the motor. */
void test_a_missing_current_stays_named(void)
{
    static const currents_t MISSING = {2400, 0, 16384};
    for (int32_t sign = -1; sign <= 1; sign += 2) {
        setUp();
        for (int n = 1; n <= 300; n++) {
            TEST_ASSERT_EQUAL_INT(n >= MONITOR_OPEN_STEPS, step_with(&MISSING, sign, 0));
        }
        TEST_ASSERT_EQUAL_UINT8(sign > 0 ? MONITOR_OPEN_STEPS : 0, state.missing[0][0]);
        TEST_ASSERT_EQUAL_UINT8(sign > 0 ? 0 : MONITOR_OPEN_STEPS, state.missing[0][1]);
    }
}

/* The angle's step is 4000, or was already. */
void test_a_missing_current_does_not_count_after_a_jump_of_the_angle(void)
{
    static const currents_t MISSING = {2400, 0, 16384};
    for (int jumps = 0; jumps < 2; jumps++) {
        setUp();
        state.steps_known = 2;
        state.theta_turn = (uint16_t)-4000;
        state.step_turn = jumps != 0 ? 0 : 4000;
        (void)step_with(&MISSING, 1, 0);
        TEST_ASSERT_EQUAL_UINT8(jumps != 0 ? MONITOR_OPEN_JUMP_STEPS : 0, state.unsettled);
        TEST_ASSERT_EQUAL_UINT8(jumps != 0 ? 0 : 1, state.missing[0][0]);
    }
}

/* Each of the four counts of each phase. */
void test_a_step_without_pwm_forgets_everything(void)
{
    static const currents_t MISSING = {2400, 0, 16384};
    static const uint16_t PHASE[] = {0, 21845, 43691};
    const monitor_open_state_t fresh = {.suspected = false};
    for (int x = 0; x < 3; x++) {
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            setUp();
            (void)step_with(&MISSING, sign, PHASE[x]);
            (void)step_with(&MISSING, sign, PHASE[x]);
            const monitor_case_t off = {
                .report = {.sample = {.theta_turn = PHASE[x]}, .bridge = BRIDGE_OFF}};
            const dq_t none = {0, 0};
            TEST_ASSERT_EQUAL_INT(REASON_NONE,
                                  monitor_open_step(&state, measured_of(&off), none, 0));
            TEST_ASSERT_EQUAL_MEMORY(fresh.missing, state.missing, sizeof state.missing);
            TEST_ASSERT_EQUAL_MEMORY(fresh.turned, state.turned, sizeof state.turned);
            TEST_ASSERT_EQUAL_MEMORY(fresh.zeros, state.zeros, sizeof state.zeros);
        }
    }
}
