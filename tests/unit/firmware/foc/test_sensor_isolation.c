/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Which current sensor is wrong, and what current is used meanwhile. The currents are those of the
 * reference, worked out in double precision; the model behind the prediction is tested against its
 * closed form, and on the simulated motor in tests/closed_loop.
 */
#include "sensor_isolation.h"

#include <math.h>

#include "foc_rig.h"

static const double PI_2 = 6.283185307179586;
static const double TURNS_PER_PERIOD = 0.00813; /* 40 km/h */
static double turn;
static double error_codes[3];
static double d_codes, q_codes;

void setUp(void)
{
    rig_up();
    turn = 0.0;
    setpoint.clear_trip = false;
    d_codes = q_codes = 0.0;
    error_codes[0] = error_codes[1] = error_codes[2] = 0.0;
}

void tearDown(void) {}

static const sensor_isolation_t *const isolation = &foc.current.isolation;

/* A period in which the currents (d, q) flow and the sensors show `error_codes` more. */
static void sample(double turns)
{
    turn += turns;
    turn -= floor(turn);
    in.rotor_angle_turn = (uint16_t)(uint32_t)(turn * 65536.0);
    const double angle = in.rotor_angle_turn / 65536.0;
    for (int x = 0; x < 3; x++) {
        const double at = PI_2 * (angle - x / 3.0);
        codes[x] =
            (uint16_t)lround(2048.0 + d_codes * cos(at) - q_codes * sin(at) + error_codes[x]);
    }
    step(true);
}

/* Steady at 600 codes of i_q, 48 A, braking, once the angle's speed is known. */
static void settle(double turns)
{
    for (int n = 0; n < 4000; n++) {
        turn += turns;
        turn -= floor(turn);
        in.rotor_angle_turn = (uint16_t)(uint32_t)(turn * 65536.0);
        foc_idle_step(&foc, &config, &setpoint, &in);
    }
    q_codes = -600.0;
    setpoint.i_reference_pu.q = -600 * 16;
    for (int n = 0; n < 200; n++) {
        sample(turns);
    }
}

/* Two roundings of a code in phases are within two codes in dq. */
static void assert_used(double d, double q)
{
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * 16.0, 16.0 * d, q_pair_x(period->i_pu.v));
    TEST_ASSERT_DOUBLE_WITHIN(2.0 * 16.0, 16.0 * q, q_pair_y(period->i_pu.v));
}

void test_sum_within_a_quarter_of_the_implausible_one_is_not_examined(void)
{
    const int32_t implausible = config.monitor.current_sum_pu_q15;
    const int32_t suspect = implausible / 4;
    TEST_ASSERT_FALSE(sensor_isolation_due(isolation, suspect));
    TEST_ASSERT_FALSE(sensor_isolation_due(isolation, -suspect));
    TEST_ASSERT_TRUE(sensor_isolation_due(isolation, suspect + 1));
    TEST_ASSERT_TRUE(sensor_isolation_due(isolation, -suspect - 1));
    TEST_ASSERT_TRUE(sensor_isolation_due(isolation, 200000));
    TEST_ASSERT_TRUE(sensor_isolation_due(isolation, -200000));
}

void test_wrong_sensor_is_replaced_at_once_and_named_in_the_second_period(void)
{
    static const double ERRORS[] = {110.0, -110.0, 700.0, -700.0};
    for (int x = 0; x < 3; x++) {
        for (int e = 0; e < 4; e++) {
            for (int instant = 0; instant < 123; instant += 7) {
                rig_up();
                error_codes[0] = error_codes[1] = error_codes[2] = 0.0;
                settle(TURNS_PER_PERIOD);
                for (int n = 0; n < instant; n++) {
                    sample(TURNS_PER_PERIOD);
                }
                TEST_ASSERT_EQUAL_UINT8(0, report.wrong_current_sensor);
                error_codes[x] = ERRORS[e];
                sample(TURNS_PER_PERIOD);
                assert_used(0.0, -600.0);
                TEST_ASSERT_EQUAL_UINT8(0, report.wrong_current_sensor);
                sample(TURNS_PER_PERIOD);
                assert_used(0.0, -600.0);
                TEST_ASSERT_EQUAL_UINT8(x + 1, report.wrong_current_sensor);
                TEST_ASSERT_FALSE(report.current_undetermined);
            }
        }
    }
}

