/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The whole controller under a coverage-guided fuzzer: any configuration the validator accepts, any
 * codes, any order of fast and slow steps. Address and undefined-behaviour sanitizers watch the
 * arithmetic. The checks here are properties of every run: on-times within the timer's range, a
 * sampling window on every leg while switching, and no PWM after a trip.
 *
 * The input is read as a string of bytes. The first ones choose one of the configurations that come
 * with the project and change its fields, each to any value of its range, and a change that breaks
 * a relation between fields is taken back, so every input means a valid configuration.
 */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config/bases.h"
#include "controller/controller.h"
#include "derive.h"
#include "tuning.h"
#include "winding.h"
/* The source, because of what it keeps to itself: relations_hold(). */
#include "validate.c"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct {
    const uint8_t *at;
    size_t left;
} bytes_t;

/* After the end of the input everything is zero. */
static uint8_t take8(bytes_t *bytes)
{
    if (bytes->left == 0) {
        return 0;
    }
    bytes->left--;
    return *bytes->at++;
}

static uint16_t take16(bytes_t *bytes)
{
    const uint8_t low = take8(bytes);
    return (uint16_t)(low | (uint16_t)(take8(bytes) << 8));
}

static uint32_t take32(bytes_t *bytes)
{
    const uint16_t low = take16(bytes);
    return low | (uint32_t)take16(bytes) << 16;
}

/* lowest .. highest, its ends often. */
static int32_t take_within(bytes_t *bytes, int32_t lowest, int32_t highest)
{
    const uint8_t how = take8(bytes);
    if (how < 32) {
        return lowest;
    }
    if (how < 64) {
        return highest;
    }
    const uint64_t count = (uint64_t)((int64_t)highest - lowest) + 1U;
    return (int32_t)((int64_t)(take32(bytes) % count) + lowest);
}

static void promise(bool holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "broken promise: %s\n", what);
        abort();
    }
}

/* ---- configuration ----
 *
 * The ones that come with the project are valid and every change stays inside its field's range, so
 * only relations can break. Checksum and ranges of the whole image would take 99 % of an execution;
 * they are asked for once in a while, to see that this holds.
 */

static bool accepted(const config_t *config)
{
    config_result_t refusal;
    return relations_hold(config, &refusal);
}

static void check_configuration(config_t *config)
{
    config->crc32 = config_crc32(config, (uint32_t)offsetof(config_t, crc32));
    promise(config_validate(config, sizeof(*config)).code == CONFIG_RESULT_OK,
            "the validator accepts what was changed");
}

/* One entry of a stored map, or all of them, with alternating signs or not. */
static void change_map(int16_t *values, uint32_t count, bytes_t *bytes)
{
    const uint8_t how = take8(bytes);
    const uint32_t first = take16(bytes) % count;
    const int32_t value = take_within(bytes, -INT16_MAX, INT16_MAX);
    const uint32_t changed = (how & 1U) != 0 ? count : 1U;
    for (uint32_t i = 0; i < changed; i++) {
        values[(first + i) % count] = (int16_t)((how & i & 2U) != 0 ? -value : value);
    }
}

static void change_maps(config_t *config, bytes_t *bytes)
{
    static config_t before;
    for (int changes = take8(bytes) % 4; changes > 0; changes--) {
        before = *config;
        if ((take8(bytes) & 1U) != 0) {
            change_map(config->regen_map.torque_lsb, CONFIG_REGEN_POINTS_MAX, bytes);
        } else {
            change_map(config->current_map.current_d_lsb, CONFIG_CURRENT_MAP_POINTS_MAX, bytes);
        }
        if (!accepted(config)) {
            *config = before;
        }
    }
}

/* One value of a field, as wide as it is. */
static void store(config_t *config, const config_field_t *field, uint32_t place, int32_t value)
{
    void *const image = config;
    if (field->count > CONFIG_FIELD_VALUES_MAX) {
        ((int16_t *)image)[field->offset_bytes / sizeof(int16_t) + place] = (int16_t)value;
    } else {
        ((int32_t *)image)[field->offset_bytes / sizeof(int32_t) + place] = value;
    }
}

