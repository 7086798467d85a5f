/* SPDX-License-Identifier: Apache-2.0 */
/*
 * config.h: config_t, all parameters of one controller: board, motor, battery and vehicle.
 *
 * One constant image: written by tools/regen_table from a TOML file, linked into its own flash
 * section, replaceable without rebuilding the firmware, refused in BOOT unless config_validate()
 * accepts it. This header alone defines the layout: C structures, validator
 * and Python generator are made from the lists below, one line a field:
 *
 *     X(name, smallest accepted value, largest accepted value, "unit",
 *       "meaning, meaning of zero, effect of raising")
 *
 * Every scalar is an int32_t and every map an even number of int16_t, so there is no padding on any
 * machine. The unit is part of the name:
 * _mNm, _mA, _mV, _mW, _uOhm, _nH, _nWb, _cC (hundredths of a degree Celsius), _mJ_K, _mK_W,
 * _mrad_s (mechanical), _turn (65 536 = one electrical turn), _pu_qN (per unit, fixed point with N
 * fraction bits). Per-unit bases: firmware/config/include/config/bases.h.
 *
 * Limits are those of ONE motor and its share of the battery (the pack's current divided by the
 * driven wheels). Braking torques are magnitudes >= 0; signed torques drive forward when positive.
 */
#ifndef CONFIG_CONFIG_H
#define CONFIG_CONFIG_H

#include <stdint.h>

#define CONFIG_MAGIC 0x434F4648 /* "HFOC" in memory, little endian */
#define CONFIG_FORMAT_VERSION 23
#define CONFIG_NAME_LENGTH 32
#define CONFIG_HALL_EDGES 6
#define CONFIG_PEDAL_CHANNELS 4    /* accelerator a and b, brake pedal a and b */
#define CONFIG_WHEELS 4            /* in the order of vehicle.wheel_position */
#define CONFIG_CAN_BASE_STEP 32    /* of vehicle.can_base */
#define CONFIG_CAN_IDENTIFIERS 160 /* from vehicle.can_base on: those of the messages are below */
#define CONFIG_SERVICE_BASE_STEP 8 /* of service.can_base */
#define CONFIG_SERVICE_KEY_WORDS 4
#define CONFIG_CURVE_POINTS 64      /* of a temperature sensor, hal/analog_curve.h */
#define CONFIG_REGEN_POINTS_MAX 800 /* such as 47 speeds at 17 temperatures, or 65 at 12 */
/* such as 31 torques and 19 speeds at 2 temperatures */
#define CONFIG_CURRENT_MAP_POINTS_MAX 1178
#define CONFIG_FLUX_MAP_POINTS_MAX 290 /* such as 17 d by 17 q currents, or 29 by 10 */

#define CONFIG_MOTOR_SPMSM 0
#define CONFIG_MOTOR_IPMSM 1

#define CONFIG_STRATEGY_PARALLEL_RATIO 0
#define CONFIG_STRATEGY_PARALLEL_FREE_TRAVEL 1
#define CONFIG_STRATEGY_SERIES_OPTIMAL 2

/* an absolute electrical angle from the port: resolver, or ideal in simulation */
#define CONFIG_ROTOR_ANGLE 0
#define CONFIG_ROTOR_HALL 1    /* three hall sensors */
#define CONFIG_ROTOR_ENCODER 2 /* incremental encoder with index */

/* a temperature limit of this or more is switched off */
#define CONFIG_TEMPERATURE_OFF_cC 30000

#define CONFIG_PEDAL_PROPORTIONAL 0
#define CONFIG_PEDAL_FREE_TRAVEL 1

/* clang-format off */

#define CONFIG_MOTOR_FIELDS(X) \
    X(type, 0, 1, "", "0 surface magnets (L_d = L_q), 1 interior magnets") \
    X(pole_pairs, 1, 60, "1", "electrical turns in a mechanical turn") \
    X(phase_resistance_uOhm, 10, 100000000, "uOhm", "one phase, at reference_temperature_cC") \
    X(reference_temperature_cC,              -5000,     15000,      "cC", \
      "winding temperature of phase_resistance_uOhm") \
    X(resistance_coefficient_ppm_K,          0,         10000,      "ppm/K", \
      "rise of resistance with temperature; copper 3930") \
    X(d_inductance_nH,                       100,       1000000000, "nH",     "direct axis") \
    X(q_inductance_nH,                       100,       1000000000, "nH",     "quadrature axis") \
    X(flux_linkage_nWb,                      1000,      2000000000, "nWb", \
      "peak phase flux linkage of the magnets (amplitude-invariant)") \
    X(flux_coefficient_ppm_K,                -10000,    0,          "ppm/K", \
      "fall of the flux with temperature, magnets at winding temperature; NdFeB -1100; 0: " \
      "constant") \
    X(iron_loss_resistance_mOhm,             0,         2000000000, "mOhm", \
      "constant part of R_i = a0 + a1 omega_e; both parts 0: no iron loss") \
    X(iron_loss_resistance_slope_nOhm_s,     0,         2000000000, "nOhm s", \
      "part of R_i proportional to electrical speed") \
    X(friction_torque_mNm, 0, 1000000, "mNm", "Coulomb friction of bearings and seals") \
    X(viscous_friction_uNm_s,                0,         1000000000, "uNm s", \
      "friction proportional to mechanical speed") \
    X(rated_torque_mNm,                      10,        1638200,    "mNm",    "continuous torque") \
    X(max_torque_mNm,                        10,        1638200,    "mNm", \
      "largest torque in either direction; Demand carries no more for driving") \
    X(max_power_mW,                          1000,      1000000000, "mW", \
      "largest electromagnetic power in either direction") \
    X(max_phase_current_mA,                  100,       3000000,    "mA",     "peak") \
    X(max_speed_mrad_s,                      1000,      5000000,    "mrad/s", \
      "driving torque fades out here; braking torque does not") \
    X(speed_fade_share_q15,                  0,         16384,      "1", \
      "last part of the speed range over which driving torque fades out; 0: a step at its end; " \
      "default 1/32") \
    X(derate_winding_temperature_cC,         0,         30000,      "cC", "start of the derating") \
    X(max_winding_temperature_cC,            1000,      30000,      "cC", \
      "end of the derating: torque limit zero")

