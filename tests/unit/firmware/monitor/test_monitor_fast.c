/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_fast.h"
#include "paper_vehicle.h"
#include "unity.h"

/* 60.564 V trips at 61.8 V full scale; a Q15 step is 1.9 mV. */
enum {
    LIMIT = 19363,         /* of the phase currents, Q15: about 97.5 A of 165 A */
    BELOW_TRIP_V = 32107,  /* 60.555 V */
    ABOVE_TRIP_V = 32117,  /* 60.573 V */
    PERIODS_PER_SLOW = 20, /* 20 kHz over 1 kHz */
};

static config_t config;
static monitor_fast_state_t state;
static monitor_fast_input_t in;

static const monitor_fast_input_t HEALTHY = {
    .i_pu = {.v = Q_PAIR_INIT(-400, 1000)},
    .v_dc_pu = 28102, /* 53 V */
    .power_stage_fault = false,
    .switching = true,
    .slow_step_count = 7,
};

void setUp(void)
{
    config = paper_vehicle();
    config.monitor.overcurrent_pu_q15 = LIMIT;
    config.battery.overvoltage_trip_mV = 60564;
    config.drive.voltage_full_scale_mV = 61800;
    config.drive.bus_capacitance_nF = 0; /* unknown */
    monitor_fast_init(&state, &config);
    in = HEALTHY;
}

void tearDown(void) {}

static void set_current(int32_t d, int32_t q)
{
    in.i_pu.v = q_pair(d, q);
}

static reason_t step(void)
{
    return monitor_fast_step(&state, &in);
}

/* The slow loop steps every 20 periods, as it should. */
static reason_t run(int periods)
{
    reason_t trip = REASON_NONE;
    for (int n = 0; n < periods; n++) {
        if (n % PERIODS_PER_SLOW == 0) {
            in.slow_step_count++;
        }
        trip = step();
    }
    return trip;
}

void test_a_healthy_drive_never_trips(void)
{
    TEST_ASSERT_EQUAL_INT(REASON_NONE,
                          run(200000)); /* ten seconds, the slow loop's counter wraps */
}

/* LIMIT of length in any direction: the 3-4-5 triangle and the axes. */
void test_overcurrent_at_any_angle_trips_in_its_second_period(void)
{
    static const int32_t DIRECTION[8][2] = {{5, 0}, {0, 5},  {-5, 0},  {0, -5},
                                            {3, 4}, {-4, 3}, {-3, -4}, {4, -3}};
    for (int k = 0; k < 8; k++) {
        setUp();
        /* Rounded towards zero by less than 1 each, so still longer. */
        set_current((LIMIT + 5) * DIRECTION[k][0] / 5, (LIMIT + 5) * DIRECTION[k][1] / 5);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
        TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step());
    }
}

/* Without PWM the safe state's own current flows: nothing that a trip could end. */
void test_no_overcurrent_while_the_bridge_does_not_switch(void)
{
    set_current(INT16_MAX, 0);
    in.switching = false;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
    in.switching = true;
    step();
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step());
}

void test_largest_measurable_current_vector_trips_with_the_largest_limit(void)
{
    /* Components saturate at 1, also with the largest limit there may be. */
    config.monitor.overcurrent_pu_q15 = INT16_MAX;
    static const int32_t LONGEST[4][2] = {
        {INT16_MAX, 0}, {0, INT16_MIN}, {INT16_MIN, INT16_MIN}, {INT16_MAX, INT16_MIN}};
    for (int k = 0; k < 4; k++) {
        monitor_fast_init(&state, &config);
        set_current(LONGEST[k][0], LONGEST[k][1]);
        step();
        TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step());
    }
}

void test_current_at_the_limit_never_trips(void)
{
    set_current(0, -LIMIT);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
}

/* A reference of 40 % of the range, of which a quarter is the least that may flow. */
static void expect_current(void)
{
    in.least_square = 3277U * 3277U;
    set_current(-3000, 12500);
}

