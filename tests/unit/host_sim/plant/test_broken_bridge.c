/* SPDX-License-Identifier: Apache-2.0 */
/* Bridge and wires with faults: circuits by hand, and the energy balance of all. */
#include "plant/broken_bridge.h"

#include <math.h>
#include <string.h>

#include "machines.h"
#include "plant/numbers.h"
#include "unity.h"

static const double BUS_V = 48.0;
static double period_s;
static const plant_abc_t NO_DUTY = {.a = 0.0, .b = 0.0, .c = 0.0};

static fault_params_t fault;
static broken_bridge_t state;
static inverter_t inverter;
static pmsm_t machine;
static pmsm_state_t rotor;

/* Sums of a run. */
static broken_bridge_flow_t sum;
static double highest_a[3], lowest_a[3];

static void use(const pmsm_params_t *params)
{
    machine = pmsm_at_temperature(params, 25.0);
    rotor = pmsm_at_rest(0.0);
}

void setUp(void)
{
    memset(&fault, 0, sizeof(fault));
    memset(&state, 0, sizeof(state));
    period_s = 50e-6;
    const inverter_params_t bridge = {.switch_resistance_ohm = 0.004,
                                      .diode_forward_voltage_v = 0.8,
                                      .diode_resistance_ohm = 0.005,
                                      .dead_time_s = 0.5e-6,
                                      .pwm_frequency_hz = 1.0 / period_s,
                                      .turn_on_loss_j_per_a = 1e-6,
                                      .turn_off_loss_j_per_a = 1e-6};
    inverter = inverter_model(&bridge, 25.0);
    const pmsm_params_t plain = plain_machine();
    use(&plain);
}

void tearDown(void) {}

/* Duties that make a voltage of u_v (peak phase), phase_turn ahead of the rotor. */
static plant_abc_t sine(double u_v, double phase_turn)
{
    const double at = PLANT_TWO_PI * (rotor.theta_turn + phase_turn);
    const double third = PLANT_TWO_PI / 3.0;
    const plant_abc_t out = {.a = 0.5 + u_v / BUS_V * cos(at),
                             .b = 0.5 + u_v / BUS_V * cos(at - third),
                             .c = 0.5 + u_v / BUS_V * cos(at + third)};
    return out;
}

static void add(const broken_bridge_flow_t *flow)
{
    sum.machine.copper_j += flow->machine.copper_j;
    sum.machine.series_j += flow->machine.series_j;
    sum.machine.iron_j += flow->machine.iron_j;
    sum.machine.source_j += flow->machine.source_j;
    sum.machine.torque_nms += flow->machine.torque_nms;
    sum.bridge.dc_j += flow->bridge.dc_j;
    sum.bridge.diode_j += flow->bridge.diode_j;
    const plant_abc_t i = plant_inverse_clarke(rotor.terminal);
    const double now_a[3] = {i.a, i.b, i.c};
    for (int x = 0; x < 3; x++) {
        highest_a[x] = plant_max(highest_a[x], now_a[x]);
        lowest_a[x] = plant_min(lowest_a[x], now_a[x]);
    }
}

/* So many periods; fixed: these duties, else a turning voltage of u_v. */
static void run(broken_bridge_mode_t mode, const plant_abc_t *fixed, double u_v, double omega,
                int periods)
{
    const broken_bridge_flow_t none = {.bridge = {.dc_j = 0.0}};
    sum = none;
    for (int x = 0; x < 3; x++) {
        highest_a[x] = lowest_a[x] = 0.0;
    }
    const pmsm_step_t step = {.omega_rad_s = omega, .duration_s = period_s};
    for (int k = 0; k < periods; k++) {
        const broken_bridge_command_t command = {
            .mode = mode, .duty = fixed != NULL ? *fixed : sine(u_v, 0.25), .bus_voltage_v = BUS_V};
        const broken_bridge_flow_t flow =
            broken_bridge_step(&fault, &state, &inverter, &machine, &rotor, &command, &step);
        add(&flow);
    }
}