#define CONFIG_DRIVE_FIELDS(X) \
    X(current_full_scale_mA,                 1000,      4000000,    "mA", \
      "base of current: half the range of the converter") \
    X(voltage_full_scale_mV,                 5000,      2000000,    "mV", \
      "base of voltage: the whole range of the converter") \
    X(pwm_frequency_Hz,                      4000,      100000,     "Hz", \
      "rate of the fast loop; base of speed is a sixteenth of it") \
    X(dead_time_ns, 0, 10000, "ns", "between the two switches of a leg") \
    X(diode_drop_mV,                         0,         5000,       "mV", \
      "forward voltage of the freewheeling diodes, opposes the current during the dead time") \
    X(min_pulse_ns,                          0,         25000,      "ns", \
      "half of the shortest low-side pulse: sampling window of the shunts") \
    X(derate_switch_temperature_cC,          0,         30000,      "cC", "start of the derating") \
    X(max_switch_temperature_cC,             1000,      30000,      "cC", \
      "end of the derating: torque limit zero") \
    X(device_voltage_mV,                     1000,      2000000,    "mV", \
      "rating of the bridge's devices and capacitors, which the bus must never reach; not " \
      "given: battery.overvoltage_trip_mV") \
    X(bus_capacitance_nF,                    0,         1000000000, "nF", \
      "bus capacitors of this bridge; 0: unknown, a short circuit ends only without current") \
    X(loss_per_ampere_uW_A,                  0,         2000000000, "uW/A",   "of the bridge") \
    X(loss_resistance_uOhm,                  0,         100000000,  "uOhm",   "of the switches") \
    X(offset_a_q4,                           0,         65520,      "code/16", \
      "stored zero-current code of phase a, times 16: for a start on a wheel too fast to measure " \
      "it; default the middle, 32768") \
    X(offset_b_q4,                           0,         65520,      "code/16", "same, phase b") \
    X(offset_c_q4,                           0,         65520,      "code/16", "same, phase c")

#define CONFIG_CURRENT_LOOP_FIELDS(X) \
    X(bandwidth_Hz,                          10,        10000,      "Hz", \
      "closed loop, first order after 1.5 periods of delay; determines the gains below, the " \
      "reference prefilter and the current predictor") \
    X(proportional_d_pu_q16,                 1,         1048576,    "pu", \
      "k_i / (1 - exp(-R T / L_d)), volts per ampere; raising: faster, less damped") \
    X(proportional_q_pu_q16,                 1,         1048576,    "pu", \
      "k_i / (1 - exp(-R T / L_q)), volts per ampere; raising: faster, less damped") \
    X(integral_d_pu_q24,                     1,         16777216,   "pu", \
      "a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the " \
      "regulator's zero on the winding's pole") \
    X(integral_q_pu_q24,                     1,         16777216,   "pu", \
      "a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the " \
      "regulator's zero on the winding's pole") \
    X(inductance_d_pu_q16,                   1,         1048576,    "pu", \
      "omega_base L_d I_base / V_base, cross-coupling") \
    X(inductance_q_pu_q16,                   1,         1048576,    "pu", \
      "omega_base L_q I_base / V_base, cross-coupling") \
    X(flux_pu_q16, 1, 1048576, "pu", "omega_base psi / V_base, back-EMF") \
    X(modulation_limit_pu_q15,               8192,      32767,      "pu", \
      "largest |u| over u_dc/sqrt(3); below 1 keeps the sampling window") \
    X(modulation_target_pu_q15,              16384,     32112,      "pu", \
      "|u| regulated by field weakening, over the radius of that circle; the remaining " \
      "voltage is for the loop's dynamics; raising: more torque at high speed, slower torque " \
      "changes; default 0.9689") \
    X(modulation_reserve_pu_q15,             0,         3276,       "pu", \
      "distance of |u| below the target in the torque limits, so that field weakening only " \
      "trims; default 1/128 of the target") \
    X(max_current_pu_q15, 164, 32767, "pu", "largest |i| of a current reference") \
    X(field_weakening_gain_pu_q15,           0,         32767,      "pu", \
      "current per unit of excess squared voltage and period; 0: no field weakening; " \
      "raising: faster, less damped") \
    X(field_weakening_current_pu_q15,        0,         32767,      "pu", \
      "largest demagnetising current of field weakening") \
    X(dead_time_zone_pu_q15,                 128,       32767,        "pu", \
      "current below which the dead-time compensation is proportional, at the middle of " \
      "the battery's range; proportional to the bus voltage")

