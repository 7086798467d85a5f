/* SPDX-License-Identifier: Apache-2.0 */
/* The fast loop as a whole: codes in, compare values out, and what it reports. */
#include "foc/foc.h"

#include <math.h>
#include <stdlib.h>

#include "emf_observer.h"
#include "field_weakening.h"
#include "sense.h"
#include "tuning.h"
#include "winding.h"

#include "foc_rig.h"

static const double PI = 3.14159265358979323846;

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

/* Phase currents of a rotor-frame current, as codes. */
static void set_current(double d_pu, double q_pu, uint16_t theta_turn)
{
    const double theta = theta_turn * 2.0 * PI / 65536.0;
    for (int x = 0; x < 3; x++) {
        const double angle = theta - x * 2.0 * PI / 3.0;
        codes[x] = (uint16_t)lround(2048.0 + 2048.0 * (d_pu * cos(angle) - q_pu * sin(angle)));
    }
}

/* The stator voltage the compare values make, share of u_dc. */
static void applied(double *alpha, double *beta)
{
    const double on[3] = {foc.current.on_q16[0] >> 16, foc.current.on_q16[1] >> 16,
                          foc.current.on_q16[2] >> 16};
    *alpha = (2.0 * on[0] - on[1] - on[2]) / 3.0 / PERIOD_COUNTS;
    *beta = (on[1] - on[2]) / sqrt(3.0) / PERIOD_COUNTS;
}

void test_first_state_is_zero_but_for_what_is_initialised(void)
{
    memset(&foc, 0x55, sizeof(foc));
    foc_init(&foc, &config, BASES_MODEL_TIMER_Hz);
    TEST_ASSERT_EQUAL_UINT16(0, foc.period.rotor.theta_turn);
    TEST_ASSERT_EQUAL_UINT16(0, foc.period.theta_turn);
    TEST_ASSERT_EQUAL_UINT32(0, foc.period.step_count);
    TEST_ASSERT_EQUAL_INT32(FOC_NO_SETPOINT, foc.sequence);
    TEST_ASSERT_EQUAL_UINT32(66, foc.observer.acquisition_periods); /* 20 000/300 */
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[x] >> 16);
    }
}

static void observe(void)
{
    setpoint.observer.volt = q_pair(5000, 5000);
    setpoint.observer.minus_resistance = q_pair(-300, -300);
    setpoint.tuning.forward_q_q25 = 20000 * 1024;
}

void test_observed_angle_less_its_lead_is_used_if_the_setpoint_asks_for_it(void)
{
    in.rotor_angle_turn = 5000;
    for (int used = 0; used <= 1; used++) {
        restart();
        observe();
        setpoint.observer.used = used != 0;
        setpoint.observer.lead_turn = 1000;
        for (int n = 0; n < 20; n++) {
            step(true);
        }
        const uint16_t observed_turn = (uint16_t)(foc.observer.theta_q32 >> 16);
        TEST_ASSERT_TRUE(observed_turn > 1000 && observed_turn != 6000);
        step(true);
        TEST_ASSERT_EQUAL_UINT16(used != 0 ? observed_turn - 1000 : 5000, foc.period.theta_turn);
        TEST_ASSERT_EQUAL_UINT16(5000, foc.period.rotor.theta_turn);
    }
}

void test_observer_meets_the_voltage_that_acts_and_the_current_of_the_period(void)
{
    observe();
    step(true);
    /* Without an angle or a speed the voltage is the feed-forward, along beta. */
    const ab16_t acting = foc.period.u_ab;
    TEST_ASSERT_INT32_WITHIN(2, 0, q_pair_x(acting.v));
    TEST_ASSERT_INT32_WITHIN(2, 20000, q_pair_y(acting.v));
    emf_observer_t expected = foc.observer;
    codes[1] = 2148;
    codes[2] = 1948;
    step(true);
    TEST_ASSERT_INT32_WITHIN(1, 1847, q_pair_y(period->i_ab_pu.v)); /* 2 * 1600/sqrt 3 */
    emf_observer_step(&expected, acting, period->i_ab_pu, &setpoint.observer);
    TEST_ASSERT_EQUAL_INT32(expected.alpha_q30, foc.observer.alpha_q30);
    TEST_ASSERT_EQUAL_INT32(expected.beta_q30, foc.observer.beta_q30);
    TEST_ASSERT_EQUAL_HEX32(expected.theta_q32, foc.observer.theta_q32);
    TEST_ASSERT_TRUE(foc.observer.beta_q30 > 4000 * 20000);
}

