/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Fixed input sequences for both step functions, run on the host and on the emulated core. Prints
 * for each sequence a 32-bit hash over every output of every step, and the number of slow steps in
 * each operating mode, which shows that the sequence reaches the modes it is meant for.
 */
#include <stddef.h>
#include <string.h>

#include "config/bases.h"
#include "config_image.h"
#include "digest.h"
#include "print.h"
#include "wheel.h"

enum { FAST_STEPS = 24000, FAST_STEPS_A_SLOW_STEP = 20 };

typedef struct sequence sequence_t;
struct sequence {
    const char *name;
    void (*configure)(config_t *config);
    /* 1 kHz: demands, temperatures and speed. */
    void (*set_inputs)(wheel_t *wheel, slow_input_t *in, int32_t ms);
    /* Every PWM period; may be NULL. */
    void (*disturb)(wheel_t *wheel, fast_input_t *in);
    /* The torque enable is set in every mode, trips are cleared at once, and the current references
     * are random. */
    bool forced;
};

/* ---- configurations ---- */

static void as_generated(config_t *config)
{
    (void)config;
}

static void with_angle_sensor(config_t *config)
{
    config->rotor.sensor = CONFIG_ROTOR_ANGLE;
}

static void with_an_encoder(config_t *config)
{
    config->rotor.sensor = CONFIG_ROTOR_ENCODER;
    config->motor.pole_pairs = 23;
    config->rotor.encoder_counts = 2048 * 23;
    config->rotor.encoder_index_turn = 0;
    config->rotor.encoder_index_tolerance_counts = 8;
}

static void with_halls_and_ratio(config_t *config)
{
    config->rotor.sensor = CONFIG_ROTOR_HALL;
    config->brake.strategy = CONFIG_STRATEGY_PARALLEL_RATIO;
}

static void with_field_weakening_and_free_travel(config_t *config)
{
    config->rotor.sensor = CONFIG_ROTOR_ANGLE;
    config->brake.strategy = CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL;
    config->current_loop.field_weakening_gain_pu_q15 = 400;
    config->current_loop.field_weakening_current_pu_q15 =
        config->current_loop.max_current_pu_q15 / 2;
}

static void with_interior_magnets(config_t *config)
{
    config->rotor.sensor = CONFIG_ROTOR_ANGLE;
    config->motor.type = CONFIG_MOTOR_IPMSM;
    config->motor.q_inductance_nH = config->motor.d_inductance_nH * 2;
    config->current_loop.inductance_q_pu_q16 = config->current_loop.inductance_d_pu_q16 * 2;
}

/* ---- inputs ---- */

static void enabled_at_room_temperature(slow_input_t *in, int32_t ms)
{
    in->demand_age_ms = 0;
    in->bms.charge_current_mA = 200000;
    in->bms.discharge_current_mA = 400000;
    in->temperature.winding_cC = 2500 + ms;
    in->temperature.switch_cC = 3000 + 2 * ms;
    in->demand.enable = ms > 200;
    in->demand.drive_torque_mNm = 0;
    in->demand.brake_torque_mNm = 0;
}

static void drive_and_brake(wheel_t *wheel, slow_input_t *in, int32_t ms)
{
    enabled_at_room_temperature(in, ms);
    in->demand.drive_torque_mNm = ms % 600 > 300 ? 20000 : 0;
    in->demand.brake_torque_mNm = ms % 600 > 100 && ms % 600 <= 300 ? ms * 50 : 0;
    wheel->speed_q32 = ms * 20000;
}

/* The pedal is up until the controller runs. */
static void reverse(wheel_t *wheel, slow_input_t *in, int32_t ms)
{
    enabled_at_room_temperature(in, ms);
    if (ms > 220) {
        in->demand.drive_torque_mNm = ms % 400 < 200 ? -15000 : 15000;
    }
    wheel->speed_q32 = (600 - ms) * 25000;
}