#define CONFIG_ROTOR_FIELDS(X) \
    X(sensor,                                0,         2,          "", \
      "0 absolute electrical angle, 1 three hall sensors, 2 incremental encoder with index") \
    X(pll_bandwidth_Hz,                      1,         1000,       "Hz", \
      "bandwidth of the angle tracking loop; informative, the gains below realise it") \
    X(pll_proportional_q16,                  1,         65536,      "1", \
      "share of the angle error corrected in one PWM period") \
    X(pll_integral_q24,                      1,         16777216,   "1", \
      "share of the angle error added to the speed in one PWM period") \
    X(encoder_counts,                        0,         65536,      "1", \
      "counts in a mechanical turn, four to a line; 0: no encoder") \
    X(encoder_index_turn, 0, 65535, "turn", "electrical angle at the index pulse") \
    X(encoder_index_tolerance_counts,        0,         1024,       "1", \
      "largest distance of an index pulse from its expected count: the width of the pulse") \
    X(encoder_reversed, 0, 1, "", "1: the count falls when turning forward") \
    X(observer_speed_mrad_s,                 1,         5000000,    "mrad/s", \
      "mechanical, from which the EMF observer watches the sensor and takes over from it") \
    X(observer_takeover, 0, 1, "", "1: it does; 0: it is only reported") \
    X(hall_lines,                            0,         15,         "", \
      "bits 0 to 2: level of A, B, C inverted; bit 3: then B and C exchanged; 0: 120 degrees " \
      "apart, in order; 2, 10: 60 degrees apart")

#define CONFIG_HALL_ARRAY(Y) \
    Y(edge_turn, CONFIG_HALL_EDGES,          0,         65535,      "turn", \
      "electrical angle at which sector k begins when turning forward")

#define CONFIG_BATTERY_FIELDS(X) \
    X(driven_wheels,                         1,         16,         "1", \
      "motors that share the pack; limits below are one motor's share") \
    X(pack_share_q15,                        0,         32768,      "1", \
      "this motor's share of the currents that the management allows the pack; 0: the motors are " \
      "alike, 1/driven_wheels") \
    X(max_charge_current_mA,                 0,         2000000,    "mA", \
      "0: no regeneration into the battery") \
    X(max_discharge_current_mA,              100,       2000000,    "mA",     "") \
    X(foldback_voltage_mV,                   1000,      2000000,    "mV", \
      "start of the charge current fold-back") \
    X(max_voltage_mV,                        1000,      2000000,    "mV", \
      "end of the charge current fold-back: limit zero") \
    X(min_voltage_mV,                        1000,      2000000,    "mV", \
      "end of the discharge current fold-back: limit zero") \
    X(discharge_foldback_voltage_mV,         1000,      2000000,    "mV", \
      "start of the discharge current fold-back; default as far above min_voltage_mV as " \
      "foldback_voltage_mV is below max_voltage_mV") \
    X(resistance_uOhm,                       0,         100000000,  "uOhm", \
      "series resistance of the pack over this motor's share: voltage per ampere of one motor " \
      "when all motors take their shares; 0: not counted, the fold-back then overshoots its line") \
    X(current_filter_ms,                     0,         10000,      "ms", \
      "longest time constant of the current that the management reports: sensors of the motor " \
      "are compared with it over eight times this; counts only where it reports one; default 2 s") \
    X(overvoltage_trip_mV,                   1000,      2000000,    "mV", \
      "bridge goes to its safe state") \
    X(undervoltage_trip_mV,                  500,       2000000,    "mV", \
      "bridge goes to its safe state")