void test_idle_step_centres_the_legs_and_does_not_integrate(void)
{
    set_current(0.2, 0.3, 0);
    setpoint.i_reference_pu.q = 9000;
    for (int n = 0; n < 100; n++) {
        step(false);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[x] >> 16);
        }
    }
    TEST_ASSERT_EQUAL_INT32(0, foc.current.controller.d.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(0, foc.current.controller.q.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->voltage.applied).q);
}

void test_currents_are_measured_with_and_without_run_in_the_rotor_frame(void)
{
    for (int run = 0; run <= 1; run++) {
        for (uint32_t theta = 0; theta < 65536U; theta += 997U) {
            restart();
            in.rotor_angle_turn = (uint16_t)theta;
            set_current(-0.1, 0.25, (uint16_t)theta);
            step(run != 0);
            /* Half a code of 16 LSB in each of two phases reaches dq amplified by at most 2/sqrt 3
             * * sqrt 3. */
            TEST_ASSERT_DOUBLE_WITHIN(20.0, -0.1 * 32768.0, dq_of(period->i_pu).d);
            TEST_ASSERT_DOUBLE_WITHIN(20.0, 0.25 * 32768.0, dq_of(period->i_pu).q);
        }
    }
}

/* A vector of 0.3 that turns by an eighth of a turn a period, from the middle of the first
 * quarter's first half on. */
static void turn_current(int periods, int direction, bool permitted)
{
    static uint16_t theta_turn;
    for (int n = 0; n < periods; n++) {
        theta_turn = (uint16_t)(theta_turn + direction * 8192);
        set_current(0.3 * cos(PI / 8.0), 0.3 * sin(PI / 8.0), theta_turn);
        step(permitted);
    }
}

void test_quadrant_transitions_are_counted_in_the_idle_step(void)
{
    turn_current(8, 1, false); /* wherever it was before */
    const uint16_t before = report.quadrant_transitions;
    turn_current(8 * 5, 1, false);
    TEST_ASSERT_EQUAL_UINT16(before + 20, report.quadrant_transitions);
    /* The vector has just come into the first quarter, or one period ago. */
    TEST_ASSERT_UINT32_WITHIN(1, report.sequence, report.quadrant_step);
    turn_current(8 * 7, -1, false);
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(before - 8), report.quadrant_transitions);
    const uint16_t step_before = report.quadrant_step;
    turn_current(1, 1, false);
    turn_current(1, -1, false); /* to and fro: nothing in sum */
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(before - 8), report.quadrant_transitions);
    for (int n = 0; n < 100; n++) {
        turn_current(0, 1, false);
        step(false); /* stands */
    }
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(before - 8), report.quadrant_transitions);
    TEST_ASSERT_TRUE((uint16_t)(report.quadrant_step - step_before) <= 2);
    turn_current(100, 1, true);
    TEST_ASSERT_EQUAL_UINT16((uint16_t)(before - 8), report.quadrant_transitions);
}

void test_current_step_across_two_quadrants_does_not_count(void)
{
    set_current(0.3, 0.1, 0);
    step(false);
    const uint16_t before = report.quadrant_transitions;
    for (int n = 0; n < 9; n++) {
        set_current(n % 2 == 0 ? -0.3 : 0.3, n % 2 == 0 ? -0.1 : 0.1, 0);
        step(false);
        TEST_ASSERT_EQUAL_UINT16(before, report.quadrant_transitions);
    }
}

void test_voltage_angle_is_advanced_by_one_and_a_half_periods(void)
{
    const double speed_turns = 0.0123; /* 641 r/min of 23 pole pairs */
    for (uint32_t theta = 0; theta < 65536U; theta += 1013U) {
        restart();
        in.rotor_angle_turn = (uint16_t)theta;
        const winding_t winding = winding_constants(&config);
        setpoint.tuning = current_tuning(
            &config, &winding, foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz), 3513 * 8,
            (int32_t)lround(speed_turns * 0.5 * 4294967296.0), /* half: inside the circle */
            config.motor.reference_temperature_cC);
        step(true);
        const double angle = theta * 2.0 * PI / 65536.0 + 1.5 * 0.5 * speed_turns * 2.0 * PI;
        const double v_dc_V = 3513.0 / 4096.0 * config.drive.voltage_full_scale_mV * 1e-3;
        const double emf =
            0.5 * speed_turns * 20000.0 * 2.0 * PI * config.motor.flux_linkage_nWb * 1e-9 / v_dc_V;
        double alpha = 0.0;
        double beta = 0.0;
        applied(&alpha, &beta);
        /* One count of each leg, 1/4200, is what the modulator may be off. */
        TEST_ASSERT_DOUBLE_WITHIN(1.2 / PERIOD_COUNTS, -emf * sin(angle), alpha);
        TEST_ASSERT_DOUBLE_WITHIN(1.2 / PERIOD_COUNTS, emf * cos(angle), beta);
    }
}

