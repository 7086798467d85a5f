/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The application on its simulated board against the two step functions called directly: in every
 * period of a drive that the application itself controls, the bridge must get the same numbers; and
 * the drive must agree with the bench.
 */
#include "bench/board.h"
#include "config/bases.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "app/can_link.h"
#include "app/report_timer.h"
#include "comms/node.h"
#include "config/validate.h"
#include "unity.h"
#include "vehicle_fixture.h"

/* Cycle time of the demand and of the brake command, the delay that CAN adds to each. */
static const double CYCLE_S = 0.010;

/* Reference: the pure modules alone, with the same sensor values and the frames of the vehicle. */
typedef struct {
    board_t board;
    wheel_coupling_t through_board;
    const config_t *config;
    controller_t controller;
    fast_setpoint_t to_fast;
    fast_report_t report;
    report_timer_t report_timer;
    unsigned reports_taken;
    node_t node;
    fast_output_t next;
    wheel_temperatures_t temperature;
    uint32_t now_ms;
    int switching_periods, braking_commands;
    bool has_report;
} twin_t;

static bench_t bench;
static twin_t twin;

static fast_output_t period(void *context, const fast_input_t *in)
{
    twin_t *t = context;
    const fast_output_t out = t->through_board.period(t->through_board.context, in);
    const fast_output_t expected = t->next;
    t->next = *controller_fast_step(&t->controller.fast, t->config, &t->to_fast, in);
    /* As the application does: where a run begins anew, its millisecond comes early. */
    if (report_timer_is_due(&t->report_timer, t->reports_taken)) {
        controller_fast_report(&t->controller.fast, &t->report);
        t->has_report = true;
    }
    TEST_ASSERT_EQUAL_INT(expected.bridge, out.bridge);
    TEST_ASSERT_EQUAL_UINT16_ARRAY(expected.compare_counts, out.compare_counts, 3);
    t->switching_periods += out.bridge == BRIDGE_PWM ? 1 : 0;
    return out;
}

static void deliver_frames(twin_t *t)
{
    (void)node_tick(&t->node, t->now_ms);
    for (uint32_t i = 0; i < t->board.vehicle.queued_count; i++) {
        (void)node_receive(&t->node, &t->board.vehicle.queued[i], t->now_ms);
    }
}

static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    twin_t *t = context;
    const slow_output_t out = t->through_board.millisecond(t->through_board.context, in);
    deliver_frames(t);
    t->now_ms++;
    const node_command_t *command = &t->node.command;
    const slow_input_t received = {
        .demand = command->demand,
        .demand_age_ms = node_demand_age_ms(command, t->now_ms),
        .bms = command->bms,
        .temperature = t->temperature,
        .selftest_passed = true,
        .config_accepted = true,
    };
    /* The board's temperatures are sampled with the currents, so the next millisecond sees them. */
    t->temperature = in->temperature;
    t->reports_taken += t->has_report ? 1U : 0U;
    t->has_report = false;
    const slow_output_t expected =
        controller_slow_step(&t->controller.slow, t->config, &t->report, &received, &t->to_fast);
    if (t->board.vehicle.link[MESSAGES_WHEEL_BRAKE].link == E2E_VALID &&
        t->board.vehicle.link[MESSAGES_WHEEL_BRAKE].refreshed_ms == t->now_ms) {
        TEST_ASSERT_INT_WITHIN(50, expected.hydraulic_torque_mNm,
                               out.hydraulic_torque_mNm); /* half a step */
        TEST_ASSERT_INT_WITHIN(100, expected.electric_brake_available_mNm,
                               out.electric_brake_available_mNm); /* rounded down to a step */
        t->braking_commands += out.hydraulic_torque_mNm > 0 ? 1 : 0;
    }
    if (t->board.vehicle.link[MESSAGES_WHEEL_STATE].link == E2E_VALID &&
        t->board.vehicle.link[MESSAGES_WHEEL_STATE].refreshed_ms == t->now_ms) {
        TEST_ASSERT_EQUAL_INT(expected.mode, out.mode);
        TEST_ASSERT_EQUAL_INT(expected.fault_reason, out.fault_reason);
    }
    return out;
}