#define CONFIG_BRAKE_FIELDS(X) \
    X(strategy,                              0,         2,          "", \
      "0 parallel_ratio, 1 parallel_free_travel, 2 series_optimal") \
    X(parallel_electric_share_q15,           0,         32767,      "1", \
      "electric part of the whole demand (parallel_ratio)") \
    X(electric_rated_torque_mNm,             0,         20000000,   "mNm", \
      "electric torque above which the hydraulic brake adds torque (parallel strategies)") \
    X(max_hydraulic_torque_mNm,              0,         3276700,    "mNm", \
      "0: no hydraulic brake commanded by this controller; WheelBrake carries no more") \
    X(hydraulic_dead_time_ms,                0,         250,        "ms", \
      "from a changed command until the hydraulic brake begins to move") \
    X(hydraulic_time_constant_ms,            0,         2000,       "ms", \
      "first-order lag of the hydraulic torque after the dead time; 0: none") \
    X(hydraulic_rate_mNm_s,                  100,       2000000000, "mNm/s", \
      "fastest change of hydraulic torque") \
    X(hydraulic_timeout_ms,                  0,         1000,       "ms", \
      "reports of the measured hydraulic torque that are missing for longer are not used; " \
      "0: none is used; default 70") \
    X(hydraulic_report_delay_ms,             0,         40,         "ms", \
      "from the hydraulic torque to its report; default 10") \
    X(hydraulic_gain_band_q15,               0,         16384,      "1", \
      "the gain of the hydraulic brake is learned within 1 -+ this; 0: not learned; default 0.2") \
    X(hydraulic_tolerance_mNm,               1,         20000000,   "mNm", \
      "four standard deviations of the noise of a report; farther from what the commands " \
      "explain it shows a wrong brake; default 1.25 % of max_hydraulic_torque_mNm") \
    X(bridging_time_ms,                      0,         10000,      "ms", \
      "in which motor torque above a fallen deferrable limit goes down to a tenth, with feedback " \
      "at most twice as long; 0: at once; default hydraulic_dead_time_ms and 2.3 " \
      "hydraulic_time_constant_ms") \
    X(loss_braking,                          0,         1,          "", \
      "1: where the battery takes nothing, the motor brakes with what its own losses take; " \
      "default 1") \
    X(blend_out_start_mrad_s,                 0,         1000000,    "mrad/s", \
      "electric braking starts to fade below this speed") \
    X(blend_out_end_mrad_s,                   0,         1000000,    "mrad/s", \
      "no electric braking below this speed") \
    X(torque_rate_mNm_s,                     100,       2000000000, "mNm/s", \
      "rate limit of the motor torque command") \
    X(shortfall_band_mNm,                    1,         1000000,    "mNm", \
      "shortfall of motor torque tolerated before the hydraulic brake adds it; default 5 % of " \
      "motor.max_torque_mNm") \
    X(demand_timeout_ms,                     5,         1000,       "ms", \
      "largest age of a demand; an older one has timed out; default 100") \
    X(motor_arrival_ms,                      1,         1000,       "ms", \
      "torque that the motor reaches within this time counts as available; raising: the " \
      "hydraulic brake adds torque later for a motor short of voltage; default 100") \
    X(abs_hold_ms,                           0,         10000,      "ms", \
      "time without electric braking after an anti-lock intervention; default 300") \
    X(torque_growth_end_q15,                 16384,     32767,      "1", \
      "squared modulation index at which the torque no longer grows; default 0.96") \
    X(torque_growth_slope_q9,                512,       65535,      "1", \
      "share of torque_rate_mNm_s per unit of that square below its end; raising: full rate " \
      "up to a higher modulation index; default 1/0.02") \
    X(stop_lamp_on_mm_s2,                    100,       20000,      "mm/s^2", \
      "deceleration without a braking demand above which the stop lamp is lit; default 1300") \
    X(stop_lamp_off_mm_s2,                   0,         20000,      "mm/s^2", \
      "deceleration below which it is switched off; default 700") \
    X(stop_lamp_filter_log2,                 0,         10,         "", \
      "time constant of its low-passes of speed and of deceleration, 2^this ms; default 6")

#define CONFIG_VEHICLE_FIELDS(X) \
    X(wheel_radius_um,                       10000,     2000000,    "um",     "rolling radius") \
    X(mass_g,                                1000,      100000000,  "g", \
      "the driven wheels share it in the estimate of the road") \
    X(wheel_position,                        0,         3,          "", \
      "address on CAN: 0 front left, 1 front right, 2 rear left, 3 rear right") \
    X(can_base,                              0,         1856,       "", \
      "identifier of Demand for the front left wheel, the lowest of all; a multiple of 32; " \
      "default 256")

#define CONFIG_DRIVER_FIELDS(X) \
    X(lost_hold_ms,                          0,         10000,      "ms", \
      "a braking demand is kept this long after it counts as lost; default 300") \
    X(no_other_brake,                        0,         1,          "", \
      "1: no brake but those commanded here: a lost braking demand is kept until standstill") \
    X(direction_change_mrad_s,               0,         1000000,    "mrad/s", \
      "a wheel that turns faster against a drive direction refuses it; default 3 km/h") \
    X(hold_torque_mNm,                       0,         3276700,    "mNm", \
      "hydraulic torque that holds the vehicle at standstill until it drives off; 0: none") \
    X(hold_release_ms,                       10,        10000,      "ms", \
      "from the driving demand until the hold is gone at the latest, unless the vehicle rolls " \
      "back; default 1000") \
    X(largest_drive_mNm,  1, 20000000, "mNm", "a Demand beyond it is refused: README of comms") \
    X(largest_brake_mNm,  1, 20000000, "mNm", "a Demand beyond it is refused: README of comms") \
    X(demand_rise_ms,     0, 1000, "ms", "from zero to the largest, faster is refused; 0: none") \
    X(demand_lost_frames, 0, 3,    "1",  "Demand frames in a row that may be missing; default 2")