void test_named_sensor_that_stays_wrong_is_never_used_again(void)
{
    settle(TURNS_PER_PERIOD);
    error_codes[1] = 300.0;
    sample(TURNS_PER_PERIOD);
    sample(TURNS_PER_PERIOD);
    for (int n = 0; n < 20000; n++) {
        error_codes[1] = 700.0 * sin(n); /* also where the sum is small */
        sample(TURNS_PER_PERIOD);
        assert_used(0.0, -600.0);
    }
    TEST_ASSERT_EQUAL_UINT8(2, report.wrong_current_sensor);
    setpoint.torque_enabled = false;
    setpoint.clear_trip = true;
    codes[0] = codes[2] = 2048;
    codes[1] = 2048 + 50;
    step(false);
    assert_used(0.0, 0.0);
    step(true);
    assert_used(0.0, 0.0);
    TEST_ASSERT_EQUAL_UINT8(2, report.wrong_current_sensor);
}

/* ---- a named sensor that reads right again ---- */

static void glitch(int phase, int periods)
{
    error_codes[phase] = 500.0;
    for (int n = 0; n < periods; n++) {
        sample(TURNS_PER_PERIOD);
    }
    error_codes[phase] = 0.0;
    TEST_ASSERT_EQUAL_UINT8(phase + 1, report.wrong_current_sensor);
}

/* A period with the bridge open, in which no current flows. */
static void coast(void)
{
    turn += TURNS_PER_PERIOD;
    turn -= floor(turn);
    in.rotor_angle_turn = (uint16_t)(uint32_t)(turn * 65536.0);
    for (int x = 0; x < 3; x++) {
        codes[x] = (uint16_t)lround(2048.0 + error_codes[x]);
    }
    step(false);
}

/* Periods until the sensor is used again; `most` + 1: it is not. */
static int periods_out(double turns, int most)
{
    int n = 0;
    while (n <= most && report.wrong_current_sensor != 0) {
        sample(turns);
        n++;
    }
    return n;
}

/* 20 ms of samples with |i| > 2 * 102.4 codes in its phase, of 600 codes' amplitude: |cos| > 0.3413
 * in 0.7783 of a turn, so 400 of 514 periods. In whole half waves of 61.5: 8.36 of them, the last
 * one from a crossing on. */
void test_named_sensor_is_used_again_after_20_ms_with_much_current(void)
{
    for (int phase = 0; phase < 3; phase++) {
        for (int periods = 2; periods <= 4000; periods *= 10) {
            setUp();
            settle(TURNS_PER_PERIOD);
            glitch(phase, periods);
            TEST_ASSERT_INT_WITHIN(15, 514, periods_out(TURNS_PER_PERIOD, 1000));
            assert_used(0.0, -600.0);
            glitch(phase, 2); /* examined as before */
        }
    }
}

/* Twice the implausible sum are 204.75 codes. */
void test_current_up_to_twice_the_implausible_sum_proves_nothing(void)
{
    settle(TURNS_PER_PERIOD);
    glitch(0, 20);
    q_codes = -204.0;
    setpoint.i_reference_pu.q = -204 * 16;
    TEST_ASSERT_EQUAL_INT(20001, periods_out(TURNS_PER_PERIOD, 20000));
    q_codes = -300.0;
    setpoint.i_reference_pu.q = -300 * 16;
    TEST_ASSERT_LESS_THAN_INT(1500, periods_out(TURNS_PER_PERIOD, 20000));
}

void test_current_of_one_sign_proves_nothing(void)
{
    settle(TURNS_PER_PERIOD);
    glitch(0, 20);
    for (int n = 0; n < 20000; n++) { /* q is along -a where the angle is a quarter: -600 codes */
        turn = 0.25;
        sample(0.0);
    }
    TEST_ASSERT_EQUAL_UINT8(1, report.wrong_current_sensor);
}

