/* SPDX-License-Identifier: Apache-2.0 */
/* Brake blending with dead time and lag of the hydraulic brake (hydraulic_model.h). Without them:
 * test_brake_blending.c. */
#include <math.h>

#include "blending_rig.h"

void setUp(void)
{
    rig_up();
}

void tearDown(void) {}

/* The hydraulic brake of the vehicle, by the same model as in the firmware. */
static hydraulic_model_t brake;

/* Dead time 40 ms and time constant 60 ms, as the paper's vehicle has them. */
static void late_hydraulic_brake(void)
{
    hydraulic_model_init(&brake);
    config.brake.hydraulic_dead_time_ms = 40;
    config.brake.hydraulic_time_constant_ms = 60;
    config.brake.hydraulic_rate_mNm_s = 2000000;
    config.brake.torque_rate_mNm_s = 400000;
}

static int32_t motor_mNm; /* braking torque of the motor, magnitude */

/* One step of both brakes; the motor's torque follows its command at 400 N m/s. */
static brake_blending_out_t step_with_brakes(void)
{
    motor_follows(motor_mNm);
    const brake_blending_out_t out = step();
    motor_mNm = q_clamp(out.electric_mNm, motor_mNm - 400, motor_mNm + 400);
    hydraulic_model_step(&brake, &config, out.hydraulic_mNm);
    return out;
}

void test_returning_motor_torque_never_exceeds_demand_minus_hydraulic_torque(void)
{
    late_hydraulic_brake();
    motor_mNm = 0;
    in.brake_torque_mNm = 60000;
    abs_active = true;
    for (int n = 0; n < 1000; n++) {
        step_with_brakes();
    }
    TEST_ASSERT_INT32_WITHIN(1, 60000, hydraulic_model_torque_mNm(&brake));
    abs_active = false;
    for (int n = 0; n < 2000; n++) {
        const brake_blending_out_t out = step_with_brakes();
        TEST_ASSERT_LESS_OR_EQUAL_INT32(60000,
                                        out.electric_mNm + hydraulic_model_torque_mNm(&brake));
    }
    TEST_ASSERT_INT32_WITHIN(2, 24000, motor_mNm);
    assert_split(24000, 36000, REASON_LOSS_OPTIMUM, step());
}

void test_motor_plus_hydraulic_torque_settle_on_the_demand(void)
{
    random_t random = random_seeded(9);
    for (int n = 0; n < 300; n++) {
        late_hydraulic_brake();
        random_conditions(&random);
        abs_active = false;
        config.brake.hydraulic_dead_time_ms = random_between(&random, 0, 250);
        config.brake.hydraulic_time_constant_ms = random_between(&random, 0, 300);
        brake_blending_init(&state, &config);
        motor_mNm = random_between(&random, 0, 60000);
        brake_blending_out_t out = {0};
        for (int k = 0; k < 5000; k++) {
            out = step_with_brakes();
            TEST_ASSERT_LESS_OR_EQUAL_INT32(in.brake_torque_mNm, out.hydraulic_mNm);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(out.available.torque_mNm, out.electric_mNm);
        }
        /* The lag of up to 301 steps stops within 301/64 mN m of its target. */
        TEST_ASSERT_INT32_WITHIN(5, in.brake_torque_mNm, motor_mNm + out.hydraulic_mNm);
        TEST_ASSERT_INT32_WITHIN(5, in.brake_torque_mNm,
                                 motor_mNm + hydraulic_model_torque_mNm(&brake));
    }
}

void test_hydraulic_command_leads_a_falling_limit_by_dead_time_plus_lag(void)
{
    late_hydraulic_brake();
    in.brake_torque_mNm = 30000;
    motor_mNm = 30000;
    brake_blending_out_t out = {0};
    for (int n = 0; n <= 1500; n++) { /* 20 N m/s */
        capability.optimal = limit_init(50000 - 20 * n, REASON_LOSS_OPTIMUM);
        out = step_with_brakes();
        if (n > 500) { /* both low-passes have settled on the ramp */
            TEST_ASSERT_INT32_WITHIN(150, 30000, motor_mNm + hydraulic_model_torque_mNm(&brake));
        }
    }
    /* The limit is at 20 N m: 10 of 30 N m hydraulic, and 20 N m/s over 100 ms ahead. */
    TEST_ASSERT_INT32_WITHIN(60, 10000 + 2000, out.hydraulic_mNm);
}