#define CONFIG_PEDALS_FIELDS(X) \
    X(accelerator_channels,   0,   2,        "1",   "0: the driving demand comes by CAN") \
    X(brake_channels,         0,   2,        "1",   "0: the braking demand comes by CAN") \
    X(interpretation,         0,   1,        "",    "brake pedal: 0 proportional, 1 free travel") \
    X(drive_torque_mNm,       0,   1638200,  "mNm", \
      "whole accelerator, wheel of share 1; default motor.max_torque_mNm") \
    X(lift_off_torque_mNm,    0,   1638200,  "mNm", \
      "braking torque of the released accelerator, wheel of share 1; 0: it coasts") \
    X(lift_off_travel_q15,    328, 16384,    "1", \
      "share of the accelerator over which lift-off braking fades out; default 0.15") \
    X(brake_torque_mNm,       0,   3276600,  "mNm", \
      "whole brake pedal, motor and hydraulic, wheel of share 1; default both limits' sum, " \
      "within the range") \
    X(free_travel_q15,        328, 32440,    "1", \
      "share of the brake pedal that is the friction brake's free travel; default 0.3") \
    X(free_travel_torque_mNm, 0,   3276600,  "mNm", \
      "braking torque at its end; default brake.electric_rated_torque_mNm") \
    X(dead_band_q15,          164, 8192,     "1",   "travel of a released pedal; default 0.05") \
    X(difference_q15,         328, 16384,    "1", \
      "of the travel: two channels farther apart are implausible; default 0.1") \
    X(fault_time_ms,          1,   1000,     "ms", \
      "qualify and heal time of a channel that is implausible or out of range; default 100") \
    X(override_q15,           0,   32768,    "1", \
      "accelerator beyond it with the brake pressed must be released; 1: never; default 0.25") \
    X(other_wheels,           0,   15,       "",    "bit of each wheel position to send Demand to")

/* Channels: accelerator a and b, brake pedal a and b; ratios are of the sensors' supply. */
#define CONFIG_PEDALS_ARRAY(Y) \
    Y(lowest_q15,      CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "below: shorted to ground, or open") \
    Y(highest_q15,     CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "above: shorted to the supply") \
    Y(released_q15,    CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "ratio at 0 % travel") \
    Y(pressed_q15,     CONFIG_PEDAL_CHANNELS, 0, 32768, "1", "ratio at 100 % travel") \
    Y(drive_share_q15, CONFIG_WHEELS,         0, 32768, "1", "of drive and lift-off torque") \
    Y(brake_share_q15, CONFIG_WHEELS,         0, 32768, "1", "of the braking torque")

#define CONFIG_SERVICE_FIELDS(X) \
    X(can_base,                              0,         2040,       "", \
      "identifier of XCP commands to the front left wheel, then those of the others, then of the " \
      "four answers; a multiple of 8 above all messages; 0: no XCP on CAN; default 2032")

#define CONFIG_CAN_FIELDS(X) \
    X(vesc_status,                           0,         250,        "", \
      "VESC controller id of the front left wheel in its status frames, those of the others " \
      "follow: README of comms; 0: no such frame is sent, default")

/* Limits, +- as a data sheet gives them; the standard uncertainty is 1/sqrt(3) of each. Only
 * motor_torque_uncertainty_mNm depends on them. */
#define CONFIG_TOLERANCE_FIELDS(X) \
    X(magnet_flux_q15,                       0,         16384,      "1", \
      "of motor.flux_linkage_nWb, magnet temperature included; default 0.05") \
    X(inductance_q15,                        0,         32768,      "1", \
      "of each inductance: reluctance torque; default 0.2") \
    X(drag_q15,                              0,         32768,      "1", \
      "of the torque that iron loss and friction take; default 0.2") \
    X(current_gain_q15,                      0,         16384,      "1", \
      "of the gain that all current sensors have in common; default 0.02") \
    X(rotor_angle_rad_q15,                   0,         16384,      "rad", \
      "of the electrical angle; default 3 degrees")

#define CONFIG_MODES_FIELDS(X) \
    X(limp_drive_share_q15,                  0,         32767,      "1", \
      "share of motor.max_torque_mNm enabled for driving in LIMP, after a warning; braking is " \
      "not reduced; default 0.3") \
    X(selftest_timeout_ms,                   10,        60000,      "ms", \
      "SELFTEST without a result is a fault; default 1000") \
    X(coast_delay_ms,                        0,         60000,      "ms", \
      "zero demand this long opens the bridge below the EMF limit; 0: it keeps switching; " \
      "default 100") \
    X(offset_wait_ms,                        10,        60000,      "ms", \
      "a start on a wheel whose EMF drives a current waits this long, then takes the stored " \
      "offsets; default 100")