static void change_configuration(config_t *config, bytes_t *bytes)
{
    for (int changes = take8(bytes) % 12; changes > 0; changes--) {
        config_field_t field = config_field_first();
        for (uint8_t left = take8(bytes); left > 0; left--) {
            if (!config_field_next(&field)) {
                field = config_field_first();
            }
        }
        const uint32_t place = field.count > 1 ? take16(bytes) % field.count : 0U;
        const config_t before = *config;
        store(config, &field, place, take_within(bytes, field.lowest, field.highest));
        if (!derive(config) || !accepted(config)) {
            *config = before;
        }
    }
    change_maps(config, bytes);
}

static config_t take_configuration(bytes_t *bytes)
{
    static const config_t *const WITH_THE_PROJECT[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V,
                                                       &CONFIG_SCOOTER48V, &CONFIG_IPM400V};
    config_t config =
        *WITH_THE_PROJECT[take8(bytes) % (sizeof(WITH_THE_PROJECT) / sizeof(WITH_THE_PROJECT[0]))];
    change_configuration(&config, bytes);
    return config;
}

/* ---- steps ---- */

enum { MOST_STEPS = 4096 };

/* How often a fast input is given: up to 15 times, and now and then long enough for a timer to run
 * out. */
static int take_repeats(uint8_t what, bytes_t *bytes)
{
    const int few = what % 16;
    return few < 15 ? few : 1 << (take8(bytes) % 13);
}

static slow_input_t take_slow_input(bytes_t *bytes)
{
    const uint8_t flags = take8(bytes);
    const slow_input_t in = {
        .demand = {.drive_torque_mNm =
                       (flags & 1U) != 0 ? take_within(bytes, INT32_MIN, INT32_MAX) : 0,
                   .brake_torque_mNm =
                       (flags & 2U) != 0 ? take_within(bytes, INT32_MIN, INT32_MAX) : 0,
                   .direction = DRIVE_DIRECTION_FORWARD,
                   .enable = (flags & 8U) == 0,
                   .abs_active = (flags & 16U) != 0,
                   .fault_reset = (flags & 32U) != 0},
        .demand_age_ms = (flags & 4U) != 0 ? take32(bytes) : 0,
        .bms.charge_current_mA = take_within(bytes, INT32_MIN, INT32_MAX),
        .bms.discharge_current_mA = take_within(bytes, INT32_MIN, INT32_MAX),
        .temperature.winding_cC = take_within(bytes, INT32_MIN, INT32_MAX),
        .temperature.switch_cC = take_within(bytes, INT32_MIN, INT32_MAX),
        .selftest_passed = (flags & 64U) == 0,
        .config_accepted = (flags & 128U) == 0,
    };
    return in;
}

/* What a slow loop may say without having been asked: any reference, any speed and bus voltage to
 * be tuned for. */
static void take_command(fast_setpoint_t *command, const config_t *config,
                         int32_t modulation_limit_q15, bytes_t *bytes)
{
    command->i_reference_pu.d = (int16_t)take16(bytes);
    command->i_reference_pu.q = (int16_t)take16(bytes);
    const winding_t winding = winding_constants(config);
    command->tuning = current_tuning(
        config, &winding, modulation_limit_q15, take_within(bytes, -32768, 32767),
        take_within(bytes, INT32_MIN, INT32_MAX), take_within(bytes, INT32_MIN, INT32_MAX));
    command->i_d_sampling_correction_pu = take_within(bytes, INT32_MIN, INT32_MAX);
    command->dead_time_slope = dead_time_slope_at(config, take_within(bytes, INT32_MIN, INT32_MAX));
    command->calibrate_offsets = (take8(bytes) & 7U) == 0;
    command->torque_enabled = take8(bytes) % 3U == 1U;
    command->safe_bridge = (take8(bytes) & 1U) != 0 ? BRIDGE_SHORT : BRIDGE_OFF;
    command->clear_trip = (take8(bytes) & 7U) == 0;
    command->sequence++;
}

