/* SPDX-License-Identifier: Apache-2.0 */
/*
 * variables.h: the inputs and outputs of the controller's two steps by name, in engineering units
 * and raw.
 *
 *     X(name_unit, raw name, type, scale, lowest raw, highest raw, "unit", "meaning")
 *
 * The raw name is the member of controller.h's exchange structs (with a phase's letter in place of
 * an index, an underscore in place of a dot), the raw value the integer the firmware works with.
 * scale says how the two belong together, variables_scale() puts it in numbers: raw = zero +
 * engineering * per_unit. type is what the variable is to a tool: REAL, FLAG or CODE (an integer
 * that stands for something). Everything that offers a controller to other programs reads these
 * lists, so a variable has one name, one unit and one meaning everywhere.
 *
 * Signs as in controller.h: motor torque, current and speed are positive driving forward, braking
 * torques are magnitudes, phase current is positive into the motor.
 */
#ifndef EXCHANGE_VARIABLES_H
#define EXCHANGE_VARIABLES_H

#include <stdbool.h>
#include <stdint.h>

#include "controller/controller.h"

/* clang-format off */
#define EXCHANGE_FAST_INPUTS(X) \
    X(phase_a_a,         phase_current_code_a, REAL, CURRENT_CODE, 0, 4095,  "A", \
      "current into phase a at the sampling instant") \
    X(phase_b_a,         phase_current_code_b, REAL, CURRENT_CODE, 0, 4095,  "A", \
      "current into phase b at the sampling instant") \
    X(phase_c_a,         phase_current_code_c, REAL, CURRENT_CODE, 0, 4095,  "A", \
      "current into phase c at the sampling instant") \
    X(bus_voltage_v,     bus_voltage_code,     REAL, VOLTAGE_CODE, 0, 4095,  "V", \
      "DC bus voltage at the sampling instant") \
    X(rotor_angle_turn,  rotor_angle_turn,     REAL, TURN,         0, 65535, "turn", \
      "electrical angle of the rotor, any number of turns; read with an angle sensor only") \
    X(encoder_count,       encoder_count,       CODE, PLAIN,       0, 65535, "", \
      "free running, four to a line; read with an encoder only") \
    X(encoder_index_count, encoder_index_count, CODE, PLAIN,       0, 65535, "", \
      "the count at the latest index pulse") \
    X(encoder_index,       encoder_index,       FLAG, PLAIN,       0, 1,     "", \
      "an index pulse came since the last period") \
    X(hall_state,        hall_state,           CODE, PLAIN,        0, 7,     "", \
      "bit 0 hall A, bit 1 B, bit 2 C; read with hall sensors only") \
    X(power_stage_fault, power_stage_fault,    FLAG, PLAIN,        0, 1,     "", \
      "gate driver or break input active")

#define EXCHANGE_FAST_OUTPUTS(X) \
    X(duty_a, compare_counts_a, REAL, DUTY,  0, 65535, "1", \
      "share of the period in which the upper switch of phase a is on, from the next " \
      "period on") \
    X(duty_b, compare_counts_b, REAL, DUTY,  0, 65535, "1", \
      "share of the period in which the upper switch of phase b is on, from the next " \
      "period on") \
    X(duty_c, compare_counts_c, REAL, DUTY,  0, 65535, "1", \
      "share of the period in which the upper switch of phase c is on, from the next " \
      "period on") \
    X(bridge, bridge,           CODE, PLAIN, 0, 2,     "", \
      "0 all switches off, 1 pulse-width modulation, 2 the three lower switches on")

#define EXCHANGE_SLOW_INPUTS(X) \
    X(drive_torque_nm, drive_torque_mNm, REAL, MILLI, INT32_MIN, INT32_MAX, "N.m", \
      "driving torque demanded of this wheel, positive forward") \
    X(brake_torque_nm, brake_torque_mNm, REAL, MILLI, 0, INT32_MAX, "N.m", \
      "braking torque demanded of this wheel, motor and hydraulic brake together, magnitude") \
    X(demand_age_s,            demand_age_ms,            REAL, MILLI, 0,         INT32_MAX, "s", \
      "time since the last valid demand") \
    X(bms_charge_current_a,    bms_charge_current_mA,    REAL, MILLI, 0,         INT32_MAX, "A", \
      "what the whole pack takes now, magnitude") \
    X(bms_discharge_current_a, bms_discharge_current_mA, REAL, MILLI, 0,         INT32_MAX, "A", \
      "what the whole pack gives now, magnitude") \
    X(winding_temperature_c, winding_temperature_cC, REAL, CENTI, -30000, 100000, "degC", \
      "of the motor's winding") \
    X(switch_temperature_c, switch_temperature_cC, REAL, CENTI, -30000, 100000, "degC", \
      "of the inverter's switches") \
    X(enable,                  enable,                   FLAG, PLAIN, 0,         1,         "", \
      "the driver has switched the vehicle on") \
    X(abs_active,              abs_active,               FLAG, PLAIN, 0,         1,         "", \
      "the anti-lock system is at work: the motor gets out of its way") \
    X(fault_reset,             fault_reset,              FLAG, PLAIN, 0,         1,         "", \
      "its rising edge acknowledges a latched fault") \
    X(selftest_passed,         selftest_passed,          FLAG, PLAIN, 0,         1,         "", \
      "the hardware's power-up checks have passed") \
    X(config_accepted,         config_accepted,          FLAG, PLAIN, 0,         1,         "", \
      "the configuration was accepted at boot")