#define CONFIG_MONITOR_FIELDS(X) \
    X(overcurrent_pu_q15,                    164,       32767,      "pu", \
      "magnitude of the current vector that trips, peak; default " \
      "1.3 times motor.max_phase_current_mA") \
    X(overcurrent_periods, 1, 16, "1", "PWM periods in a row that trip; default 2") \
    X(current_sum_pu_q15, 16, 32767, "pu", "largest |i_a + i_b + i_c|") \
    X(current_dead_periods, 2, 16, "1", "a current that vanishes: PWM periods; default 2") \
    X(current_missing_pu_q15, 1, 1000000000, "pu ms", "reference times time without any current") \
    X(offset_tolerance_codes,                1,         1024,       "1", \
      "largest distance of a current sensor's offset from mid-range") \
    X(torque_tolerance_mNm,                  1,         1000000,    "mNm", \
      "largest excess of the estimated over the permitted torque") \
    X(torque_fault_time_ms,                  1,         1000,       "ms", \
      "qualify time of an implausible torque; default 50") \
    X(sensor_fault_time_ms,                  1,         1000,       "ms", \
      "qualify time of current sum, saturated current sensor and temperature; default 20") \
    X(voltage_fault_time_ms,                 1,         1000,       "ms", \
      "a bus below its trip is a fault after it and battery_message_time_ms; default 5") \
    X(rotor_fault_time_ms,                   1,         10000,      "ms", \
      "qualify time of an invalid rotor angle, from zero torque on; default " \
      "250") \
    X(angle_fault_time_ms,                   8,         1000,       "ms", \
      "qualify time of an implausible angle: steps with one less steps without; default 20") \
    X(rotor_warning_time_ms,                 1,         60000,      "ms", \
      "heal time of the rotor sensor's warning, and so of LIMP; default 10000") \
    X(battery_message_time_ms,               5,         10000,      "ms", \
      "a bus beyond a trip waits this long for the message that the battery is disconnected " \
      "before it is a fault; default 300") \
    X(diode_fault_time_ms,                   1,         1000,       "ms", \
      "qualify time of a diode current in freewheel, which shows a turning wheel; default 20") \
    X(overtemperature_margin_cC,             0,         5000,       "cC", \
      "above the end of the derating, where a temperature is a fault; default 1000") \
    X(lowest_temperature_cC,                 -20000,    0,          "cC", \
      "below it a temperature sensor counts as broken; default -6000") \
    X(highest_temperature_cC,                10000,     29998,      "cC", \
      "above it a temperature sensor counts as broken; default 29000") \
    X(tyre_grip_mm_s2,                       1000,      20000,      "mm/s^2", \
      "largest deceleration of the vehicle: the speed upper bound falls no faster while the " \
      "rotor sensor is valid; default 11768") \
    X(coasting_mm_s2,                        1,         2000,       "mm/s^2", \
      "smallest deceleration of the coasting vehicle: the speed upper bound falls no faster " \
      "while it is not; default 98") \
    X(standstill_mrad_s,                     10,        5000,       "mrad/s", \
      "speed upper bound below which the wheel counts as at standstill; default 300") \
    X(short_release_permille,                500,       999,        "permille", \
      "of the speed where it begins, below which an active short circuit ends; default 900") \
    X(winding_sensor_fitted,                 0,         1,          "1", \
      "1: a winding temperature sensor is fitted, default; 0: none, the estimate stands alone") \
    X(switch_sensor_fitted,                  0,         1,          "1", \
      "likewise of the switches") \
    X(coldest_ambient_cC,                    -5000,     5000,       "cC", \
      "the estimate of temperatures never starts below it; default 2000") \
    X(warmest_ambient_cC,                    0,         10000,      "cC", \
      "the ambient of the estimate is the warmest reading at the start, at most this; " \
      "default 4000") \
    X(flux_tolerance_permille,               20,        1000,       "permille", \
      "the back-EMF differs this much, and its uncertainty, from the magnets': a warning; " \
      "default 150")

#define CONFIG_THERMAL_FIELDS(X) \
    X(winding_heat_capacity_mJ_K,            0,         2000000000, "mJ/K", \
      "of one motor's winding; 0: its temperature is not estimated, and a broken sensor ends " \
      "the torque") \
    X(winding_thermal_resistance_mK_W,       0,         1000000,    "mK/W", \
      "winding to housing; 0: insulated") \
    X(housing_heat_capacity_mJ_K,            0,         2000000000, "mJ/K", \
      "of one motor's iron and housing; 0: none between winding and ambient") \
    X(housing_thermal_resistance_mK_W,       0,         1000000,    "mK/W", \
      "housing to ambient; 0: insulated") \
    X(switch_heat_capacity_mJ_K,             0,         2000000000, "mJ/K", \
      "of one inverter's switches; 0: as of the winding") \
    X(switch_thermal_resistance_mK_W,        0,         1000000,    "mK/W", \
      "switches to heat sink; 0: insulated") \
    X(heatsink_heat_capacity_mJ_K,           0,         2000000000, "mJ/K", \
      "of one inverter's heat sink; 0: none between switches and ambient") \
    X(heatsink_thermal_resistance_mK_W,      0,         1000000,    "mK/W", \
      "heat sink to ambient; 0: insulated")

/* Codes of the converter below the lowest or above the highest are those of a broken sensor: open,
 * shorted, or of another kind. */
#define CONFIG_TEMPERATURE_FIELDS(X) \
    X(winding_lowest_code,                   0,         4031,       "code", \
      "least code of the winding's sensor; above winding_highest_code: none is fitted") \
    X(winding_highest_code,                  0,         4031,       "code",   "its largest") \
    X(switch_lowest_code,                    0,         4031,       "code", \
      "likewise of the switches' sensor") \
    X(switch_highest_code,                   0,         4031,       "code",   "its largest")

/* Between two points by linear interpolation. */
#define CONFIG_TEMPERATURE_ARRAY(Y) \
    Y(winding_cC, CONFIG_CURVE_POINTS,       -32767,    32767,      "cC", \
      "temperature of the winding at code 0, 64, 128 .. 4032") \
    Y(switch_cC,  CONFIG_CURVE_POINTS,       -32767,    32767,      "cC", \
      "likewise of the switches")

/* The entries of a map have 16 bits: half the flash, and in the finest power of two of a milli-unit
 * in which the largest one fits, which costs less than a ten-thousandth of a per cent of the
 * energy. */