/* Half a turn forward and back shows both signs. */
void test_less_than_a_turn_proves_nothing(void)
{
    settle(TURNS_PER_PERIOD);
    glitch(1, 20);
    for (int n = 0; n < 100; n++) {
        for (int k = 0; k < 100; k++) {
            sample(n % 2 == 0 ? 0.005 : -0.005);
        }
    }
    TEST_ASSERT_EQUAL_UINT8(2, report.wrong_current_sensor);
    TEST_ASSERT_LESS_THAN_INT(1000, periods_out(0.005, 2000));
}

/* An implausible sample begins the proof anew: 300 periods are too few. */
void test_proof_is_without_an_implausible_sum_in_between(void)
{
    settle(TURNS_PER_PERIOD);
    glitch(2, 20);
    for (int n = 0; n < 20000; n++) {
        error_codes[2] = n % 300 == 0 ? -700.0 : 0.0;
        sample(TURNS_PER_PERIOD);
        assert_used(0.0, -600.0);
    }
    TEST_ASSERT_EQUAL_UINT8(3, report.wrong_current_sensor);
}

/* With the bridge open there is no current: it neither proves anything nor forgets what was. */
void test_time_without_current_does_not_count(void)
{
    settle(TURNS_PER_PERIOD);
    glitch(0, 20);
    for (int n = 0; n < 300; n++) {
        sample(TURNS_PER_PERIOD);
    }
    for (int n = 0; n < 20000; n++) {
        coast();
    }
    TEST_ASSERT_EQUAL_UINT8(1, report.wrong_current_sensor);
    TEST_ASSERT_INT_WITHIN(15, 514 - 300, periods_out(TURNS_PER_PERIOD, 1000));
}

/* Twice as long each time it comes back within ten seconds: 514, 1 028, 2 056, at most 200 000
 * periods with much current, 256 970 in all. */
void test_sensor_that_comes_and_goes_proves_itself_for_longer_each_time(void)
{
    settle(TURNS_PER_PERIOD);
    double expected = 514.0;
    for (int n = 0; n < 11; n++) {
        glitch(n % 3, 20);
        const int out = periods_out(TURNS_PER_PERIOD, 300000);
        TEST_ASSERT_DOUBLE_WITHIN(15.0 + 0.01 * expected, expected, out);
        expected = fmin(2.0 * expected, 256970.0);
    }
    for (int n = 0; n < 200010; n++) {
        sample(TURNS_PER_PERIOD);
    }
    glitch(0, 20);
    TEST_ASSERT_INT_WITHIN(15, 514, periods_out(TURNS_PER_PERIOD, 1000));
}

/* ---- a second wrong sensor while one is named ---- */

/* 20 ms and a turn after the glitch, with too little current for a proof. */
static void return_from_glitch(int phase)
{
    setUp();
    settle(TURNS_PER_PERIOD);
    glitch(phase, 20);
    q_codes = -150.0;
    setpoint.i_reference_pu.q = -150 * 16;
    for (int n = 0; n < 500; n++) {
        sample(TURNS_PER_PERIOD);
    }
    TEST_ASSERT_EQUAL_UINT8(phase + 1, report.wrong_current_sensor);
}

void test_second_wrong_sensor_is_undetermined_in_two_periods_and_the_prediction_is_used(void)
{
    for (int phase = 0; phase < 3; phase++) {
        for (int other = 1; other < 3; other++) {
            return_from_glitch(phase);
            error_codes[(phase + other) % 3] = -400.0;
            sample(TURNS_PER_PERIOD);
            assert_used(0.0, -150.0);
            TEST_ASSERT_FALSE(report.current_undetermined);
            sample(TURNS_PER_PERIOD);
            assert_used(0.0, -150.0);
            TEST_ASSERT_TRUE(report.current_undetermined);
            TEST_ASSERT_EQUAL_UINT8(phase + 1, report.wrong_current_sensor);
        }
    }
}

