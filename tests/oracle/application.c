/* SPDX-License-Identifier: Apache-2.0 */
/*
 * application FIRST END: the whole application on its simulated board (hal/host), one drive an
 * entry, around a motor (motor.h). Hashed besides both steps are the bytes that leave the board:
 * every CAN frame, and the black box at the end.
 *
 * A drive draws demands, limits and reports, which reach the application as frames or, with pedals,
 * as voltages of their sensors; and a fault of the power stage or of a sensor. What the shell says
 * is not hashed: it is text.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "app/can_link.h"
#include "bench/vehicle_can.h"
#include "configurations.h"
#include "hal/memory.h"
#include "host/port.h"
#include "motor.h"
#include "numbers.h"
#include "program.h"

enum { DRIVE_ms = 4000, BOOT_ms = 150, PEDAL_CODE_MOST = 4095 };
enum { BOX_CHECKSUM_WORD = 36, BOX_CONFIGURATION_WORD = 38 };
static const uint64_t SEED = 1947;

typedef struct {
    config_t config;
    random_t random;
    motor_t motor;
    vehicle_can_t vehicle;
    slow_input_t in;
    fast_output_t active;
    int32_t ms, phase_left_ms, fault_ms;
    int32_t drive_to_mNm, brake_to_mNm, ramp_mNm;
    int32_t accelerator, brake_pedal; /* thousandths of their travel */
    int32_t accelerator_to, brake_pedal_to, pedal_ramp;
    bool has_pedals;
} drive_t;

static drive_t drive;

static bool chance(int32_t per_mille)
{
    return random_chance(&drive.random, per_mille);
}

static int32_t between(int32_t low, int32_t high)
{
    return random_between(&drive.random, low, high);
}

/* ---- the board ---- */

static uint16_t pedal_code(int32_t channel, int32_t per_mille)
{
    const config_pedals_t *pedals = &drive.config.pedals;
    const double released = pedals->released_q15[channel];
    const double ratio = released + (pedals->pressed_q15[channel] - released) * per_mille * 1e-3;
    return (uint16_t)numbers_within(ratio / 32768.0 * PEDAL_CODE_MOST, 0, PEDAL_CODE_MOST);
}

static host_sample_t sample(void *context)
{
    (void)context;
    fast_input_t in = motor_sampled(&drive.motor, &drive.random);
    const bool faulty = drive.ms >= drive.fault_ms;
    host_sample_t out = {
        .bus_voltage_code = in.bus_voltage_code,
        .rotor_angle_turn = in.rotor_angle_turn,
        .hall_state = in.hall_state,
        .encoder = {.count = in.encoder.count,
                    .index_count = in.encoder.index_count,
                    .index = in.encoder.index},
        .power_stage_fault = faulty && drive.fault_ms % 3 == 0,
        .winding_temperature_cC = drive.in.temperature.winding_cC,
        .switch_temperature_cC = drive.in.temperature.switch_cC,
        .pedal_code = {pedal_code(0, drive.accelerator), pedal_code(1, drive.accelerator),
                       pedal_code(2, drive.brake_pedal), pedal_code(3, drive.brake_pedal)},
    };
    memcpy(out.phase_current_code, in.phase_current_code, sizeof out.phase_current_code);
    if (faulty && drive.fault_ms % 3 == 1) {
        out.phase_current_code[0] = MOTOR_CODE_MOST;
    }
    return out;
}

static void act(void *context, inverter_mode_t mode, const uint16_t compare_counts[3])
{
    (void)context;
    drive.active.bridge = (bridge_mode_t)mode;
    memcpy(drive.active.compare_counts, compare_counts, sizeof drive.active.compare_counts);
}

/* ---- the drive ---- */

static void wire_pedals(config_t *config)
{
    config_t wired = *config;
    wired.pedals.accelerator_channels = between(1, 2);
    wired.pedals.brake_channels = between(0, 2);
    wired.pedals.interpretation = between(0, 1);
    wired.pedals.lift_off_torque_mNm = between(0, 1) * config->motor.max_torque_mNm / 4;
    wired.pedals.other_wheels = 15 & ~(1 << config->vehicle.wheel_position);
    if (configuration_is_accepted(&wired)) {
        *config = wired;
        drive.has_pedals = true;
    }
}

static void begin_drive(int entry)
{
    const drive_t fresh = {.random = random_for(SEED, (uint64_t)entry)};
    drive = fresh;
    drive.config = *configuration_shipped(entry % CONFIGURATIONS);
    configuration_vary(&drive.config, &drive.random, chance(500) ? 6 : 0);
    if (entry / CONFIGURATIONS % 2 == 1) {
        wire_pedals(&drive.config);
    }
    motor_init(&drive.motor, &drive.config);
    drive.motor.angle_turn = random_real(&drive.random, 0.0, 1.0);
    drive.in.bms.charge_current_mA = between(0, 400000);
    drive.in.bms.discharge_current_mA = between(100000, 400000);
    drive.in.bms.voltage_mV = numbers_whole(drive.motor.battery_v * (chance(800) ? 1e3 : 0.8e3));
    drive.in.temperature.winding_cC = between(1000, 9000);
    drive.in.temperature.switch_cC = between(1000, 6000);
    drive.in.hydraulic.age_ms = 1000000;
    drive.fault_ms = chance(700) ? between(BOOT_ms, DRIVE_ms) : DRIVE_ms;
    vehicle_can_init(&drive.vehicle,
                     can_link_address(&drive.config, drive.config.vehicle.wheel_position));
    const host_plant_t plant = {.sample = sample, .drive = act};
    host_connect(&plant, &drive.config, sizeof drive.config);
    app_boot();
}

