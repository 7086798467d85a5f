/* SPDX-License-Identifier: Apache-2.0 */
/* The thresholds of the open phase, in currents of a stator frame that are written down. */
#include "monitor/monitor_open.h"

#include <math.h>

#include "unity.h"

#define TURN_RAD 6.283185307179586

static monitor_open_state_t state;

void setUp(void)
{
    const monitor_open_state_t fresh = {.suspected = false};
    state = fresh;
}

void tearDown(void) {}

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
    const monitor_open_input_t in = {
        .sampled_pu = {.d = sign * -i->x, .q = sign * -i->q},
        .reference_pu = {.d = sign * -i->r, .q = 0},
        .theta_turn = theta_turn,
        .switching = true,
    };
    return monitor_open_step(&state, &in);
}

/* The step in which it is named, 0: not in ten. */
static int named_in(const currents_t *i, int32_t sign, uint16_t theta_turn)
{
    setUp();
    for (int n = 1; n <= 10; n++) {
        if (step_with(i, sign, theta_turn)) {
            return n;
        }
        TEST_ASSERT_EQUAL_INT(state.missing[0][0] + state.missing[1][0] + state.missing[2][0] +
                                      state.missing[0][1] + state.missing[1][1] +
                                      state.missing[2][1] >=
                                  MONITOR_OPEN_SUSPECT_STEPS,
                              state.suspected);
    }
    return 0;
}

/* Above and below each threshold; phase a takes a current of the reference's sign. */
static const struct {
    currents_t missing, not_missing;
} THRESHOLDS[] = {
    {{2400, 599, 16384}, {2400, 600, 16384}},   /* a quarter of the reference */
    {{20000, 472, 4096}, {20000, 473, 4096}},   /* an eighth of 3784 */
    {{20000, 1000, 5197}, {20000, 1000, 5196}}, /* others 5001 and 5000, a quarter of it */
    {{20000, 2249, 5630}, {20000, 2250, 5630}}, /* 3/8 of 6000 and 6001, in whole eighths */
    {{2560, 10, 918}, {2560, 10, 917}},         /* others 801 and 800 */
    {{1280, 100, 16384}, {1279, 100, 16384}},   /* a reference that is judged */
};

void test_thresholds_of_a_missing_current_are_exact(void)
{
    for (unsigned k = 0; k < sizeof THRESHOLDS / sizeof THRESHOLDS[0]; k++) {
        TEST_ASSERT_EQUAL_INT(MONITOR_OPEN_STEPS, named_in(&THRESHOLDS[k].missing, 1, 0));
        TEST_ASSERT_EQUAL_INT(0, named_in(&THRESHOLDS[k].not_missing, 1, 0));
    }
}