void test_acknowledged_second_fault_begins_anew_with_all_sensors(void)
{
    return_from_glitch(0);
    error_codes[1] = -400.0;
    sample(TURNS_PER_PERIOD);
    sample(TURNS_PER_PERIOD);
    setpoint.clear_trip = true;
    step(false);
    TEST_ASSERT_FALSE(report.current_undetermined);
    TEST_ASSERT_EQUAL_UINT8(0, report.wrong_current_sensor);
}

/* Wrong again at once, it is out without it; a slow drift could be any sensor's. */
void test_named_sensor_may_be_wrong_again(void)
{
    return_from_glitch(2);
    error_codes[2] = 400.0;
    for (int n = 0; n < 2000; n++) {
        sample(TURNS_PER_PERIOD);
        assert_used(0.0, -150.0);
    }
    TEST_ASSERT_EQUAL_UINT8(3, report.wrong_current_sensor);
    error_codes[2] = 0.0;
    for (int n = 0; n < 2000; n++) {
        error_codes[2] += 0.1; /* it has lost its credit: no sum counts */
        sample(TURNS_PER_PERIOD);
        TEST_ASSERT_FALSE(report.current_undetermined);
    }
    return_from_glitch(2);
    for (int n = 0; n < 2000 && !report.current_undetermined; n++) {
        error_codes[1] += 0.1;
        sample(TURNS_PER_PERIOD);
    }
    TEST_ASSERT_TRUE(report.current_undetermined);
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 102.4 + 0.8, error_codes[1]);
}

/* 20 ms are 400 periods, with the bridge open as without a named sensor (monitor). */
void test_sum_with_the_bridge_open_counts_for_a_sensor_that_has_returned(void)
{
    for (int returned = 0; returned < 2; returned++) {
        setUp();
        settle(TURNS_PER_PERIOD);
        glitch(0, 20);
        for (int n = 0; n < 399 + returned; n++) {
            coast();
        }
        error_codes[1] = 200.0;
        for (int n = 0; n < 399; n++) {
            coast();
        }
        error_codes[1] = 0.0; /* not in a row */
        coast();
        error_codes[1] = 200.0;
        for (int n = 0; n < 399; n++) {
            coast();
        }
        TEST_ASSERT_FALSE(report.current_undetermined);
        coast();
        TEST_ASSERT_EQUAL(returned == 1, report.current_undetermined);
        TEST_ASSERT_EQUAL_UINT8(1, report.wrong_current_sensor);
    }
}

/* 240 ms are 4 800 periods. */
void test_sum_counts_only_after_a_glitch(void)
{
    for (int longer = 0; longer < 2; longer++) {
        setUp();
        settle(TURNS_PER_PERIOD);
        q_codes = -150.0;
        setpoint.i_reference_pu.q = -150 * 16;
        for (int n = 0; n < 200; n++) {
            sample(TURNS_PER_PERIOD);
        }
        glitch(0, longer != 0 ? 4804 : 4801);
        for (int n = 0; n < 500; n++) {
            sample(TURNS_PER_PERIOD);
        }
        error_codes[1] = -400.0;
        sample(TURNS_PER_PERIOD);
        sample(TURNS_PER_PERIOD);
        TEST_ASSERT_EQUAL(longer == 0, report.current_undetermined);
    }
}

