/* SPDX-License-Identifier: Apache-2.0 */
/* Inverter model against the loss integrals of the paper, and its energy balance. */
#include "plant/inverter.h"

#include <math.h>

#include "machines.h"
#include "unity.h"

static const double BUS_V = 53.0;
static const double NARROW_A = 1e-6;
static inverter_params_t params;
static inverter_t inverter;

void setUp(void)
{
    const inverter_params_t all_different = {.switch_resistance_ohm = 0.0033,
                                             .diode_forward_voltage_v = 0.8,
                                             .diode_resistance_ohm = 0.005,
                                             .dead_time_s = 1e-6,
                                             .pwm_frequency_hz = 20000.0,
                                             .turn_on_loss_j_per_a = 4e-6,
                                             .turn_off_loss_j_per_a = 6e-6};
    params = all_different;
    inverter = inverter_model(&params, 25.0);
}

void tearDown(void) {}

/* Flow of a sinusoidal current of the given amplitude through a machine during one period around an
 * angle. */
static pmsm_flow_t sinusoid(double amplitude_a, double angle)
{
    const plant_ab_t i = {.alpha = amplitude_a * cos(angle), .beta = amplitude_a * sin(angle)};
    const double h = inverter.period_s;
    const pmsm_flow_t out = {
        .charge_as = {.alpha = i.alpha * h, .beta = i.beta * h},
        .series_j = 1.5 * inverter.pwm_resistance_ohm * amplitude_a * amplitude_a * h,
        .rectified_as = h * plant_rectified_sum(i),
        .opposed_as = h * plant_rectified_sum(i), /* no phase in the zone */
    };
    return out;
}

void test_losses_averaged_over_a_turn_equal_the_integrals_of_the_paper(void)
{
    const double amplitude = 40.0;
    const int steps = 3600;
    const double pi = PLANT_TWO_PI / 2.0;
    const double delta = 2.0 * params.dead_time_s * params.pwm_frequency_hz;
    double conduction_w = 0.0;
    double diode_w = 0.0;
    double switching_w = 0.0;
    for (int k = 0; k < steps; k++) {
        const double angle = PLANT_TWO_PI * (k + 0.5) / steps;
        const pmsm_flow_t flow = sinusoid(amplitude, angle);
        const plant_abc_t half = {.a = 0.5, .b = 0.5, .c = 0.5};
        const inverter_drive_t drive = inverter_drive(&inverter, half, BUS_V, NARROW_A);
        const inverter_flow_t bridge = inverter_pwm_flow(&inverter, &drive, &flow);
        conduction_w += bridge.conduction_j / inverter.period_s / steps;
        diode_w += bridge.diode_j / inverter.period_s / steps;
        switching_w += bridge.switching_j / inverter.period_s / steps;
    }
    const double square = amplitude * amplitude;
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-9,
        1.5 * square *
            (params.switch_resistance_ohm * (1.0 - delta) + params.diode_resistance_ohm * delta),
        conduction_w);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 6.0 / pi * params.diode_forward_voltage_v * amplitude * delta,
                              diode_w);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4,
                              3.0 * (params.turn_on_loss_j_per_a + params.turn_off_loss_j_per_a) *
                                  amplitude * params.pwm_frequency_hz / pi,
                              switching_w);
}

void test_dc_energy_is_the_sum_of_terminal_energy_and_losses(void)
{
    const plant_abc_t duty = {.a = 0.81, .b = 0.33, .c = 0.42};
    for (int k = 0; k < 12; k++) {
        const double angle = PLANT_TWO_PI * k / 12.0 + 0.1;
        const pmsm_flow_t flow = sinusoid(25.0, angle);
        const inverter_drive_t drive = inverter_drive(&inverter, duty, BUS_V, NARROW_A);
        const inverter_flow_t bridge = inverter_pwm_flow(&inverter, &drive, &flow);
        const double source_j = 1.5 * (drive.legs.alpha * flow.charge_as.alpha +
                                       drive.legs.beta * flow.charge_as.beta) -
                                drive.opposition.volts * flow.opposed_as;
        const double terminal_j = source_j - flow.series_j;
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-12, terminal_j + bridge.conduction_j + bridge.diode_j + bridge.switching_j,
            bridge.dc_j);
    }
}