static void draw_phase(void)
{
    wheel_demand_t *demand = &drive.in.demand;
    const int32_t most_mNm = drive.config.motor.max_torque_mNm;
    const bool begins = drive.ms < BOOT_ms;
    drive.phase_left_ms = begins ? BOOT_ms : between(10, 300);
    demand->enable = true;
    demand->direction = DRIVE_DIRECTION_FORWARD;
    drive.drive_to_mNm = !begins && chance(500) ? between(0, most_mNm) : 0;
    drive.brake_to_mNm = !begins && chance(300) ? between(0, 2 * most_mNm) : 0;
    drive.ramp_mNm = most_mNm / (chance(900) ? between(50, 200) : 1) + 1;
    demand->abs_active = chance(50);
    demand->fault_reset = chance(300);
    drive.accelerator_to = !begins && chance(600) ? between(-50, 1000) : 0;
    drive.brake_pedal_to = !begins && chance(400) ? between(-50, 1000) : 0;
    drive.pedal_ramp = between(1, 20);
    drive.in.bms.contactor = chance(120) ? CONTACTOR_OPEN : CONTACTOR_CLOSED;
    drive.in.bms.current_given = chance(500);
    const double most_rad_s2 = begins ? 0.0 : 2.0 * drive.motor.top_rad_s;
    drive.motor.acceleration_rad_s2 =
        random_real(&drive.random, drive.motor.speed_rad_s > 0.0 ? -most_rad_s2 : 0.0, most_rad_s2);
}

static int32_t towards(int32_t now, int32_t to, int32_t most)
{
    const int32_t apart = to - now;
    return apart > most ? now + most : apart < -most ? now - most : to;
}

static void move_feet(void)
{
    drive.accelerator = towards(drive.accelerator, drive.accelerator_to, drive.pedal_ramp);
    drive.brake_pedal = towards(drive.brake_pedal, drive.brake_pedal_to, drive.pedal_ramp);
}

static void give_frames(void)
{
    wheel_demand_t *demand = &drive.in.demand;
    demand->drive_torque_mNm =
        towards(demand->drive_torque_mNm, drive.drive_to_mNm, drive.ramp_mNm);
    demand->brake_torque_mNm =
        towards(demand->brake_torque_mNm, drive.brake_to_mNm, drive.ramp_mNm);
    vehicle_can_send(&drive.vehicle, &drive.in);
    for (uint32_t k = 0; k < drive.vehicle.queued_count; k++) {
        const messages_frame_t *queued = &drive.vehicle.queued[k];
        can_frame_t frame = {.identifier = queued->identifier, .length = queued->length};
        memcpy(frame.data, queued->data, sizeof frame.data);
        host_can_send(&frame);
    }
    drive.vehicle.now_ms++;
}

static void take_frames(void)
{
    can_frame_t frame;
    while (host_can_receive(&frame)) {
        const uint16_t identifier = (uint16_t)frame.identifier;
        oracle_bytes(&identifier, sizeof identifier);
        oracle_bytes(frame.data, frame.length);
    }
}

/* As `hubsim blackbox` reads it, but for the checksums of the record and of the configuration. */
static void take_black_box(void)
{
    const memory_window_t box = memory_retained();
    for (uint32_t k = 0; k < box.words; k++) {
        const uint32_t word = box.begin[k];
        if (k != BOX_CHECKSUM_WORD && k != BOX_CONFIGURATION_WORD) {
            oracle_bytes(&word, sizeof word);
        }
    }
}

static void run_drive(void)
{
    const int32_t periods = drive.config.drive.pwm_frequency_Hz / 1000;
    for (drive.ms = 0; drive.ms < DRIVE_ms; drive.ms++) {
        if (drive.phase_left_ms-- <= 0) {
            draw_phase();
        }
        move_feet();
        give_frames();
        app_background();
        host_millisecond();
        app_background();
        take_frames();
        for (int32_t k = 0; k < periods; k++) {
            host_pwm_period();
            motor_step(&drive.motor, &drive.active, false);
        }
    }
    take_black_box();
}

int main(int count, char **arguments)
{
    if (count < 3 || !program_begin(count, arguments, 3, 0)) {
        fprintf(stderr, "usage: application FIRST END [OPTION...]\n");
        return 2;
    }
    const int first = atoi(arguments[1]);
    const int end = atoi(arguments[2]);
    for (int entry = first; entry < end; entry++) {
        begin_drive(entry);
        run_drive();
        char name[48];
        snprintf(name, sizeof name, "%s%s %d", configuration_name(entry % CONFIGURATIONS),
                 drive.has_pedals ? " with pedals" : "", entry);
        program_entry(name);
    }
    program_end();
    return 0;
}