/* Six codes of noise are no current; the trip comes in the second period, not in the first. */
void test_current_that_vanishes_from_one_sample_to_the_next_trips_in_the_second_period(void)
{
    expect_current();
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100));
    set_current(60, -70);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step());
}

/* Of a reference of 12 % of the range, 63 codes of which are the quarter, noise and the edges of
 * misplaced halls bring the current near zero for a moment; four times as long is a sensor. */
void test_a_small_current_has_to_be_gone_for_four_times_as_long(void)
{
    in.least_square = 1023U * 1023U;
    set_current(0, 1100);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100));
    set_current(60, -70);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(7));
    set_current(0, 1100);
    step();
    set_current(60, -70);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(7));
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step());
}

/* The reference grows while the current is gone. */
void test_a_current_gone_for_long_enough_trips_when_its_reference_becomes_large(void)
{
    in.least_square = 1023U * 1023U;
    set_current(0, 1100);
    step();
    set_current(0, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(5));
    in.least_square = 1024U * 1024U;
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step());
}

void test_current_that_comes_back_in_time_does_not_trip(void)
{
    expect_current();
    for (int n = 0; n < 1000; n++) {
        set_current(n % 2 == 0 ? 5000 : 0, 0);
        in.slow_step_count++;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    }
}

/* A real current takes at least a period below the least one before it is gone. */
void test_current_that_decays_does_not_trip(void)
{
    expect_current();
    step();
    set_current(2000, 1000);
    step();
    set_current(0, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
    /* Once it has been there again, a loss at once is seen again. */
    set_current(0, 5000);
    step();
    set_current(0, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step());
}

void test_no_current_is_expected_without_a_reference_and_without_pwm(void)
{
    set_current(5000, 0);
    step();
    set_current(0, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
    in.switching = false;
    expect_current();
    step();
    set_current(0, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
}

/* Counts of the two do not add up. */
void test_over_current_after_a_missing_one_needs_its_whole_qualify_time(void)
{
    expect_current();
    step();
    set_current(0, 0);
    step();
    set_current(0, LIMIT + 10);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step());
}

void test_single_samples_above_the_limit_do_not_trip(void)
{
    for (int n = 0; n < 1000; n++) {
        set_current(0, n % 2 == 0 ? INT16_MAX : 0);
        in.slow_step_count++;
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    }
}

void test_rotating_overcurrent_trips(void)
{
    set_current(0, LIMIT + 1);
    step();
    set_current(-(LIMIT + 1), 0);
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step());
}

void test_overvoltage_trips_in_one_period(void)
{
    in.v_dc_pu = BELOW_TRIP_V;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
    in.v_dc_pu = ABOVE_TRIP_V;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, step());
}

/* 53 V, then 60.57: more than 5/64 of the range. A millivolt less, in two periods, is a bus. */
void test_bus_voltage_that_jumps_above_its_trip_is_the_sensor_s(void)
{
    step();
    in.v_dc_pu = ABOVE_TRIP_V;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, step());
    setUp();
    in.v_dc_pu = ABOVE_TRIP_V - MONITOR_BUS_JUMP_PU;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    in.v_dc_pu = ABOVE_TRIP_V;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, step());
}

void test_overvoltage_trips_with_and_without_pwm(void)
{
    in.switching = false;
    in.v_dc_pu = ABOVE_TRIP_V;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, step());
}

void test_power_stage_fault_line_trips_in_one_period(void)
{
    in.power_stage_fault = true;
    TEST_ASSERT_EQUAL_INT(REASON_HARDWARE_BREAK, step());
}

void test_four_missed_slow_steps_trip_while_the_bridge_switches(void)
{
    step(); /* sees a new count */
    for (int n = 0; n < MONITOR_STALE_STEPS * PERIODS_PER_SLOW; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    }
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step());
}

void test_missed_slow_steps_do_not_trip_without_pwm(void)
{
    in.switching = false;
    for (int n = 0; n < 100000; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    }
    /* Steps missed before the bridge switches do not count afterwards. */
    in.switching = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
}