static void balances(double omega, double magnetic_before_j)
{
    const pmsm_flow_t *m = &sum.machine;
    const double work_j = m->torque_nms * omega / machine.params.pole_pairs;
    const double stored_j = pmsm_magnetic_energy_j(&machine, &rotor) - magnetic_before_j;
    const double turned_j = fabs(m->source_j) + fabs(work_j) + m->copper_j + fabs(stored_j);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * turned_j, m->source_j,
                              m->copper_j + m->series_j + m->iron_j + work_j + stored_j);
}

void test_a_healthy_bridge_is_the_averaged_one(void)
{
    const pmsm_params_t salient = salient_machine();
    use(&salient);
    const double omega = 500.0;
    pmsm_state_t other = rotor;
    double torque_nms = 0.0;
    double dc_j = 0.0;
    const pmsm_step_t step = {.omega_rad_s = omega,
                              .duration_s = period_s,
                              .series_resistance_ohm = inverter.pwm_resistance_ohm};
    for (int k = 0; k < 400; k++) {
        const plant_abc_t duty = sine(13.0, 0.25);
        const double zone_a =
            inverter_zone_a(&inverter, BUS_V, pmsm_amperes_per_volt(&machine, &other, &step));
        const inverter_drive_t drive = inverter_drive(&inverter, duty, BUS_V, zone_a);
        pmsm_step_t with = step;
        with.opposition = drive.opposition;
        const pmsm_flow_t flow = pmsm_step(&machine, &other, drive.legs, &with);
        torque_nms += flow.torque_nms;
        dc_j += inverter_pwm_flow(&inverter, &drive, &flow).dc_j;
        rotor.theta_turn = other.theta_turn; /* equal duties in the run below */
    }
    use(&salient);
    run(BROKEN_BRIDGE_PWM, NULL, 13.0, omega, 400);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(torque_nms), torque_nms, sum.machine.torque_nms);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * fabs(dc_j), dc_j, sum.bridge.dc_j);
}

/* 20 steps of 5 us, and the d axis fades four times as quickly as the q axis. What is left of the
 * energy in the open winding becomes heat; the other wires have at most the sum of two currents. */
void test_a_phase_opens_under_current_in_a_salient_motor_at_a_low_pwm_frequency(void)
{
    pmsm_params_t salient = salient_machine();
    salient.q_inductance_h = 4.0 * salient.d_inductance_h;
    for (int turn = 0; turn < 12; turn++) {
        setUp();
        period_s = 100e-6;
        use(&salient);
        rotor.theta_turn = turn / 12.0;
        run(BROKEN_BRIDGE_PWM, NULL, 12.0, 500.0, 60 + turn);
        const double before_j = pmsm_magnetic_energy_j(&machine, &rotor);
        double most_a = 0.0;
        for (int x = 0; x < 3; x++) {
            most_a = plant_max(most_a, plant_max(highest_a[x], -lowest_a[x]));
        }
        TEST_ASSERT_TRUE(most_a > 10.0);
        fault.phase_open = 1.0;
        run(BROKEN_BRIDGE_PWM, NULL, 12.0, 500.0, 40);
        const double opened_j = sum.bridge.diode_j; /* the arc's, and that of the dead times */
        TEST_ASSERT_TRUE(opened_j >= 0.0 && opened_j < 2.0 * before_j + 0.5);
        /* An EMF of 10 V behind 1.3 * 150 uH/5 us = 39 ohm. */
        TEST_ASSERT_DOUBLE_WITHIN(10.0 / 39.0, 0.0, plant_inverse_clarke(rotor.terminal).a);
        for (int x = 1; x < 3; x++) {
            TEST_ASSERT_TRUE(highest_a[x] < 2.0 * most_a && lowest_a[x] > -2.0 * most_a);
        }
    }
}