#define CONFIG_REGEN_MAP_FIELDS(X) \
    X(speed_points,                          2,         65,         "1", \
      "points along speed, from standstill") \
    X(speed_step_log2,                       6,         20,         "", \
      "distance of the points is 2^this mrad/s, mechanical") \
    X(temperature_points,                    2,         17,         "1", \
      "points along winding temperature") \
    X(temperature_step_log2,                 6,         15,         "", \
      "distance of the points is 2^this hundredths of a degree") \
    X(temperature_origin_cC,                 -10000,    20000,      "cC", \
      "winding temperature of the first point") \
    X(lsb_log2,                              0,         10,         "", \
      "the entries count in 2^this mNm, the finest in which the largest fits")

/* Row after row of equal temperature: torque[t * speed_points + s]; unused entries are 0. */
#define CONFIG_REGEN_MAP_ARRAY(Y) \
    Y(torque_lsb, CONFIG_REGEN_POINTS_MAX,   -32767,    32767,      "2^lsb_log2 mNm", \
      "unclamped braking torque that returns the most energy with the i_d of current_map, " \
      "magnitude; near standstill negative by extrapolation, which counts as 0")

#define CONFIG_CURRENT_MAP_FIELDS(X) \
    X(torque_points,                         3,         65,         "1", \
      "odd: points along torque in the direction of rotation, braking first; the middle " \
      "one is zero torque") \
    X(torque_step_log2,                      0,         20,         "", \
      "distance of the points is 2^this mNm at the airgap") \
    X(speed_points,                          2,         65,         "1", \
      "points along speed, from standstill") \
    X(speed_step_log2,                       6,         20,         "", \
      "distance of the points is 2^this mrad/s, mechanical") \
    X(temperature_points,                    1,         5,          "1", \
      "points along winding temperature; 1: the map does not depend on it") \
    X(temperature_step_log2,                 6,         15,         "", \
      "distance of the points is 2^this hundredths of a degree") \
    X(temperature_origin_cC,                 -10000,    20000,      "cC", \
      "winding temperature of the first point") \
    X(lsb_log2,                              0,         6,          "", \
      "the entries count in 2^this mA, the finest in which the largest fits")

/* Layer after layer of equal temperature, row after row of equal speed:
 * current_d[(w * speed_points + s) * torque_points + t]; unused entries at the end are 0. */
#define CONFIG_CURRENT_MAP_ARRAY(Y) \
    Y(current_d_lsb, CONFIG_CURRENT_MAP_POINTS_MAX, -32767, 32767, "2^lsb_log2 mA", \
      "terminal i_d of least loss, before field weakening; all 0: i_d = 0")

/* Flux linkages of the torque-producing currents at motor.reference_temperature_cC, peak phase,
 * bilinear; for i_q < 0 psi_d is the same and psi_q negative. */
#define CONFIG_FLUX_MAP_FIELDS(X) \
    X(d_points,                              0,         65,         "1", \
      "points along i_d; 0: no map, motor.d_inductance_nH, q_inductance_nH and flux_linkage_nWb " \
      "are the motor") \
    X(d_negative_points,                     0,         65,         "1", \
      "of them below i_d = 0") \
    X(d_step_mA, 0, 1000000, "mA", "distance of the points along i_d") \
    X(q_points, 0, 65, "1", "points along i_q, from zero") \
    X(q_step_mA, 0, 1000000, "mA", "distance of the points along i_q") \
    X(lsb_log2,                              0,         16,         "", \
      "the entries count in 2^this nWb, the finest in which the largest fits")

/* Row after row of equal i_d: psi[d * q_points + q]; unused entries are 0. */
#define CONFIG_FLUX_MAP_ARRAY(Y) \
    Y(psi_d_lsb, CONFIG_FLUX_MAP_POINTS_MAX, -32767,    32767,      "2^lsb_log2 nWb", \
      "flux linkage of the d axis, magnets included") \
    Y(psi_q_lsb, CONFIG_FLUX_MAP_POINTS_MAX, -32767,    32767,      "2^lsb_log2 nWb", \
      "flux linkage of the q axis")

/* Relations of two fields: BELOW(lower, upper) for lower < upper, AT_MOST for lower <= upper. */
#define CONFIG_ORDERS(BELOW, AT_MOST) \
    AT_MOST(motor.rated_torque_mNm, motor.max_torque_mNm) \
    BELOW(motor.derate_winding_temperature_cC, motor.max_winding_temperature_cC) \
    AT_MOST(monitor.coldest_ambient_cC, monitor.warmest_ambient_cC) \
    AT_MOST(drive.derate_switch_temperature_cC, drive.max_switch_temperature_cC) \
    BELOW(current_loop.max_current_pu_q15, monitor.overcurrent_pu_q15) \
    AT_MOST(current_loop.field_weakening_current_pu_q15, current_loop.max_current_pu_q15) \
    BELOW(battery.undervoltage_trip_mV, battery.min_voltage_mV) \
    BELOW(battery.min_voltage_mV, battery.foldback_voltage_mV) \
    BELOW(battery.min_voltage_mV, battery.discharge_foldback_voltage_mV) \
    BELOW(battery.discharge_foldback_voltage_mV, battery.max_voltage_mV) \
    BELOW(battery.foldback_voltage_mV, battery.max_voltage_mV) \
    BELOW(battery.max_voltage_mV, battery.overvoltage_trip_mV) \
    AT_MOST(battery.overvoltage_trip_mV, drive.device_voltage_mV) \
    AT_MOST(brake.blend_out_end_mrad_s, brake.blend_out_start_mrad_s) \
    AT_MOST(brake.stop_lamp_off_mm_s2, brake.stop_lamp_on_mm_s2) \
    AT_MOST(driver.hold_torque_mNm, brake.max_hydraulic_torque_mNm) \
    AT_MOST(pedals.free_travel_torque_mNm, pedals.brake_torque_mNm) \
    AT_MOST(monitor.coasting_mm_s2, monitor.tyre_grip_mm_s2)

