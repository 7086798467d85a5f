/* SPDX-License-Identifier: Apache-2.0 */
/* Switching bridge: energy balance, loss of an edge, and agreement of its mean with the averaged
 * bridge. */
#include "plant/switching.h"

#include <math.h>

#include "machines.h"
#include "unity.h"

static const double BUS_V = 50.0;
static const double TWO_PI = 6.283185307179586;
static inverter_params_t params;
static pmsm_t machine;
static pmsm_state_t rotor;
static pmsm_step_t step;

void setUp(void)
{
    const inverter_params_t p = {.switch_resistance_ohm = 0.004,
                                 .diode_forward_voltage_v = 0.8,
                                 .diode_resistance_ohm = 0.006,
                                 .dead_time_s = 1e-6,
                                 .pwm_frequency_hz = 20000.0,
                                 .turn_on_loss_j_per_a = 5e-6,
                                 .turn_off_loss_j_per_a = 7e-6};
    const pmsm_params_t motor = salient_machine();
    const pmsm_step_t s = {.omega_rad_s = 500.0, .duration_s = 50e-6};
    params = p;
    machine = pmsm_at_temperature(&motor, 25.0);
    rotor = pmsm_at_rest(0.0);
    step = s;
}

void tearDown(void) {}

static double work_j(const pmsm_flow_t *flow)
{
    return flow->torque_nms * step.omega_rad_s / machine.params.pole_pairs;
}

/* Bus energy less heat, work and field energy. */
static double residual_j(const switching_flow_t *flow, double field_before_j)
{
    const double heat_j = flow->machine.copper_j + flow->machine.iron_j +
                          flow->bridge.conduction_j + flow->bridge.diode_j +
                          flow->bridge.switching_j;
    const double field_j = pmsm_magnetic_energy_j(&machine, &rotor) - field_before_j;
    return flow->bridge.dc_j - heat_j - work_j(&flow->machine) - field_j;
}

static plant_abc_t duty_at(double amplitude_v, double angle)
{
    const plant_abc_t out = {.a = 0.5 + amplitude_v / BUS_V * cos(angle),
                             .b = 0.5 + amplitude_v / BUS_V * cos(angle - TWO_PI / 3.0),
                             .c = 0.5 + amplitude_v / BUS_V * cos(angle + TWO_PI / 3.0)};
    return out;
}

void test_energy_balance_closes_in_every_period_at_any_current_and_dead_time(void)
{
    const double dead_times_s[] = {0.0, 1e-6, 3e-6};
    for (int d = 0; d < 3; d++) {
        params.dead_time_s = dead_times_s[d];
        const switching_t bridge = switching_model(&params, 25.0);
        for (int level = 0; level < 4; level++) { /* from small currents, where legs are
                                                     undetermined in the dead time, to large ones */
            rotor = pmsm_at_rest(0.0);
            double turned_j = 0.0;
            double lost_j = 0.0;
            for (int k = 0; k < 2000; k++) {
                const double field_j = pmsm_magnetic_energy_j(&machine, &rotor);
                const plant_abc_t duty =
                    duty_at(10.0 + 1.5 * level, TWO_PI * rotor.theta_turn + 1.65 + 0.02 * level);
                const switching_flow_t flow =
                    switching_pwm(&bridge, &machine, &rotor, duty, BUS_V, &step, NULL);
                turned_j += fabs(flow.bridge.dc_j);
                lost_j += fabs(residual_j(&flow, field_j));
                TEST_ASSERT_TRUE(flow.bridge.diode_j >= -1e-9 && flow.bridge.switching_j >= 0.0);
            }
            TEST_ASSERT_TRUE(turned_j > 0.1);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, lost_j / turned_j);
        }
    }
}

typedef struct {
    double torque_nm, copper_w, iron_w, conduction_w, diode_w, switching_w;
} means_t;