void test_positive_q_error_gives_voltage_a_quarter_turn_ahead_of_the_rotor(void)
{
    setpoint.i_reference_pu.q = 3000;
    for (uint32_t theta = 0; theta < 65536U; theta += 4096U) {
        restart();
        setpoint.i_reference_pu.q = 3000;
        in.rotor_angle_turn = (uint16_t)theta;
        step(true);
        double alpha = 0.0;
        double beta = 0.0;
        applied(&alpha, &beta);
        const double angle = theta * 2.0 * PI / 65536.0;
        TEST_ASSERT_TRUE(-alpha * sin(angle) + beta * cos(angle) > 0.05);
        TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.0, alpha * cos(angle) + beta * sin(angle));
    }
}

void test_idle_step_resets_the_integrators(void)
{
    setpoint.i_reference_pu.q = 5000;
    step(true);
    int32_t first[3];
    memcpy(first, foc.current.on_q16, sizeof(first));
    for (int n = 0; n < 200; n++) {
        step(true); /* a current that does not come: the integrator fills */
    }
    TEST_ASSERT_TRUE(memcmp(first, foc.current.on_q16, sizeof(first)) != 0);
    step(false);
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[x] >> 16);
    }
    step(true);
    TEST_ASSERT_EQUAL_INT32_ARRAY(first, foc.current.on_q16, 3);
}

void test_idle_step_resets_the_controller_state(void)
{
    setpoint.i_reference_pu.q = 5000;
    for (int n = 0; n < 100; n++) {
        step(true);
    }
    TEST_ASSERT_NOT_EQUAL(0, foc.current.controller.q.integrator_q30);
    foc_idle_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_EQUAL_INT32(0, foc.current.controller.q.integrator_q30);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).d);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).q);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(foc.current.predictor.predicted_pu.v));
    TEST_ASSERT_EQUAL_INT32(FOC_NO_SETPOINT, foc.sequence);
    for (int x = 0; x < SENSE_PHASES; x++) {
        TEST_ASSERT_EQUAL_INT32(PERIOD_COUNTS / 2, foc.current.on_q16[x] >> 16);
    }
}