/* Of 102.4 codes: 51.2. Neither does it prove anything nor return with more. */
void test_named_sensor_agrees_to_half_of_the_implausible_sum(void)
{
    for (int half = 0; half < 2; half++) {
        setUp();
        settle(TURNS_PER_PERIOD);
        q_codes = -150.0;
        setpoint.i_reference_pu.q = -150 * 16;
        for (int n = 0; n < 200; n++) {
            sample(TURNS_PER_PERIOD);
        }
        glitch(0, 20);
        for (int n = 0; n < 2000; n++) {
            error_codes[0] = half != 0 ? 49.0 : 53.0; /* the readings are whole codes */
            sample(TURNS_PER_PERIOD);
        }
        error_codes[0] = 0.0;
        sample(TURNS_PER_PERIOD);
        error_codes[1] = -400.0;
        sample(TURNS_PER_PERIOD);
        sample(TURNS_PER_PERIOD);
        TEST_ASSERT_EQUAL(half == 1, report.current_undetermined);
        setUp();
        settle(TURNS_PER_PERIOD);
        glitch(0, 20);
        error_codes[0] = half != 0 ? 49.0 : 53.0;
        TEST_ASSERT_EQUAL(half == 1, periods_out(TURNS_PER_PERIOD, 3000) <= 3000);
    }
}

/* 20 ms are 400 periods; a turn at 40 km/h is 123. */
void test_sum_counts_20_ms_after_a_glitch(void)
{
    for (int later = 0; later < 2; later++) {
        setUp();
        settle(TURNS_PER_PERIOD);
        q_codes = -150.0;
        setpoint.i_reference_pu.q = -150 * 16;
        for (int n = 0; n < 200; n++) {
            sample(TURNS_PER_PERIOD);
        }
        glitch(0, 20);
        for (int n = 0; n < 399 + later; n++) {
            sample(TURNS_PER_PERIOD);
        }
        error_codes[1] = -400.0;
        sample(TURNS_PER_PERIOD);
        sample(TURNS_PER_PERIOD);
        TEST_ASSERT_EQUAL(later == 1, report.current_undetermined);
    }
}

void test_single_disturbed_sample_is_replaced_and_names_no_sensor(void)
{
    settle(TURNS_PER_PERIOD);
    for (int n = 0; n < 20; n++) {
        error_codes[2] = n % 2 == 0 ? 900.0 : 0.0;
        sample(TURNS_PER_PERIOD);
        assert_used(0.0, -600.0);
    }
    TEST_ASSERT_EQUAL_UINT8(0, report.wrong_current_sensor);
    TEST_ASSERT_FALSE(report.current_undetermined);
}

void test_two_wrong_sensors_are_undetermined_in_eight_periods_and_the_prediction_is_used(void)
{
    settle(TURNS_PER_PERIOD);
    error_codes[0] = 200.0;
    error_codes[1] = 200.0;
    for (int n = 0; n < 8; n++) {
        TEST_ASSERT_FALSE(report.current_undetermined);
        sample(TURNS_PER_PERIOD);
        assert_used(0.0, -600.0);
    }
    TEST_ASSERT_TRUE(report.current_undetermined);
    TEST_ASSERT_EQUAL_UINT8(0, report.wrong_current_sensor);
    setpoint.clear_trip = true;
    step(false);
    TEST_ASSERT_FALSE(report.current_undetermined);
}

/* A slow drift has moved the current before its sum is implausible: no residual tells whose it is,
 * and the reading in use is as good as another. */
void test_slow_drift_is_undetermined(void)
{
    settle(TURNS_PER_PERIOD);
    for (int n = 0; n < 2000 && !report.current_undetermined; n++) {
        error_codes[0] += 0.1;
        sample(TURNS_PER_PERIOD);
        TEST_ASSERT_EQUAL_UINT8(0, report.wrong_current_sensor);
    }
    TEST_ASSERT_TRUE(report.current_undetermined);
    /* 5 % of full scale are 102.4 codes; eight periods. */
    TEST_ASSERT_DOUBLE_WITHIN(1.5, 102.4 + 0.8, error_codes[0]);
}

/*
 * The prediction against a twin in double precision, with a sum between suspect and implausible and
 * currents that miss their reference. Per period of w T: an error e is reduced by a (1 - a) e with
 * a = exp(-w_c T), one period late; what the decoupling takes wrongly for a current, x on one axis,
 * changes the other by w T (1 - m) x, with 1 - m = a (1 + a)/2.
 */
