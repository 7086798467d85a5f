/* SPDX-License-Identifier: Apache-2.0 */
/* What each row of the table of findings does to the mode, and what of a demand, an angle and a
 * speed the modes look at. */
#include "modes_rig.h"

void setUp(void)
{
    start();
}

void tearDown(void) {}

/* ---- rows ---- */

/* Rows that modes_step() sets itself, and the one of the fast monitor, which has its reason. */
static bool is_of_another_part(finding_t row)
{
    static const finding_t OTHERS[] = {
        FINDING_STATE_DAMAGED, FINDING_TRIP,           FINDING_CONFIGURATION,
        FINDING_SELFTEST,      FINDING_OFFSETS_WRONG,  FINDING_OFFSETS_OLD,
        FINDING_ACCELERATOR,   FINDING_BRAKE_PEDAL,    FINDING_DEMAND_OLD,
        FINDING_FRAMES_UNSENT, FINDING_DEMAND_SENDERS, FINDING_DEMAND_REFUSED,
    };
    for (unsigned k = 0; k < sizeof OTHERS / sizeof OTHERS[0]; k++) {
        if (OTHERS[k] == row) {
            return false;
        }
    }
    return true;
}

static bool latches(finding_reaction_t reaction)
{
    return reaction == FINDING_REACTION_SAFE_STATE || reaction == FINDING_REACTION_TRIP ||
           reaction == FINDING_REACTION_RAMP;
}

static void assert_enabled(int32_t drive_q15, int32_t brake_q15, const modes_output_t *out)
{
    TEST_ASSERT_EQUAL_INT(drive_q15, out->torque_enable.drive_q15);
    TEST_ASSERT_EQUAL_INT(brake_q15, out->torque_enable.brake_q15);
}

static void check_fault(const modes_output_t *out, reason_t reason)
{
    assert_mode(MODE_FAULT, *out);
    TEST_ASSERT_EQUAL_INT(reason, out->fault);
    TEST_ASSERT_EQUAL_INT(reason, out->torque_enable.reason);
    assert_enabled(0, 0, out);
}

static void check_warning(const modes_output_t *out, reason_t reason, finding_reaction_t reaction)
{
    const bool named = reason != REASON_NONE;
    TEST_ASSERT_EQUAL_INT(reason, out->warning);
    TEST_ASSERT_EQUAL_INT(reason, out->present_warning);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out->fault);
    if (reaction == FINDING_REACTION_NONE) {
        assert_mode(MODE_RUN, *out);
        assert_enabled(Q15_ONE, Q15_ONE, out);
    } else if (reaction == FINDING_REACTION_OFF) {
        assert_mode(named ? MODE_LIMP : MODE_RUN, *out);
        assert_enabled(0, 0, out);
        TEST_ASSERT_EQUAL_INT(named ? reason : REASON_TORQUE_ENABLE, out->torque_enable.reason);
        const bool hot =
            reason == REASON_WINDING_OVERTEMPERATURE || reason == REASON_SWITCH_OVERTEMPERATURE;
        TEST_ASSERT_EQUAL_INT(hot ? WAITS_FOR_COOLING : WAITS_FOR_BATTERY, out->waits_for);
    } else {
        assert_mode(MODE_LIMP, *out);
        assert_enabled(config.modes.limp_drive_share_q15, Q15_ONE, out);
        TEST_ASSERT_EQUAL_INT(reason, out->torque_enable.reason);
    }
}

void test_each_row_takes_the_torque_that_its_reaction_says(void)
{
    int faults = 0;
    int warnings = 0;
    for (finding_t row = (finding_t)0; row < FINDING_COUNT; row++) {
        if (!is_of_another_part(row)) {
            continue;
        }
        const finding_row_t columns = findings_row(row);
        start_in(MODE_RUN);
        in.warning = row;
        const modes_output_t out = step();
        if (latches(columns.reaction)) {
            check_fault(&out, columns.reason);
            faults++;
        } else {
            check_warning(&out, columns.reason, columns.reaction);
            warnings++;
        }
        in.warning = FINDING_COUNT;
        assert_mode(latches(columns.reaction) ? MODE_FAULT : MODE_RUN, step());
    }
    TEST_ASSERT_GREATER_THAN_INT(10, faults);
    TEST_ASSERT_GREATER_THAN_INT(20, warnings);
}

/* What comes with the demand; a code of another row is none of it, nor is one of a limit. */
void test_a_demand_brings_a_warning_of_its_own_rows_only(void)
{
    static const struct {
        reason_t reason;
        operating_mode_t mode;
    } OWN[] = {{REASON_ACCELERATOR_SENSOR, MODE_LIMP},
               {REASON_BRAKE_PEDAL_SENSOR, MODE_LIMP},
               {REASON_DEMAND_TIMEOUT, MODE_LIMP},
               {REASON_DEMAND_IMPLAUSIBLE, MODE_RUN}};
    for (int k = 0; k < 4; k++) {
        start_in(MODE_RUN);
        in.demand_reason = OWN[k].reason;
        const modes_output_t out = step();
        assert_mode(OWN[k].mode, out);
        TEST_ASSERT_EQUAL_INT(OWN[k].reason, out.warning);
        in.demand_reason = REASON_NONE;
        const modes_output_t after = step();
        assert_mode(MODE_RUN, after);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, after.warning);
    }
    start_in(MODE_RUN);
    in.demand_reason = REASON_ACCELERATOR_LOCKED;
    const modes_output_t out = step();
    assert_mode(MODE_RUN, out);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, out.warning);
}

