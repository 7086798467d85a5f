/* SPDX-License-Identifier: Apache-2.0 */
/*
 * board_rig.h: a reproducible sequence of sensor samples and a record of the bridge's commands, for
 * tests of the whole application on the simulated board. Included once in a program.
 */
#ifndef BOARD_RIG_H
#define BOARD_RIG_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "app/app.h"
#include "config_image.h"
#include "hal/time.h"
#include "host/port.h"

enum { PERIODS = 40000 };

/* Pseudo-random phase currents, none of them near zero, which an open phase would show; a rotor of
 * slowly changing speed, constant bus voltage. Equal seeds give equal samples; with this one no two
 * readings repeat by chance at three looks in a row, which would be frozen (foc/frozen_currents.h).
 */
typedef struct {
    uint32_t random;
    uint32_t angle_q32;
    int32_t speed_q32;
    uint16_t bus_code;
    bool halls_off; /* hall sensors unplugged */
} sensors_t;

typedef struct {
    inverter_mode_t mode;
    uint16_t compare_counts[3];
} bridge_command_t;

static sensors_t sensors;
static bridge_command_t commands[PERIODS];
static int command_count;

static inline uint32_t next_random(sensors_t *s)
{
    s->random = s->random * 1664525U + 1013904223U; /* Numerical Recipes' generator */
    return s->random >> 16;
}

static inline host_sample_t next_sample(sensors_t *s)
{
    static const uint8_t HALL_OF_SECTOR[6] = {5, 1, 3, 2, 6, 4};
    host_sample_t out = {.winding_temperature_cC = 2500,
                         .switch_temperature_cC = 3000,
                         .bus_voltage_code = s->bus_code};
    const int32_t sign = (next_random(s) & 1U) != 0 ? 1 : -1;
    const int32_t one = sign * (40 + (int32_t)(next_random(s) % 11U));
    const int32_t other = sign * (40 + (int32_t)(next_random(s) % 11U));
    const uint32_t first = next_random(s) % 3U;
    out.phase_current_code[first] = (uint16_t)(2048 + one);
    out.phase_current_code[(first + 1U) % 3U] = (uint16_t)(2048 + other);
    out.phase_current_code[(first + 2U) % 3U] = (uint16_t)(2048 - one - other);
    s->speed_q32 += (int32_t)(next_random(s) % 2001U) - 1000;
    s->angle_q32 += (uint32_t)s->speed_q32;
    out.rotor_angle_turn = (uint16_t)(s->angle_q32 >> 16);
    out.hall_state = s->halls_off ? 7 : HALL_OF_SECTOR[((uint64_t)s->angle_q32 * 6U) >> 32];
    return out;
}

static inline host_sample_t sample(void *context)
{
    return next_sample(context);
}

static inline void drive(void *context, inverter_mode_t mode, const uint16_t compare_counts[3])
{
    (void)context;
    if (command_count < PERIODS) {
        commands[command_count].mode = mode;
        memcpy(commands[command_count].compare_counts, compare_counts,
               sizeof commands[0].compare_counts);
        command_count++;
    }
}

static inline void start_sensors(void)
{
    const config_t *c = &CONFIG_IMAGE;
    const int32_t v_dc_mV = (c->battery.min_voltage_mV + c->battery.foldback_voltage_mV) / 2;
    sensors = (sensors_t){.random = 12347,
                          .speed_q32 = 8000000,
                          .bus_code =
                              (uint16_t)((int64_t)v_dc_mV * 4096 / c->drive.voltage_full_scale_mV)};
}

static inline void connect(const config_t *config)
{
    const host_plant_t plant = {.context = &sensors, .sample = sample, .drive = drive};
    start_sensors();
    command_count = 0;
    memset(commands, 0, sizeof commands);
    host_connect(&plant, config, sizeof *config);
}

static inline void run_for(uint32_t periods)
{
    host_run_for(periods);
    while (time_running()) {
        app_background();
    }
}

#endif