void test_prediction_is_that_of_the_designed_loop(void)
{
    const double a = exp(-PI_2 * config.current_loop.bandwidth_Hz / 20000.0);
    const double share = a * (1.0 - a);
    const double coupled = PI_2 * TURNS_PER_PERIOD * a * (1.0 + a) / 2.0;
    settle(TURNS_PER_PERIOD);
    d_codes = 8.0;
    q_codes = -612.0;
    sample(TURNS_PER_PERIOD);
    const double reference_q = setpoint.i_reference_pu.q;
    double d = q_pair_x(period->i_pu.v);
    double q = q_pair_y(period->i_pu.v);
    double change_d = share * -d;
    double change_q = share * (reference_q - q);
    error_codes[2] = 60.0; /* suspect: from 26 to 102 codes */
    for (int n = 0; n < 40; n++) {
        const double used_d = q_pair_x(period->i_pu.v);
        const double used_q = q_pair_y(period->i_pu.v);
        const double wrong_d = used_d - d;
        const double wrong_q = used_q - q;
        d += change_d;
        q += change_q;
        change_d = share * -used_d - coupled * wrong_q;
        change_q = share * (reference_q - used_q) + coupled * wrong_d;
        sample(TURNS_PER_PERIOD);
        TEST_ASSERT_FALSE(report.voltage_limited);
        /* Rounded down three times in a period, within 3 LSB. */
        TEST_ASSERT_DOUBLE_WITHIN(3.0 * (n + 1), d, isolation->predicted_pu.d);
        TEST_ASSERT_DOUBLE_WITHIN(3.0 * (n + 1), q, isolation->predicted_pu.q);
    }
    /* Far more than the tolerance: the wrong sensor's 60 codes have turned through both axes. */
    TEST_ASSERT_TRUE(fabs(d) + fabs(q - reference_q) > 500.0);
}

void test_current_at_the_voltage_limit_is_predicted_to_stay(void)
{
    config.current_loop.field_weakening_current_pu_q15 = 0;
    settle(TURNS_PER_PERIOD);
    q_codes = 600.0; /* an error of 97 A drives the voltage to its limit */
    for (int n = 0; n < 400; n++) {
        sample(TURNS_PER_PERIOD);
    }
    TEST_ASSERT_TRUE(report.voltage_limited);
    const int32_t before = q_pair_y(period->i_pu.v);
    error_codes[0] = 300.0;
    sample(TURNS_PER_PERIOD);
    assert_used(0.0, 600.0);
    TEST_ASSERT_INT32_WITHIN(2 * 16, before, isolation->predicted_pu.q);
}

void test_a_sum_that_stays_suspect_begins_a_new_prediction(void)
{
    settle(TURNS_PER_PERIOD);
    error_codes[1] = 60.0;
    for (int n = 0; n < 300; n++) {
        sample(TURNS_PER_PERIOD);
        TEST_ASSERT_LESS_OR_EQUAL_UINT16(SENSOR_ISOLATION_MEMORY_PERIODS, isolation->periods);
    }
    while (isolation->periods != 1) {
        sample(TURNS_PER_PERIOD);
    }
    error_codes[1] = 600.0;
    sample(TURNS_PER_PERIOD);
    sample(TURNS_PER_PERIOD);
    TEST_ASSERT_EQUAL_UINT8(2, report.wrong_current_sensor);
}

/* The same on the d axis: at its limit the current stays, whatever the reference asks. */
void test_d_current_at_the_voltage_limit_is_predicted_to_stay(void)
{
    config.current_loop.field_weakening_current_pu_q15 = 0;
    settle(TURNS_PER_PERIOD);
    d_codes = 1500.0;
    for (int n = 0; n < 4000; n++) {
        sample(TURNS_PER_PERIOD);
    }
    TEST_ASSERT_TRUE(report.voltage_limited);
    const int32_t before = q_pair_x(period->i_pu.v);
    error_codes[0] = 300.0;
    sample(TURNS_PER_PERIOD);
    assert_used(1500.0, -600.0);
    TEST_ASSERT_INT32_WITHIN(2 * 16, before, isolation->predicted_pu.d);
}
