/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Rotor estimates: for any sequence of sensor readings no arithmetic overflows and no index leaves
 * its array. The hall estimate is proved by induction: from any state that its invariant
 * allows one step leads to another such state.
 */
#include "absolute_angle.h"
#include "config/config.h"
#include "encoder.h"
#include "hall.h"
#include "proof.h"
#include "rotor.h"

/* Any configuration that the validator accepts, as far as the rotor estimates read it. */
static void any_rotor_configuration(config_t *config)
{
    config->drive.pwm_frequency_Hz = any_within(4000, 100000);
    config->rotor.sensor = any_within(0, 2);
    config->rotor.pll_proportional_q16 = any_within(1, 65536);
    config->rotor.pll_integral_q24 = any_within(1, 16777216);
    config->rotor.hall_lines = any_within(0, 15);
    uint32_t turn = 0;
    for (int k = 0; k < CONFIG_HALL_EDGES; k++) {
        config->rotor.edge_turn[k] = any_within(0, 65535);
    }
    for (int k = 0; k < CONFIG_HALL_EDGES; k++) {
        const uint32_t next = (uint32_t)config->rotor.edge_turn[(k + 1) % CONFIG_HALL_EDGES];
        const uint32_t width = (next - (uint32_t)config->rotor.edge_turn[k]) & 0xFFFFU;
        ASSUME(width >= 5461U && width <= 16384U);
        turn += width;
    }
    /* A sum of differences round the circle is a whole number of turns, and these lie between 1/2
     * and 3/2: it is one. */
    ASSUME(turn == 65536U);
}

static bool within_quarter_turn(int32_t speed_q32)
{
    return speed_q32 >= -2 * HALL_FASTEST_Q31 && speed_q32 <= 2 * HALL_FASTEST_Q31;
}

static bool hall_invariant(const hall_t *hall, const config_t *config)
{
    return hall->sector <= 5 && hall->sectors_timed <= 6 && hall->direction >= -1 &&
           hall->direction <= 1 && hall->span_q32 >> 17 >= 1365U && hall->span_q32 >> 17 <= 8192U &&
           hall->periods_since_edge >= 0 && hall->periods_since_edge <= 65535 &&
           hall->invalid_periods >= 0 && hall->invalid_periods < HALL_INVALID_PERIODS &&
           hall->overdue_periods >= 0 && hall->overdue_periods <= hall->standstill_periods &&
           hall->bounce_periods >= 0 && hall->bounce_periods <= 65535 &&
           within_quarter_turn(hall->speed_q32) && within_quarter_turn(hall->edge_speed_q32) &&
           hall->plausible_edges <= 6 && (hall->valid || hall->plausible_edges < 6) &&
           hall->reversal_periods == config->drive.pwm_frequency_Hz / HALL_REVERSAL_DIVISOR &&
           hall->standstill_periods == config->drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S;
}

static hall_t any_hall(const config_t *config)
{
    hall_t hall;
    hall.theta_q32 = nondet_uint32();
    hall.speed_q32 = nondet_int32();
    hall.begin_q32 = nondet_uint32();
    hall.span_q32 = nondet_uint32();
    hall.timed_turn = nondet_uint32();
    hall.timed_periods = nondet_uint32();
    hall.steady_sensors = nondet_uint8();
    hall.periods_since_edge = nondet_int32();
    hall.overdue_periods = nondet_int32();
    hall.bounce_periods = nondet_int32();
    hall.standstill_periods = nondet_int32();
    hall.invalid_periods = nondet_int32();
    for (int k = 0; k < CONFIG_HALL_EDGES; k++) {
        hall.sector_periods[k] = nondet_uint16();
    }
    hall.faults = nondet_uint16();
    hall.sector = nondet_uint8();
    hall.sectors_timed = nondet_uint8();
    hall.direction = (int8_t)any_within(-1, 1);
    hall.reversal_periods = nondet_int32();
    hall.edge_theta_q32 = nondet_uint32();
    hall.edge_speed_q32 = nondet_int32();
    hall.observer_lead_q32 = nondet_uint32();
    hall.plausible_edges = nondet_uint8();
    hall.started = true;
    hall.valid = nondet_bool();
    ASSUME(hall_invariant(&hall, config));
    return hall;
}

/* As rotor_step() makes it: any reading, with or without an observed angle. */
static void any_period(hall_t *hall, hall_t *before, const config_t *config)
{
    const uint8_t sensors = nondet_uint8();
    const hall_observed_t observed = {.theta_turn = nondet_uint16(), .known = nondet_bool()};
    if (!hall_extrapolate(hall, sensors)) {
        hall_process_reading(hall, before, config, sensors, observed);
    }
}

