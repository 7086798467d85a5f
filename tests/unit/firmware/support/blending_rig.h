/* SPDX-License-Identifier: Apache-2.0 */
/*
 * blending_rig.h: brake blending of the paper's vehicle with round numbers: a torque limit of
 * 50 N m, a loss optimum of 24 N m, a hydraulic brake without delay. Included once in a program.
 */
#ifndef BLENDING_RIG_H
#define BLENDING_RIG_H

#include "config/finding_times.h"
#include "paper_vehicle.h"
#include "random_values.h"
#include "torque/brake_blending.h"
#include "unity.h"

enum { FAST_mrad_s = 30000 }; /* well above the blend-out speeds, 2.618 and 0.838 rad/s */
enum { ONE_q15 = 32768 };

/* What brake_blending_step() reads of its records, and how it is called. */
typedef struct {
    int32_t brake_torque_mNm; /* demanded, magnitude >= 0 */
    bool handed_over;
    int32_t speed_mrad_s;
    int32_t motor_command_mNm;  /* of the last step, signed */
    int32_t motor_growth_mNm;   /* permitted change of its magnitude */
    int32_t motor_achieved_mNm; /* signed */
    int32_t short_mNm;
    bool bridge_open;
    int32_t hydraulic_added_mNm; /* to the command of the last step */
    int32_t hydraulic_apart_mNm; /* of it, none of the demand */
    torque_enable_t torque_enable;
    hydraulic_feedback_t hydraulic;
} blending_case_t;

static config_t config;
static brake_blending_state_t state;
static torque_limits_t limits;
static torque_limits_state_t limits_state;
static bool abs_active;
static uint8_t abs_share_percent;
static struct {
    limit_t regenerating; /* braking torque without the lines of a strategy */
    limit_t optimal;      /* braking torque at the loss optimum */
} capability;
static blending_case_t in;

static inline void rig_up(void)
{
    config = paper_vehicle();
    config.brake.strategy = CONFIG_STRATEGY_SERIES_OPTIMAL;
    config.brake.parallel_electric_share_q15 = 6554; /* 0.2 */
    config.brake.electric_rated_torque_mNm = 40000;
    config.brake.max_hydraulic_torque_mNm = 300000;
    config.brake.shortfall_band_mNm = 2000;
    config.brake.blend_out_start_mrad_s = 2618;
    config.brake.blend_out_end_mrad_s = 838;
    config.brake.hydraulic_dead_time_ms = 0; /* the hydraulic brake follows its command at once */
    config.brake.hydraulic_time_constant_ms = 0;
    config.brake.hydraulic_rate_mNm_s = 2000000000;
    config.brake.bridging_time_ms = 0;
    brake_blending_init(&state, &config);
    config.motor.max_torque_mNm = 50000;
    torque_limits_init(&limits_state, &limits);
    abs_active = false;
    abs_share_percent = 0;
    capability.regenerating = limit_init(50000, REASON_MAX_TORQUE);
    capability.optimal = limit_init(24000, REASON_LOSS_OPTIMUM);
    in.brake_torque_mNm = 0;
    in.speed_mrad_s = FAST_mrad_s;
    in.motor_command_mNm = 0;
    in.motor_growth_mNm = 1000000; /* the motor's torque rate is unlimited */
    in.motor_achieved_mNm = 0;
    in.torque_enable.drive_q15 = Q15_ONE;
    in.torque_enable.brake_q15 = Q15_ONE;
    in.torque_enable.reason = REASON_NONE;
}

/* The lines as torque_limits_step() writes them, with `capability` for the lines that depend on
 * the motor. */
static inline void write_limits(void)
{
    limit_t *line = limits.braking;
    line[TORQUE_LINE_MAX_TORQUE] = capability.regenerating;
    const int32_t brake_torque_mNm = in.brake_torque_mNm > 0 ? in.brake_torque_mNm : 0;
    torque_limits_strategy(line, &config, in.speed_mrad_s, capability.optimal.torque_mNm,
                           brake_torque_mNm);
    line[TORQUE_LINE_LOSS_OPTIMUM].reason = capability.optimal.reason;
    const int64_t enabled_mNm = (int64_t)config.motor.max_torque_mNm * in.torque_enable.brake_q15;
    line[TORQUE_LINE_ENABLE] = limit_init(
        in.torque_enable.brake_q15 < Q15_ONE ? (int32_t)(enabled_mNm / 32768) : INT32_MAX,
        in.torque_enable.reason);
    const wheel_demand_t wheel = {.abs_active = abs_active,
                                  .abs_motor_share_percent = abs_share_percent};
    line[TORQUE_LINE_ABS] =
        torque_limits_anti_lock(&limits_state, &config, &wheel, brake_torque_mNm);
}

static inline brake_blending_out_t step(void)
{
    write_limits();
    const measured_t now = {.speed_mrad_s = in.speed_mrad_s};
    const last_t last = {.torque_command_mNm = in.motor_command_mNm,
                         .hydraulic_added_mNm = in.hydraulic_added_mNm,
                         .hydraulic_apart_mNm = in.hydraulic_apart_mNm};
    const demand_t demand = {.brake_torque_mNm = in.brake_torque_mNm,
                             .handed_over = in.handed_over};
    const motor_now_t motor = {.achieved_mNm = in.motor_achieved_mNm,
                               .short_mNm = in.short_mNm,
                               .growth_mNm = in.motor_growth_mNm,
                               .bridge_open = in.bridge_open};
    return brake_blending_step(&state, &config, &limits, &now, &last, &in.hydraulic,
                               &in.torque_enable, &demand, &motor);
}