/* A low-pass lags a ramp by slope * tau (1 - exp(-t/tau)). One time constant of 64 ms after a limit
 * begins to fall the command leads by 63 % of dead time and lag, after two by 86 %. */
void test_slope_of_a_falling_limit_is_estimated_with_64_ms_time_constant(void)
{
    late_hydraulic_brake();
    in.brake_torque_mNm = 50000;
    motor_mNm = 50000;
    capability.optimal = limit_init(50000, REASON_LOSS_OPTIMUM);
    for (int n = 0; n < 1000; n++) {
        step_with_brakes();
    }
    for (int n = 1; n <= 128; n++) { /* 20 N m/s: 2 N m in 100 ms */
        capability.optimal = limit_init(50000 - 20 * n, REASON_LOSS_OPTIMUM);
        const brake_blending_out_t out = step_with_brakes();
        if (n == 64 || n == 128) {
            const double lead_mNm = 2000.0 * (1.0 - exp(-n / 64.0));
            TEST_ASSERT_INT32_WITHIN(40, 20 * n + (int32_t)lround(lead_mNm), out.hydraulic_mNm);
        }
    }
}

/* 40 N m leave between 2.618 and 0.838 rad/s; at 5 rad/s2 the line BLEND_OUT falls by 112 N m/s. A
 * command that leads it by dead time and two lags has made 1 - exp(-2) of what the lag lets it miss
 * at the end: 112 N m/s * 60 ms * exp(-2) = 0.9 N m. */
void test_sum_is_the_demand_through_the_blend_out(void)
{
    late_hydraulic_brake();
    config.motor.max_torque_mNm = 40000;
    capability.regenerating = limit_init(40000, REASON_MAX_TORQUE);
    capability.optimal = limit_init(INT32_MAX, REASON_LOSS_OPTIMUM);
    for (int sign = -1; sign <= 1; sign += 2) {
        brake_blending_init(&state, &config);
        hydraulic_model_init(&brake);
        in.brake_torque_mNm = 60000;
        motor_mNm = 0;
        for (int n = 0; n < 3000; n++) { /* 10 rad/s, then 5 rad/s2 */
            in.speed_mrad_s = sign * (n < 1000 ? 10000 : q_max(10000 - 5 * (n - 1000), 0));
            step_with_brakes();
            const int32_t sum_mNm = motor_mNm + hydraulic_model_torque_mNm(&brake);
            if (n > 600) {
                TEST_ASSERT_INT32_WITHIN(1000, 60000, sum_mNm);
                TEST_ASSERT_LESS_OR_EQUAL_INT32(60001, sum_mNm);
            }
        }
        TEST_ASSERT_EQUAL_INT32(0, motor_mNm);
    }
}

/* The motor alone makes 30 N m down to the blend-out, so no report has shown the gain before: a
 * brake of 0.8 or 1.2 would miss or exceed the demand by 6 N m at the end. The motor makes up for
 * what is missing beyond the line BLEND_OUT, and takes back what is too much. */
void test_sum_of_a_brake_of_unknown_gain_is_the_demand_through_the_first_blend_out(void)
{
    const double gains[] = {0.8, 1.0, 1.2};
    for (int g = 0; g < 3; g++) {
        late_hydraulic_brake();
        config.brake.hydraulic_timeout_ms = 50;
        config.brake.hydraulic_report_delay_ms = 0;
        config.brake.hydraulic_gain_band_q15 = 8192;
        config.brake.hydraulic_tolerance_mNm = 15000;
        config.motor.max_torque_mNm = 40000;
        capability.regenerating = limit_init(40000, REASON_MAX_TORQUE);
        capability.optimal = limit_init(INT32_MAX, REASON_LOSS_OPTIMUM);
        brake_blending_init(&state, &config);
        in.brake_torque_mNm = 30000;
        in.hydraulic.age_ms = 0;
        in.hydraulic.valid = true;
        motor_mNm = 30000;
        const int32_t end_mrad_s = config.brake.blend_out_end_mrad_s;
        for (int n = 0; n < 3000; n++) { /* 5 rad/s, then 4 rad/s2 */
            in.speed_mrad_s = n < 1000 ? 5000 : q_max(5000 - 4 * (n - 1000), 0);
            const double torque_mNm = gains[g] * hydraulic_model_torque_mNm(&brake);
            in.hydraulic.age_ms++;
            if (n % 10 == 0) {
                in.hydraulic.age_ms = 0;
                in.hydraulic.torque_mNm = (int32_t)lround(torque_mNm);
            }
            if (in.speed_mrad_s > end_mrad_s / 4) {
                const int32_t sum_mNm = motor_mNm + (int32_t)lround(torque_mNm);
                TEST_ASSERT_INT32_WITHIN(1500, 30000, sum_mNm);
            }
            step_with_brakes();
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.03, gains[g], state.feedback.gain_q15 / 32768.0);
        TEST_ASSERT_EQUAL_INT32(0, motor_mNm);
        in.hydraulic.valid = false;
        in.hydraulic.age_ms = UINT32_MAX;
    }
}