/* ---- the demand ---- */

void test_a_lost_demand_leaves_the_sensor_that_made_it_be_lost(void)
{
    static const struct {
        reason_t with, left;
    } CASES[] = {{REASON_ACCELERATOR_SENSOR, REASON_ACCELERATOR_SENSOR},
                 {REASON_BRAKE_PEDAL_SENSOR, REASON_BRAKE_PEDAL_SENSOR},
                 {REASON_ACCELERATOR_LOCKED, REASON_DEMAND_TIMEOUT},
                 {REASON_NONE, REASON_DEMAND_TIMEOUT}};
    for (int k = 0; k < 4; k++) {
        start_in(MODE_RUN);
        in.demand_lost = true;
        in.demand_reason = CASES[k].with;
        (void)step();
        in.demand_lost = false;
        in.demand_reason = REASON_NONE;
        const modes_output_t out = run(100);
        TEST_ASSERT_EQUAL_INT(CASES[k].left, out.warning);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, out.present_warning);
    }
}

/* READY becomes RUN with a lift-off torque, against the direction, but not with a driving one; in
 * neutral any torque counts as driving. */
void test_lift_off_braking_is_no_driving_demand(void)
{
    static const struct {
        drive_direction_t direction;
        int32_t drive_mNm;
        operating_mode_t mode;
    } CASES[] = {
        {DRIVE_DIRECTION_FORWARD, 1, MODE_READY}, {DRIVE_DIRECTION_FORWARD, 0, MODE_RUN},
        {DRIVE_DIRECTION_FORWARD, -1, MODE_RUN},  {DRIVE_DIRECTION_REVERSE, 1, MODE_RUN},
        {DRIVE_DIRECTION_REVERSE, 0, MODE_RUN},   {DRIVE_DIRECTION_REVERSE, -1, MODE_READY},
        {DRIVE_DIRECTION_NEUTRAL, 1, MODE_READY}, {DRIVE_DIRECTION_NEUTRAL, 0, MODE_RUN},
        {DRIVE_DIRECTION_NEUTRAL, -1, MODE_READY}};
    for (unsigned k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        start_in(MODE_READY);
        in.enable = true;
        slow_input_t slow_in = demanded();
        slow_in.demand.direction = CASES[k].direction;
        slow_in.demand.drive_torque_mNm = CASES[k].drive_mNm;
        assert_mode(CASES[k].mode, step_with(&slow_in));
    }
}

void test_a_fault_is_acknowledged_with_lift_off_but_not_with_a_driving_or_braking_demand(void)
{
    static const struct {
        int32_t drive_mNm, brake_mNm;
        operating_mode_t mode;
    } CASES[] = {{0, 0, MODE_SELFTEST}, {-1, 0, MODE_SELFTEST}, {1, 0, MODE_FAULT},
                 {0, 1, MODE_FAULT},    {0, -1, MODE_SELFTEST}, {-1, 1, MODE_FAULT}};
    for (unsigned k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        start_in(MODE_FAULT);
        in.fault_reset = true;
        slow_input_t slow_in = demanded();
        slow_in.demand.drive_torque_mNm = CASES[k].drive_mNm;
        slow_in.demand.brake_torque_mNm = CASES[k].brake_mNm;
        assert_mode(CASES[k].mode, step_with(&slow_in));
    }
}

/* ---- angle and speed ---- */

/* Without PWM the observer shows nothing yet; at its speed it will. */
void test_an_angle_that_the_observer_will_find_is_enough(void)
{
    const int32_t from_mrad_s = CONFIG_LU2013.rotor.observer_speed_mrad_s;
    static const angle_by_t WHOSE[] = {ANGLE_BY_SENSOR, ANGLE_BY_OBSERVER};
    for (int k = 0; k < 2; k++) {
        for (int32_t below_mrad_s = 0; below_mrad_s <= 1; below_mrad_s++) {
            start_in(MODE_READY);
            in.enable = true;
            in.angle_valid = false;
            in.angle_by = WHOSE[k];
            in.bound_mrad_s = from_mrad_s - below_mrad_s;
            const bool ready = WHOSE[k] == ANGLE_BY_OBSERVER && below_mrad_s == 0;
            const modes_output_t out = step();
            assert_mode(ready ? MODE_RUN : MODE_READY, out);
            TEST_ASSERT_EQUAL_INT(ready ? WAITS_FOR_NONE : WAITS_FOR_ROTOR_ANGLE, out.waits_for);
        }
    }
}

void test_run_is_left_up_to_the_hand_over_speed(void)
{
    for (int32_t above_mrad_s = 0; above_mrad_s <= 1; above_mrad_s++) {
        start_in(MODE_RUN);
        in.enable = false;
        in.bound_mrad_s = config.brake.blend_out_end_mrad_s + above_mrad_s;
        assert_mode(above_mrad_s > 0 ? MODE_RUN : MODE_READY, step());
    }
}