void test_an_open_phase_leaves_two_windings_in_series(void)
{
    fault.phase_open = 1.0;
    const plant_abc_t duty = {.a = 0.9, .b = 0.55, .c = 0.45};
    run(BROKEN_BRIDGE_PWM, &duty, 0.0, 0.0, 2000); /* 33 time constants */
    const plant_abc_t i = plant_inverse_clarke(rotor.terminal);
    const double lost_v = 2.0 * inverter.dead_share * (0.5 * BUS_V + 0.8);
    const double expected_a =
        (0.1 * BUS_V - lost_v) / (2.0 * (machine.resistance_ohm + inverter.pwm_resistance_ohm));
    TEST_ASSERT_DOUBLE_WITHIN(0.002 * expected_a, expected_a, i.b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -i.b, i.c);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, i.a);
    /* The current lies on beta, which is q at angle 0: T = 3/2 p psi 2/sqrt(3) i_b. */
    const double torque_nm = 1.5 * 7.0 * 0.02 * 2.0 * PLANT_INV_SQRT3 * i.b;
    run(BROKEN_BRIDGE_PWM, &duty, 0.0, 0.0, 10);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * torque_nm, torque_nm,
                              sum.machine.torque_nms / (10.0 * period_s));
}

void test_an_open_phase_carries_no_current_at_speed_and_torque_pulsates(void)
{
    fault.phase_open = 4.0;
    run(BROKEN_BRIDGE_PWM, NULL, 12.0, 400.0, 2000);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.0, highest_a[2]);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.0, lowest_a[2]);
    TEST_ASSERT_TRUE(highest_a[0] > 10.0 && lowest_a[0] < -10.0);
    balances(400.0, 0.0);
}

void test_a_leg_without_its_high_switch_gives_no_current_into_the_motor(void)
{
    fault.high_switch_open = 1.0;
    run(BROKEN_BRIDGE_PWM, NULL, 13.0, 400.0, 2000);
    TEST_ASSERT_TRUE(lowest_a[0] < -10.0);
    /* Into the motor only what its low side and diode let circulate. */
    TEST_ASSERT_TRUE(highest_a[0] < 0.75 * highest_a[1]);
    TEST_ASSERT_TRUE(sum.machine.torque_nms > 0.0);
    balances(400.0, 0.0);
}

void test_both_switches_of_a_leg_open_leave_its_diodes_below_the_emf_limit_without_current(void)
{
    fault.high_switch_open = 2.0;
    fault.low_switch_open = 2.0;
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, 700.0, 500); /* 24 V of 49.6 between the wires */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, highest_a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, highest_a[1]);
}

void test_the_diodes_of_an_open_bridge_rectify_an_emf_above_the_bus(void)
{
    fault.high_switch_open = 1.0;                        /* any, so that the model is in use */
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, 2400.0, 2000); /* 83 V between the wires */
    TEST_ASSERT_TRUE(sum.bridge.dc_j < 0.0);
    TEST_ASSERT_TRUE(sum.machine.torque_nms < 0.0);
    balances(2400.0, 0.0);
}

void test_a_closed_high_switch_makes_the_drivers_open_the_others_and_brakes_in_half_waves(void)
{
    fault.high_switch_closed = 1.0;
    run(BROKEN_BRIDGE_PWM, NULL, 8.0, 400.0, 2);
    TEST_ASSERT_TRUE(state.desaturated);
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, 400.0, 4000);
    /* Out of the rail through the stuck switch, back through the upper diodes of the others. */
    TEST_ASSERT_TRUE(highest_a[0] > 10.0);
    TEST_ASSERT_TRUE(lowest_a[0] > -2.0);
    TEST_ASSERT_TRUE(highest_a[1] < 2.0 && highest_a[2] < 2.0);
    TEST_ASSERT_TRUE(sum.machine.torque_nms < 0.0);
}

void test_a_closed_low_switch_is_found_when_its_partner_is_to_close_and_not_before(void)
{
    fault.low_switch_closed = 2.0;
    run(BROKEN_BRIDGE_SHORT_LOW, &NO_DUTY, 0.0, 100.0, 10);
    TEST_ASSERT_FALSE(state.desaturated);
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, 100.0, 10);
    TEST_ASSERT_FALSE(state.desaturated);
    run(BROKEN_BRIDGE_PWM, NULL, 2.0, 100.0, 1);
    TEST_ASSERT_TRUE(state.desaturated);
}

