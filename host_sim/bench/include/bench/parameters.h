/* SPDX-License-Identifier: Apache-2.0 */
/*
 * parameters.h: all parameters of the simulation, by name "section.name_unit"; those of one wheel
 * are "wheel0.name_unit" and so on.
 *
 * The members come from the models' own lists (plant/parameter.h), so a name here is the name
 * there. These are the parameters of the plant; those of a controller are its config_t. They are
 * made from the same TOML file, and a test may detune one.
 */
#ifndef BENCH_PARAMETERS_H
#define BENCH_PARAMETERS_H

#include <stdbool.h>

#include "bench/driver.h"
#include "plant/anti_lock.h"
#include "plant/battery.h"
#include "plant/bms.h"
#include "plant/brake_sensor.h"
#include "plant/bus.h"
#include "plant/chassis.h"
#include "plant/encoder.h"
#include "plant/fault.h"
#include "plant/hydraulic_brake.h"
#include "plant/inverter.h"
#include "plant/pedal_sensors.h"
#include "plant/pmsm.h"
#include "plant/sensors.h"
#include "plant/temperature_sensor.h"
#include "plant/thermal.h"
#include "plant/tyre.h"
#include "plant/vehicle.h"
#include "plant/wheel_speed.h"

/* clang-format off */
#define RUN_PARAMETERS(X) \
    X(seed,                       0.0,  9007199254740992.0, "1", "of the sensors' noise") \
    X(initial_speed_m_per_s,   -100.0,  100.0, "m/s", \
      "the vehicle is brought to it before the run begins") \
    X(boots_rolling,              0.0,  1.0,   "", \
      "1: the controllers boot when the run begins, on wheels that turn already; 0: before it, " \
      "at standstill") \
    X(stop_at_standstill,         0.0,  1.0,   "",    "1: the run ends when the vehicle stands") \
    X(record_interval_s,          1e-5, 1e3,   "s",   "distance of recorded rows") \
    X(pieces,                     0.0,  64.0,  "1", \
      "the plant takes every PWM period in so many steps; 0: in one") \
    X(rotor_turn,                 0.0,  1.0,   "1", \
      "electrical angle of the first wheel's rotor at the start") \
    X(rotor_spread_turn,          0.0,  1.0,   "1", \
      "electrical angle between the rotors of neighbouring wheels at the start")

/* Of one wheel alone, on top of what holds for all: X(wheel, name, lowest, highest, unit, text). */
#define ONE_WHEEL_PARAMETERS(X, wheel) \
    X(wheel, hall_stuck_low,       0.0,   7.0,   "",    "as sensors.hall_stuck_low, this wheel") \
    X(wheel, hall_stuck_high,      0.0,   7.0,   "",    "as sensors.hall_stuck_high, this wheel") \
    X(wheel, current_offset_a,    -1e4,   1e4,   "A",   "added to sensors.current_offset_a") \
    X(wheel, brake_torque_loss,   -0.5,   1.0,   "1",   "as brake.torque_loss, this wheel") \
    X(wheel, road_friction,        0.0,   3.0,   "1", \
      "as road.friction, this wheel; 0: no other") \
    X(wheel, winding_rise_k,      -100.0, 300.0, "K", \
      "winding warmer than thermal.winding_temperature_c") \
    X(wheel, winding_sensor_open,    0.0,   1.0,   "",    "as winding_sensor.open, this wheel") \
    X(wheel, winding_sensor_shorted, 0.0,   1.0,   "",    "as winding_sensor.shorted, this wheel") \
    X(wheel, speed_sensor_dead,      0.0,   1.0,   "",    "as wheel_speed.dead, this wheel")
/* clang-format on */

enum { PARAMETERS_WHEELS_MAX = 16 };

#define ONE_WHEEL_MEMBER(wheel, name, lowest, highest, unit, text) double name;
typedef struct {
    ONE_WHEEL_PARAMETERS(ONE_WHEEL_MEMBER, )
} one_wheel_params_t;
#undef ONE_WHEEL_MEMBER

typedef struct {
    RUN_PARAMETERS(PLANT_PARAMETER_MEMBER)
} run_params_t;

typedef struct {
    pmsm_params_t motor;
    inverter_params_t inverter;
    battery_params_t battery;
    bus_params_t bus;
    bms_params_t bms;
    chassis_params_t chassis;
    tyre_params_t tyre;
    vehicle_params_t vehicle;
    road_params_t road;
    hydraulic_brake_params_t brake;
    brake_sensor_params_t brake_sensor;
    pedal_sensors_params_t pedal_sensors;
    sensors_params_t sensors;
    encoder_params_t encoder;
    thermal_params_t thermal;
    winding_sensor_params_t winding_sensor;
    winding_sensor_params_t switch_sensor; /* of the switches */
    wheel_speed_params_t wheel_speed;
    anti_lock_params_t anti_lock;
    driver_params_t driver;
    run_params_t run;
    fault_params_t fault;
    one_wheel_params_t wheel[PARAMETERS_WHEELS_MAX];
} bench_params_t;

typedef struct {
    const char *name; /* "motor.pole_pairs" */
    const char *unit;
    const char *text;
    double lowest, highest;
} parameter_info_t;

int parameters_count(void);

/* 0 <= index < parameters_count() */
parameter_info_t parameters_info(int index);

/* The index of a name, or -1. */
int parameters_find(const char *name);

double parameters_get(const bench_params_t *params, int index);

/* False, and nothing changed, outside the parameter's range (NaN included). */
bool parameters_set(bench_params_t *params, int index, double value);

#endif