/* In every phase and with either sign; the numbers are those above within a rounding. */
void test_thresholds_are_those_of_every_phase_and_sign(void)
{
    static const currents_t MISSING[] = {
        {2400, 590, 16384}, {20000, 460, 4096}, {20000, 1000, 5215}, {20000, 2230, 5630}};
    static const currents_t NOT_MISSING[] = {
        {2400, 610, 16384}, {20000, 485, 4096}, {20000, 1000, 5175}, {20000, 2270, 5630}};
    static const uint16_t PHASE[] = {0, 21845, 43691};
    for (int x = 0; x < 3; x++) {
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            for (int k = 0; k < 4; k++) {
                const int named = named_in(&MISSING[k], sign, PHASE[x]);
                TEST_ASSERT_EQUAL_INT(MONITOR_OPEN_STEPS, named);
                TEST_ASSERT_EQUAL_INT(0, named_in(&NOT_MISSING[k], sign, PHASE[x]));
            }
        }
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

/* Wanted in phase a: a quarter of 8000, and less than half of what is wanted in the others. */
static double wanted_alpha_pu = 2050.0;

/* alpha and beta of the stator in the frame of the rotor. */
static bool step_stator(double alpha_pu, double beta_pu, uint16_t theta_turn)
{
    const monitor_open_input_t in = {
        .sampled_pu = rotor_frame(alpha_pu, beta_pu, theta_turn),
        .reference_pu = rotor_frame(wanted_alpha_pu, 8000.0, theta_turn),
        .theta_turn = theta_turn,
        .switching = true,
    };
    return monitor_open_step(&state, &in);
}

/* The step in which a phase at zero is named while the rotor turns by `step_turn` a millisecond,
 * 0: never. The other two carry `others_pu` and this one `own_pu`. */
static int zero_named_in(int32_t step_turn, double others_pu, double own_pu)
{
    setUp();
    const double beta_pu = (others_pu - 0.5 * fabs(own_pu)) * 2.0 / sqrt(3.0);
    for (int n = 1; n <= 40; n++) {
        if (step_stator(own_pu, beta_pu, (uint16_t)(n * step_turn))) {
            return n;
        }
    }
    return 0;
}

/* 5461 of 65 536, three samples, and less than 10 923 from one to the next; both directions. */
void test_angle_and_samples_that_name_a_phase_at_zero_are_exact(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT(7, zero_named_in(sign * 1000, 8000.0, 0.0));
        TEST_ASSERT_EQUAL_INT(4, zero_named_in(sign * 2730, 8000.0, 0.0));
        TEST_ASSERT_EQUAL_INT(3, zero_named_in(sign * 2731, 8000.0, 0.0));
        TEST_ASSERT_EQUAL_INT(3, zero_named_in(sign * 8000, 8000.0, 0.0));
        TEST_ASSERT_EQUAL_INT(3, zero_named_in(sign * 10922, 8000.0, 0.0));
        TEST_ASSERT_EQUAL_INT(0, zero_named_in(sign * 10923, 8000.0, 0.0));
        TEST_ASSERT_EQUAL_INT(0, zero_named_in(0, 8000.0, 0.0));
    }
}

/* A phase in which less than a quarter of the others' current is wanted has none by the reference.
 */
void test_a_phase_without_a_reference_is_not_named_at_zero(void)
{
    wanted_alpha_pu = 1950.0;
    TEST_ASSERT_EQUAL_INT(0, zero_named_in(1000, 8000.0, 0.0));
    wanted_alpha_pu = -1950.0;
    TEST_ASSERT_EQUAL_INT(0, zero_named_in(1000, 8000.0, 0.0));
    wanted_alpha_pu = -2050.0;
    TEST_ASSERT_EQUAL_INT(7, zero_named_in(1000, 8000.0, 0.0));
    wanted_alpha_pu = 2050.0;
}

void test_currents_that_name_a_phase_at_zero(void)
{
    TEST_ASSERT_EQUAL_INT(7, zero_named_in(1000, 810.0, 0.0));
    TEST_ASSERT_EQUAL_INT(0, zero_named_in(1000, 790.0, 0.0));
    for (int sign = -1; sign <= 1; sign += 2) { /* an eighth of 8000 */
        TEST_ASSERT_EQUAL_INT(7, zero_named_in(1000, 8000.0, sign * 985.0));
        TEST_ASSERT_EQUAL_INT(0, zero_named_in(1000, 8000.0, sign * 1015.0));
    }
}

/* After five samples of 1000 one with short currents: nothing is known unless the phase carries
 * half of the least current. One with a current of its own begins anew. */
static int named_after(double own_pu, double beta_pu)
{
    setUp();
    for (int n = 1; n <= 5; n++) {
        TEST_ASSERT_FALSE(step_stator(0.0, 8000.0, (uint16_t)(1000 * n)));
    }
    TEST_ASSERT_FALSE(step_stator(own_pu, beta_pu, 6000));
    for (int n = 1; n <= 20; n++) {
        if (step_stator(0.0, 8000.0, (uint16_t)(6000 + 1000 * n))) {
            return n;
        }
    }
    return 0;
}

