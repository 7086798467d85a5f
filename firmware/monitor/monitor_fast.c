/* SPDX-License-Identifier: Apache-2.0 */
#include "monitor/monitor_fast.h"

#include "config/bases.h"
#include "core/q15.h"

enum {
    SLOW_RATE_HZ = 1000,
    RISE_nF = 2000000000 /* 1e9 nF in a farad; twice, for age and resistance of the capacitors */
};

/* The bridge charges its capacitors with no more than the peak of a phase current. mA s/nF = 1e6 V
 * = 1e9 mV. */
static int32_t jump_pu(const config_t *config)
{
    const config_drive_t *drive = &config->drive;
    if (drive->bus_capacitance_nF == 0) {
        return MONITOR_BUS_JUMP_PU;
    }
    const int32_t most_mA = bases_current_mA(config, config->current_loop.max_current_pu_q15);
    const int32_t rise_mV =
        q_scale(most_mA, RISE_nF, drive->bus_capacitance_nF) / drive->pwm_frequency_Hz;
    return q_clamp(q_scale(rise_mV, 32768, drive->voltage_full_scale_mV), MONITOR_BUS_LEAST_JUMP_PU,
                   MONITOR_BUS_JUMP_PU);
}

void monitor_fast_init(monitor_fast_state_t *state, const config_t *config)
{
    const int32_t stale_limit_periods =
        config->drive.pwm_frequency_Hz / SLOW_RATE_HZ * MONITOR_STALE_STEPS;
    /* A component of a sampled current saturates at Q15_ONE, which must count as over any limit. */
    const int32_t overcurrent_pu = q_min(config->monitor.overcurrent_pu_q15, Q15_ONE - 1);
    const monitor_fast_state_t fresh = {
        .trip = REASON_NONE,
        .inverted_trip = ~(uint32_t)REASON_NONE,
        .overcurrent_square = (uint32_t)(overcurrent_pu * overcurrent_pu),
        .overvoltage_pu = q_scale(config->battery.overvoltage_trip_mV, 32768,
                                  config->drive.voltage_full_scale_mV),
        .jump_pu = jump_pu(config),
        .stale_limit_periods = stale_limit_periods,
        .trip_periods = config->monitor.overcurrent_periods,
        .dead_periods = config->monitor.current_dead_periods,
        .periods_left = stale_limit_periods,
        .last_v_dc_pu = 2 * Q15_ONE, /* the first sample rises from nowhere */
    };
    *state = fresh;
}

bool monitor_fast_intact(const monitor_fast_state_t *state, const config_t *config)
{
    monitor_fast_state_t fresh;
    monitor_fast_init(&fresh, config);
    return state->inverted_trip == ~(uint32_t)state->trip &&
           state->overcurrent_square == fresh.overcurrent_square &&
           state->overvoltage_pu == fresh.overvoltage_pu && state->jump_pu == fresh.jump_pu &&
           state->stale_limit_periods == fresh.stale_limit_periods &&
           state->trip_periods == fresh.trip_periods && state->dead_periods == fresh.dead_periods;
}