static void start_twin(const config_t *config)
{
    const node_limits_t limits = can_link_limits(config);
    memset(&twin, 0, sizeof twin);
    board_start(&twin.board, config);
    twin.through_board = board_coupling(&twin.board);
    twin.config = config;
    controller_init(&twin.controller, config, BASES_MODEL_TIMER_Hz);
    twin.to_fast = controller_initial_setpoint(config, BASES_MODEL_TIMER_Hz);
    node_init(&twin.node, link_address(config), &limits, 0);
    controller_fast_report(&twin.controller.fast, &twin.report);
    report_timer_init(&twin.report_timer, (uint32_t)config->drive.pwm_frequency_Hz,
                      CONTROLLER_SLOW_RATE_HZ);
    twin.next.bridge = BRIDGE_OFF;
    twin.temperature.winding_cC = twin.board.sample.winding_temperature_cC;
    twin.temperature.switch_cC = twin.board.sample.switch_temperature_cC;
}

static bench_params_t moving_vehicle(double speed_m_per_s)
{
    bench_params_t params = fixture_quarter_vehicle();
    params.run.initial_speed_m_per_s = speed_m_per_s;
    return params;
}

/* A bench whose one wheel has this coupling; NULL: the bench's default. */
static bench_start_t start(const bench_params_t *params, const config_t *config,
                           const wheel_coupling_t *coupling)
{
    const driver_trace_t none = {.points = 0};
    bench_init(&bench, params, config, &none);
    bench.wheel[0].coupling = coupling;
    return bench_start(&bench);
}

/* Brakes beyond the motor's limit, releases the brake, drives, brakes gently to the end. */
static void drive_about(void)
{
    bench.params.driver.brake_demand_nm = 75.03; /* between two steps of the message */
    fixture_run(&bench, 0.4);
    bench.params.driver.brake_demand_nm = 0.0;
    fixture_run(&bench, 0.1);
    bench.params.driver.drive_demand_nm = 12.34;
    fixture_run(&bench, 0.3);
    bench.params.driver.drive_demand_nm = 0.0;
    bench.params.driver.brake_demand_nm = 90.0;
    fixture_run_to_standstill(&bench, 10.0);
}

void setUp(void) {}

void tearDown(void) {}

static void assert_the_same_in_every_period(const config_t *config, const bench_params_t *params)
{
    start_twin(config);
    const wheel_coupling_t compared = {
        .context = &twin, .period = period, .millisecond = millisecond};
    TEST_ASSERT_EQUAL_INT(BENCH_READY, start(params, config, &compared));
    drive_about();
    TEST_ASSERT_TRUE_MESSAGE(twin.switching_periods > 20000,
                             "the bridge must switch to prove anything");
    TEST_ASSERT_TRUE_MESSAGE(twin.braking_commands > 20,
                             "the hydraulic brake must have been asked");
    TEST_ASSERT_FALSE(host_watchdog_bit());
}

void test_bridge_commands_of_application_and_direct_steps_are_equal_with_an_angle_sensor(void)
{
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    const bench_params_t params = moving_vehicle(5.0);
    assert_the_same_in_every_period(&config, &params);
}

void test_bridge_commands_of_application_and_direct_steps_are_equal_with_hall_sensors(void)
{
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL, CONFIG_ROTOR_HALL);
    const bench_params_t params = moving_vehicle(5.0);
    assert_the_same_in_every_period(&config, &params);
}

void test_bridge_commands_of_application_and_direct_steps_are_equal_with_an_encoder(void)
{
    config_t config = fixture_config(CONFIG_STRATEGY_SERIES_OPTIMAL);
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_counts = 4096;
    config.rotor.encoder_index_tolerance_counts = 2;
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    bench_params_t params = moving_vehicle(5.0);
    params.encoder.counts = 4096.0;
    params.encoder.index_width_counts = 1.0;
    assert_the_same_in_every_period(&config, &params);
}

typedef struct {
    double distance_m;
    double chemical_j;
    double kinetic_j;
} stop_t;