void test_current_between_two_samples_at_zero_begins_anew(void)
{
    TEST_ASSERT_EQUAL_INT(2, named_after(0.0, 100.0)); /* 4000, and 1000 each */
    TEST_ASSERT_EQUAL_INT(2, named_after(390.0, 100.0));
    TEST_ASSERT_EQUAL_INT(2, named_after(-390.0, 100.0));
    TEST_ASSERT_EQUAL_INT(7, named_after(410.0, 100.0));
    TEST_ASSERT_EQUAL_INT(7, named_after(-410.0, 100.0));
    TEST_ASSERT_EQUAL_INT(7, named_after(2000.0, 8000.0));
}

/* The step of the angle changes by 3641 or by one more: two samples do not count. */
void test_samples_after_a_jump_of_the_angle_do_not_count(void)
{
    for (int32_t jump = 3641; jump <= 3642; jump++) {
        setUp();
        uint16_t theta_turn = 0;
        for (int n = 0; n < 4; n++) { /* 3 * 100 */
            theta_turn = (uint16_t)(theta_turn + 100);
            TEST_ASSERT_FALSE(step_stator(0.0, 8000.0, theta_turn));
        }
        /* A step of 100 + jump, one of 100 again: its change is a jump as well. */
        theta_turn = (uint16_t)(theta_turn + 100 + jump);
        TEST_ASSERT_FALSE(step_stator(0.0, 8000.0, theta_turn));
        TEST_ASSERT_EQUAL_UINT8(jump > 3641 ? MONITOR_OPEN_JUMP_STEPS : 0, state.unsettled);
        TEST_ASSERT_EQUAL_UINT16(jump > 3641 ? 300 : 400 + jump, state.turned[0]);
        theta_turn = (uint16_t)(theta_turn + 100);
        TEST_ASSERT_FALSE(step_stator(0.0, 8000.0, theta_turn));
        TEST_ASSERT_EQUAL_UINT8(jump > 3641 ? MONITOR_OPEN_JUMP_STEPS : 0, state.unsettled);
        for (int n = 1; n <= 4; n++) {
            theta_turn = (uint16_t)(theta_turn + 100);
            TEST_ASSERT_FALSE(step_stator(0.0, 8000.0, theta_turn));
            const int counted = n < MONITOR_OPEN_JUMP_STEPS ? 0 : n - MONITOR_OPEN_JUMP_STEPS + 1;
            TEST_ASSERT_EQUAL_UINT16(jump > 3641 ? 300 + 100 * counted : 500 + jump + 100 * n,
                                     state.turned[0]);
        }
    }
}

/* Each of the four counts of each phase. */
void test_a_step_without_pwm_forgets_everything(void)
{
    static const currents_t MISSING = {2400, 0, 16384};
    static const uint16_t PHASE[] = {0, 21845, 43691};
    for (int x = 0; x < 3; x++) {
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            setUp();
            (void)step_with(&MISSING, sign, PHASE[x]);
            (void)step_with(&MISSING, sign, PHASE[x]);
            const monitor_open_input_t off = {.theta_turn = PHASE[x], .switching = false};
            TEST_ASSERT_FALSE(monitor_open_step(&state, &off));
            for (int y = 0; y < 3; y++) {
                TEST_ASSERT_EQUAL_UINT8(0, state.missing[y][0]);
                TEST_ASSERT_EQUAL_UINT8(0, state.missing[y][1]);
                TEST_ASSERT_EQUAL_UINT16(0, state.turned[y]);
                TEST_ASSERT_EQUAL_UINT8(0, state.zeros[y]);
            }
            (void)step_with(&MISSING, sign, PHASE[x]);
            TEST_ASSERT_FALSE(step_with(&MISSING, sign, PHASE[x]));
            TEST_ASSERT_TRUE(step_with(&MISSING, sign, PHASE[x]));
        }
    }
}