#define CONFIG_SCALAR_MEMBER(name, lowest, highest, unit, text) int32_t name;
#define CONFIG_ARRAY_MEMBER(name, count, lowest, highest, unit, text) int32_t name[count];
#define CONFIG_MAP_MEMBER(name, count, lowest, highest, unit, text) int16_t name[count];

typedef struct { CONFIG_MOTOR_FIELDS(CONFIG_SCALAR_MEMBER) } config_motor_t;
typedef struct { CONFIG_DRIVE_FIELDS(CONFIG_SCALAR_MEMBER) } config_drive_t;
typedef struct { CONFIG_CURRENT_LOOP_FIELDS(CONFIG_SCALAR_MEMBER) } config_current_loop_t;
typedef struct {
    CONFIG_ROTOR_FIELDS(CONFIG_SCALAR_MEMBER)
    CONFIG_HALL_ARRAY(CONFIG_ARRAY_MEMBER)
} config_rotor_t;
typedef struct { CONFIG_BATTERY_FIELDS(CONFIG_SCALAR_MEMBER) } config_battery_t;
typedef struct { CONFIG_BRAKE_FIELDS(CONFIG_SCALAR_MEMBER) } config_brake_t;
typedef struct { CONFIG_VEHICLE_FIELDS(CONFIG_SCALAR_MEMBER) } config_vehicle_t;
typedef struct { CONFIG_DRIVER_FIELDS(CONFIG_SCALAR_MEMBER) } config_driver_t;
typedef struct {
    CONFIG_PEDALS_FIELDS(CONFIG_SCALAR_MEMBER)
    CONFIG_PEDALS_ARRAY(CONFIG_ARRAY_MEMBER)
} config_pedals_t;
typedef struct { CONFIG_SERVICE_FIELDS(CONFIG_SCALAR_MEMBER) } config_service_t;
typedef struct { CONFIG_CAN_FIELDS(CONFIG_SCALAR_MEMBER) } config_can_t;
typedef struct { CONFIG_TOLERANCE_FIELDS(CONFIG_SCALAR_MEMBER) } config_tolerance_t;
typedef struct { CONFIG_MODES_FIELDS(CONFIG_SCALAR_MEMBER) } config_modes_t;
typedef struct { CONFIG_MONITOR_FIELDS(CONFIG_SCALAR_MEMBER) } config_monitor_t;
typedef struct { CONFIG_THERMAL_FIELDS(CONFIG_SCALAR_MEMBER) } config_thermal_t;
typedef struct {
    CONFIG_TEMPERATURE_FIELDS(CONFIG_SCALAR_MEMBER)
    CONFIG_TEMPERATURE_ARRAY(CONFIG_MAP_MEMBER)
} config_temperature_t;
typedef struct {
    CONFIG_REGEN_MAP_FIELDS(CONFIG_SCALAR_MEMBER)
    CONFIG_REGEN_MAP_ARRAY(CONFIG_MAP_MEMBER)
} config_regen_map_t;
typedef struct {
    CONFIG_CURRENT_MAP_FIELDS(CONFIG_SCALAR_MEMBER)
    CONFIG_CURRENT_MAP_ARRAY(CONFIG_MAP_MEMBER)
} config_current_map_t;
typedef struct {
    CONFIG_FLUX_MAP_FIELDS(CONFIG_SCALAR_MEMBER)
    CONFIG_FLUX_MAP_ARRAY(CONFIG_MAP_MEMBER)
} config_flux_map_t;
/* clang-format on */

typedef struct {
    uint32_t magic; /* CONFIG_MAGIC */
    /* CONFIG_FORMAT_VERSION; changes whenever the layout of this header changes. */
    uint32_t format_version;
    uint32_t size_bytes;           /* sizeof(config_t) */
    uint32_t generator_version;    /* 0x00MMmmpp of tools/regen_table */
    char name[CONFIG_NAME_LENGTH]; /* of the TOML file, zero padded, always zero terminated */
    config_motor_t motor;
    config_drive_t drive;
    config_current_loop_t current_loop;
    config_rotor_t rotor;
    config_battery_t battery;
    config_brake_t brake;
    config_vehicle_t vehicle;
    config_driver_t driver;
    config_pedals_t pedals;
    config_service_t service;
    config_can_t can;
    config_tolerance_t tolerance;
    config_modes_t modes;
    config_monitor_t monitor;
    config_thermal_t thermal;
    config_temperature_t temperature;
    config_regen_map_t regen_map;
    config_current_map_t current_map;
    config_flux_map_t flux_map;
    uint32_t crc32; /* CRC-32 (IEEE 802.3, reflected, initial and final 0xFFFFFFFF) of all bytes
                       before this field */
    /* Of the lock of XCP, little endian; all zero: none, nothing can be unlocked. Behind the
     * checksum, which is shown where the key must not be known; no list of fields has it. */
    uint32_t service_key[CONFIG_SERVICE_KEY_WORDS];
} config_t;

#endif