#define EXCHANGE_SLOW_OUTPUTS(X) \
    X(motor_torque_command_nm, motor_torque_command_mNm, REAL, MILLI, INT32_MIN, INT32_MAX, "N.m", \
      "airgap torque the current loop is asked for now, signed") \
    X(motor_torque_estimate_nm, motor_torque_estimate_mNm, REAL, MILLI, INT32_MIN, INT32_MAX, "N.m", \
      "airgap torque worked out from measured currents, signed") \
    X(hydraulic_torque_nm, hydraulic_torque_mNm, REAL, MILLI, INT32_MIN, INT32_MAX, "N.m", \
      "command to the hydraulic brake, magnitude") \
    X(electric_brake_available_nm, electric_brake_available_mNm, REAL, MILLI, INT32_MIN, INT32_MAX, "N.m", \
      "braking torque the motor could take over now, magnitude") \
    X(speed_rad_per_s, speed_mrad_s, REAL, MILLI, INT32_MIN, INT32_MAX, "rad/s", \
      "mechanical speed, estimated") \
    X(current_d_a, i_d_mA, REAL, MILLI, INT32_MIN, INT32_MAX, "A", \
      "direct-axis current, peak phase value, measured and low-passed") \
    X(current_q_a, i_q_mA, REAL, MILLI, INT32_MIN, INT32_MAX, "A", \
      "quadrature-axis current, peak phase value, measured and low-passed") \
    X(bus_voltage_v, bus_voltage_mV, REAL, MILLI, INT32_MIN, INT32_MAX, "V", \
      "DC bus voltage, measured") \
    X(bus_current_a, bus_current_mA, REAL, MILLI, INT32_MIN, INT32_MAX, "A", \
      "DC bus current, estimated, positive out of the battery") \
    X(torque_reason, torque_reason, CODE, PLAIN, 0, 255, "", \
      "what limits the motor torque; 0: none") \
    X(available_reason, available_reason, CODE, PLAIN, 0, 255, "", \
      "what bounds the electric braking torque that is available") \
    X(hydraulic_reason, hydraulic_reason, CODE, PLAIN, 0, 255, "", \
      "not 0: motor and hydraulic brake together cannot meet the demand") \
    X(fault_reason, fault_reason, CODE, PLAIN, 0, 255, "", \
      "the latched fault; 0: healthy") \
    X(mode, mode, CODE, PLAIN, 0, 6, "", \
      "0 boot, 1 self-test, 2 offset calibration, 3 ready, 4 run, 5 limp, 6 fault") \
    X(stop_lamp, stop_lamp, FLAG, PLAIN, 0, 1, "", \
      "the stop lamp is to be lit") \
    X(standstill, standstill, FLAG, PLAIN, 0, 1, "", \
      "nothing says that the wheel turns, and no speed that was seen is unaccounted for")
/* clang-format on */

#define EXCHANGE_COUNT_LINE(name, raw, type, scale, lowest, highest, unit, text) +1
enum {
    EXCHANGE_FAST_INPUT_COUNT = 0 EXCHANGE_FAST_INPUTS(EXCHANGE_COUNT_LINE),
    EXCHANGE_FAST_OUTPUT_COUNT = 0 EXCHANGE_FAST_OUTPUTS(EXCHANGE_COUNT_LINE),
    EXCHANGE_SLOW_INPUT_COUNT = 0 EXCHANGE_SLOW_INPUTS(EXCHANGE_COUNT_LINE),
    EXCHANGE_SLOW_OUTPUT_COUNT = 0 EXCHANGE_SLOW_OUTPUTS(EXCHANGE_COUNT_LINE)
};
#undef EXCHANGE_COUNT_LINE

typedef enum {
    EXCHANGE_PORT_FAST_INPUT = 0,
    EXCHANGE_PORT_FAST_OUTPUT = 1,
    EXCHANGE_PORT_SLOW_INPUT = 2,
    EXCHANGE_PORT_SLOW_OUTPUT = 3
} exchange_port_t;
enum { EXCHANGE_PORTS = 4 };

typedef enum { EXCHANGE_REAL, EXCHANGE_FLAG, EXCHANGE_CODE } exchange_type_t;
typedef enum {
    EXCHANGE_PLAIN,        /* the number itself */
    EXCHANGE_MILLI,        /* thousandths */
    EXCHANGE_CENTI,        /* hundredths */
    EXCHANGE_TURN,         /* 65 536 to a turn, wrapping */
    EXCHANGE_CURRENT_CODE, /* converter codes around 2048 */
    EXCHANGE_VOLTAGE_CODE, /* converter codes from 0 */
    EXCHANGE_DUTY          /* timer counts of a period */
} exchange_scale_t;

typedef struct {
    const char *name, *raw_name, *unit, *text;
    exchange_type_t type;
    exchange_scale_t scale;
    int32_t lowest_raw, highest_raw;
} variable_info_t;

/* 0 <= index < variables_count(port) */
int variables_count(exchange_port_t port);
variable_info_t variables_info(exchange_port_t port, int index);

/* raw = zero + engineering * per_unit, with the full scales of a configuration. */
typedef struct {
    double zero, per_unit;
} variables_affine_t;
variables_affine_t variables_affine(exchange_scale_t scale, const config_t *config);

/* To the nearest raw value, halves up; what lies outside the raw range saturates as a converter
 * does, an angle wraps. A value that is no number becomes the lowest raw value; ask before. */
int32_t variables_to_raw(const variable_info_t *info, variables_affine_t affine, double value);

double variables_from_raw(variables_affine_t affine, int32_t raw);

#endif
