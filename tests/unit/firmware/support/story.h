/* SPDX-License-Identifier: Apache-2.0 */
/*
 * story.h: a board that lives through the same story every time, for tests of the whole application
 * on the simulated board. One motor, seen through its sensors only; included once in a program.
 */
#ifndef TEST_APP_STORY_H
#define TEST_APP_STORY_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "app/app.h"
#include "config_image.h"
#include "hal/time.h"
#include "host/port.h"

enum { PERIODS = 40000 };

/* A motor seen through its sensors only: halls that turn, currents that wander. Equal seeds, equal
 * stories. */
typedef struct {
    uint32_t random;
    uint32_t angle_q32;
    int32_t speed_q32;
    uint16_t bus_code;
    bool halls_off; /* their plug */
} story_t;

typedef struct {
    inverter_mode_t mode;
    uint16_t compare_counts[3];
} seen_t;

static story_t story;
static seen_t seen[PERIODS];
static int seen_count;

static inline uint32_t next_random(story_t *s)
{
    s->random = s->random * 1664525U + 1013904223U; /* Numerical Recipes' generator */
    return s->random >> 16;
}

static inline host_sample_t tell(story_t *s)
{
    static const uint8_t HALL_OF_SECTOR[6] = {5, 1, 3, 2, 6, 4};
    host_sample_t out = {.winding_temperature_cC = 2500,
                         .switch_temperature_cC = 3000,
                         .bus_voltage_code = s->bus_code};
    const int32_t a = (int32_t)(next_random(s) % 101U) - 50;
    const int32_t b = (int32_t)(next_random(s) % 101U) - 50;
    out.phase_current_code[0] = (uint16_t)(2048 + a);
    out.phase_current_code[1] = (uint16_t)(2048 + b);
    out.phase_current_code[2] = (uint16_t)(2048 - a - b);
    s->speed_q32 += (int32_t)(next_random(s) % 2001U) - 1000;
    s->angle_q32 += (uint32_t)s->speed_q32;
    out.rotor_angle_turn = (uint16_t)(s->angle_q32 >> 16);
    out.hall_state = s->halls_off ? 7 : HALL_OF_SECTOR[((uint64_t)s->angle_q32 * 6U) >> 32];
    return out;
}

static inline host_sample_t sample(void *context)
{
    return tell(context);
}

static inline void drive(void *context, inverter_mode_t mode, const uint16_t compare_counts[3])
{
    (void)context;
    if (seen_count < PERIODS) {
        seen[seen_count].mode = mode;
        memcpy(seen[seen_count].compare_counts, compare_counts, sizeof seen[0].compare_counts);
        seen_count++;
    }
}

static inline void begin_story(void)
{
    const config_t *c = &CONFIG_IMAGE;
    const int32_t v_dc_mV = (c->battery.min_voltage_mV + c->battery.foldback_voltage_mV) / 2;
    story =
        (story_t){.random = 12345,
                  .speed_q32 = 8000000,
                  .bus_code = (uint16_t)((int64_t)v_dc_mV * 4096 / c->drive.voltage_full_scale_mV)};
}

static inline void connect(const config_t *config)
{
    const host_plant_t plant = {.context = &story, .sample = sample, .drive = drive};
    begin_story();
    seen_count = 0;
    memset(seen, 0, sizeof seen);
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
