/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pedals.h: demand of accelerator and brake pedal that are wired to this controller. 1 kHz, before
 * the slow step, whose demand it gives. Precondition: pedals_wired().
 *
 *     ratio -> valid range -> travel (calibration) -> two channels compared -> torque
 *
 * A pedal has one or two channels, each the ratio of a sensor's voltage to its supply. A channel
 * outside its valid range is shorted or open; two that differ by more than pedals.difference are
 * implausible. The accelerator then counts as released: at once out of range, with the smaller
 * travel while the difference qualifies, without lift-off braking after pedals.fault_time. The
 * brake pedal counts with the larger travel; without a valid channel its demand is kept for
 * pedals.fault_time and is then lost (demand.h).
 *
 * The accelerator drives only after it has been released once since the start, a fault, or a
 * travel beyond pedals.override with the brake pedal pressed. Direction and switches come by CAN; a
 * controller that has never received a demand takes the vehicle for one without CAN, switched on
 * and forward, and one whose messages have ended is neutral. README.
 */
#ifndef PEDALS_PEDALS_H
#define PEDALS_PEDALS_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/slow_messages.h"

typedef struct {
    int32_t ratio_q15[CONFIG_PEDAL_CHANNELS]; /* of the supply, 0 .. 32 768; any other value counts
                                                 as out of range */
    uint32_t age_ms;                          /* of the sample; too old counts as out of range */
    wheel_demand_t received; /* by CAN: switches, and torques of pedals elsewhere */
    uint32_t received_age_ms;
} pedals_input_t;

typedef struct {
    int32_t accelerator_fault_halves; /* implausible half milliseconds less plausible ones */
    int32_t brake_fault_halves;
    int32_t no_brake_ms;      /* without a valid channel, saturating */
    int32_t brake_travel_q15; /* the last valid one */
    bool accelerator_fault;
    bool brake_fault;
    bool must_release; /* no driving torque until the accelerator is released */
    bool was_received; /* a CAN demand has arrived since the start */
} pedals_state_t;

typedef struct {
    wheel_demand_t demand; /* of a wheel of share 1 */
    uint32_t age_ms;       /* as demand.h takes it */
} pedals_output_t;

void pedals_init(pedals_state_t *state);

pedals_output_t pedals_step(pedals_state_t *state, const config_t *config,
                            const pedals_input_t *in);

/* The demand of one wheel, 0 .. 3 as vehicle.wheel_position. */
wheel_demand_t pedals_wheel_demand(const config_t *config, const wheel_demand_t *demand,
                                   int32_t wheel);

/* Braking torque at a travel of 0 .. 32 768, wheel of share 1, mNm: interpretation of the pedal. */
int32_t pedals_brake_torque_mNm(const config_pedals_t *pedals, int32_t travel_q15);

static inline bool pedals_wired(const config_t *config)
{
    return config->pedals.accelerator_channels > 0 || config->pedals.brake_channels > 0;
}

#endif