void prove_hall_begin(void)
{
    config_t config;
    any_rotor_configuration(&config);
    hall_t hall;
    hall_init(&hall, &config);
    hall_t before = hall;
    any_period(&hall, &before, &config);
    PROVE(!before.valid);
    PROVE(!hall.started || hall_invariant(&hall, &config));
    PROVE(!hall.valid || hall.started);
    PROOF_END();
}

void prove_hall_step(void)
{
    config_t config;
    any_rotor_configuration(&config);
    hall_t hall = any_hall(&config);
    hall_t before = any_hall(&config);
    any_period(&hall, &before, &config);
    PROVE(hall_invariant(&hall, &config));
    PROVE(!before.valid || hall_invariant(&before, &config));
    PROOF_END();
}

void prove_absolute_angle(void)
{
    config_t config;
    any_rotor_configuration(&config);
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    rotor_state_t state;
    state.absolute.tracker.theta_q32 = nondet_uint32();
    state.absolute.tracker.speed_q32 = nondet_int32();
    state.absolute.tracker.started = nondet_bool();
    state.absolute.faults = nondet_uint16();
    state.absolute.settled = nondet_uint8();
    state.absolute.apart = nondet_uint8();
    state.absolute.valid = nondet_bool();
    __CPROVER_assume(state.absolute.apart < ABSOLUTE_ANGLE_GIVEN_UP);
    const absolute_angle_t before = state.absolute;
    state.sensor = CONFIG_ROTOR_ANGLE;
    hall_init(&state.hall, &config);
    const foc_input_t in = {.rotor_angle_turn = nondet_uint16(), .hall_state = nondet_uint8()};
    rotor_out_t out;
    const emf_observer_t observer = {.theta_q32 = nondet_uint32(), .periods = nondet_uint32()};
    rotor_step(&state, &config, &in, &observer, nondet_uint16(), &out);
    PROVE(state.absolute.apart < ABSOLUTE_ANGLE_GIVEN_UP);
    PROVE(out.valid || !before.valid || out.faults == (uint16_t)(before.faults + 1U));
    PROVE(before.valid || !out.valid ||
          (state.absolute.apart == 0 && state.absolute.settled == ABSOLUTE_ANGLE_SETTLED));
    /* The next period reads the sensor again. */
    PROVE(state.hall.periods_since_edge >= state.hall.overdue_periods);
    PROOF_END();
}

/* From any state with a bounded position and for any counter and index: no overflow, and the
 * position stays bounded. */
static bool encoder_invariant(const encoder_t *encoder)
{
    return encoder->position_counts >= -INT32_C(200000) &&
           encoder->position_counts <= INT32_C(200000);
}

void prove_encoder(void)
{
    config_t config;
    any_rotor_configuration(&config);
    config.rotor.encoder_counts = any_within(32, 65536);
    config.rotor.encoder_index_tolerance_counts = any_within(0, 1024);
    config.motor.pole_pairs = any_within(1, 60);
    ASSUME(config.rotor.encoder_counts >= 32 * config.motor.pole_pairs);
    ASSUME(config.rotor.encoder_index_tolerance_counts * 12 * config.motor.pole_pairs <=
           config.rotor.encoder_counts);
    encoder_t encoder;
    encoder.turn_per_count_q32 = nondet_uint32();
    encoder.origin_q32 = nondet_uint32();
    encoder.base_q32 = nondet_uint32();
    encoder.counts = config.rotor.encoder_counts;
    encoder.tolerance_counts = config.rotor.encoder_index_tolerance_counts;
    encoder.overdue_counts = encoder.counts + encoder.counts / ENCODER_OVERDUE_DIVISOR;
    encoder.max_counts = any_within(16, 32768);
    ASSUME(encoder.max_counts <= encoder.counts / 2);
    encoder.count_turn = any_within(1, 2049);
    encoder.sign = nondet_bool() ? 1 : -1;
    encoder.tracker.theta_q32 = nondet_uint32();
    encoder.tracker.speed_q32 = nondet_int32();
    encoder.tracker.started = nondet_bool();
    encoder.theta_turn = nondet_uint16();
    encoder.position_counts = nondet_int32();
    encoder.last_count = nondet_uint16();
    encoder.faults = nondet_uint16();
    encoder.started = nondet_bool();
    encoder.referenced = nondet_bool();
    encoder.valid = nondet_bool();
    ASSUME(encoder_invariant(&encoder));
    const encoder_input_t in = {
        .count = nondet_uint16(), .index_count = nondet_uint16(), .index = nondet_bool()};
    encoder_step(&encoder, &config, &in);
    PROVE(encoder_invariant(&encoder));
    PROOF_END();
}