static void hot_and_full(wheel_t *wheel, slow_input_t *in, int32_t ms)
{
    enabled_at_room_temperature(in, ms);
    in->temperature.winding_cC = 9000 + 6 * ms;
    in->bms.charge_current_mA = 40000 - 30 * ms > 0 ? 40000 - 30 * ms : 0;
    in->demand.brake_torque_mNm = 60000;
    in->demand.abs_active = ms % 250 > 200;
    wheel->speed_q32 = 15000000 - ms * 8000;
    wheel->bus_code = (uint16_t)(3500 + ms / 4);
}

/* Demand timeout, hardware fault and acknowledgement, periodically. */
static void faults_and_recoveries(wheel_t *wheel, slow_input_t *in, int32_t ms)
{
    enabled_at_room_temperature(in, ms);
    in->demand.brake_torque_mNm = ms % 400 < 150 ? 30000 : 0;
    in->demand_age_ms = ms % 300 > 250 ? (uint32_t)(ms % 300) : 0;
    in->demand.fault_reset = ms % 100 > 50;
    in->demand.enable = ms > 200 && ms % 400 < 300;
    wheel->speed_q32 = ms % 400 < 200 ? 3000000 : 0;
}

/* Random values within and beyond the range of every input. */
static void random_inputs(wheel_t *wheel, slow_input_t *in, int32_t ms)
{
    const int32_t roll = (int32_t)wheel_random(wheel);
    in->demand.drive_torque_mNm = (roll - 32768) * 100;
    in->demand.brake_torque_mNm = (int32_t)wheel_random(wheel) * 100;
    in->demand_age_ms = roll % 16 == 0 ? UINT32_MAX : 0;
    in->bms.charge_current_mA = (int32_t)wheel_random(wheel) * 100;
    in->bms.discharge_current_mA = (int32_t)wheel_random(wheel) * 100;
    in->temperature.winding_cC = (int32_t)(wheel_random(wheel) % 20000U) - 5000;
    in->temperature.switch_cC = (int32_t)(wheel_random(wheel) % 20000U) - 5000;
    in->demand.enable = ms > 200 && roll % 64 != 0;
    in->demand.abs_active = roll % 8 == 1;
    in->demand.fault_reset = roll % 2 == 1;
    wheel->speed_q32 = (roll - 32768) * 8000;
}

/* ---- disturbances ---- */

static void random_power_stage_faults(wheel_t *wheel, fast_input_t *in)
{
    in->power_stage_fault = wheel_random(wheel) % 4001U == 0;
}

static void random_codes(wheel_t *wheel, fast_input_t *in)
{
    for (int x = 0; x < 3; x++) {
        in->phase_current_code[x] = (uint16_t)(wheel_random(wheel) & 0xFFFU);
    }
    in->bus_voltage_code = (uint16_t)(wheel_random(wheel) & 0xFFFU);
    in->rotor_angle_turn = (uint16_t)wheel_random(wheel);
    in->hall_state = (uint8_t)(wheel_random(wheel) & 7U);
    in->encoder.count = (uint16_t)(in->encoder.count + (wheel_random(wheel) & 15U));
    in->encoder.index_count = (uint16_t)wheel_random(wheel);
    in->encoder.index = wheel_random(wheel) % 61U == 0;
    in->power_stage_fault = wheel_random(wheel) % 997U == 0;
}

/* Random codes in a few periods only, so that the controller keeps running and its limiters act. */
static void bursts(wheel_t *wheel, fast_input_t *in)
{
    if (wheel_random(wheel) % 50U == 0) {
        const int phase = (int)(wheel_random(wheel) % 3U);
        in->phase_current_code[phase] = (uint16_t)(wheel_random(wheel) & 0xFFFU);
    }
    if (wheel_random(wheel) % 200U == 0) {
        in->hall_state = (uint8_t)(wheel_random(wheel) & 7U);
        in->rotor_angle_turn = (uint16_t)wheel_random(wheel);
    }
}

