/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sensors.h: measurements of one wheel, with the faults of real sensors.
 *
 * Converter codes are right-aligned 12 bit, as the firmware's port delivers them (controller.h):
 * phase currents around 2048, rising with current into the motor; bus voltage from 0. A coarser
 * converter leaves the low bits zero. All samples are taken at one instant, the boundary of two PWM
 * periods or sampling_delay_s later; where the controller chooses two of three phases, all three
 * are offered. The caller provides the shunt currents at that instant (shunts.h).
 *
 * Halls: sector k = 0 .. 5 begins at edge k and shows 5, 1, 3, 2, 6, 4 (bit 0 = A, 1 = B, 2 = C),
 * sensors 120 degrees apart, in order; hall_lines makes others of them. Misplacement is a parameter
 * of the plant: the controller is configured with hall_edges, without the error.
 */
#ifndef PLANT_SENSORS_H
#define PLANT_SENSORS_H

#include <stdint.h>

#include "plant/parameter.h"
#include "plant/random.h"
#include "plant/vectors.h"

/* clang-format off */
#define SENSORS_PARAMETERS(X) \
    X(current_full_scale_a,   0.1,   1e5,   "A", \
      "current that half the converter's range represents") \
    X(voltage_full_scale_v,   1.0,   1e5,   "V",   "voltage that the whole range represents") \
    X(current_noise_a,        0.0,   1e4,   "A",   "standard deviation") \
    X(bus_voltage_noise_v,    0.0,   1e4,   "V",   "standard deviation") \
    X(current_offset_a,      -1e4,   1e4,   "A",   "of phases a and c; the opposite in b") \
    X(hall_edge_error_deg,    0.0,   30.0,  "deg", \
      "misplacement of the hall edges, electrical, late and early in turn") \
    X(adc_bits,               4.0,   16.0,  "1",   "resolution of every converter") \
    X(hall_edge_0_deg,        0.0,   360.0, "deg", \
      "electrical angle at which sector 0 begins, turning forward") \
    X(hall_edge_1_deg,        0.0,   360.0, "deg", "sector 1") \
    X(hall_edge_2_deg,        0.0,   360.0, "deg", "sector 2") \
    X(hall_edge_3_deg,        0.0,   360.0, "deg", "sector 3") \
    X(hall_edge_4_deg,        0.0,   360.0, "deg", "sector 4") \
    X(hall_edge_5_deg,        0.0,   360.0, "deg", "sector 5") \
    X(hall_lines,             0.0,   15.0,  "", \
      "lines that are inverted: 1 = A, 2 = B, 4 = C, sums; and 8: B and C exchanged") \
    X(current_drift_a_per_s, -1e3,   1e3,   "A/s", \
      "growth of the offset of phases a and c, and of the opposite in b") \
    X(current_a_gain_error,  -0.5,   0.5,   "1", \
      "share of its current that sensor a shows too much") \
    X(current_b_gain_error,  -0.5,   0.5,   "1",   "sensor b") \
    X(current_c_gain_error,  -0.5,   0.5,   "1",   "sensor c") \
    X(bus_gain_error,        -0.5,   0.5,   "1",   "share of the bus voltage shown too much") \
    X(angle_offset_deg,     -30.0,   30.0,  "deg", \
      "electrical, what an angle sensor shows too much") \
    X(angle_error_deg,        0.0,   30.0,  "deg", \
      "electrical, amplitude of an error that an angle sensor has once an electrical turn") \
    X(sampling_delay_s,       0.0,   1e-4,  "s", \
      "converters sample so long after the middle of the low sides' time; 0: in it") \
    X(shunt_settling_s,       0.0,   1e-4,  "s", \
      "of the shunts' amplifiers (shunts.h); 0: currents are measured at all times") \
    X(hall_stuck_low,         0.0,   7.0,   "", \
      "sensors whose line is shorted to ground: 1 = A, 2 = B, 4 = C, sums") \
    X(hall_stuck_high,        0.0,   7.0,   "", \
      "sensors whose line is broken and pulled up, likewise; 7: plug off")
/* clang-format on */

typedef struct {
    SENSORS_PARAMETERS(PLANT_PARAMETER_MEMBER)
} sensors_params_t;

enum { SENSORS_HALL_SECTORS = 6 };

/* Worked out once. */
typedef struct {
    double steps_per_a[3], steps_per_v; /* steps of the converter */
    double middle_steps, highest_step;
    uint32_t codes_per_step; /* a step in 12-bit codes */
    double offset_a[3];
    double current_noise_a, bus_voltage_noise_v;
    double angle_offset_turn, angle_error_turn;
    double edge_turn[SENSORS_HALL_SECTORS];   /* rising */
    uint8_t state_from[SENSORS_HALL_SECTORS]; /* hall state that begins at edge_turn[k] */
} sensors_t;

/* What has gone wrong at one wheel since. */
typedef struct {
    double offset_a; /* of the current sensors: phases a and c, the opposite in b */
    uint8_t hall_stuck_low, hall_stuck_high; /* bit 0 = A, 1 = B, 2 = C; broken wins */
} sensors_fault_t;

typedef struct {
    uint16_t phase_current_code[3];
    uint16_t bus_voltage_code;
    uint16_t rotor_angle_turn; /* 65 536 = one electrical turn */
    uint8_t hall_state;
} sensors_sample_t;

sensors_t sensors_init(const sensors_params_t *params);

/* current: in the wires, or as the shunts show it; theta_turn: electrical, 0 <= theta < 1. Draws
 * from `random` only where there is noise. */
sensors_sample_t sensors_sample(const sensors_t *sensors, const sensors_fault_t *fault,
                                random_t *random, plant_abc_t current_a, double bus_voltage_v,
                                double theta_turn);

/* Hall state alone. */
uint8_t sensors_hall_state(const sensors_t *sensors, double theta_turn);

#endif