void test_one_slow_step_restarts_the_timeout(void)
{
    for (int k = 0; k < 10; k++) {
        in.slow_step_count++;
        for (int n = 0; n <= MONITOR_STALE_STEPS * PERIODS_PER_SLOW; n++) {
            TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
        }
    }
}

void test_trip_is_latched(void)
{
    in.power_stage_fault = true;
    step();
    in = HEALTHY;
    TEST_ASSERT_EQUAL_INT(REASON_HARDWARE_BREAK, run(100000));
}

void test_reason_of_the_first_trip_is_kept(void)
{
    in.v_dc_pu = ABOVE_TRIP_V;
    step();
    in.power_stage_fault = true;
    set_current(0, INT16_MAX);
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, run(100));
}

void test_acknowledgement_clears_a_trip_without_a_cause(void)
{
    in.power_stage_fault = true;
    step();
    in = HEALTHY;
    in.clear_trip = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    in.clear_trip = false;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(1000));
}

void test_acknowledgement_does_not_clear_a_trip_with_a_present_cause(void)
{
    in.power_stage_fault = true;
    step();
    in.clear_trip = true;
    for (int n = 0; n < 100; n++) {
        TEST_ASSERT_EQUAL_INT(REASON_HARDWARE_BREAK, step());
    }
    setUp();
    in.v_dc_pu = ABOVE_TRIP_V;
    in.clear_trip = true;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, step());
}

void test_overcurrent_trips_again_after_an_acknowledgement(void)
{
    set_current(0, LIMIT + 1);
    run(2);
    in.clear_trip = true;
    run(1000);
    in.clear_trip = false;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, run(2));
}

void test_init_clears_the_trip(void)
{
    in.power_stage_fault = true;
    step();
    monitor_fast_init(&state, &config);
    in = HEALTHY;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(100));
}

/* Acknowledging a trip resets the debounce: the next over-current trips in its second period. */
void test_acknowledgement_resets_the_overcurrent_debounce(void)
{
    set_current(LIMIT + 5, 0);
    (void)step();
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step());
    in.clear_trip = true;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    in.clear_trip = false;
    TEST_ASSERT_EQUAL_INT(REASON_OVERCURRENT, step());
}

void test_bus_voltage_at_the_trip_voltage_does_not_trip(void)
{
    in.v_dc_pu = state.overvoltage_pu;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    in.v_dc_pu++;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, step());
}

/* Every bit of the trip, of its copy and of each limit; what runs by itself may have any value. */
void test_a_flipped_bit_of_trip_or_limits_is_found_and_counters_are_not_watched(void)
{
    for (int tripped = 0; tripped < 2; tripped++) {
        setUp();
        in.power_stage_fault = tripped != 0;
        step();
        TEST_ASSERT_TRUE(monitor_fast_intact(&state, &config));
        unsigned char *bytes = (unsigned char *)&state;
        int found = 0;
        for (unsigned bit = 0; bit < 8U * sizeof(state); bit++) {
            bytes[bit / 8U] ^= (unsigned char)(1U << bit % 8U);
            found += monitor_fast_intact(&state, &config) ? 0 : 1;
            bytes[bit / 8U] ^= (unsigned char)(1U << bit % 8U);
        }
        TEST_ASSERT_EQUAL_INT(7 * 32 + 8 * (int)sizeof(reason_t), found);
    }
    in.power_stage_fault = false;
    in.clear_trip = true;
    step();
    TEST_ASSERT_TRUE(monitor_fast_intact(&state, &config));
}

/* Whole periods in a millisecond, at a frequency that is no multiple of 1 kHz. */
void test_limits_are_those_of_the_configuration(void)
{
    TEST_ASSERT_EQUAL_INT32(32112, state.overvoltage_pu); /* 0.98 of 32768 is 32112.6 */
    config.drive.pwm_frequency_Hz = 19980;
    monitor_fast_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(MONITOR_STALE_STEPS * 19, state.stale_limit_periods);
    config.monitor.overcurrent_pu_q15 = INT16_MAX;
    monitor_fast_init(&state, &config);
    set_current(INT16_MAX - 1, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, run(10));
}