void test_idle_step_applies_no_voltage_and_weakens_no_field(void)
{
    observe();
    setpoint.i_reference_pu.d = -3000;
    setpoint.tuning.forward_q_q25 = 40000 * 1024; /* more than the circle */
    set_current(0.1, 0.2, 0);
    for (int n = 0; n < 200; n++) {
        step(true);
    }
    TEST_ASSERT_NOT_EQUAL(0, period->voltage.unsaturated_d_q25);
    TEST_ASSERT_NOT_EQUAL(0, q_pair_x(foc.u_acting.v));
    TEST_ASSERT_NOT_EQUAL(0, foc.weakening.current_q28);
    TEST_ASSERT_NOT_EQUAL(0, foc.observer.periods);
    TEST_ASSERT_NOT_EQUAL(0, q_pair_x(foc.observer.x.v));
    foc_idle_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_EQUAL_INT32(0, period->voltage.unsaturated_d_q25);
    TEST_ASSERT_EQUAL_INT32(0, period->voltage.unsaturated_q_q25);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(period->voltage.applied.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(period->voltage.applied.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(period->u_ab.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(period->u_ab.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(foc.u_acting.v));
    TEST_ASSERT_EQUAL_INT32(0, q_pair_y(foc.u_acting.v));
    TEST_ASSERT_EQUAL_INT32(0, foc.weakening.current_q28);
    TEST_ASSERT_EQUAL_UINT32(0, foc.observer.periods);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(foc.observer.x.v));
}

/* Codes of 100 in phase b and -100 in c: no alpha current, beta 2 * 1600/sqrt 3 = 1847.5; then 50
 * more in b, so that the sum is 800 and phase a is reconstructed as minus 800. */
void test_idle_step_sums_up_the_current_of_the_stator(void)
{
    codes[1] = 2148;
    codes[2] = 1948;
    foc_idle_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_EQUAL_INT32(0, q_pair_x(period->i_ab_pu.v));
    TEST_ASSERT_INT32_WITHIN(1, 1847, q_pair_y(period->i_ab_pu.v));
    TEST_ASSERT_EQUAL_INT32(0, period->current_sum_pu);
    const int32_t beta = q_pair_y(period->i_ab_pu.v);
    codes[1] = 2198;
    foc_idle_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_EQUAL_INT32(800, period->current_sum_pu);
    TEST_ASSERT_EQUAL_INT32(-800, (int32_t)foc.idle.alpha_pu);
    TEST_ASSERT_EQUAL_INT32(beta + q_pair_y(period->i_ab_pu.v), (int32_t)foc.idle.beta_pu);
}

void test_a_voltage_shortfall_raises_field_weakening_up_to_its_limit(void)
{
    config.current_loop.field_weakening_gain_pu_q15 = 2000;
    config.current_loop.field_weakening_current_pu_q15 = 6000;
    restart();
    setpoint.tuning.forward_q_q25 = 40000 * 1024; /* more than the circle */
    for (int n = 0; n < 2000; n++) {
        step(true);
        const int32_t weakening_pu = field_weakening_current_pu(&foc.weakening);
        TEST_ASSERT_TRUE(weakening_pu <= 0 && weakening_pu >= -6000);
    }
    TEST_ASSERT_EQUAL_INT32(-6000, field_weakening_current_pu(&foc.weakening));
    TEST_ASSERT_TRUE(report.voltage_limited);
    TEST_ASSERT_EQUAL_INT32(-6000, report.i_d_weakening_pu);
    step(false);
    TEST_ASSERT_EQUAL_INT32(0, report.i_d_weakening_pu);
    setpoint.tuning.forward_q_q25 = 0;
    step(true);
    TEST_ASSERT_EQUAL_INT32(0, field_weakening_current_pu(&foc.weakening)); /* a rest forgets it */
}

void test_field_weakening_returns_without_a_new_setpoint(void)
{
    config.current_loop.field_weakening_gain_pu_q15 = 2000;
    config.current_loop.field_weakening_current_pu_q15 = 6000;
    restart();
    /* No current follows here, and the regulator must not ask for voltage because of it. */
    setpoint.tuning.d.proportional_q10 = 1;
    setpoint.tuning.d.integral_q15 = 0;
    setpoint.tuning.forward_q_q25 = 40000 * 1024;
    for (int n = 0; n < 2000; n++) {
        step(true);
    }
    TEST_ASSERT_EQUAL_INT32(-6000, dq_of(period->i_reference_pu).d);
    setpoint.tuning.forward_q_q25 = 0;
    for (int n = 0; n < 12000; n++) {
        step(true);
    }
    TEST_ASSERT_EQUAL_INT32(0, field_weakening_current_pu(&foc.weakening));
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).d);
}

void test_limited_flag_is_set_in_periods_at_the_voltage_limit(void)
{
    setpoint.tuning.forward_q_q25 = 20000 * 1024;
    step(true);
    TEST_ASSERT_FALSE(report.voltage_limited);
    setpoint.tuning.forward_q_q25 = 33000 * 1024;
    step(true);
    TEST_ASSERT_TRUE(report.voltage_limited);
}

void test_offsets_are_averaged_and_applied_once_per_command(void)
{
    codes[0] = 2060;
    codes[1] = 2040;
    codes[2] = 2049;
    setpoint.calibrate_offsets = true;
    for (int n = 0; n < (1 << SENSE_CALIBRATION_LOG2); n++) {
        TEST_ASSERT_FALSE(report.offsets_done);
        step(false);
    }
    TEST_ASSERT_TRUE(report.offsets_done);
    TEST_ASSERT_EQUAL_INT32(2060 * 16, report.offset_q4[0]);
    TEST_ASSERT_EQUAL_INT32(2040 * 16, report.offset_q4[1]);
    TEST_ASSERT_EQUAL_INT32(2049 * 16, report.offset_q4[2]);
    step(false);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_pu).d);
    TEST_ASSERT_EQUAL_INT32(0, period->current_sum_pu);
    setpoint.calibrate_offsets = false;
    step(false);
    setpoint.calibrate_offsets = true; /* a new setpoint starts anew */
    step(false);
    TEST_ASSERT_FALSE(report.offsets_done);
}

void test_offsets_are_measured_again_on_a_second_command(void)
{
    setpoint.calibrate_offsets = true;
    for (int n = 0; n < (1 << SENSE_CALIBRATION_LOG2); n++) {
        step(false);
    }
    TEST_ASSERT_TRUE(report.offsets_done);
    step(true); /* the setpoint stands all the while */
    step(false);
    TEST_ASSERT_FALSE(report.offsets_done);
}