static stop_t stop_with(const wheel_coupling_t *coupling, const config_t *config, double demand_nm)
{
    const bench_params_t params = moving_vehicle(5.0);
    TEST_ASSERT_EQUAL_INT(BENCH_READY, start(&params, config, coupling));
    bench.params.driver.brake_demand_nm = demand_nm;
    const double kinetic_j = vehicle_kinetic_energy_j(&bench.road.vehicle, &bench.vehicle);
    fixture_run_to_standstill(&bench, 20.0);
    const stop_t out = {bench.vehicle.distance_m, bench_ledger(&bench).chemical_j, kinetic_j};
    return out;
}

/*
 * CAN makes the demand older by a cycle and the brake's command by another, and rounds both to 0.1
 * N m, half of which is 0.1 % of 50 N m. So the stop may be longer by twice the cycle at full speed
 * and by a thousandth or two of itself, and the battery may miss the power of a cycle at the start:
 * T w <= 50 N m * 20 rad/s = 1 kW.
 */
void test_a_stop_with_the_application_equals_that_of_the_bench_except_for_the_can_delay(void)
{
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    const stop_t direct = stop_with(NULL, &config, 50.0);
    static board_t board;
    board_start(&board, &config);
    const wheel_coupling_t coupling = board_coupling(&board);
    const stop_t through = stop_with(&coupling, &config, 50.0);
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * CYCLE_S * 5.0 + 0.002 * direct.distance_m, direct.distance_m,
                              through.distance_m);
    TEST_ASSERT_TRUE_MESSAGE(direct.chemical_j < -0.3 * direct.kinetic_j,
                             "the battery must get something");
    TEST_ASSERT_DOUBLE_WITHIN(1000.0 * CYCLE_S + 0.002 * direct.kinetic_j, direct.chemical_j,
                              through.chemical_j);
}

enum { CUT_ms = 1000 };

/* Motor and hydraulic brake together, in each millisecond: the motor falls with the lag with which
 * the own path of the brake system comes. A tenth of the demand for what plant and firmware round
 * and time differently. */
static void assert_both_brakes_make_the_demand(const board_t *board, double demand_nm)
{
    for (int ms = 0; ms < CUT_ms; ms++) {
        const double before_nms = bench.wheel[0].totals.torque_impulse_nms;
        fixture_run(&bench, 0.001);
        const double motor_nm = (before_nms - bench.wheel[0].totals.torque_impulse_nms) / 0.001;
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * demand_nm, demand_nm,
                                  motor_nm + bench.wheel[0].brake.torque_nm);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * demand_nm, demand_nm, bench.wheel[0].brake.torque_nm);
    TEST_ASSERT_FALSE(board->vehicle.received.hydraulic_valid);
}

/* The demand still comes, the wheel's frames do not leave: the brake system takes its own path
 * after 50 ms, so the motor has to go. With a demand that ends as well it is the same, as the clock
 * of the frames is the earlier one. When they leave again the wheel brakes again. */
void test_a_wheel_whose_frames_do_not_leave_hands_its_brake_over(void)
{
    const config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    for (int both_ways = 0; both_ways <= 1; both_ways++) {
        static board_t board;
        board_start(&board, &config);
        const wheel_coupling_t coupling = board_coupling(&board);
        const bench_params_t params = moving_vehicle(12.0);
        TEST_ASSERT_EQUAL_INT(BENCH_READY, start(&params, &config, &coupling));
        bench.params.driver.own_brake_path = 1.0;
        bench.params.driver.brake_demand_nm = 20.0;
        fixture_run(&bench, 0.3);
        TEST_ASSERT_TRUE_MESSAGE(bench.wheel[0].brake.torque_nm < 2.0, "the motor brakes alone");
        bench.params.fault.can_unsent = 1.0;
        bench.params.driver.silent = both_ways;
        bench_refresh(&bench);
        assert_both_brakes_make_the_demand(&board, 20.0);
        bench.params.fault.can_unsent = 0.0;
        bench.params.driver.silent = 0.0;
        bench_refresh(&bench);
        fixture_run(&bench, 0.5);
        TEST_ASSERT_TRUE(board.vehicle.received.hydraulic_valid);
        TEST_ASSERT_TRUE_MESSAGE(bench.wheel[0].brake.torque_nm < 2.0, "the motor brakes again");
    }
}

