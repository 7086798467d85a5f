/* SPDX-License-Identifier: Apache-2.0 */
/* The thresholds of the open phase, in currents of a stator frame that are written down. */
#include "monitor/monitor_open.h"

#include <math.h>
#include <string.h>

#include "monitor_case.h"
#include "unity.h"

#define TURN_RAD 6.283185307179586

/* What is before the state is not the monitor's. */
static struct {
    uint8_t before[16];
    monitor_open_state_t state;
} memory;
#define state memory.state

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
    return monitor_open_step(&state, measured_of(&in), reference_pu) != REASON_NONE;
}

static bool step_off(uint16_t theta_turn)
{
    const monitor_case_t in = {
        .report = {.sample = {.theta_turn = theta_turn}, .bridge = BRIDGE_OFF}};
    const dq_t none = {0, 0};
    return monitor_open_step(&state, measured_of(&in), none) != REASON_NONE;
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
    {{2400, 599, 16384}, {2400, 600, 16384}},     /* a quarter of the reference */
    {{20000, 644, 4096}, {20000, 645, 4096}},     /* a sixth of 3548 + 322, which is 645 */
    {{20000, 2578, 16384}, {20000, 2579, 16384}}, /* of 14189 + 1289: 2579 and 4 of 6 parts */
    {{2560, 10, 918}, {2560, 10, 917}},           /* others 801 and 800 */
    {{1280, 100, 16384}, {1279, 100, 16384}},     /* a reference that is judged */
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
        {2400, 590, 16384}, {20000, 630, 4096}, {20000, 2560, 16384}};
    static const currents_t NOT_MISSING[] = {
        {2400, 610, 16384}, {20000, 660, 4096}, {20000, 2600, 16384}};
    static const uint16_t PHASE[] = {0, 21845, 43691};
    for (int x = 0; x < 3; x++) {
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            for (int k = 0; k < 3; k++) {
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
    return step(rotor_frame(alpha_pu, beta_pu, theta_turn),
                rotor_frame(wanted_alpha_pu, 8000.0, theta_turn), theta_turn);
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

/* ---- a phase at zero at the angle zero: exact numbers ---- */

/* A rotor that stands: phase a carries -x, phase c 0.866 q + x/2, and -r is wanted in phase a. */
static void stand(int32_t x, int32_t q, int32_t r)
{
    const dq_t sampled_pu = {.d = -x, .q = -q};
    const dq_t reference_pu = {.d = -r, .q = -16384};
    (void)step(sampled_pu, reference_pu, 0);
}

void test_the_least_current_of_the_others_is_exact(void)
{
    for (int32_t q = 917; q <= 918; q++) { /* 0.866 q + 5 is 800 or 801 */
        setUp();
        stand(10, q, 2050);
        TEST_ASSERT_EQUAL_UINT8(q == 918 ? 1 : 0, state.zeros[0]);
    }
}

/* Beside currents below that: half of them. */
void test_the_current_of_a_phase_between_two_samples_at_zero_is_exact(void)
{
    for (int32_t x = 400; x <= 401; x++) {
        setUp();
        stand(0, 8192, 2050);
        stand(x, 100, 2050);
        TEST_ASSERT_EQUAL_UINT8(x == 400 ? 1 : 0, state.zeros[0]);
    }
}

/* 0.866 * 4096 + 236 is 3784, an eighth of which is 473. */
void test_an_eighth_of_the_others_current_is_not_zero(void)
{
    for (int32_t x = 472; x <= 473; x++) {
        setUp();
        stand(x, 4096, 2050);
        TEST_ASSERT_EQUAL_UINT8(x == 472 ? 1 : 0, state.zeros[0]);
    }
}

/* A turn of the rotor in two steps that are not equal: 0.866 * 8000 at the angle zero in the third
 * sample, of which a quarter is 1732. */
void test_a_quarter_of_the_others_current_is_wanted(void)
{
    for (int32_t r = 1731; r <= 1732; r++) {
        setUp();
        (void)step_stator(0.0, 8000.0, (uint16_t)-2000);
        (void)step_stator(0.0, 8000.0, (uint16_t)-1000);
        const int32_t before_turn = state.turned[0];
        stand(0, 8000, r);
        TEST_ASSERT_EQUAL_INT32(before_turn + (r == 1732 ? 1000 : 0), state.turned[0]);
    }
}

/* Samples at 0, 2731 and 5461, and one less. */
void test_the_angle_that_names_a_phase_at_zero_is_exact(void)
{
    for (uint16_t last = 5460; last <= 5461; last++) {
        setUp();
        (void)step_stator(0.0, 8000.0, 0);
        (void)step_stator(0.0, 8000.0, 2731);
        TEST_ASSERT_EQUAL_INT(last == 5461, step_stator(0.0, 8000.0, last));
    }
}

/* For more samples than a count of 8 bits and more turns than an angle of 16 bits hold. */
void test_a_phase_stays_named_for_as_long_as_it_is_at_zero(void)
{
    for (int n = 1; n <= 400; n++) {
        const bool named = step_stator(0.0, 8000.0, (uint16_t)(n * 3000));
        TEST_ASSERT_EQUAL_INT(n >= MONITOR_OPEN_STEPS, named);
    }
    TEST_ASSERT_EQUAL_UINT16(MONITOR_OPEN_TURN, state.turned[0]);
    TEST_ASSERT_EQUAL_UINT8(MONITOR_OPEN_STEPS, state.zeros[0]);
    TEST_ASSERT_EQUAL_UINT8(2, state.steps_known);
    TEST_ASSERT_TRUE(step_stator(0.0, 8000.0, (uint16_t)(400 * 3000))); /* a rotor that stops */
    TEST_ASSERT_TRUE(step_stator(0.0, 8000.0, (uint16_t)(400 * 3000)));
}

/* ---- which phases are judged ---- */

static void miss(int32_t r, int32_t reference_q)
{
    const dq_t sampled_pu = {.d = 0, .q = -16384};
    const dq_t reference_pu = {.d = -r, .q = -reference_q};
    (void)step(sampled_pu, reference_pu, 0);
}

/* 0.866 * 4158 + 1200 is 4800 or 4801, half of which in whole numbers is 2400; of 4160, 2401. */
void test_a_phase_is_judged_from_half_of_the_largest_reference(void)
{
    miss(2400, 4158);
    TEST_ASSERT_EQUAL_UINT8(1, state.missing[0][0]);
    miss(2400, 4160);
    TEST_ASSERT_EQUAL_UINT8(1, state.missing[0][0]);
}

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
    for (int jumps = 0; jumps < 2; jumps++) {
        setUp();
        state.steps_known = 2;
        state.theta_turn = (uint16_t)-4000;
        state.step_turn = jumps != 0 ? 0 : 4000;
        miss(2400, 0);
        TEST_ASSERT_EQUAL_UINT8(jumps != 0 ? MONITOR_OPEN_JUMP_STEPS : 0, state.unsettled);
        TEST_ASSERT_EQUAL_UINT8(jumps != 0 ? 0 : 1, state.missing[0][0]);
    }
}

void test_a_step_without_pwm_writes_to_its_state_only(void)
{
    memset(memory.before, 0x5A, sizeof memory.before);
    (void)step_off(0);
    TEST_ASSERT_EACH_EQUAL_UINT8(0x5A, memory.before, sizeof memory.before);
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
            TEST_ASSERT_FALSE(step_off(PHASE[x]));
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