/* Steady braking under the same sinusoidal duties; means over whole electrical turns. */
static means_t steady(bool edges, double amplitude_v, double lead)
{
    const switching_t bridge = switching_model(&params, 25.0);
    const inverter_t averaged = inverter_model(&params, 25.0);
    step.series_resistance_ohm = averaged.pwm_resistance_ohm;
    rotor = pmsm_at_rest(0.0);
    const double zone_a =
        inverter_zone_a(&averaged, BUS_V, pmsm_amperes_per_volt(&machine, &rotor, &step));
    means_t out = {.torque_nm = 0.0};
    const int settle = 4000;
    const int count = 2513; /* ten turns of 500 rad/s: 0.12566 s */
    for (int k = 0; k < settle + count; k++) {
        const double middle = TWO_PI * rotor.theta_turn + 0.5 * step.omega_rad_s * step.duration_s;
        const plant_abc_t duty = duty_at(amplitude_v, middle + lead);
        switching_flow_t flow = {.bridge = {.dc_j = 0.0}};
        if (edges) {
            flow = switching_pwm(&bridge, &machine, &rotor, duty, BUS_V, &step, NULL);
        } else {
            const inverter_drive_t drive = inverter_drive(&averaged, duty, BUS_V, zone_a);
            pmsm_step_t opposed = step;
            opposed.opposition = drive.opposition;
            flow.machine = pmsm_step(&machine, &rotor, drive.legs, &opposed);
            flow.bridge = inverter_pwm_flow(&averaged, &drive, &flow.machine);
        }
        if (k >= settle) {
            const double per_s = 1.0 / (count * step.duration_s);
            out.torque_nm += flow.machine.torque_nms * per_s;
            out.copper_w += flow.machine.copper_j * per_s;
            out.iron_w += flow.machine.iron_j * per_s;
            out.conduction_w += flow.bridge.conduction_j * per_s;
            out.diode_w += flow.bridge.diode_j * per_s;
            out.switching_w += flow.bridge.switching_j * per_s;
        }
    }
    return out;
}

static void check_agreement(double amplitude_v, double lead)
{
    const means_t mean = steady(false, amplitude_v, lead);
    const means_t edge = steady(true, amplitude_v, lead);
    const double all_mean_w =
        mean.copper_w + mean.iron_w + mean.conduction_w + mean.diode_w + mean.switching_w;
    const double all_edge_w =
        edge.copper_w + edge.iron_w + edge.conduction_w + edge.diode_w + edge.switching_w;
    TEST_ASSERT_TRUE(fabs(mean.torque_nm) > 1.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(mean.torque_nm), mean.torque_nm, edge.torque_nm);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * all_mean_w, all_mean_w, all_edge_w);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * mean.copper_w, mean.copper_w, edge.copper_w);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * mean.iron_w, mean.iron_w, edge.iron_w);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * mean.conduction_w, mean.conduction_w, edge.conduction_w);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * mean.diode_w, mean.diode_w, edge.diode_w);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * mean.switching_w, mean.switching_w, edge.switching_w);
}

void test_averaged_and_switching_bridge_agree_on_torque_and_losses_within_1_percent(void)
{
    check_agreement(7.5, 1.85);
    check_agreement(13.0, 1.45);
    check_agreement(10.5, 1.85);
}

void test_open_switches_below_the_emf_limit_have_zero_current(void)
{
    const switching_t bridge = switching_model(&params, 25.0);
    switching_off(&bridge, &machine, &rotor, BUS_V, &step, NULL); /* the iron current builds up */
    for (int k = 0; k < 400; k++) {
        const switching_flow_t flow = switching_off(&bridge, &machine, &rotor, BUS_V, &step, NULL);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, flow.bridge.dc_j);
    }
}

void test_open_switches_above_the_emf_limit_rectify_with_a_closed_energy_balance(void)
{
    const switching_t bridge = switching_model(&params, 25.0);
    step.omega_rad_s = 2500.0; /* line EMF of 87 V against 51.6 V */
    double into_bus_j = 0.0;
    double work = 0.0;
    double lost_j = 0.0;
    for (int k = 0; k < 4000; k++) {
        const double field_j = pmsm_magnetic_energy_j(&machine, &rotor);
        const switching_flow_t flow = switching_off(&bridge, &machine, &rotor, BUS_V, &step, NULL);
        lost_j += fabs(residual_j(&flow, field_j));
        into_bus_j -= flow.bridge.dc_j;
        work += work_j(&flow.machine);
    }
    TEST_ASSERT_TRUE(into_bus_j > 10.0 && work < -into_bus_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * into_bus_j, 0.0, lost_j);
}

/* Once the current no longer stops its diodes oppose it with 2/pi of the bus, the averaged ones
 * with 1/sqrt(3), where it begins: little above that the averaged bridge carries nearly twice as
 * much, far above it 5 % less. Charge into the bus in 0.1 s. */