void test_the_reported_power_is_voltage_times_current(void)
{
    setpoint.i_reference_pu.d = -3000;
    setpoint.i_reference_pu.q = 6000;
    set_current(-3000.0 / 32768.0, 6000.0 / 32768.0, 0);
    setpoint.tuning.forward_q_q25 = 20000 * 1024;
    setpoint.tuning.d.integral_q15 = 0; /* no drift from the half code of rounding */
    setpoint.tuning.q.integral_q15 = 0;
    step(true);
    const dq_t u = dq_of(period->voltage.applied);
    const dq_t i = dq_of(period->i_pu);
    /* One period: the sums are its values. */
    TEST_ASSERT_DOUBLE_WITHIN(1.0, (u.d * (double)i.d + u.q * (double)i.q) / 32768.0,
                              (int32_t)report.sums.power_pu);
    TEST_ASSERT_EQUAL_INT32(i.d, (int32_t)report.sums.i_d_pu);
    TEST_ASSERT_EQUAL_INT32(i.q, (int32_t)report.sums.i_q_pu);
    TEST_ASSERT_EQUAL_INT32(in.bus_voltage_code * 8, (int32_t)report.sums.v_dc_pu);
}

/* Hall states of a forward turn. */
static const uint8_t FORWARD[6] = {5, 1, 3, 2, 6, 4};

static void with_hall_sensors(void)
{
    config.rotor.sensor = CONFIG_ROTOR_HALL;
    restart();
}

void test_a_new_setpoint_that_meets_a_hall_edge_waits_one_period(void)
{
    with_hall_sensors();
    for (int n = 0; n < 100; n++) {
        step(true);
    }
    setpoint.i_reference_pu.q = 3000;
    setpoint.sequence++;
    in.hall_state = FORWARD[1];
    foc_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_EQUAL_INT32(0, dq_of(period->i_reference_pu).q);
    foc_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_GREATER_THAN_INT32(2000, dq_of(period->i_reference_pu).q);
}

/* What an earlier run left, e.g. the feed-forward of its speed, must not act once more. */
void test_a_start_that_meets_a_hall_edge_applies_its_setpoint_at_once(void)
{
    with_hall_sensors();
    setpoint.i_reference_pu.q = 3000;
    for (int n = 0; n < 100; n++) {
        step(true);
    }
    step(false);
    setpoint.i_reference_pu.q = -5000;
    setpoint.sequence++;
    in.hall_state = FORWARD[1];
    foc_step(&foc, &config, &setpoint, &in);
    TEST_ASSERT_LESS_THAN_INT32(-3000, dq_of(period->i_reference_pu).q);
}

void test_bus_voltage_is_eight_lsb_per_code_and_codes_are_clamped_to_12_bits(void)
{
    in.bus_voltage_code = 1000;
    step(false);
    TEST_ASSERT_EQUAL_INT32(8000, period->v_dc_pu);
    in.bus_voltage_code = 65535;
    step(false);
    TEST_ASSERT_EQUAL_INT32(4095 * 8, period->v_dc_pu);
}

void test_adc_saturation_is_reported(void)
{
    step(true);
    TEST_ASSERT_FALSE(report.adc_saturated);
    codes[0] = 4095;
    codes[1] = 0;
    step(true);
    TEST_ASSERT_TRUE(report.adc_saturated);
}

void test_two_instances_in_one_process_are_independent(void)
{
    foc_state_t alone = foc;
    foc_state_t other;
    foc_init(&other, &config, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t stir = setpoint;
    stir.i_reference_pu.q = -7000;
    setpoint.i_reference_pu.q = 2000;
    const foc_input_t others_in = {.phase_current_code = {1000, 3000, 2500},
                                   .bus_voltage_code = 2000,
                                   .rotor_angle_turn = 30000,
                                   .hall_state = 3};
    for (int n = 0; n < 100; n++) {
        in.rotor_angle_turn = (uint16_t)(in.rotor_angle_turn + 500U);
        foc_step(&alone, &config, &setpoint, &in);
    }
    in.rotor_angle_turn = 0;
    for (int n = 0; n < 100; n++) {
        in.rotor_angle_turn = (uint16_t)(in.rotor_angle_turn + 500U);
        foc_step(&other, &config, &stir, &others_in);
        step(true);
    }
    TEST_ASSERT_EQUAL_INT32_ARRAY(alone.current.on_q16, foc.current.on_q16, 3);
    TEST_ASSERT_EQUAL_UINT32(alone.sums.power_pu, report.sums.power_pu);
    TEST_ASSERT_EQUAL_INT32(alone.period.rotor.speed_q32, foc.period.rotor.speed_q32);
}