/* Uphill, 8 %, with half as much again as the slope pulls with. */
static void stop_on_slope(board_t *board, wheel_coupling_t *coupling, double speed_m_per_s)
{
    config_t config =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    bench_params_t params = moving_vehicle(speed_m_per_s);
    params.road.slope = 0.08;
    params.driver.own_brake_path = 1.0;
    const double pull_nm = params.vehicle.mass_kg * 9.81 * 0.08 * params.vehicle.wheel_radius_m;
    config.driver.hold_torque_mNm = (int32_t)(1500.0 * pull_nm);
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    board_start(board, &config);
    *coupling = board_coupling(board);
    TEST_ASSERT_EQUAL_INT(BENCH_READY, start(&params, &config, coupling));
    bench.params.driver.brake_demand_nm = 2.0 * pull_nm;
}

static double rolled_m(double duration_s)
{
    const double before_m = bench.vehicle.distance_m;
    fixture_run(&bench, duration_s);
    return fabs(bench.vehicle.distance_m - before_m);
}

/* Twice: after 40 ms the brake system still has the last command; after 300 ms it has had none for
 * a quarter of a second, in which the vehicle rolls g s t^2/2, 25 mm, and then until the brake has
 * stopped it. Then the driver drives off. */
void test_a_vehicle_that_is_held_on_a_slope_is_held_after_a_restart(void)
{
    static board_t board;
    wheel_coupling_t coupling;
    stop_on_slope(&board, &coupling, 2.0);
    fixture_run(&bench, 3.0);
    bench.params.driver.brake_demand_nm = 0.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, rolled_m(1.0));
    board_restart(&board, RESET_WATCHDOG, 40);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, rolled_m(2.0));
    TEST_ASSERT_TRUE(board.vehicle.received.hydraulic_valid);
    board_restart(&board, RESET_BROWN_OUT, 300);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.0, rolled_m(0.5));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, rolled_m(2.0));
    TEST_ASSERT_EQUAL_INT(MODE_RUN, board.vehicle.received.mode);
    bench.params.driver.drive_demand_nm = 38.0;
    fixture_run(&bench, 2.0);
    TEST_ASSERT_TRUE_MESSAGE(bench.vehicle.speed_m_per_s > 0.1, "the hold ends as usual");
    TEST_ASSERT_EQUAL_INT(0, board.vehicle.received.hydraulic_torque_mNm);
}

/* Nor one that was, after a supply that was away. */
void test_a_restart_holds_no_vehicle_that_was_not_held(void)
{
    static board_t board;
    wheel_coupling_t coupling;
    stop_on_slope(&board, &coupling, 8.0);
    bench.params.driver.brake_demand_nm = 0.0;
    fixture_run(&bench, 0.5);
    board_restart(&board, RESET_WATCHDOG, 40);
    fixture_run(&bench, 1.0);
    TEST_ASSERT_EQUAL_INT(0, board.vehicle.received.hydraulic_torque_mNm);
    TEST_ASSERT_TRUE(bench.wheel[0].brake.torque_nm < 0.01);
    stop_on_slope(&board, &coupling, 2.0);
    fixture_run(&bench, 3.0);
    bench.params.driver.brake_demand_nm = 0.0;
    fixture_run(&bench, 0.5);
    board_restart(&board, RESET_POWER, 40);
    TEST_ASSERT_TRUE_MESSAGE(rolled_m(2.0) > 0.5, "nothing is known of it any more");
}

void test_vehicle_stays_at_standstill_with_a_refused_configuration(void)
{
    const config_t good =
        fixture_config_with_sensor(CONFIG_STRATEGY_SERIES_OPTIMAL, CONFIG_ROTOR_ANGLE);
    config_t damaged = good;
    damaged.motor.pole_pairs++; /* the checksum now says so */
    static board_t board;
    board_start(&board, &damaged);
    const wheel_coupling_t coupling = board_coupling(&board);
    const bench_params_t params = moving_vehicle(0.0);
    TEST_ASSERT_EQUAL_INT(BENCH_NOT_RUN, start(&params, &good, &coupling));
    TEST_ASSERT_EQUAL_INT(BRIDGE_OFF, bench.wheel[0].active.bridge);
    TEST_ASSERT_NOT_NULL(strstr(host_serial_output(), "configuration refused: crc32"));
}
