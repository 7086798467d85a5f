/* SPDX-License-Identifier: Apache-2.0 */
/*
 * wheel.h: one in-wheel drive: a complete controller and the motor, bridge, brake and sensors it
 * works with.
 *
 * Everything between the firmware's two step functions and the plant's models is here, the timing
 * above all:
 *
 *     sensors at t_n -> controller_fast_step() -> the bridge does it from t_{n+1} to t_{n+2}
 *
 * wheel_slow() is the millisecond, wheel_sample() the beginning of a PWM period, wheel_step() the
 * plant in it; the bench calls them and closes the loop over battery and vehicle. The exchange
 * structs are carried by assignment, unless a wheel has a coupling of its own: then something else
 * that holds a controller stands there, the whole application on its simulated board (board.h). The
 * two steps may also be executed by another processor (processor.h).
 */
#ifndef BENCH_WHEEL_H
#define BENCH_WHEEL_H

#include <stdint.h>

#include "bench/injection.h"
#include "bench/link.h"
#include "bench/parameters.h"
#include "bench/processor.h"
#include "controller/controller.h"
#include "plant/bms.h"
#include "plant/broken_bridge.h"
#include "plant/random.h"
#include "plant/sensor_fault.h"
#include "plant/switching.h"
#include "plant/temperature_sensor.h"
#include "plant/wheel_speed.h"

/* What all wheels of a bench have in common, worked out from the parameters. */
typedef struct {
    const bench_params_t *params;
    const config_t *config;
    sensors_t sensors;
    double step_s; /* of the plant: a PWM period or an equal part of it */
    double duty_per_count;
    bool config_damaged; /* the background check has found it */
} wheel_world_t;

/* An external controller in place of the two steps. */
typedef struct {
    void *context;
    /* The top of the count: what the sensors see; returns what the bridge does from now to the next
     * top. */
    fast_output_t (*period)(void *context, const fast_input_t *in);
    slow_output_t (*millisecond)(void *context, const slow_input_t *in);
    /* Before each millisecond: the faults that this wheel has now, NULL: none. NULL: a controller
     * that can have none. */
    void (*break_down)(void *context, const fault_params_t *fault);
} wheel_coupling_t;

/* Energies and impulses since the start of the run. Heat and work in J. */
typedef struct {
    double copper_j, iron_j, conduction_j, diode_j, switching_j;
    double dc_j;                  /* taken from the bus */
    double torque_impulse_nms;    /* airgap torque */
    double hydraulic_impulse_nms; /* torque of the brake, positive against forward motion */
    double
        shaft_j; /* work of the motor at the wheel, bearing friction taken off, positive driving */
    double hydraulic_j, bearing_j;
} wheel_totals_t;

/* How the wheel moves and what it does to the road (motion.h). */
typedef struct {
    double speed_rad_s; /* mechanical */
    double acceleration_rad_s2;
    double load_n;
    double force_n; /* of the tyre, positive forward */
    tyre_state_t tyre;
} wheel_motion_t;

typedef struct {
    /* The firmware. */
    controller_t controller;
    fast_setpoint_t to_fast;
    slow_output_t slow;
    fast_output_t active;             /* what the bridge does in this period */
    fast_output_t next;               /* from the next one on */
    const wheel_coupling_t *coupling; /* NULL after wheel_init(): the two steps, called directly */
    const processor_t *processor;     /* NULL after wheel_init(): this one */
    /* The plant. */
    pmsm_t machine;
    pmsm_state_t rotor;
    encoder_shaft_t shaft;
    hydraulic_brake_state_t brake;
    double brake_capacity_nm;
    brake_sensor_state_t brake_sensor;
    thermal_t winding, switches; /* with housing and heat sink */
    inverter_t inverter;         /* at the switches' temperature */
    switching_t switching;       /* the same, edge by edge */
    wheel_motion_t motion;
    double friction; /* of tyre and road */
    random_t random;
    sensors_fault_t fault;
    sensor_fault_t broken_sensors;
    bool is_faulty;          /* faults of fault.h concern this wheel */
    bool has_broken_sensors; /* of fault.h */
    bool has_broken_bridge;
    bool has_broken_program; /* injection.h */
    broken_bridge_t bridge;
    injection_t injection;
    bool has_broken_link; /* link.h */
    link_t link;
    plant_abc_t sampled_a; /* what stood in front of the current converters at the last sample */
    shunts_t shunts;
    plant_ab_t at_top; /* A, at the last top of the count */
    temperature_sensor_t winding_sensor, switch_sensor;
    wheel_speed_t ring;
    double zone_a;
    double peak_a2; /* square of the longest current vector, active short circuits apart */
    int index;
    /* The accounts. */
    wheel_totals_t totals;
    double heat_winding_j, heat_iron_j, heat_switches_j; /* since the last millisecond */
    reason_t first_fault;
    double first_fault_s;
} wheel_t;

/* What a wheel did to bus and axle in one period. */
typedef struct {
    double dc_j;
    double airgap_nms;           /* impulse of the airgap torque */
    double viscous_nms;          /* of viscous friction, sign of speed */
    double friction_capacity_nm; /* brake and bearing */
} wheel_flow_t;

wheel_world_t wheel_world(const bench_params_t *params, const config_t *config);

void wheel_init(wheel_t *wheel, const wheel_world_t *world, int index);

/* Start of a run: temperatures, brake and accounts from the parameters; controller and rotor are
 * unchanged. */
void wheel_begin(wheel_t *wheel, const wheel_world_t *world);

/* After a change of parameters: everything of the wheel that was worked out from them, states
 * untouched. A temperature without heat capacity is no state but follows its parameter. */
void wheel_refresh(wheel_t *wheel, const wheel_world_t *world);

/* What the millisecond brings to every wheel alike. */
typedef struct {
    double drive_nm, brake_nm;
    double charge_limit_a, discharge_limit_a, peak_charge_a;
    double pack_voltage_v, pack_current_a;
    bool pack_current_given;
    bms_contactor_t contactor;
    double demand_age_s;
    double current_drift_a; /* what the current sensors' offset has grown by */
    double speed_rad_s;     /* mechanical */
    double bus_voltage_v;
    double time_s;
    drive_direction_t direction;
    bool enable, abs_active, fault_reset;
    double abs_motor_share; /* 0 .. 1, that the anti-lock system leaves the motor */
    reason_t demand_reason; /* of the pedals */
    double pedal_nm;        /* what the brake system makes of the pedal without a valid command */
} wheel_order_t;

void wheel_slow(wheel_t *wheel, const wheel_world_t *world, const wheel_order_t *order);

/* A PWM period begins: sensors, the firmware's fast step, and the bridge does what was commanded a
 * period ago. */
void wheel_sample(wheel_t *wheel, const wheel_world_t *world, double bus_voltage_v);

/* The plant for world->step_s. speed_rad_s: mechanical, expected in the middle of the step. */
wheel_flow_t wheel_step(wheel_t *wheel, const wheel_world_t *world, double speed_rad_s,
                        double bus_voltage_v);

/* Result of the vehicle model: speed in the middle of the period and the active share of friction,
 * -1 .. 1. */
void wheel_settle(wheel_t *wheel, const wheel_world_t *world, const wheel_flow_t *flow,
                  double speed_rad_s, double friction_used);

#endif