void test_output_of_an_ideal_bridge_is_bus_voltage_times_duty(void)
{
    const inverter_params_t ideal = {.pwm_frequency_hz = 16000.0};
    const inverter_t bridge = inverter_model(&ideal, 25.0);
    const plant_abc_t duty = {.a = 0.7, .b = 0.2, .c = 0.4};
    const inverter_drive_t drive =
        inverter_drive(&bridge, duty, BUS_V, inverter_zone_a(&bridge, BUS_V, 0.5));
    const plant_abc_t legs = plant_inverse_clarke(drive.legs);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, drive.opposition.volts);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, BUS_V * 0.5, legs.a - legs.b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, BUS_V * -0.2, legs.b - legs.c);
}

/* Each of the two dead times of a period lowers or raises the mean voltage by t_d f v_dc. */
void test_dead_time_voltage_error_opposes_the_current_of_each_leg(void)
{
    const plant_abc_t half = {.a = 0.5, .b = 0.5, .c = 0.5};
    const inverter_drive_t drive = inverter_drive(&inverter, half, BUS_V, NARROW_A);
    const double lost_v = BUS_V * params.dead_time_s * params.pwm_frequency_hz;
    const double drop_v =
        2.0 * params.diode_forward_voltage_v * params.dead_time_s * params.pwm_frequency_hz;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, lost_v, drive.shifted_v);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, drop_v, drive.drop_v);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, lost_v + drop_v, drive.opposition.volts);
    TEST_ASSERT_EQUAL_DOUBLE(NARROW_A, drive.opposition.zone_a);
}

/* 2 A in phase a, zero terminal voltage: the error voltage must bring the current to zero and keep
 * it there, with the inductance alone and with the iron branch in parallel. */
void test_leg_with_zero_current_is_clamped_without_limit_cycle(void)
{
    const pmsm_params_t machines[] = {plain_machine(), salient_machine()};
    for (int m = 0; m < 2; m++) {
        const pmsm_t machine = pmsm_at_temperature(&machines[m], 25.0);
        pmsm_state_t state = pmsm_at_rest(0.0);
        state.i_t.d = 2.0;
        state.terminal.alpha = 2.0;
        const plant_abc_t half = {.a = 0.5, .b = 0.5, .c = 0.5};
        pmsm_step_t step = {
            .omega_rad_s = 0.0, .duration_s = inverter.period_s, .series_resistance_ohm = 0.0};
        const double zone_a =
            inverter_zone_a(&inverter, BUS_V, pmsm_amperes_per_volt(&machine, &state, &step));
        double largest_a = 2.0;
        for (int k = 0; k < 60; k++) {
            const inverter_drive_t drive = inverter_drive(&inverter, half, BUS_V, zone_a);
            step.opposition = drive.opposition;
            pmsm_step(&machine, &state, drive.legs, &step);
            TEST_ASSERT_TRUE(fabs(state.i_t.d) <= largest_a);
            largest_a = fabs(state.i_t.d);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, state.i_t.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, state.terminal.alpha);
    }
}

void test_active_short_circuit_has_zero_dc_current(void)
{
    const pmsm_flow_t flow = {.series_j = 0.25};
    const inverter_flow_t bridge = inverter_short_flow(&flow);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, bridge.dc_j);
    TEST_ASSERT_EQUAL_DOUBLE(0.25, bridge.conduction_j);
}

void test_rectifying_diodes_dissipate_two_forward_voltages_times_the_current(void)
{
    const pmsm_flow_t flow = {.source_j = -1.0, .series_j = 0.02};
    const inverter_flow_t bridge = inverter_rectifier_flow(&inverter, BUS_V, &flow);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.6 / (BUS_V + 1.6), bridge.diode_j);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -1.0, bridge.dc_j - bridge.diode_j);
    TEST_ASSERT_EQUAL_DOUBLE(0.02, bridge.conduction_j);
}