/* What is reported of the hydraulic brake and of its reports. */
static inline reason_t found(void)
{
    finding_times_t times[FINDING_COUNT];
    findings_t findings;
    finding_times(&config, times);
    findings_init(&findings, times, false);
    brake_blending_report(&state, &findings);
    return findings_reason(&findings, findings_warning(&findings));
}

static inline void assert_split(int32_t electric_mNm, int32_t hydraulic_mNm, reason_t reason,
                                brake_blending_out_t out)
{
    TEST_ASSERT_EQUAL_INT32(electric_mNm, out.electric_mNm);
    TEST_ASSERT_EQUAL_INT32(hydraulic_mNm, out.hydraulic_mNm);
    TEST_ASSERT_EQUAL_INT(reason, out.reason);
}

/* The motor's torque is its command, against the present direction of rotation. */
static inline void motor_follows(int32_t electric_mNm)
{
    in.motor_command_mNm = in.speed_mrad_s >= 0 ? -electric_mNm : electric_mNm;
    in.motor_achieved_mNm = in.motor_command_mNm;
}

/* Any strategy, limits, demand and speed; in one of twenty cases with the anti-lock system active,
 * in one of five with a partial torque enable. */
static inline void random_conditions(random_t *random)
{
    config.brake.strategy = random_between(random, 0, 2);
    config.brake.max_hydraulic_torque_mNm = 1000000;
    capability.regenerating = limit_init(random_between(random, 0, 60000), REASON_MAX_POWER);
    capability.optimal = capability.regenerating;
    limit_tighten(&capability.optimal, random_between(random, 0, 80000), REASON_LOSS_OPTIMUM);
    in.brake_torque_mNm = random_between(random, 0, 300000);
    in.speed_mrad_s = random_between(random, -70000, 70000);
    abs_active = random_chance(random, 0.05);
    in.torque_enable.brake_q15 =
        (int16_t)(random_chance(random, 0.2) ? random_between(random, 0, Q15_ONE) : Q15_ONE);
    in.torque_enable.reason = REASON_TORQUE_ENABLE;
}

/* ---- states of the parts, each by its own steps ---- */

/* A model after five milliseconds of commands, of which a brake without lag makes the third last
 * now, one twice as early the second last, and one twice as late the first. */
static inline void model_after(hydraulic_model_t *model, const int32_t commands_mNm[5])
{
    config_t quick = config;
    quick.brake.hydraulic_dead_time_ms = 2;
    quick.brake.hydraulic_time_constant_ms = 0;
    quick.brake.hydraulic_rate_mNm_s = 2000000000;
    quick.brake.hydraulic_report_delay_ms = 0;
    for (int n = 0; n < 5; n++) {
        hydraulic_model_step(model, &quick, commands_mNm[n]);
    }
}

/* A brake whose torque does not move within a step: the first one takes a tenth of a mN m. */
static inline void slow_brake(int32_t torque_mNm)
{
    const int32_t steady_mNm = torque_mNm + 1;
    const int32_t commands_mNm[5] = {steady_mNm, steady_mNm, steady_mNm, steady_mNm, steady_mNm};
    model_after(&state.hydraulic, commands_mNm);
    config.brake.hydraulic_dead_time_ms = 40;
    config.brake.hydraulic_time_constant_ms = 60;
    config.brake.hydraulic_rate_mNm_s = 100;
}

/* A report of a torque in the next step, which no gain of the band contradicts. */
static inline void reported(int32_t report_mNm, int32_t band_q15)
{
    config.brake.hydraulic_timeout_ms = 50;
    config.brake.hydraulic_gain_band_q15 = band_q15;
    config.brake.hydraulic_tolerance_mNm = 20000000;
    hydraulic_feedback_init(&state.feedback, &config);
    in.hydraulic.torque_mNm = report_mNm;
    in.hydraulic.age_ms = 0;
    in.hydraulic.valid = true;
}

/* The same before the next step, in use. The brake made no torque before, so that the interval of
 * its gain is still the band's. */
static inline void measured(int32_t report_mNm, int32_t band_q15)
{
    const hydraulic_model_t released = {.next = 0};
    reported(report_mNm, band_q15);
    (void)hydraulic_feedback_step(&state.feedback, &config, &released, &in.hydraulic, true);
    in.hydraulic.age_ms = 1000; /* that one stands */
}

/* Before that, reports of a torque that lies between two until they make the interval no smaller,
 * which is within 3 of 32 768; without noise. */
static inline void learned(int32_t band_q15, int32_t late_mNm, int32_t early_mNm,
                           int32_t report_mNm)
{
    const int32_t commands_mNm[5] = {late_mNm, late_mNm, late_mNm, early_mNm, 0};
    const hydraulic_feedback_t report = {.torque_mNm = report_mNm, .age_ms = 0, .valid = true};
    const hydraulic_feedback_t zero = {.torque_mNm = 0, .age_ms = 0, .valid = true};
    const hydraulic_model_t released = {.next = 0};
    hydraulic_model_t model = {.next = 0};
    measured(0, band_q15);
    config_t exact = config;
    model_after(&model, commands_mNm);
    exact.brake.max_hydraulic_torque_mNm = 400; /* the resolution is a 512th of it */
    for (int n = 0; n < 100; n++) {
        (void)hydraulic_feedback_step(&state.feedback, &exact, &model, &report, true);
    }
    for (int n = 0; n < 2; n++) {
        (void)hydraulic_feedback_step(&state.feedback, &config, &released, &zero, true);
    }
}

#endif