void test_a_short_on_the_side_of_the_stuck_switch_is_symmetrical(void)
{
    fault.low_switch_closed = 2.0;
    state.desaturated = true;
    run(BROKEN_BRIDGE_SHORT_LOW, &NO_DUTY, 0.0, 400.0, 4000);
    /* E / |R + j w L|, in all three. */
    const double r = machine.resistance_ohm + inverter.short_resistance_ohm;
    const double expected_a = 400.0 * 0.02 / hypot(r, 400.0 * 150e-6);
    run(BROKEN_BRIDGE_SHORT_LOW, &NO_DUTY, 0.0, 400.0, 400);
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * expected_a, expected_a, highest_a[x]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * expected_a, -expected_a, lowest_a[x]);
    }
}

void test_a_short_on_the_high_side_is_symmetrical_and_the_wrong_side_opens_again(void)
{
    fault.high_switch_closed = 1.0;
    run(BROKEN_BRIDGE_PWM, NULL, 8.0, 400.0, 2);
    TEST_ASSERT_TRUE(state.desaturated);
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, 400.0, 2);
    TEST_ASSERT_FALSE(state.desaturated); /* released, so that a short can be commanded */
    run(BROKEN_BRIDGE_SHORT_LOW, &NO_DUTY, 0.0, 400.0, 1);
    TEST_ASSERT_TRUE(state.desaturated);
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, 400.0, 2);
    run(BROKEN_BRIDGE_SHORT_HIGH, &NO_DUTY, 0.0, 400.0, 4000);
    TEST_ASSERT_FALSE(state.desaturated);
    const double r = machine.resistance_ohm + inverter.short_resistance_ohm;
    const double expected_a = 400.0 * 0.02 / hypot(r, 400.0 * 150e-6);
    run(BROKEN_BRIDGE_SHORT_HIGH, &NO_DUTY, 0.0, 400.0, 400);
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * expected_a, expected_a, highest_a[x]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * expected_a, -expected_a, lowest_a[x]);
    }
}

void test_shorted_phases_circulate_current_while_the_bridge_is_off(void)
{
    fault.phase_short = 1.0;
    fault.phase_short_ohm = 0.02;
    const double omega = 300.0;
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, omega, 4000);
    run(BROKEN_BRIDGE_OFF, &NO_DUTY, 0.0, omega, 4189); /* ten turns */
    /* sqrt(3) E across 2 R + R_s and 2 w L: amplitude and mean power. */
    const double r = 2.0 * machine.resistance_ohm + 0.02;
    const double z = hypot(r, omega * 2.0 * 150e-6);
    const double amplitude_a = sqrt(3.0) * omega * 0.02 / z;
    const double power_w = 0.5 * amplitude_a * amplitude_a * r;
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * amplitude_a, amplitude_a, highest_a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * amplitude_a, -amplitude_a, lowest_a[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * amplitude_a, 0.0, highest_a[2]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * power_w, -power_w,
                              sum.machine.torque_nms / (4189.0 * period_s) * omega / 7.0);
}

void test_shorted_phases_are_found_when_they_are_driven_apart_beyond_the_blanking_time(void)
{
    fault.phase_short = 1.0;
    fault.blanking_s = 2e-6;
    const plant_abc_t near = {.a = 0.50, .b = 0.43, .c = 0.5}; /* 1.75 us each side */
    run(BROKEN_BRIDGE_PWM, &near, 0.0, 0.0, 3);
    TEST_ASSERT_FALSE(state.desaturated);
    const plant_abc_t apart = {.a = 0.50, .b = 0.41, .c = 0.5}; /* 2.25 us */
    run(BROKEN_BRIDGE_PWM, &apart, 0.0, 0.0, 1);
    TEST_ASSERT_TRUE(state.desaturated);
}

void test_a_stuck_leg_is_at_its_rail_whatever_is_commanded_without_a_shoot_through(void)
{
    fault.leg_low = 1.0;
    const plant_abc_t duty = {.a = 0.9, .b = 0.1, .c = 0.1};
    run(BROKEN_BRIDGE_PWM, &duty, 0.0, 0.0, 3000);
    TEST_ASSERT_FALSE(state.desaturated);
    /* b and c at 4.8 V drive current out of a at 0 V: 2/3 of the voltage over R. */
    const plant_abc_t i = plant_inverse_clarke(rotor.terminal);
    TEST_ASSERT_TRUE(i.a < -20.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.5 * i.a, i.b);
}