void test_open_switches_of_a_salient_machine_rectify_no_more_than_averaged_ones(void)
{
    enum { SETTLING = 4000, PERIODS = 2000 };
    pmsm_params_t motor = salient_machine();
    motor.q_inductance_h = 3.0 * motor.d_inductance_h;
    machine = pmsm_at_temperature(&motor, 25.0);
    const switching_t bridge = switching_model(&params, 25.0);
    const inverter_t averaged = inverter_model(&params, 25.0);
    const double ceiling_v = inverter_rectifier_ceiling_v(&averaged, BUS_V);
    for (double over = 1.2; over < 2.1; over += 0.4) {
        step.omega_rad_s = over * ceiling_v / motor.flux_linkage_wb;
        step.series_resistance_ohm = 0.0;
        pmsm_state_t other = pmsm_at_rest(0.0);
        rotor = pmsm_at_rest(0.0);
        double edges_as = 0.0;
        double mean_as = 0.0;
        for (int k = 0; k < SETTLING + PERIODS; k++) {
            step.series_resistance_ohm = 0.0;
            const switching_flow_t flow =
                switching_off(&bridge, &machine, &rotor, BUS_V, &step, NULL);
            step.series_resistance_ohm = averaged.diode_resistance_ohm;
            const pmsm_flow_t mean = pmsm_step_rectified(&machine, &other, ceiling_v, &step);
            edges_as -= k < SETTLING ? 0.0 : flow.bridge.dc_j / BUS_V;
            mean_as -=
                k < SETTLING ? 0.0 : inverter_rectifier_flow(&averaged, BUS_V, &mean).dc_j / BUS_V;
        }
        TEST_ASSERT_TRUE(edges_as > 0.5 * mean_as && edges_as < 1.08 * mean_as);
    }
}

void test_closed_low_sides_give_the_short_circuit_torque(void)
{
    const pmsm_params_t motor = plain_machine();
    machine = pmsm_at_temperature(&motor, 25.0);
    const switching_t bridge = switching_model(&params, 25.0);
    pmsm_flow_t last = {.torque_nms = 0.0};
    for (int k = 0; k < 20000; k++) {
        last = switching_short(&bridge, &machine, &rotor, BUS_V, &step, NULL).machine;
    }
    /* T = -3/2 p psi^2 R w / (R^2 + (w L)^2) */
    const double r = motor.phase_resistance_ohm + 0.004;
    const double x = 500.0 * motor.d_inductance_h;
    const double torque_nm = -1.5 * 7.0 * 0.02 * 0.02 * r * 500.0 / (r * r + x * x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * fabs(torque_nm), torque_nm, last.torque_nms / step.duration_s);
}

void test_zero_current_in_the_dead_time_causes_no_limit_cycle(void)
{
    /* Rotor at standstill, equal duties: zero line voltage, so dead times and diodes must cause no
     * current. */
    step.omega_rad_s = 0.0;
    const switching_t bridge = switching_model(&params, 25.0);
    const plant_abc_t half = {.a = 0.5, .b = 0.5, .c = 0.5};
    for (int k = 0; k < 100; k++) {
        switching_pwm(&bridge, &machine, &rotor, half, BUS_V, &step, NULL);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, hypot(rotor.terminal.alpha, rotor.terminal.beta));
    }
}

/* Until the first edge all low sides conduct: the machine in short circuit through the switches'
 * resistance. */
void test_a_sample_inside_the_period_has_currents_and_shunts_of_that_instant(void)
{
    const switching_t bridge = switching_model(&params, 25.0);
    const pmsm_params_t plain =
        plain_machine(); /* iron loss by switching edges is described in phases.h */
    machine = pmsm_at_temperature(&plain, 25.0);
    const plant_abc_t half = {.a = 0.5, .b = 0.5, .c = 0.5}; /* up from 12.5 us on */
    const double until_s = 8e-6;
    rotor = pmsm_at_rest(0.1);
    rotor.i_t.q = 40.0;
    pmsm_step(&machine, &rotor, (plant_ab_t){0.0, 0.0},
              &step); /* the terminal current belongs to the state */
    pmsm_state_t looked = rotor;
    pmsm_state_t reference = rotor;
    shunts_t shunts = {.output_a = {5.0, 0.0, 0.0}};
    const switching_watch_t watch = {.shunts = &shunts, .settling_s = 1e-6, .until_s = until_s};
    switching_pwm(&bridge, &machine, &looked, half, BUS_V, &step, &watch);
    pmsm_step_t part = step;
    part.duration_s = until_s;
    part.series_resistance_ohm = bridge.switch_ohm;
    pmsm_step(&machine, &reference, (plant_ab_t){0.0, 0.0}, &part);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, reference.terminal.alpha, looked.terminal.alpha);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, reference.terminal.beta, looked.terminal.beta);
    const plant_abc_t begin = plant_inverse_clarke(rotor.terminal);
    const plant_abc_t end = plant_inverse_clarke(looked.terminal);
    /* Eight time constants on, the amplifier lags a ramp by its time constant at most. */
    TEST_ASSERT_DOUBLE_WITHIN(fabs(end.a - begin.a) + 5.0 * exp(-8.0) + 0.05, end.a,
                              shunts.output_a[0]);
    TEST_ASSERT_DOUBLE_WITHIN(fabs(end.b - begin.b) + 0.05, end.b, shunts.output_a[1]);
    TEST_ASSERT_TRUE(fabs(end.a) + fabs(end.b) > 20.0);
}
