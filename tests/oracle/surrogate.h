/* SPDX-License-Identifier: Apache-2.0 */
/*
 * surrogate.h: one wheel and its fast loop as a slow step sees them, once a millisecond: the report
 * that a fast loop would give which follows its setpoints, about a motor, a battery and a vehicle
 * that answer to them. Whatever can go wrong with it, does on demand.
 *
 * Simplified, not accurate: currents settle within a millisecond, voltages are those of the steady
 * state. It needs nothing of the firmware but its messages and its configuration. Doubles with the
 * four operations and conversions only, which are the same on every machine.
 */
#ifndef ORACLE_SURROGATE_H
#define ORACLE_SURROGATE_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/fast_messages.h"
#include "core/slow_messages.h"
#include "random.h"

/* What is wrong at present. Shares of 1 where nothing else is given. */
typedef struct {
    double current_gain;    /* of all three sensors; 1: none */
    double extra_torque;    /* current along q that is not in the setpoint, of its full scale */
    double bus_gain;        /* of the bus voltage sensor; 1: none */
    double flux_share;      /* of the magnets that is left */
    double sensor_turn;     /* by which the rotor sensor is displaced */
    double sensor_speed;    /* what it shows of the speed: 1, 0 frozen, -1 reversed */
    double observer_speed;  /* the same of the observer */
    double bus_share;       /* of the bus voltage that is left, a collapse or an excess */
    double brake_gain;      /* of the hydraulic brake; 1: none */
    int32_t brake_delay_ms; /* more than configured */
    double open_share;      /* of the current that the open phase lacks */
    int32_t open_phase;     /* 1 .. 3 */
    int32_t wrong_sensor;   /* 1 .. 3: named by the fast loop */
    int32_t current_sum_pu; /* added to the sum */
    int32_t offset_codes;   /* the offsets that a calibration finds */
    int32_t periods;        /* fast steps more or less in a millisecond */
    reason_t trip;          /* of the fast loop, in this millisecond */
    bool no_current, undetermined, rotor_invalid, rotor_faults, observer_lost, battery_open;
    bool brake_stuck; /* the hydraulic brake stays as it is */
    bool wild;        /* the report is any numbers */
} surrogate_fault_t;

enum { SURROGATE_DELAY_MOST_ms = 512 };

typedef struct {
    const config_t *config;
    /* of the configuration, SI */
    double flux_wb, resistance_ohm, inductance_d_h, inductance_q_h, pole_pairs;
    double current_base_a, flux_base_wb, inertia_kg_m2, battery_ohm, circle_share;
    /* drawn for a run */
    double battery_v;  /* open circuit */
    double response;   /* share of a current's change that a millisecond brings */
    double mass_share; /* of the configured mass */
    double noise_pu;
    /* state */
    double speed_rad_s, angle_turn; /* mechanical; electrical, 0 .. 1 */
    double i_d_a, i_q_a;
    double brake_nm;
    double bus_v, bus_a;
    double road_rad_s2; /* acceleration from outside */
    double commanded_nm[SURROGATE_DELAY_MOST_ms];
    int32_t commanded_next;
    int32_t weakening_pu;
    uint32_t turned_quarters;
    int32_t switching_ms, calibrating_ms;
    reason_t trip;
    fast_report_t report; /* the latest */
} surrogate_t;

void surrogate_init(surrogate_t *wheel, const config_t *config, random_t *random);

/* A millisecond with this setpoint and these commands; wheel->report is then what the next slow
 * step gets. */
void surrogate_step(surrogate_t *wheel, const fast_setpoint_t *setpoint,
                    const slow_output_t *commands, const surrogate_fault_t *fault,
                    random_t *random);

/* No fault. */
surrogate_fault_t surrogate_healthy(void);

#endif