void test_falling_motor_torque_counts_with_its_value_after_dead_time_and_lag(void)
{
    late_hydraulic_brake();
    config.brake.torque_rate_mNm_s = 100000;
    in.brake_torque_mNm = 24000;
    motor_follows(24000);
    TEST_ASSERT_EQUAL_INT32(0, step().hydraulic_mNm);
    abs_active = true; /* the motor's torque falls by 100 mN m in each of 100 steps */
    TEST_ASSERT_EQUAL_INT32(10000, step().hydraulic_mNm);
}

void test_motor_that_cannot_gain_torque_counts_with_its_command(void)
{
    in.brake_torque_mNm = 20000;
    motor_follows(5000);
    in.motor_growth_mNm = 0;
    assert_split(20000 - 15000, 15000, REASON_TORQUE_RATE, step());
    in.motor_growth_mNm = -400; /* falling */
    TEST_ASSERT_EQUAL_INT32(15000, step().hydraulic_mNm);
    in.motor_growth_mNm = 10; /* 1 N m in the 100 ms of motor_arrival */
    TEST_ASSERT_EQUAL_INT32(14000, step().hydraulic_mNm);
    config.brake.motor_arrival_ms = 500; /* five in half a second */
    TEST_ASSERT_EQUAL_INT32(10000, step().hydraulic_mNm);
    config.brake.motor_arrival_ms = 1;
    TEST_ASSERT_EQUAL_INT32(14990, step().hydraulic_mNm);
}

/* The hydraulic brake replaces half of the motor's torque. This must not reduce the motor's
 * command.
 */
void test_lasting_motor_shortfall_is_covered_without_reducing_the_motor_command(void)
{
    late_hydraulic_brake();
    in.brake_torque_mNm = 20000;
    motor_mNm = 20000;
    brake_blending_out_t out = {0};
    for (int n = 0; n < 3000; n++) {
        in.motor_command_mNm = -motor_mNm;
        in.motor_achieved_mNm = -motor_mNm / 2;
        out = step();
        motor_mNm = q_clamp(out.electric_mNm, motor_mNm - 400, motor_mNm + 400);
    }
    TEST_ASSERT_EQUAL_INT32(20000, motor_mNm);
    TEST_ASSERT_EQUAL_INT32(8000, out.hydraulic_mNm); /* shortfall 10 N m, 2 are tolerated */
}

/* ---- deferrable limits: the motor torque falls only as the hydraulic torque rises ---- */

/* Dead time and 2.3 lags, in which a first-order lag has made nine tenths of its way. */
enum { BRIDGING_ms = 40 + 138 };

static int32_t least_sum_mNm, most_sum_mNm;

/* Some steps of both brakes, and the range of their sum. */
static void sum_of_brakes(int steps)
{
    least_sum_mNm = INT32_MAX;
    most_sum_mNm = 0;
    for (int n = 0; n < steps; n++) {
        step_with_brakes();
        const int32_t sum_mNm = motor_mNm + hydraulic_model_torque_mNm(&brake);
        least_sum_mNm = q_min(least_sum_mNm, sum_mNm);
        most_sum_mNm = q_max(most_sum_mNm, sum_mNm);
    }
}