static const sequence_t SEQUENCES[] = {
    {"as generated, drive and brake", as_generated, drive_and_brake, NULL, false},
    {"angle sensor, drive and brake", with_angle_sensor, drive_and_brake, NULL, false},
    {"encoder, drive and brake", with_an_encoder, drive_and_brake, NULL, false},
    {"encoder, through standstill", with_an_encoder, reverse, NULL, false},
    {"halls, ratio, through standstill", with_halls_and_ratio, reverse, NULL, false},
    {"field weakening, free travel, hot, full battery", with_field_weakening_and_free_travel,
     hot_and_full, NULL, false},
    {"interior magnets, reverse", with_interior_magnets, reverse, NULL, false},
    {"faults and recoveries", with_angle_sensor, faults_and_recoveries, random_power_stage_faults,
     false},
    {"bursts of noise", with_halls_and_ratio, drive_and_brake, bursts, false},
    {"random inputs, hall sensors", with_halls_and_ratio, random_inputs, random_codes, false},
    {"random inputs, angle sensor", with_interior_magnets, random_inputs, random_codes, false},
    {"random inputs, encoder", with_an_encoder, random_inputs, random_codes, false},
    {"forced, random inputs, encoder", with_an_encoder, random_inputs, random_codes, true},
    {"forced, random inputs, hall sensors", with_halls_and_ratio, random_inputs, random_codes,
     true},
    {"forced, random inputs, angle sensor", with_field_weakening_and_free_travel, random_inputs,
     random_codes, true},
};

static void force(wheel_t *wheel, fast_setpoint_t *command)
{
    command->torque_enabled = true;
    command->clear_trip = true;
    command->i_reference_pu.d = (int16_t)((int32_t)wheel_random(wheel) - 32768);
    command->i_reference_pu.q = (int16_t)((int32_t)wheel_random(wheel) - 32768);
}

static uint32_t run(const sequence_t *sequence, uint32_t mode_steps[PRINT_MODES])
{
    static config_t config;
    static controller_t controller;
    config = CONFIG_IMAGE;
    sequence->configure(&config);
    controller_init(&controller, &config, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t fast_setpoint = controller_initial_setpoint(&config, BASES_MODEL_TIMER_Hz);
    wheel_t wheel = {.random = 2013, .bus_code = 3500, .noise_codes = 6};
    slow_input_t slow_in = {.demand.direction = DRIVE_DIRECTION_FORWARD,
                            .config_accepted = true,
                            .selftest_passed = true};
    digest_t digest;
    digest_begin(&digest);
    for (int32_t step = 1; step <= FAST_STEPS; step++) {
        fast_input_t in = wheel_sample(&wheel);
        if (sequence->disturb != NULL && step > 4000) {
            sequence->disturb(&wheel, &in);
        }
        const fast_output_t out =
            *controller_fast_step(&controller.fast, &config, &fast_setpoint, &in);
        digest_fast(&digest, &out, &controller.fast);
        wheel_step(&wheel, &config, &out);
        if (step % FAST_STEPS_A_SLOW_STEP == 0) {
            sequence->set_inputs(&wheel, &slow_in, step / FAST_STEPS_A_SLOW_STEP);
            fast_report_t fast_report;
            controller_fast_report(&controller.fast, &fast_report);
            const slow_output_t slow = controller_slow_step(&controller.slow, &config, &fast_report,
                                                            &slow_in, &fast_setpoint);
            digest_slow(&digest, &slow, &fast_setpoint);
            if (sequence->forced) {
                force(&wheel, &fast_setpoint);
            }
            mode_steps[slow.mode]++;
        }
    }
    return digest_end(&digest);
}

int main(void)
{
    for (size_t i = 0; i < sizeof SEQUENCES / sizeof SEQUENCES[0]; i++) {
        uint32_t mode_steps[PRINT_MODES] = {0};
        const uint32_t crc = run(&SEQUENCES[i], mode_steps);
        print_trace(crc, SEQUENCES[i].name, mode_steps);
    }
    return 0;
}