static fast_input_t take_fast_input(bytes_t *bytes)
{
    const uint8_t flags = take8(bytes);
    fast_input_t in = {
        .rotor_angle_turn = take16(bytes),
        .bus_voltage_code = (flags & 1U) != 0 ? take16(bytes) : 3500,
        .hall_state = take8(bytes),
        .encoder = {.count = take16(bytes),
                    .index_count = take16(bytes),
                    .index = (flags & 4U) != 0},
        .power_stage_fault = (flags & 0xF0U) == 0xF0U,
    };
    for (int x = 0; x < 3; x++) {
        in.phase_current_code[x] = (flags & 2U) != 0 ? (uint16_t)(take16(bytes) & 4095U)
                                                     : (uint16_t)(2048U + take8(bytes));
    }
    return in;
}

static void check_fast(const config_t *config, const fast_setpoint_t *command,
                       const fast_report_t *report, const fast_output_t *out)
{
    const bool tripped = report->trip != REASON_NONE;
    promise(!tripped || out->bridge != BRIDGE_PWM, "a tripped bridge does not switch");
    promise((out->bridge == BRIDGE_PWM) == (command->torque_enabled && !tripped),
            "without a trip the bridge follows the enable");
    promise(out->bridge == BRIDGE_PWM || out->bridge == command->safe_bridge,
            "a bridge that does not switch is in its safe state");
    promise(report->bridge == out->bridge, "what the bridge does is reported");
    for (int x = 0; x < 3; x++) {
        const int32_t on = out->compare_counts[x];
        promise(on >= bases_min_pulse_counts(config, BASES_MODEL_TIMER_Hz),
                "the low side keeps its shortest pulse");
        promise(on <= bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz) -
                          bases_min_pulse_counts(config, BASES_MODEL_TIMER_Hz),
                "so does the high side");
    }
    promise(report->i_d_weakening_pu <= 0, "field weakening only takes flux away");
    promise(report->i_d_weakening_pu >= -config->current_loop.field_weakening_current_pu_q15,
            "up to its limit");
}

static void check_slow(const config_t *config, const slow_output_t *out)
{
    promise(out->hydraulic_torque_mNm >= 0, "hydraulic torque is a magnitude");
    promise(out->motor_torque_uncertainty_mNm >= 0, "an uncertainty is one as well");
    promise(out->electric_brake_available_mNm >= 0, "so is what the motor could take over");
    promise(out->electric_brake_ahead_mNm >= 0, "so is what it will");
    promise(out->drive_available_mNm >= 0 && out->drive_ahead_mNm >= 0, "so is driving");
    promise(out->electric_brake_ahead_mNm <= config->motor.max_torque_mNm &&
                out->drive_ahead_mNm <= config->motor.max_torque_mNm,
            "and within the motor's limit");
    promise(q_abs(out->motor_torque_command_mNm) <= config->motor.max_torque_mNm,
            "torque stays inside the motor's limit");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes_t bytes = {.at = data, .left = size};
    static config_t config;
    config = take_configuration(&bytes);
    if (size % 64 == 0) {
        check_configuration(&config);
    }

    controller_t controller;
    controller_init(&controller, &config, BASES_MODEL_TIMER_Hz);
    fast_setpoint_t command = controller_initial_setpoint(&config, BASES_MODEL_TIMER_Hz);
    const bool with_slow_loop = (take8(&bytes) & 1U) != 0;
    int steps = 0;
    while (bytes.left > 0 && steps < MOST_STEPS) {
        const uint8_t what = take8(&bytes);
        if (what < 64 && with_slow_loop) {
            const slow_input_t in = take_slow_input(&bytes);
            fast_report_t report;
            controller_fast_report(&controller.fast, &report);
            report.offsets_done = true; /* a thousand samples are more than an input has to spare */
            for (int repeat = what % 8; repeat >= 0; repeat--) {
                const slow_output_t out =
                    controller_slow_step(&controller.slow, &config, &report, &in, &command);
                check_slow(&config, &out);
            }
        } else if (what < 64) {
            take_command(&command, &config, foc_modulation_limit_q15(&config, BASES_MODEL_TIMER_Hz),
                         &bytes);
        }
        const fast_input_t in = take_fast_input(&bytes);
        for (int repeat = take_repeats(what, &bytes); repeat >= 0; repeat--) {
            const fast_output_t out =
                *controller_fast_step(&controller.fast, &config, &command, &in);
            fast_report_t report;
            controller_fast_report(&controller.fast, &report);
            check_fast(&config, &command, &report, &out);
            steps++;
        }
    }
    return 0;
}
