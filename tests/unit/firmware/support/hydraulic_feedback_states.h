/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_feedback_states.h: single reports beside given states of the model of the hydraulic
 * brake. Included once in a program.
 */
#ifndef HYDRAULIC_FEEDBACK_STATES_H
#define HYDRAULIC_FEEDBACK_STATES_H

#include "paper_vehicle.h"
#include "torque/hydraulic_feedback.h"
#include "unity.h"

/* Noise of the sensor, a 512th of the brake: 100 mN m. A torque says something from a 64th on. */
enum { MOST_mNm = 51200, NOISE_mNm = 100, SIGNIFICANT_mNm = 800, TIMEOUT_ms = 20 };
enum { TOLERANCE_mNm = 5000 };
enum { LOWEST_q15 = 24576, ONE_q15 = 32768, HIGHEST_q15 = 40960 }; /* a band of a quarter */

static config_t config;
static hydraulic_model_t model;
static hydraulic_feedback_state_t state;
static hydraulic_feedback_t report;
static hydraulic_feedback_out_t out;

static inline void begin(void)
{
    report.valid = false;
    report.age_ms = 0;
    hydraulic_feedback_init(&state, &config);
}

static inline void states_up(void)
{
    config = paper_vehicle();
    config.brake.max_hydraulic_torque_mNm = MOST_mNm;
    config.brake.hydraulic_timeout_ms = TIMEOUT_ms;
    config.brake.hydraulic_report_delay_ms = 0;
    config.brake.hydraulic_gain_band_q15 = 8192;
    config.brake.hydraulic_tolerance_mNm = TOLERANCE_mNm;
    hydraulic_model_init(&model);
    begin();
}

static inline void modelled(int32_t torque_mNm, int32_t early_mNm, int32_t late_mNm)
{
    const int32_t commands_mNm[5] = {late_mNm, 0, torque_mNm, early_mNm, 0};
    config_t quick = config; /* without lag: 2 ms later, 1 ms if early, 4 ms if late */
    quick.brake.hydraulic_dead_time_ms = 2;
    quick.brake.hydraulic_time_constant_ms = 0;
    quick.brake.hydraulic_rate_mNm_s = 2000000000;
    quick.brake.hydraulic_report_delay_ms = 0;
    quick.brake.max_hydraulic_torque_mNm = 20000000;
    for (int n = 0; n < 5; n++) {
        hydraulic_model_step(&model, &quick, commands_mNm[n]);
    }
}

static inline void step(void)
{
    out = hydraulic_feedback_step(&state, &config, &model, &report, true);
}

/* A millisecond without a report, and one with a report that is so old. */
static inline void silent(void)
{
    report.valid = false;
    step();
}

static inline void reported(int32_t torque_mNm, uint32_t age_ms)
{
    report.valid = true;
    report.torque_mNm = torque_mNm;
    report.age_ms = age_ms;
    step();
}

static inline void settled(int32_t torque_mNm, int32_t report_mNm, int reports)
{
    modelled(torque_mNm, torque_mNm, torque_mNm);
    for (int n = 0; n < reports; n++) {
        reported(report_mNm, 0);
        TEST_ASSERT_TRUE(state.least_q15 <= state.gain_q15 && state.gain_q15 <= state.most_q15);
    }
}

static inline void assert_interval(int32_t least_q15, int32_t most_q15)
{
    TEST_ASSERT_EQUAL_INT32(least_q15, state.least_q15);
    TEST_ASSERT_EQUAL_INT32(most_q15, state.most_q15);
}

#endif
