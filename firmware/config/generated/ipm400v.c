/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Configuration "ipm400v": 400 V interior-magnet traction motor.
 *
 * Written by tools/regen_table 0.1.0; the same bytes as ipm400v.bin. Do not edit:
 * change the TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the
 * section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t CONFIG_IPM400V;

CONFIG_SECTION const config_t CONFIG_IPM400V = {
    .magic = CONFIG_MAGIC,
    .format_version = 23,
    .size_bytes = sizeof(config_t),
    .generator_version = 0x00000100,
    .name = "ipm400v",
    .motor = {
        /* 0 surface magnets (L_d = L_q), 1 interior magnets */
        .type                              = 1,
        .pole_pairs                        = 3, /* electrical turns in a mechanical turn */
        /* [uOhm] one phase, at reference_temperature_cC */
        .phase_resistance_uOhm             = 18000,
        /* [cC] winding temperature of phase_resistance_uOhm */
        .reference_temperature_cC          = 2500,
        /* [ppm/K] rise of resistance with temperature; copper 3930 */
        .resistance_coefficient_ppm_K      = 3930,
        .d_inductance_nH                   = 370000, /* [nH] direct axis */
        .q_inductance_nH                   = 1200000, /* [nH] quadrature axis */
        /* [nWb] peak phase flux linkage of the magnets (amplitude-invariant) */
        .flux_linkage_nWb                  = 66000000,
        /* [ppm/K] fall of the flux with temperature, magnets at winding temperature; NdFeB
         * -1100; 0: constant */
        .flux_coefficient_ppm_K            = -1100,
        /* [mOhm] constant part of R_i = a0 + a1 omega_e; both parts 0: no iron loss */
        .iron_loss_resistance_mOhm         = 15000,
        /* [nOhm s] part of R_i proportional to electrical speed */
        .iron_loss_resistance_slope_nOhm_s = 20000000,
        .friction_torque_mNm               = 300, /* [mNm] Coulomb friction of bearings and seals */
        /* [uNm s] friction proportional to mechanical speed */
        .viscous_friction_uNm_s            = 200,
        .rated_torque_mNm                  = 70000, /* [mNm] continuous torque */
        /* [mNm] largest torque in either direction; Demand carries no more for driving */
        .max_torque_mNm                    = 115000,
        /* [mW] largest electromagnetic power in either direction */
        .max_power_mW                      = 60000000,
        .max_phase_current_mA              = 200000, /* [mA] peak */
        /* [mrad/s] driving torque fades out here; braking torque does not */
        .max_speed_mrad_s                  = 1151917,
        /* last part of the speed range over which driving torque fades out; 0: a step at its
         * end; default 1/32 */
        .speed_fade_share_q15              = 1024,
        .derate_winding_temperature_cC     = 13500, /* [cC] start of the derating */
        /* [cC] end of the derating: torque limit zero */
        .max_winding_temperature_cC        = 15500,
    },
    .drive = {
        /* [mA] base of current: half the range of the converter */
        .current_full_scale_mA        = 280000,
        /* [mV] base of voltage: the whole range of the converter */
        .voltage_full_scale_mV        = 500000,
        /* [Hz] rate of the fast loop; base of speed is a sixteenth of it */
        .pwm_frequency_Hz             = 10000,
        .dead_time_ns                 = 500, /* [ns] between the two switches of a leg */
        /* [mV] forward voltage of the freewheeling diodes, opposes the current during the
         * dead time */
        .diode_drop_mV                = 1200,
        /* [ns] half of the shortest low-side pulse: sampling window of the shunts */
        .min_pulse_ns                 = 1000,
        .derate_switch_temperature_cC = 13000, /* [cC] start of the derating */
        .max_switch_temperature_cC    = 15000, /* [cC] end of the derating: torque limit zero */
        /* [mV] rating of the bridge's devices and capacitors, which the bus must never reach;
         * not given: battery.overvoltage_trip_mV */
        .device_voltage_mV            = 650000,
        /* [nF] bus capacitors of this bridge; 0: unknown, a short circuit ends only without
         * current */
        .bus_capacitance_nF           = 560000,
        .loss_per_ampere_uW_A         = 404890, /* [uW/A] of the bridge */
        .loss_resistance_uOhm         = 4000, /* [uOhm] of the switches */
        /* [code/16] stored zero-current code of phase a, times 16: for a start on a wheel too
         * fast to measure it; default the middle, 32768 */
        .offset_a_q4                  = 32768,
        .offset_b_q4                  = 32768, /* [code/16] same, phase b */
        .offset_c_q4                  = 32768, /* [code/16] same, phase c */
    },
    .current_loop = {
        /* [Hz] closed loop, first order after 1.5 periods of delay; determines the gains
         * below, the reference prefilter and the current predictor */
        .bandwidth_Hz                   = 500,
        /* [pu] k_i / (1 - exp(-R T / L_d)), volts per ampere; raising: faster, less damped */
        .proportional_d_pu_q16          = 26819,
        /* [pu] k_i / (1 - exp(-R T / L_q)), volts per ampere; raising: faster, less damped */
        .proportional_q_pu_q16          = 86801,
        /* [pu] a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the
         * regulator's zero on the winding's pole */
        .integral_d_pu_q24              = 40701,
        /* [pu] a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the
         * regulator's zero on the winding's pole */
        .integral_q_pu_q24              = 40701,
        /* [pu] omega_base L_d I_base / V_base, cross-coupling */
        .inductance_d_pu_q16            = 53325,
        /* [pu] omega_base L_q I_base / V_base, cross-coupling */
        .inductance_q_pu_q16            = 172945,
        .flux_pu_q16                    = 33971, /* [pu] omega_base psi / V_base, back-EMF */
        /* [pu] largest |u| over u_dc/sqrt(3); below 1 keeps the sampling window */
        .modulation_limit_pu_q15        = 31113,
        /* [pu] |u| regulated by field weakening, over the radius of that circle; the
         * remaining voltage is for the loop's dynamics; raising: more torque at high speed,
         * slower torque changes; default 0.9689 */
        .modulation_target_pu_q15       = 31748,
        /* [pu] distance of |u| below the target in the torque limits, so that field weakening
         * only trims; default 1/128 of the target */
        .modulation_reserve_pu_q15      = 248,
        .max_current_pu_q15             = 23406, /* [pu] largest |i| of a current reference */
        /* [pu] current per unit of excess squared voltage and period; 0: no field weakening;
         * raising: faster, less damped */
        .field_weakening_gain_pu_q15    = 146,
        /* [pu] largest demagnetising current of field weakening */
        .field_weakening_current_pu_q15 = 19895,
        /* [pu] current below which the dead-time compensation is proportional, at the middle
         * of the battery's range; proportional to the bus voltage */
        .dead_time_zone_pu_q15          = 128,
    },
    .rotor = {
        /* 0 absolute electrical angle, 1 three hall sensors, 2 incremental encoder with index */
        .sensor                         = 0,
        /* [Hz] bandwidth of the angle tracking loop; informative, the gains below realise it */
        .pll_bandwidth_Hz               = 50,
        /* share of the angle error corrected in one PWM period */
        .pll_proportional_q16           = 4118,
        /* share of the angle error added to the speed in one PWM period */
        .pll_integral_q24               = 16558,
        /* counts in a mechanical turn, four to a line; 0: no encoder */
        .encoder_counts                 = 0,
        .encoder_index_turn             = 0, /* [turn] electrical angle at the index pulse */
        /* largest distance of an index pulse from its expected count: the width of the pulse */
        .encoder_index_tolerance_counts = 4,
        .encoder_reversed               = 0, /* 1: the count falls when turning forward */
        /* [mrad/s] mechanical, from which the EMF observer watches the sensor and takes over
         * from it */
        .observer_speed_mrad_s          = 31664,
        .observer_takeover              = 1, /* 1: it does; 0: it is only reported */
        /* bits 0 to 2: level of A, B, C inverted; bit 3: then B and C exchanged; 0: 120
         * degrees apart, in order; 2, 10: 60 degrees apart */
        .hall_lines                     = 0,
        .edge_turn = {0, 10923, 21845, 32768, 43691, 54613},
    },
    .battery = {
        /* motors that share the pack; limits below are one motor's share */
        .driven_wheels                 = 1,
        /* this motor's share of the currents that the management allows the pack; 0: the
         * motors are alike, 1/driven_wheels */
        .pack_share_q15                = 0,
        .max_charge_current_mA         = 150000, /* [mA] 0: no regeneration into the battery */
        .max_discharge_current_mA      = 300000, /* [mA] */
        .foldback_voltage_mV           = 394940, /* [mV] start of the charge current fold-back */
        /* [mV] end of the charge current fold-back: limit zero */
        .max_voltage_mV                = 403000,
        /* [mV] end of the discharge current fold-back: limit zero */
        .min_voltage_mV                = 300000,
        /* [mV] start of the discharge current fold-back; default as far above min_voltage_mV
         * as foldback_voltage_mV is below max_voltage_mV */
        .discharge_foldback_voltage_mV = 308060,
        /* [uOhm] series resistance of the pack over this motor's share: voltage per ampere of
         * one motor when all motors take their shares; 0: not counted, the fold-back then
         * overshoots its line */
        .resistance_uOhm               = 60000,
        /* [ms] longest time constant of the current that the management reports: sensors of
         * the motor are compared with it over eight times this; counts only where it reports
         * one; default 2 s */
        .current_filter_ms             = 2000,
        .overvoltage_trip_mV           = 423150, /* [mV] bridge goes to its safe state */
        .undervoltage_trip_mV          = 270000, /* [mV] bridge goes to its safe state */
    },
    .brake = {
        /* 0 parallel_ratio, 1 parallel_free_travel, 2 series_optimal */
        .strategy                    = 2,
        /* electric part of the whole demand (parallel_ratio) */
        .parallel_electric_share_q15 = 6554,
        /* [mNm] electric torque above which the hydraulic brake adds torque (parallel
         * strategies) */
        .electric_rated_torque_mNm   = 70000,
        /* [mNm] 0: no hydraulic brake commanded by this controller; WheelBrake carries no
         * more */
        .max_hydraulic_torque_mNm    = 700000,
        /* [ms] from a changed command until the hydraulic brake begins to move */
        .hydraulic_dead_time_ms      = 30,
        /* [ms] first-order lag of the hydraulic torque after the dead time; 0: none */
        .hydraulic_time_constant_ms  = 60,
        .hydraulic_rate_mNm_s        = 3000000, /* [mNm/s] fastest change of hydraulic torque */
        /* [ms] reports of the measured hydraulic torque that are missing for longer are not
         * used; 0: none is used; default 70 */
        .hydraulic_timeout_ms        = 70,
        /* [ms] from the hydraulic torque to its report; default 10 */
        .hydraulic_report_delay_ms   = 10,
        /* the gain of the hydraulic brake is learned within 1 -+ this; 0: not learned;
         * default 0.2 */
        .hydraulic_gain_band_q15     = 6554,
        /* [mNm] four standard deviations of the noise of a report; farther from what the
         * commands explain it shows a wrong brake; default 1.25 % of max_hydraulic_torque_mNm */
        .hydraulic_tolerance_mNm     = 8750,
        /* [ms] in which motor torque above a fallen deferrable limit goes down to a tenth,
         * with feedback at most twice as long; 0: at once; default hydraulic_dead_time_ms and
         * 2.3 hydraulic_time_constant_ms */
        .bridging_time_ms            = 168,
        /* 1: where the battery takes nothing, the motor brakes with what its own losses take;
         * default 1 */
        .loss_braking                = 1,
        /* [mrad/s] electric braking starts to fade below this speed */
        .blend_out_start_mrad_s      = 24086,
        .blend_out_end_mrad_s        = 9425, /* [mrad/s] no electric braking below this speed */
        .torque_rate_mNm_s           = 1500000, /* [mNm/s] rate limit of the motor torque command */
        /* [mNm] shortfall of motor torque tolerated before the hydraulic brake adds it;
         * default 5 % of motor.max_torque_mNm */
        .shortfall_band_mNm          = 5750,
        /* [ms] largest age of a demand; an older one has timed out; default 100 */
        .demand_timeout_ms           = 100,
        /* [ms] torque that the motor reaches within this time counts as available; raising:
         * the hydraulic brake adds torque later for a motor short of voltage; default 100 */
        .motor_arrival_ms            = 100,
        /* [ms] time without electric braking after an anti-lock intervention; default 300 */
        .abs_hold_ms                 = 300,
        /* squared modulation index at which the torque no longer grows; default 0.96 */
        .torque_growth_end_q15       = 31457,
        /* share of torque_rate_mNm_s per unit of that square below its end; raising: full
         * rate up to a higher modulation index; default 1/0.02 */
        .torque_growth_slope_q9      = 25600,
        /* [mm/s^2] deceleration without a braking demand above which the stop lamp is lit;
         * default 1300 */
        .stop_lamp_on_mm_s2          = 1300,
        /* [mm/s^2] deceleration below which it is switched off; default 700 */
        .stop_lamp_off_mm_s2         = 700,
        /* time constant of its low-passes of speed and of deceleration, 2^this ms; default 6 */
        .stop_lamp_filter_log2       = 6,
    },
    .vehicle = {
        .wheel_radius_um = 57500, /* [um] rolling radius */
        .mass_g          = 1450000, /* [g] the driven wheels share it in the estimate of the road */
        /* address on CAN: 0 front left, 1 front right, 2 rear left, 3 rear right */
        .wheel_position  = 0,
        /* identifier of Demand for the front left wheel, the lowest of all; a multiple of 32;
         * default 256 */
        .can_base        = 256,
    },
    .driver = {
        /* [ms] a braking demand is kept this long after it counts as lost; default 300 */
        .lost_hold_ms            = 300,
        /* 1: no brake but those commanded here: a lost braking demand is kept until
         * standstill */
        .no_other_brake          = 0,
        /* [mrad/s] a wheel that turns faster against a drive direction refuses it; default 3
         * km/h */
        .direction_change_mrad_s = 14487,
        /* [mNm] hydraulic torque that holds the vehicle at standstill until it drives off; 0:
         * none */
        .hold_torque_mNm         = 0,
        /* [ms] from the driving demand until the hold is gone at the latest, unless the
         * vehicle rolls back; default 1000 */
        .hold_release_ms         = 1000,
        /* [mNm] a Demand beyond it is refused: README of comms */
        .largest_drive_mNm       = 143750,
        /* [mNm] a Demand beyond it is refused: README of comms */
        .largest_brake_mNm       = 1018750,
        /* [ms] from zero to the largest, faster is refused; 0: none */
        .demand_rise_ms          = 20,
        .demand_lost_frames      = 2, /* Demand frames in a row that may be missing; default 2 */
    },
    .pedals = {
        .accelerator_channels   = 0, /* 0: the driving demand comes by CAN */
        .brake_channels         = 0, /* 0: the braking demand comes by CAN */
        .interpretation         = 0, /* brake pedal: 0 proportional, 1 free travel */
        /* [mNm] whole accelerator, wheel of share 1; default motor.max_torque_mNm */
        .drive_torque_mNm       = 115000,
        /* [mNm] braking torque of the released accelerator, wheel of share 1; 0: it coasts */
        .lift_off_torque_mNm    = 0,
        /* share of the accelerator over which lift-off braking fades out; default 0.15 */
        .lift_off_travel_q15    = 4915,
        /* [mNm] whole brake pedal, motor and hydraulic, wheel of share 1; default both
         * limits' sum, within the range */
        .brake_torque_mNm       = 815000,
        /* share of the brake pedal that is the friction brake's free travel; default 0.3 */
        .free_travel_q15        = 9830,
        /* [mNm] braking torque at its end; default brake.electric_rated_torque_mNm */
        .free_travel_torque_mNm = 70000,
        .dead_band_q15          = 1638, /* travel of a released pedal; default 0.05 */
        /* of the travel: two channels farther apart are implausible; default 0.1 */
        .difference_q15         = 3277,
        /* [ms] qualify and heal time of a channel that is implausible or out of range;
         * default 100 */
        .fault_time_ms          = 100,
        /* accelerator beyond it with the brake pressed must be released; 1: never; default
         * 0.25 */
        .override_q15           = 8192,
        .other_wheels           = 0, /* bit of each wheel position to send Demand to */
        .lowest_q15 = {1638, 983, 1638, 983},
        .highest_q15 = {31130, 16384, 31130, 16384},
        .released_q15 = {4915, 2458, 4915, 2458},
        .pressed_q15 = {27853, 13926, 27853, 13926},
        .drive_share_q15 = {32768, 32768, 32768, 32768},
        .brake_share_q15 = {32768, 32768, 32768, 32768},
    },
    .service = {
        /* identifier of XCP commands to the front left wheel, then those of the others, then
         * of the four answers; a multiple of 8 above all messages; 0: no XCP on CAN; default
         * 2032 */
        .can_base = 2032,
    },
    .can = {
        /* VESC controller id of the front left wheel in its status frames, those of the
         * others follow: README of comms; 0: no such frame is sent, default */
        .vesc_status = 0,
    },
    .tolerance = {
        /* of motor.flux_linkage_nWb, magnet temperature included; default 0.05 */
        .magnet_flux_q15     = 1638,
        .inductance_q15      = 6554, /* of each inductance: reluctance torque; default 0.2 */
        /* of the torque that iron loss and friction take; default 0.2 */
        .drag_q15            = 6554,
        /* of the gain that all current sensors have in common; default 0.02 */
        .current_gain_q15    = 655,
        .rotor_angle_rad_q15 = 1716, /* [rad] of the electrical angle; default 3 degrees */
    },
    .modes = {
        /* share of motor.max_torque_mNm enabled for driving in LIMP, after a warning; braking
         * is not reduced; default 0.3 */
        .limp_drive_share_q15 = 9830,
        .selftest_timeout_ms  = 1000, /* [ms] SELFTEST without a result is a fault; default 1000 */
        /* [ms] zero demand this long opens the bridge below the EMF limit; 0: it keeps
         * switching; default 100 */
        .coast_delay_ms       = 100,
        /* [ms] a start on a wheel whose EMF drives a current waits this long, then takes the
         * stored offsets; default 100 */
        .offset_wait_ms       = 100,
    },
    .monitor = {
        /* [pu] magnitude of the current vector that trips, peak; default 1.3 times
         * motor.max_phase_current_mA */
        .overcurrent_pu_q15        = 29552,
        .overcurrent_periods       = 2, /* PWM periods in a row that trip; default 2 */
        .current_sum_pu_q15        = 1638, /* [pu] largest |i_a + i_b + i_c| */
        .current_dead_periods      = 2, /* a current that vanishes: PWM periods; default 2 */
        .current_missing_pu_q15    = 10952, /* [pu ms] reference times time without any current */
        /* largest distance of a current sensor's offset from mid-range */
        .offset_tolerance_codes    = 200,
        /* [mNm] largest excess of the estimated over the permitted torque */
        .torque_tolerance_mNm      = 11500,
        /* [ms] qualify time of an implausible torque; default 50 */
        .torque_fault_time_ms      = 50,
        /* [ms] qualify time of current sum, saturated current sensor and temperature; default
         * 20 */
        .sensor_fault_time_ms      = 20,
        /* [ms] a bus below its trip is a fault after it and battery_message_time_ms; default
         * 5 */
        .voltage_fault_time_ms     = 5,
        /* [ms] qualify time of an invalid rotor angle, from zero torque on; default 250 */
        .rotor_fault_time_ms       = 250,
        /* [ms] qualify time of an implausible angle: steps with one less steps without;
         * default 20 */
        .angle_fault_time_ms       = 20,
        /* [ms] heal time of the rotor sensor's warning, and so of LIMP; default 10000 */
        .rotor_warning_time_ms     = 10000,
        /* [ms] a bus beyond a trip waits this long for the message that the battery is
         * disconnected before it is a fault; default 300 */
        .battery_message_time_ms   = 300,
        /* [ms] qualify time of a diode current in freewheel, which shows a turning wheel;
         * default 20 */
        .diode_fault_time_ms       = 20,
        /* [cC] above the end of the derating, where a temperature is a fault; default 1000 */
        .overtemperature_margin_cC = 1000,
        /* [cC] below it a temperature sensor counts as broken; default -6000 */
        .lowest_temperature_cC     = -6000,
        /* [cC] above it a temperature sensor counts as broken; default 29000 */
        .highest_temperature_cC    = 29000,
        /* [mm/s^2] largest deceleration of the vehicle: the speed upper bound falls no faster
         * while the rotor sensor is valid; default 11768 */
        .tyre_grip_mm_s2           = 11768,
        /* [mm/s^2] smallest deceleration of the coasting vehicle: the speed upper bound falls
         * no faster while it is not; default 98 */
        .coasting_mm_s2            = 98,
        /* [mrad/s] speed upper bound below which the wheel counts as at standstill; default
         * 300 */
        .standstill_mrad_s         = 300,
        /* [permille] of the speed where it begins, below which an active short circuit ends;
         * default 900 */
        .short_release_permille    = 900,
        /* 1: a winding temperature sensor is fitted, default; 0: none, the estimate stands
         * alone */
        .winding_sensor_fitted     = 1,
        .switch_sensor_fitted      = 1, /* likewise of the switches */
        /* [cC] the estimate of temperatures never starts below it; default 2000 */
        .coldest_ambient_cC        = 2000,
        /* [cC] the ambient of the estimate is the warmest reading at the start, at most this;
         * default 4000 */
        .warmest_ambient_cC        = 4000,
        /* [permille] the back-EMF differs this much, and its uncertainty, from the magnets':
         * a warning; default 150 */
        .flux_tolerance_permille   = 150,
    },
    .thermal = {
        /* [mJ/K] of one motor's winding; 0: its temperature is not estimated, and a broken
         * sensor ends the torque */
        .winding_heat_capacity_mJ_K       = 2700000,
        .winding_thermal_resistance_mK_W  = 30, /* [mK/W] winding to housing; 0: insulated */
        /* [mJ/K] of one motor's iron and housing; 0: none between winding and ambient */
        .housing_heat_capacity_mJ_K       = 16000000,
        .housing_thermal_resistance_mK_W  = 20, /* [mK/W] housing to ambient; 0: insulated */
        /* [mJ/K] of one inverter's switches; 0: as of the winding */
        .switch_heat_capacity_mJ_K        = 60000,
        .switch_thermal_resistance_mK_W   = 20, /* [mK/W] switches to heat sink; 0: insulated */
        /* [mJ/K] of one inverter's heat sink; 0: none between switches and ambient */
        .heatsink_heat_capacity_mJ_K      = 900000,
        .heatsink_thermal_resistance_mK_W = 25, /* [mK/W] heat sink to ambient; 0: insulated */
    },
    .temperature = {
        /* [code] least code of the winding's sensor; above winding_highest_code: none is
         * fitted */
        .winding_lowest_code  = 65,
        .winding_highest_code = 3929, /* [code] its largest */
        .switch_lowest_code   = 167, /* [code] likewise of the switches' sensor */
        .switch_highest_code  = 4031, /* [code] its largest */
        .winding_cC = {32767, 19672, 15456, 13289, 11857, 10798, 9959, 9267, 8678, 8165, 7710, 7301, 6929, 6588, 6271, 5976, 5699, 5438, 5190, 4954, 4729, 4512, 4303, 4102, 3907, 3717, 3533, 3352, 3176, 3003, 2833, 2665, 2500, 2336, 2174, 2013, 1853, 1694, 1534, 1375, 1214, 1053, 891, 727, 561, 393, 221, 46, -134, -319, -510, -708, -915, -1132, -1361, -1605, -1868, -2154, -2472, -2831, -3249, -3759, -4432, -5480},
        .switch_cC = {-15448, -5480, -4432, -3759, -3249, -2831, -2472, -2154, -1868, -1605, -1361, -1132, -915, -708, -510, -319, -134, 46, 221, 393, 561, 727, 891, 1053, 1214, 1375, 1534, 1694, 1853, 2013, 2174, 2336, 2500, 2665, 2833, 3003, 3176, 3352, 3533, 3717, 3907, 4102, 4303, 4512, 4729, 4954, 5190, 5438, 5699, 5976, 6271, 6588, 6929, 7301, 7710, 8165, 8678, 9267, 9959, 10798, 11857, 13289, 15456, 19672},
    },
    .regen_map = {
        .speed_points          = 47, /* points along speed, from standstill */
        .speed_step_log2       = 9, /* distance of the points is 2^this mrad/s, mechanical */
        .temperature_points    = 17, /* points along winding temperature */
        .temperature_step_log2 = 10, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = -2000, /* [cC] winding temperature of the first point */
        /* the entries count in 2^this mNm, the finest in which the largest fits */
        .lsb_log2              = 3,
        .torque_lsb = {
            /* a column every 0.512 rad/s, mechanical; in 8 mN m */
            /* -20 degC */
            -279, 0, 1, 43, 156, 276, 400, 533, 674, 823, 983, 1169, 1381, 1627, 1913, 2259, 2676,
            3189, 3834, 4669, 5763, 7278, 9403, 12554, 15761, 16438, 17116, 17795, 18476, 19157,
            19839, 20522, 21205, 21890, 22575, 23261, 23948, 24636, 25324, 26013, 26702, 27393,
            28084, 28775, 29467, 30160, 30853,
            /* -9.76 degC */
            -266, 0, 1, 38, 145, 255, 372, 496, 626, 766, 914, 1078, 1267, 1485, 1737, 2032, 2386,
            2812, 3339, 4001, 4850, 5967, 7506, 9649, 12812, 15784, 16434, 17086, 17738, 18391,
            19045, 19700, 20356, 21012, 21670, 22328, 22986, 23645, 24305, 24966, 25627, 26289,
            26952, 27615, 28278, 28943, 29607,
            /* 0.48 degC */
            -254, 0, 1, 32, 132, 235, 345, 461, 584, 713, 851, 998, 1168, 1362, 1585, 1842, 2146,
            2506, 2943, 3484, 4166, 5027, 6176, 7712, 9865, 13014, 15802, 16427, 17053, 17681,
            18309, 18938, 19567, 20198, 20829, 21461, 22093, 22726, 23360, 23994, 24629, 25265,
            25901, 26537, 27175, 27812, 28451,
            /* 10.72 degC */
            -242, 0, 1, 27, 121, 220, 322, 430, 544, 665, 793, 930, 1080, 1254, 1451, 1679, 1941,
            2254, 2622, 3064, 3619, 4313, 5196, 6354, 7895, 10064, 13213, 15814, 16416, 17019,
            17623, 18228, 18833, 19439, 20046, 20654, 21262, 21870, 22480, 23090, 23700, 24311,
            24923, 25535, 26147, 26761, 27374,
            /* 20.96 degC */
            -232, 0, 1, 23, 111, 204, 300, 402, 508, 621, 741, 868, 1004, 1159, 1337, 1537, 1768,
            2036, 2356, 2732, 3193, 3747, 4453, 5350, 6515, 8072, 10260, 13399, 15821, 16402, 16983,
            17566, 18148, 18732, 19316, 19901, 20486, 21072, 21659, 22246, 22833, 23422, 24010,
            24599, 25189, 25779, 26370,
            /* 31.2 degC */
            -222, 0, 1, 18, 102, 189, 279, 374, 476, 581, 693, 811, 936, 1075, 1234, 1414, 1619,
            1854, 2131, 2451, 2833, 3301, 3868, 4582, 5485, 6658, 8246, 10412, 13522, 15825, 16385,
            16946, 17508, 18070, 18633, 19197, 19761, 20326, 20891, 21456, 22023, 22590, 23157,
            23725, 24293, 24862, 25431,
            /* 41.44 degC */
            -212, 0, 1, 15, 94, 175, 261, 349, 443, 542, 646, 758, 876, 1000, 1143, 1305, 1487,
            1695, 1933, 2214, 2541, 2928, 3407, 3979, 4702, 5613, 6795, 8386, 10544, 13638, 15824,
            16366, 16908, 17450, 17993, 18537, 19081, 19626, 20171, 20717, 21263, 21810, 22357,
            22905, 23453, 24001, 24550,
            /* 51.68 degC */
            -204, 0, 1, 12, 85, 163, 244, 326, 416, 509, 606, 709, 820, 935, 1061, 1208, 1372, 1557,
            1769, 2008, 2296, 2628, 3018, 3504, 4076, 4808, 5728, 6916, 8498, 10654, 13706, 15821,
            16344, 16868, 17392, 17917, 18443, 18969, 19495, 20022, 20550, 21078, 21606, 22135,
            22664, 23194, 23724,
            /* 61.92 degC */
            -195, 0, 1, 10, 78, 151, 228, 306, 389, 475, 569, 664, 766, 877, 991, 1120, 1270, 1434,
            1623, 1836, 2087, 2371, 2707, 3110, 3593, 4188, 4906, 5833, 7024, 8602, 10745, 13765,
            15814, 16320, 16827, 17334, 17842, 18350, 18859, 19369, 19878, 20389, 20899, 21410,
            21922, 22434, 22946,
            /* 72.16 degC */
            -188, 0, 1, 6, 71, 142, 212, 287, 365, 446, 533, 621, 719, 820, 927, 1044, 1177, 1327,
            1495, 1684, 1901, 2152, 2441, 2780, 3192, 3677, 4276, 4997, 5927, 7113, 8683, 10816,
            13795, 15803, 16294, 16785, 17276, 17768, 18260, 18753, 19246, 19739, 20233, 20728,
            21222, 21717, 22213,
            /* 82.4 degC */
            -180, 0, 1, 3, 66, 131, 197, 269, 342, 417, 499, 583, 675, 770, 869, 976, 1094, 1230,
            1381, 1551, 1741, 1959, 2216, 2508, 2849, 3264, 3750, 4352, 5081, 6010, 7210, 8770,
            10870, 13809, 15790, 16266, 16741, 17218, 17694, 18171, 18648, 19126, 19604, 20083,
            20562, 21041, 21521,
            /* 92.64 degC */
            -173, 0, 1, 3, 60, 121, 184, 251, 321, 391, 469, 548, 633, 722, 815, 915, 1021, 1143,
            1280, 1432, 1602, 1796, 2016, 2272, 2569, 2914, 3331, 3818, 4426, 5171, 6082, 7286,
            8823, 10897, 13793, 15775, 16236, 16697, 17159, 17621, 18084, 18547, 19010, 19473,
            19937, 20401, 20866,
            /* 102.88 degC */
            -167, 0, 1, 2, 54, 113, 172, 236, 299, 369, 441, 515, 595, 677, 763, 857, 956, 1064,
            1188, 1325, 1478, 1651, 1845, 2072, 2326, 2625, 2972, 3391, 3882, 4488, 5229, 6167,
            7342, 8868, 10918, 13767, 15757, 16204, 16652, 17100, 17549, 17997, 18447, 18896, 19346,
            19796, 20246,
            /* 113.12 degC */
            -160, 0, 1, 2, 51, 104, 161, 221, 282, 346, 415, 483, 558, 636, 719, 805, 897, 995,
            1106, 1230, 1369, 1523, 1696, 1892, 2118, 2378, 2674, 3022, 3446, 3937, 4540, 5289,
            6213, 7387, 8899, 10929, 13721, 15737, 16171, 16606, 17041, 17477, 17912, 18348, 18785,
            19221, 19658,
            /* 123.36 degC */
            -154, 0, 1, 1, 45, 97, 151, 206, 265, 325, 390, 456, 524, 597, 676, 756, 843, 934, 1032,
            1145, 1270, 1409, 1564, 1737, 1934, 2164, 2422, 2723, 3081, 3494, 3983, 4592, 5335,
            6259, 7420, 8913, 10917, 13658, 15715, 16137, 16559, 16982, 17405, 17828, 18252, 18676,
            19100,
            /* 133.6 degC */
            -149, 0, 1, 1, 41, 90, 141, 194, 249, 306, 366, 428, 494, 562, 634, 710, 791, 875, 966,
            1067, 1180, 1306, 1445, 1601, 1776, 1972, 2203, 2463, 2763, 3121, 3535, 4026, 4629,
            5373, 6286, 7440, 8913, 10882, 13568, 15690, 16101, 16512, 16923, 17334, 17745, 18157,
            18569,
            /* 143.84 degC */
            -143, 0, 1, 1, 37, 84, 132, 182, 234, 286, 345, 403, 465, 529, 596, 668, 743, 823, 907,
            996, 1100, 1213, 1339, 1479, 1636, 1811, 2008, 2239, 2499, 2800, 3156, 3570, 4063, 4667,
            5403, 6309, 7452, 8910, 10848, 13475, 15665, 16064, 16463, 16863, 17263, 17663, 18063,
        },
    },
    .current_map = {
        /* odd: points along torque in the direction of rotation, braking first; the middle
         * one is zero torque */
        .torque_points         = 31,
        .torque_step_log2      = 13, /* distance of the points is 2^this mNm at the airgap */
        .speed_points          = 19, /* points along speed, from standstill */
        .speed_step_log2       = 16, /* distance of the points is 2^this mrad/s, mechanical */
        /* points along winding temperature; 1: the map does not depend on it */
        .temperature_points    = 2,
        .temperature_step_log2 = 14, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = -2000, /* [cC] winding temperature of the first point */
        /* the entries count in 2^this mA, the finest in which the largest fits */
        .lsb_log2              = 3,
        .current_d_lsb = {
            /* a column every 8.192 N m from -122.88 N m on; in 8 mA */
            /* 0 rad/s, -20 degC */
            -15376, -14629, -13857, -13056, -12225, -11358, -10452, -9500, -8496, -7430, -6291,
            -5064, -3732, -2286, -784, 0, -784, -2286, -3732, -5064, -6291, -7430, -8496, -9500,
            -10452, -11358, -12225, -13056, -13857, -14629, -15376,
            /* 65.536 rad/s, -20 degC */
            -15906, -15145, -14358, -13542, -12695, -11812, -10888, -9918, -8895, -7808, -6647,
            -5396, -4037, -2560, -1024, -34, -1104, -2696, -4219, -5616, -6902, -8095, -9210,
            -10260, -11255, -12203, -13108, -13977, -14814, -15621, -16401,
            /* 131.072 rad/s, -20 degC */
            -17445, -16639, -15807, -14944, -14047, -13113, -12136, -11110, -10027, -8876, -7647,
            -6321, -4881, -3309, -1659, -323, -1797, -3524, -5163, -6663, -8041, -9318, -10512,
            -11636, -12701, -13714, -14683, -15612, -16507, -17370, -18204,
            /* 196.608 rad/s, -20 degC */
            -19113, -18262, -17382, -16471, -15524, -14537, -13505, -12421, -11278, -10064, -8766,
            -7368, -5849, -4192, -2430, -1212, -2606, -4453, -6190, -7779, -9240, -10595, -11861,
            -13054, -14183, -15259, -16287, -17274, -18223, -19139, -20025,
            /* 262.144 rad/s, -20 degC */
            -20681, -19790, -18868, -17914, -16922, -15889, -14809, -13675, -12479, -11210, -9855,
            -8397, -6816, -5098, -3283, -2212, -3475, -5386, -7192, -8850, -10377, -11795, -13121,
            -14371, -15556, -16684, -17763, -18798, -19794, -20756, -21687,
            /* 327.68 rad/s, -20 degC */
            -22094, -21168, -20211, -19220, -18190, -17118, -15998, -14822, -13583, -12270, -10869,
            -9364, -7738, -5983, -4162, -3205, -4358, -6286, -8134, -9842, -11420, -12887, -14262,
            -15559, -16788, -17960, -19080, -20156, -21192, -22192, -23159,
            /* 393.216 rad/s, -20 degC */
            -23352, -22396, -21410, -20388, -19327, -18222, -17068, -15858, -14583, -13234, -11797,
            -10257, -8600, -6825, -5028, -4156, -5221, -7135, -9008, -10750, -12366, -13873, -15286,
            -16620, -17887, -19094, -20249, -21358, -22427, -23458, -24456,
            /* 458.752 rad/s, -20 degC */
            -24469, -23489, -22477, -21429, -20342, -19210, -18028, -16790, -15487, -14109, -12643,
            -11077, -9399, -7618, -5856, -5053, -6045, -7930, -9813, -11579, -13224, -14761, -16205,
            -17570, -18866, -20102, -21286, -22423, -23519, -24577, -25601,
            /* 524.288 rad/s, -20 degC */
            -25464, -24463, -23430, -22360, -21250, -20096, -18891, -17630, -16303, -14902, -13414,
            -11829, -10138, -8358, -6638, -5891, -6823, -8671, -10555, -12336, -14002, -15562,
            -17031, -18421, -19742, -21002, -22210, -23371, -24489, -25569, -26615,
            /* 589.824 rad/s, -20 degC */
            -26354, -25335, -24284, -23195, -22067, -20893, -19669, -18388, -17042, -15622, -14117,
            -12518, -10819, -9047, -7371, -6671, -7551, -9359, -11237, -13028, -14709, -16288,
            -17777, -19187, -20528, -21809, -23037, -24217, -25355, -26455, -27519,
            /* 655.36 rad/s, -20 degC */
            -27153, -26119, -25052, -23948, -22803, -21614, -20373, -19076, -17714, -16278, -14760,
            -13151, -11449, -9688, -8054, -7394, -8231, -9998, -11867, -13662, -15354, -16948,
            -18453, -19880, -21238, -22536, -23781, -24978, -26133, -27248, -28329,
            /* 720.896 rad/s, -20 degC */
            -27875, -26828, -25747, -24629, -23471, -22267, -21012, -19701, -18326, -16878, -15350,
            -13733, -12031, -10284, -8691, -8065, -8864, -10592, -12448, -14244, -15945, -17550,
            -19068, -20509, -21882, -23194, -24454, -25665, -26834, -27964, -29058,
            /* 786.432 rad/s, -20 degC */
            -28529, -27470, -26378, -25248, -24078, -22862, -21595, -20273, -18886, -17429, -15892,
            -14270, -12570, -10839, -9284, -8688, -9454, -11144, -12986, -14781, -16487, -18101,
            -19630, -21083, -22468, -23793, -25065, -26289, -27470, -28612, -29718,
            /* 851.968 rad/s, -20 degC */
            -29125, -28056, -26953, -25813, -24632, -23406, -22129, -20796, -19401, -17935, -16392,
            -14767, -13071, -11355, -9836, -9267, -10003, -11658, -13484, -15277, -16987, -18608,
            -20145, -21608, -23003, -24339, -25622, -26857, -28048, -29201, -30318,
            /* 917.504 rad/s, -20 degC */
            -29670, -28591, -27479, -26330, -25140, -23905, -22619, -21278, -19874, -18402, -16854,
            -15228, -13536, -11837, -10351, -9805, -10516, -12137, -13948, -15736, -17448, -19075,
            -20619, -22090, -23494, -24840, -26132, -27376, -28577, -29740, -30866,
            /* 983.04 rad/s, -20 degC */
            -30169, -29083, -27963, -26806, -25608, -24364, -23071, -21722, -20312, -18834, -17282,
            -15656, -13969, -12286, -10832, -10306, -10994, -12584, -14379, -16163, -17876, -19506,
            -21057, -22535, -23947, -25300, -26600, -27853, -29063, -30233, -31368,
            /* 1048.58 rad/s, -20 degC */
            -30629, -29536, -28409, -27244, -26039, -24789, -23489, -22134, -20718, -19235, -17680,
            -16055, -14374, -12706, -11281, -10774, -11442, -13002, -14782, -16560, -18273, -19906,
            -21462, -22946, -24365, -25725, -27033, -28293, -29510, -30688, -31830,
            /* 1114.11 rad/s, -20 degC */
            -31054, -29955, -28821, -27650, -26438, -25182, -23876, -22515, -21094, -19608, -18051,
            -16427, -14752, -13100, -11702, -11211, -11861, -13393, -15159, -16931, -18643, -20278,
            -21838, -23327, -24752, -26118, -27432, -28699, -29923, -31108, -32256,
            /* 1179.65 rad/s, -20 degC */
            -31448, -30343, -29203, -28026, -26809, -25547, -24236, -22870, -21445, -19956, -18398,
            -16775, -15107, -13469, -12096, -11620, -12253, -13761, -15511, -17277, -18988, -20625,
            -22188, -23682, -25111, -26484, -27803, -29076, -30306, -31496, -32651,
            /* 0 rad/s, 143.84 degC */
            -16545, -15791, -15010, -14200, -13357, -12478, -11556, -10586, -9559, -8463, -7285,
            -6003, -4588, -2999, -1190, 0, -1190, -2999, -4588, -6003, -7285, -8463, -9559, -10586,
            -11556, -12478, -13357, -14200, -15010, -15791, -16545,
            /* 65.536 rad/s, 143.84 degC */
            -16773, -16013, -15226, -14411, -13562, -12676, -11748, -10771, -9737, -8634, -7448,
            -6157, -4733, -3133, -1316, -22, -1406, -3282, -4928, -6392, -7718, -8936, -10068,
            -11129, -12131, -13083, -13992, -14862, -15698, -16505, -17284,
            /* 131.072 rad/s, 143.84 degC */
            -17725, -16937, -16122, -15276, -14397, -13478, -12516, -11503, -10431, -9287, -8057,
            -6718, -5240, -3579, -1697, -154, -1841, -3814, -5548, -7087, -8480, -9760, -10949,
            -12063, -13116, -14115, -15069, -15983, -16861, -17708, -18526,
            /* 196.608 rad/s, 143.84 degC */
            -18855, -18035, -17185, -16305, -15388, -14432, -13430, -12375, -11258, -10067, -8786,
            -7392, -5853, -4124, -2158, -567, -2339, -4412, -6229, -7843, -9303, -10644, -11890,
            -13058, -14161, -15209, -16208, -17166, -18086, -18974, -19831,
            /* 262.144 rad/s, 143.84 degC */
            -19983, -19131, -18248, -17333, -16382, -15388, -14347, -13252, -12092, -10855, -9526,
            -8079, -6483, -4692, -2651, -1110, -2855, -5013, -6902, -8581, -10101, -11498, -12795,
            -14012, -15162, -16253, -17295, -18293, -19252, -20177, -21070,
            /* 327.68 rad/s, 143.84 degC */
            -21046, -20164, -19252, -18305, -17321, -16294, -15217, -14085, -12886, -11608, -10235,
            -8742, -7096, -5251, -3155, -1674, -3373, -5593, -7542, -9277, -10848, -12293, -13636,
            -14896, -16086, -17217, -18295, -19329, -20323, -21280, -22206,
            /* 393.216 rad/s, 143.84 degC */
            -22026, -21117, -20178, -19203, -18190, -17132, -16025, -14859, -13626, -12312, -10900,
            -9366, -7677, -5789, -3656, -2234, -3882, -6145, -8141, -9923, -11538, -13025, -14407,
            -15704, -16930, -18094, -19206, -20271, -21294, -22282, -23236,
            /* 458.752 rad/s, 143.84 degC */
            -22922, -21990, -21026, -20027, -18987, -17903, -16767, -15573, -14309, -12963, -11517,
            -9949, -8224, -6301, -4146, -2779, -4375, -6665, -8700, -10520, -12173, -13695, -15112,
            -16441, -17698, -18892, -20032, -21124, -22175, -23187, -24166,
            /* 524.288 rad/s, 143.84 degC */
            -23740, -22787, -21802, -20780, -19718, -18610, -17449, -16229, -14938, -13564, -12090,
            -10491, -8736, -6785, -4619, -3304, -4849, -7155, -9219, -11072, -12757, -14310, -15756,
            -17114, -18397, -19617, -20782, -21899, -22973, -24008, -25009,
            /* 589.824 rad/s, 143.84 degC */
            -24487, -23516, -22512, -21470, -20388, -19258, -18076, -16833, -15519, -14120, -12620,
            -10995, -9215, -7243, -5074, -3806, -5304, -7615, -9703, -11583, -13295, -14875, -16347,
            -17729, -19036, -20279, -21466, -22604, -23699, -24754, -25774,
            /* 655.36 rad/s, 143.84 degC */
            -25172, -24185, -23163, -22104, -21003, -19855, -18653, -17390, -16054, -14634, -13112,
            -11465, -9663, -7674, -5509, -4286, -5737, -8047, -10154, -12056, -13792, -15395,
            -16889, -18294, -19622, -20885, -22092, -23249, -24361, -25434, -26472,
            /* 720.896 rad/s, 143.84 degC */
            -25802, -24799, -23762, -22687, -21569, -20404, -19185, -17904, -16550, -15111, -13570,
            -11903, -10084, -8082, -5925, -4741, -6150, -8455, -10576, -12497, -14253, -15876,
            -17390, -18814, -20161, -21442, -22666, -23839, -24968, -26057, -27110,
            /* 786.432 rad/s, 143.84 degC */
            -26381, -25365, -24314, -23225, -22093, -20913, -19678, -18380, -17010, -15554, -13996,
            -12312, -10478, -8466, -6320, -5175, -6543, -8839, -10970, -12907, -14681, -16322,
            -17853, -19294, -20657, -21955, -23194, -24383, -25527, -26630, -27697,
            /* 851.968 rad/s, 143.84 degC */
            -26917, -25889, -24825, -23723, -22578, -21384, -20135, -18823, -17438, -15967, -14393,
            -12696, -10848, -8830, -6697, -5586, -6917, -9201, -11340, -13291, -15080, -16736,
            -18283, -19739, -21117, -22429, -23683, -24885, -26042, -27158, -28238,
            /* 917.504 rad/s, 143.84 degC */
            -27414, -26374, -25299, -24185, -23028, -21822, -20560, -19235, -17837, -16352, -14765,
            -13055, -11197, -9174, -7055, -5977, -7274, -9544, -11688, -13650, -15452, -17122,
            -18683, -20153, -21544, -22869, -24135, -25350, -26519, -27647, -28738,
            /* 983.04 rad/s, 143.84 degC */
            -27876, -26826, -25740, -24616, -23447, -22230, -20957, -19620, -18210, -16713, -15114,
            -13393, -11526, -9499, -7396, -6348, -7612, -9868, -12016, -13987, -15801, -17483,
            -19056, -20538, -21942, -23278, -24556, -25782, -26962, -28101, -29202,
            /* 1048.58 rad/s, 143.84 degC */
            -28306, -27247, -26152, -25017, -23839, -22611, -21328, -19980, -18559, -17052, -15442,
            -13711, -11836, -9808, -7721, -6700, -7935, -10175, -12325, -14304, -16128, -17821,
            -19405, -20898, -22313, -23660, -24949, -26185, -27375, -28523, -29634,
            /* 1114.11 rad/s, 143.84 degC */
            -28708, -27640, -26537, -25393, -24205, -22968, -21675, -20318, -18887, -17370, -15751,
            -14011, -12130, -10102, -8031, -7036, -8242, -10466, -12617, -14603, -16435, -18138,
            -19733, -21236, -22661, -24018, -25315, -26561, -27760, -28918, -30037,
            /* 1179.65 rad/s, 143.84 degC */
            -29085, -28009, -26897, -25745, -24549, -23303, -22002, -20635, -19195, -17669, -16042,
            -14294, -12408, -10380, -8326, -7355, -8536, -10743, -12894, -14885, -16725, -18437,
            -20041, -21553, -22987, -24353, -25659, -26913, -28121, -29286, -30414,
        },
    },
    .flux_map = {
        /* points along i_d; 0: no map, motor.d_inductance_nH, q_inductance_nH and
         * flux_linkage_nWb are the motor */
        .d_points          = 0,
        .d_negative_points = 0, /* of them below i_d = 0 */
        .d_step_mA         = 0, /* [mA] distance of the points along i_d */
        .q_points          = 0, /* points along i_q, from zero */
        .q_step_mA         = 0, /* [mA] distance of the points along i_q */
        /* the entries count in 2^this nWb, the finest in which the largest fits */
        .lsb_log2          = 0,
        .psi_d_lsb = {0},
        .psi_q_lsb = {0},
    },
    .crc32 = 0xE8A90ECC,
};
