/* SPDX-License-Identifier: Apache-2.0 */
/*
 * bench.h: a vehicle with a controller in every driven wheel, one battery, one driver, a road.
 *
 * A run: bench_init() with parameters and the controllers' configuration; bench_start() boots the
 * controllers at standstill (with encoders at a turn a second, so that they meet their index) and
 * brings the vehicle to its initial speed from outside, as on a roller, so that the run begins with
 * currents, filters and rotor estimates as they are in a moving vehicle; bench_period() is one PWM
 * period. The slow step comes first in the period in which a millisecond begins. Accounts, way and
 * time start at zero after the start, the battery and all temperatures as the parameters say.
 *
 * bench_set_rear() gives the wheels of the rear axle drives of their own: motor, bridge, brake,
 * sensors, temperatures, configuration. Vehicle, battery and road are one.
 *
 * Nothing here allocates or does I/O; equal parameters give equal bytes. A bench points into
 * itself: after copying one, call bench_refresh() on the copy.
 */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include <stdbool.h>
#include <stdint.h>

#include "bench/abs_unit.h"
#include "bench/cockpit.h"
#include "bench/ledger.h"
#include "bench/motion.h"
#include "bench/parameters.h"
#include "bench/wheel.h"

enum { BENCH_WHEELS_MAX = PARAMETERS_WHEELS_MAX };

typedef enum {
    BENCH_READY,     /* bench_period() may be called */
    BENCH_NOT_RUN,   /* a controller did not come as far as RUN */
    BENCH_UNRESOLVED /* the motor is too quick for the PWM period: R T >= L */
} bench_start_t;

typedef struct {
    bench_params_t params;
    config_t config;
    driver_trace_t trace;
    wheel_world_t world;
    motion_world_t road;
    /* Drives of the rear axle that differ, and what they make of the world. */
    bench_params_t rear_params;
    config_t rear_config;
    wheel_world_t rear_world;
    int first_rear; /* wheel with such a drive; BENCH_WHEELS_MAX: all are alike */
    const wheel_world_t *world_of[BENCH_WHEELS_MAX];
    int wheels;
    int pieces;                   /* plant steps in a PWM period */
    const processor_t *processor; /* NULL: the controllers' steps are called directly */

    wheel_t wheel[BENCH_WHEELS_MAX];
    battery_state_t battery;
    bus_state_t bus;
    bms_state_t limits;
    vehicle_state_t vehicle;
    chassis_state_t chassis;
    abs_unit_t abs_unit;
    driver_state_t driver;
    driver_demand_t demand;
    cockpit_t cockpit;
    double demand_age_s;     /* of the message the controllers have */
    double demand_due_s;     /* when the next one comes */
    random_t demand_random;  /* of its jitter */
    ledger_t booked;         /* what only the bench can count; bench_ledger() has everything */
    double kinetic_before_j; /* when the run began */
    double magnetic_before_j;
    double bus_before_j;
    ledger_t braking;       /* the finished times in which the driver braked */
    ledger_t braking_since; /* the accounts when the present one began */
    bool is_braking;
    int64_t period; /* since the start of the run */
    int64_t slow_steps;
    double time_s;
    double bus_peak_v;           /* since the run began */
    uint32_t flipped_config_bit; /* from 1; 0: none */
    config_watch_t config_watch; /* while one is flipped */
    bool speed_prescribed;       /* the vehicle's speed is set from outside */
} bench_t;

/* trace: see driver_trace_t; its arrays must outlive the bench. */
void bench_init(bench_t *bench, const bench_params_t *params, const config_t *config,
                const driver_trace_t *trace);

/* After bench_init(): the wheels from chassis.wheels_per_axle on get other drives. Of `params`
 * their sections count. */
void bench_set_rear(bench_t *bench, const bench_params_t *params, const config_t *config);

/* Why these cannot be the rear drives of a vehicle of `front`, in one line; NULL: they can. */
const char *bench_rear_objection(const bench_params_t *front, const bench_params_t *rear);

/* The configuration of a wheel's controller. */
const config_t *bench_config_of(const bench_t *bench, int wheel);

/* After bench_init(): from now on another processor executes the controllers' steps. */
void bench_use_processor(bench_t *bench, const processor_t *processor);

bench_start_t bench_start(bench_t *bench);

void bench_period(bench_t *bench);

/* The two halves of bench_period(): up to and with what the controllers see and decide at the top
 * of the count, and the plant in the period that follows. */
void bench_begin_period(bench_t *bench);
void bench_end_period(bench_t *bench);

/* The run came to the end that its parameters ask for (stop_at_standstill). */
bool bench_has_ended(const bench_t *bench);

/* Why there is no vehicle with these parameters, in one line; NULL: there is. */
const char *bench_world_objection(const bench_params_t *params);

/* Why these parameters cannot take the place of the running bench's, in one line; NULL: they can.
 */
const char *bench_objection(const bench_t *bench, const bench_params_t *changed);

/* After a change of bench->params: everything worked out from them, states untouched. */
void bench_refresh(bench_t *bench);

/* The accounts of the run so far. */
ledger_t bench_ledger(const bench_t *bench);

/* Of the times in it in which the driver pressed the brake pedal. now: bench_ledger(bench). */
ledger_t bench_braking_ledger(const bench_t *bench, const ledger_t *now);

double bench_wheel_speed_rad_s(const bench_t *bench);

#endif