static void brake_with_the_motor_alone(void)
{
    rig_up();
    late_hydraulic_brake();
    config.brake.bridging_time_ms = BRIDGING_ms;
    capability.optimal = limit_init(50000, REASON_LOSS_OPTIMUM);
    in.brake_torque_mNm = 30000;
    motor_mNm = 30000;
    sum_of_brakes(300);
    TEST_ASSERT_EQUAL_INT32(30000, motor_mNm);
}

/* Without bridging the motor leaves 30 N m at 400 N m/s, in 75 ms, of which the hydraulic brake
 * makes 30 N m (1 - exp(-35 ms/60 ms)) = 13.3 N m. */
void test_motor_torque_above_a_fallen_deferrable_limit_stays_until_the_hydraulic_torque_comes(void)
{
    brake_with_the_motor_alone();
    capability.optimal = limit_init(0, REASON_CHARGE_CURRENT);
    sum_of_brakes(600);
    /* Hydraulic torque rises at up to 500 N m/s, the motor torque falls at 400 N m/s. */
    TEST_ASSERT_INT32_WITHIN(700, 30000, most_sum_mNm);
    TEST_ASSERT_INT32_WITHIN(600, 30000, least_sum_mNm);
    TEST_ASSERT_INT32_WITHIN(50, 0, motor_mNm);

    brake_with_the_motor_alone();
    config.brake.bridging_time_ms = 0;
    capability.optimal = limit_init(0, REASON_CHARGE_CURRENT);
    sum_of_brakes(600);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(13300 + 500, least_sum_mNm);
}

/* A limit that sinks by 2 N m/s with the speed has been followed for a second when it steps to
 * zero: the motor torque stays for the dead time of 40 ms as after a level limit. */
void test_a_step_of_a_limit_that_sinks_already_is_bridged_for_the_whole_dead_time(void)
{
    late_hydraulic_brake();
    config.brake.bridging_time_ms = 178;
    in.brake_torque_mNm = 30000;
    motor_mNm = 20000;
    for (int n = 0; n < 1000; n++) {
        capability.optimal = limit_init(22000 - 2 * n, REASON_LOSS_OPTIMUM);
        step_with_brakes();
    }
    TEST_ASSERT_INT32_WITHIN(100, 20000, motor_mNm);
    capability.optimal = limit_init(0, REASON_LOSS_OPTIMUM);
    for (int n = 0; n < 40; n++) {
        step_with_brakes();
        TEST_ASSERT_INT32_WITHIN(200, 20000, motor_mNm);
        TEST_ASSERT_INT32_WITHIN(300, 30000, motor_mNm + hydraulic_model_torque_mNm(&brake));
    }
}

void test_a_hard_limit_is_obeyed_at_once_whatever_the_bridging_time(void)
{
    brake_with_the_motor_alone();
    capability.regenerating = limit_init(5000, REASON_BUS_VOLTAGE_HIGH);
    TEST_ASSERT_EQUAL_INT32(5000, step_with_brakes().electric_mNm);
}

/* A lag's tenth is left after 2.3 time constants. */
void test_nine_tenths_of_a_bridged_torque_are_gone_after_the_bridging_time(void)
{
    brake_with_the_motor_alone();
    capability.optimal = limit_init(0, REASON_CHARGE_CURRENT);
    config.brake.max_hydraulic_torque_mNm = 0; /* nothing comes in its place */
    config.brake.torque_rate_mNm_s = 20000000;
    brake_blending_out_t out = {0};
    for (int n = 0; n < BRIDGING_ms; n++) {
        motor_follows(motor_mNm);
        out = step();
        motor_mNm = out.electric_mNm;
        if (n < 40) {
            TEST_ASSERT_INT32_WITHIN(2, 30000, motor_mNm);
        }
    }
    TEST_ASSERT_INT32_WITHIN(300, 3000, out.electric_mNm);
}

void test_bridging_never_raises_the_motor_torque(void)
{
    brake_with_the_motor_alone();
    in.brake_torque_mNm =
        10000; /* the driver brakes less, then the limit falls, then he brakes more */
    sum_of_brakes(300);
    capability.optimal = limit_init(0, REASON_CHARGE_CURRENT);
    step_with_brakes();
    in.brake_torque_mNm = 40000;
    for (int n = 0; n < 300; n++) {
        TEST_ASSERT_LESS_OR_EQUAL_INT32(10000, step_with_brakes().electric_mNm);
    }
}
