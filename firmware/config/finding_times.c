/* SPDX-License-Identifier: Apache-2.0 */
#include "config/finding_times.h"

#include "core/q15.h"

/* ms, in which the largest torque leaves at the torque rate: it must not be cut off on its way. */
static int32_t ramp_ms(const config_t *config)
{
    return q_scale(config->motor.max_torque_mNm, 1000, config->brake.torque_rate_mNm_s);
}

static uint16_t steps(int32_t time_ms)
{
    return (uint16_t)q_clamp(time_ms, 1, UINT16_MAX);
}

#define AT_ONCE 1
#define NEVER 1
#define MS(n) (n)
#define FIELD(section, name) config->section.name
#define RAMP(section, name) (ramp_ms(config) + config->section.name)
#define OWN(text) 1
#define TIMES(check, reason, evidence, qualify, heal, explanation, reaction)                       \
    put(&times[FINDING_##check], qualify, heal);

/* Most rows have constants, for which nothing is left of this. */
static inline void put(finding_times_t *times, int32_t qualify_ms, int32_t heal_ms)
{
    if (qualify_ms != AT_ONCE || heal_ms != AT_ONCE) {
        times->qualify_steps = steps(qualify_ms);
        times->heal_steps = steps(heal_ms);
    }
}

void finding_times(const config_t *config, finding_times_t times[FINDING_COUNT])
{
    const finding_times_t at_once = {.qualify_steps = AT_ONCE, .heal_steps = AT_ONCE};
    for (int row = 0; row < FINDING_COUNT; row++) {
        times[row] = at_once;
    }
    FINDING_LIST(TIMES)
}
