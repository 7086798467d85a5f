/* SPDX-License-Identifier: Apache-2.0 */
/*
 * external.h: the plant alone: a vehicle of engine.h whose bridges are commanded by the caller, for
 * an external controller.
 *
 * hubsim_start() brings the vehicle to its initial speed with the firmware's controllers, which
 * give zero torque. hubsim_external_take() replaces them by the caller; from then on
 * hubsim_external_step() is one PWM period. Battery, bus, temperatures, brakes, sensors, driver,
 * anti-lock system and accounts are those that the firmware works with, so both can be compared on
 * the same run. Signals of engine.h that come from a controller are constant.
 *
 * Plain declarations only, as in engine.h. Motor signs: current into the motor is positive, torque
 * is positive where it drives forward.
 */
#ifndef BENCH_EXTERNAL_H
#define BENCH_EXTERNAL_H

#include "bench/engine.h"

enum {
    HUBSIM_BRIDGE_OFF = 0,
    HUBSIM_BRIDGE_PWM = 1,
    HUBSIM_BRIDGE_SHORT = 2,
    HUBSIM_BRIDGE_SHORT_HIGH = 3
};

/* What one wheel's controller decides for a period. */
typedef struct {
    double duty[3];      /* 1: share of the period in which a phase's high side is on; clamped to
                            0 .. 1, rounded to the counts of the PWM timer; for HUBSIM_BRIDGE_PWM */
    double hydraulic_nm; /* N m >= 0 at the wheel; reaches the brake with the next millisecond */
    int32_t bridge;      /* OFF: diodes only; SHORT: the three low sides are on;
                            SHORT_HIGH: the high sides */
    int32_t reserved;    /* 0 */
} hubsim_command_t;

/* One wheel at the top of the count, the boundary of two PWM periods. */
typedef struct {
    double phase_current_a[3];          /* A, in the wires */
    double phase_current_measured_a[3]; /* A, as the converters of the current sensors show it */
    double rotor_turn;                  /* electrical, 0 <= angle < 1 */
    double speed_rad_s;                 /* mechanical */
    double motor_torque_nm;             /* N m, airgap */
    double hydraulic_torque_nm;         /* N m, what the brake can hold now, >= 0 */
    double winding_temperature_c;       /* degC */
    double switch_temperature_c;        /* degC */
    int32_t hall_state;                 /* bit 0 = A, 1 = B, 2 = C */
    int32_t encoder_count;              /* 0 without an encoder */
} hubsim_wheel_t;

/* The vehicle at that instant. */
typedef struct {
    double time_s;                 /* since the start of the run */
    double speed_m_per_s;          /* positive forward */
    double bus_voltage_v;          /* V, at the bridges */
    double bus_voltage_measured_v; /* V, as the converter shows it */
    double battery_voltage_v;      /* V, at the terminals, mean of the last period */
    double battery_current_a;      /* A, positive out of the pack, mean of the last period */
    double drive_demand_nm;        /* N m a wheel, from the driver's pedal */
    double brake_demand_nm;        /* N m a wheel, >= 0 */
    double charge_limit_a;         /* A, what the battery management allows into the pack */
    double discharge_limit_a;      /* A, and out of it */
    int32_t enable;                /* the driver's switch */
    int32_t anti_lock_at_work;     /* motor torque must be zero */
} hubsim_vehicle_t;

/*
 * After hubsim_start(), once. delay_periods: 1: what a step is given acts in the period after it,
 * as the firmware's result does; 0: in the very period.
 */
int hubsim_external_take(hubsim_t *sim, int delay_periods);

/* The wheels that have a motor; 0 before hubsim_start(). */
int hubsim_external_wheels(const hubsim_t *sim);

/* One PWM period. commands: one for each wheel. HUBSIM_ENDED when the run is over. */
int hubsim_external_step(hubsim_t *sim, const hubsim_command_t *commands);

/* State of the vehicle at the top of the count; wheels: space for all. */
int hubsim_external_read(hubsim_t *sim, hubsim_vehicle_t *vehicle, hubsim_wheel_t *wheels);

#endif