/* Twice the range is the largest reading there can be. */
void test_first_reading_is_no_jump(void)
{
    in.v_dc_pu = 65536;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, step());
    setUp();
    in.v_dc_pu = ABOVE_TRIP_V - MONITOR_BUS_JUMP_PU - 1;
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    in.v_dc_pu = ABOVE_TRIP_V;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_SENSOR, step());
}

/* 75 A for 50 us into 2.46 mF are 1.524 V; twice that is 3.049 V, 1616 of 61.8 V. 1.7433 mF: 4.302
 * V, 2281.03; 1.5799 mF: 4.747 V, 2516.99. Of a capacitor a hundred times as large it is less than
 * the least, 0.97 V; of an unknown and of a very small one it is 5/64 of the range. */
void test_jump_of_the_bus_is_what_its_capacitors_do_not_allow(void)
{
    static const struct {
        int32_t capacitance_nF;
        int32_t jump_pu;
    } CASES[] = {{2460000, 1616},  {1743300, 2281}, {1579900, 2516},
                 {246000000, 512}, {0, 2560},       {1, 2560}};
    for (unsigned n = 0; n < sizeof CASES / sizeof CASES[0]; n++) {
        for (int more = 0; more <= 1; more++) {
            setUp();
            config.drive.current_full_scale_mA = 150000;
            config.current_loop.max_current_pu_q15 = 16384;
            config.drive.pwm_frequency_Hz = 20000;
            config.drive.bus_capacitance_nF = CASES[n].capacitance_nF;
            monitor_fast_init(&state, &config);
            in.v_dc_pu = ABOVE_TRIP_V - CASES[n].jump_pu - more;
            TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
            in.v_dc_pu = ABOVE_TRIP_V;
            TEST_ASSERT_EQUAL_INT(more > 0 ? REASON_BUS_SENSOR : REASON_BUS_OVERVOLTAGE, step());
        }
    }
}

/* 96 of Q15, and one more across. The count stays within its contract (monitor_fast.h). */
void test_largest_current_that_counts_as_none_is_exact(void)
{
    for (int across = 0; across <= 1; across++) {
        setUp();
        expect_current();
        step();
        set_current(96, across);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
        TEST_ASSERT_EQUAL_INT(across == 0 ? REASON_CURRENT_SENSOR : REASON_NONE, step());
        TEST_ASSERT_EQUAL_INT32(across == 0 ? -2 : INT16_MIN, state.current_periods);
        set_current(0, 0);
        step();
        TEST_ASSERT_EQUAL_INT32(across == 0 ? -2 : INT16_MIN, state.current_periods);
    }
}

void test_missing_current_after_a_single_sample_above_the_limit_needs_two_periods(void)
{
    expect_current();
    set_current(0, LIMIT + 10);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    set_current(0, 0);
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step());
    in.clear_trip = true; /* in a period without current, the first of two again */
    TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    in.clear_trip = false;
    TEST_ASSERT_EQUAL_INT(REASON_CURRENT_SENSOR, step());
}

/* The qualify time of one condition does not hide another one. */
void test_bus_and_slow_steps_are_watched_while_a_current_is_qualified(void)
{
    set_current(0, LIMIT + 10);
    in.v_dc_pu = 32113;
    TEST_ASSERT_EQUAL_INT(REASON_BUS_OVERVOLTAGE, step());
    setUp();
    expect_current();
    for (int n = 0; n <= MONITOR_STALE_STEPS * PERIODS_PER_SLOW; n++) {
        set_current(n % 2 == 0 ? 5000 : 0, 0);
        TEST_ASSERT_EQUAL_INT(REASON_NONE, step());
    }
    set_current(0, 0);
    TEST_ASSERT_EQUAL_INT(REASON_PROGRAM_FLOW, step());
}
