/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Configuration "scooter48v": 48 V scooter hub, low inductance.
 *
 * Written by tools/regen_table 0.1.0; the same bytes as scooter48v.bin. Do not edit:
 * change the TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the
 * section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t CONFIG_SCOOTER48V;

CONFIG_SECTION const config_t CONFIG_SCOOTER48V = {
    .magic = CONFIG_MAGIC,
    .format_version = 23,
    .size_bytes = sizeof(config_t),
    .generator_version = 0x00000100,
    .name = "scooter48v",
    .motor = {
        /* 0 surface magnets (L_d = L_q), 1 interior magnets */
        .type                              = 1,
        .pole_pairs                        = 15, /* electrical turns in a mechanical turn */
        /* [uOhm] one phase, at reference_temperature_cC */
        .phase_resistance_uOhm             = 21000,
        /* [cC] winding temperature of phase_resistance_uOhm */
        .reference_temperature_cC          = 2500,
        /* [ppm/K] rise of resistance with temperature; copper 3930 */
        .resistance_coefficient_ppm_K      = 3930,
        .d_inductance_nH                   = 85000, /* [nH] direct axis */
        .q_inductance_nH                   = 150000, /* [nH] quadrature axis */
        /* [nWb] peak phase flux linkage of the magnets (amplitude-invariant) */
        .flux_linkage_nWb                  = 18000000,
        /* [ppm/K] fall of the flux with temperature, magnets at winding temperature; NdFeB
         * -1100; 0: constant */
        .flux_coefficient_ppm_K            = 0,
        /* [mOhm] constant part of R_i = a0 + a1 omega_e; both parts 0: no iron loss */
        .iron_loss_resistance_mOhm         = 6000,
        /* [nOhm s] part of R_i proportional to electrical speed */
        .iron_loss_resistance_slope_nOhm_s = 10000000,
        .friction_torque_mNm               = 80, /* [mNm] Coulomb friction of bearings and seals */
        /* [uNm s] friction proportional to mechanical speed */
        .viscous_friction_uNm_s            = 0,
        .rated_torque_mNm                  = 10000, /* [mNm] continuous torque */
        /* [mNm] largest torque in either direction; Demand carries no more for driving */
        .max_torque_mNm                    = 19000,
        /* [mW] largest electromagnetic power in either direction */
        .max_power_mW                      = 1000000,
        .max_phase_current_mA              = 50000, /* [mA] peak */
        /* [mrad/s] driving torque fades out here; braking torque does not */
        .max_speed_mrad_s                  = 73304,
        /* last part of the speed range over which driving torque fades out; 0: a step at its
         * end; default 1/32 */
        .speed_fade_share_q15              = 1024,
        .derate_winding_temperature_cC     = 10000, /* [cC] start of the derating */
        /* [cC] end of the derating: torque limit zero */
        .max_winding_temperature_cC        = 12000,
    },
    .drive = {
        /* [mA] base of current: half the range of the converter */
        .current_full_scale_mA        = 82500,
        /* [mV] base of voltage: the whole range of the converter */
        .voltage_full_scale_mV        = 72000,
        /* [Hz] rate of the fast loop; base of speed is a sixteenth of it */
        .pwm_frequency_Hz             = 24000,
        .dead_time_ns                 = 500, /* [ns] between the two switches of a leg */
        /* [mV] forward voltage of the freewheeling diodes, opposes the current during the
         * dead time */
        .diode_drop_mV                = 800,
        /* [ns] half of the shortest low-side pulse: sampling window of the shunts */
        .min_pulse_ns                 = 1000,
        .derate_switch_temperature_cC = 13000, /* [cC] start of the derating */
        .max_switch_temperature_cC    = 15000, /* [cC] end of the derating: torque limit zero */
        /* [mV] rating of the bridge's devices and capacitors, which the bus must never reach;
         * not given: battery.overvoltage_trip_mV */
        .device_voltage_mV            = 75000,
        /* [nF] bus capacitors of this bridge; 0: unknown, a short circuit ends only without
         * current */
        .bus_capacitance_nF           = 1000000,
        .loss_per_ampere_uW_A         = 220016, /* [uW/A] of the bridge */
        .loss_resistance_uOhm         = 4048, /* [uOhm] of the switches */
        /* [code/16] stored zero-current code of phase a, times 16: for a start on a wheel too
         * fast to measure it; default the middle, 32768 */
        .offset_a_q4                  = 32768,
        .offset_b_q4                  = 32768, /* [code/16] same, phase b */
        .offset_c_q4                  = 32768, /* [code/16] same, phase c */
    },
    .current_loop = {
        /* [Hz] closed loop, first order after 1.5 periods of delay; determines the gains
         * below, the reference prefilter and the current predictor */
        .bandwidth_Hz                   = 1000,
        /* [pu] k_i / (1 - exp(-R T / L_d)), volts per ampere; raising: faster, less damped */
        .proportional_d_pu_q16          = 27324,
        /* [pu] k_i / (1 - exp(-R T / L_q)), volts per ampere; raising: faster, less damped */
        .proportional_q_pu_q16          = 48092,
        /* [pu] a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the
         * regulator's zero on the winding's pole */
        .integral_d_pu_q24              = 85201,
        /* [pu] a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the
         * regulator's zero on the winding's pole */
        .integral_q_pu_q24              = 85201,
        /* [pu] omega_base L_d I_base / V_base, cross-coupling */
        .inductance_d_pu_q16            = 60158,
        /* [pu] omega_base L_q I_base / V_base, cross-coupling */
        .inductance_q_pu_q16            = 106161,
        .flux_pu_q16                    = 154416, /* [pu] omega_base psi / V_base, back-EMF */
        /* [pu] largest |u| over u_dc/sqrt(3); below 1 keeps the sampling window */
        .modulation_limit_pu_q15        = 28779,
        /* [pu] |u| regulated by field weakening, over the radius of that circle; the
         * remaining voltage is for the loop's dynamics; raising: more torque at high speed,
         * slower torque changes; default 0.9689 */
        .modulation_target_pu_q15       = 31748,
        /* [pu] distance of |u| below the target in the torque limits, so that field weakening
         * only trims; default 1/128 of the target */
        .modulation_reserve_pu_q15      = 248,
        .max_current_pu_q15             = 19859, /* [pu] largest |i| of a current reference */
        /* [pu] current per unit of excess squared voltage and period; 0: no field weakening;
         * raising: faster, less damped */
        .field_weakening_gain_pu_q15    = 0,
        /* [pu] largest demagnetising current of field weakening */
        .field_weakening_current_pu_q15 = 0,
        /* [pu] current below which the dead-time compensation is proportional, at the middle
         * of the battery's range; proportional to the bus voltage */
        .dead_time_zone_pu_q15          = 128,
    },
    .rotor = {
        /* 0 absolute electrical angle, 1 three hall sensors, 2 incremental encoder with index */
        .sensor                         = 1,
        /* [Hz] bandwidth of the angle tracking loop; informative, the gains below realise it */
        .pll_bandwidth_Hz               = 50,
        /* share of the angle error corrected in one PWM period */
        .pll_proportional_q16           = 1716,
        /* share of the angle error added to the speed in one PWM period */
        .pll_integral_q24               = 2875,
        /* counts in a mechanical turn, four to a line; 0: no encoder */
        .encoder_counts                 = 0,
        .encoder_index_turn             = 0, /* [turn] electrical angle at the index pulse */
        /* largest distance of an index pulse from its expected count: the width of the pulse */
        .encoder_index_tolerance_counts = 4,
        .encoder_reversed               = 0, /* 1: the count falls when turning forward */
        /* [mrad/s] mechanical, from which the EMF observer watches the sensor and takes over
         * from it */
        .observer_speed_mrad_s          = 4418,
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
        .max_charge_current_mA         = 10000, /* [mA] 0: no regeneration into the battery */
        .max_discharge_current_mA      = 30000, /* [mA] */
        .foldback_voltage_mV           = 53508, /* [mV] start of the charge current fold-back */
        /* [mV] end of the charge current fold-back: limit zero */
        .max_voltage_mV                = 54600,
        /* [mV] end of the discharge current fold-back: limit zero */
        .min_voltage_mV                = 39000,
        /* [mV] start of the discharge current fold-back; default as far above min_voltage_mV
         * as foldback_voltage_mV is below max_voltage_mV */
        .discharge_foldback_voltage_mV = 40092,
        /* [uOhm] series resistance of the pack over this motor's share: voltage per ampere of
         * one motor when all motors take their shares; 0: not counted, the fold-back then
         * overshoots its line */
        .resistance_uOhm               = 110000,
        /* [ms] longest time constant of the current that the management reports: sensors of
         * the motor are compared with it over eight times this; counts only where it reports
         * one; default 2 s */
        .current_filter_ms             = 2000,
        .overvoltage_trip_mV           = 57330, /* [mV] bridge goes to its safe state */
        .undervoltage_trip_mV          = 35100, /* [mV] bridge goes to its safe state */
    },
    .brake = {
        /* 0 parallel_ratio, 1 parallel_free_travel, 2 series_optimal */
        .strategy                    = 2,
        /* electric part of the whole demand (parallel_ratio) */
        .parallel_electric_share_q15 = 9830,
        /* [mNm] electric torque above which the hydraulic brake adds torque (parallel
         * strategies) */
        .electric_rated_torque_mNm   = 10000,
        /* [mNm] 0: no hydraulic brake commanded by this controller; WheelBrake carries no
         * more */
        .max_hydraulic_torque_mNm    = 50000,
        /* [ms] from a changed command until the hydraulic brake begins to move */
        .hydraulic_dead_time_ms      = 50,
        /* [ms] first-order lag of the hydraulic torque after the dead time; 0: none */
        .hydraulic_time_constant_ms  = 80,
        .hydraulic_rate_mNm_s        = 300000, /* [mNm/s] fastest change of hydraulic torque */
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
        .hydraulic_tolerance_mNm     = 625,
        /* [ms] in which motor torque above a fallen deferrable limit goes down to a tenth,
         * with feedback at most twice as long; 0: at once; default hydraulic_dead_time_ms and
         * 2.3 hydraulic_time_constant_ms */
        .bridging_time_ms            = 234,
        /* 1: where the battery takes nothing, the motor brakes with what its own losses take;
         * default 1 */
        .loss_braking                = 1,
        /* [mrad/s] electric braking starts to fade below this speed */
        .blend_out_start_mrad_s      = 4189,
        .blend_out_end_mrad_s        = 1571, /* [mrad/s] no electric braking below this speed */
        .torque_rate_mNm_s           = 80000, /* [mNm/s] rate limit of the motor torque command */
        /* [mNm] shortfall of motor torque tolerated before the hydraulic brake adds it;
         * default 5 % of motor.max_torque_mNm */
        .shortfall_band_mNm          = 950,
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
        .wheel_radius_um = 127000, /* [um] rolling radius */
        .mass_g          = 95000, /* [g] the driven wheels share it in the estimate of the road */
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
        .direction_change_mrad_s = 6559,
        /* [mNm] hydraulic torque that holds the vehicle at standstill until it drives off; 0:
         * none */
        .hold_torque_mNm         = 0,
        /* [ms] from the driving demand until the hold is gone at the latest, unless the
         * vehicle rolls back; default 1000 */
        .hold_release_ms         = 1000,
        .largest_drive_mNm       = 23750, /* [mNm] a Demand beyond it is refused: README of comms */
        .largest_brake_mNm       = 86250, /* [mNm] a Demand beyond it is refused: README of comms */
        /* [ms] from zero to the largest, faster is refused; 0: none */
        .demand_rise_ms          = 20,
        .demand_lost_frames      = 2, /* Demand frames in a row that may be missing; default 2 */
    },
    .pedals = {
        .accelerator_channels   = 0, /* 0: the driving demand comes by CAN */
        .brake_channels         = 0, /* 0: the braking demand comes by CAN */
        .interpretation         = 0, /* brake pedal: 0 proportional, 1 free travel */
        /* [mNm] whole accelerator, wheel of share 1; default motor.max_torque_mNm */
        .drive_torque_mNm       = 19000,
        /* [mNm] braking torque of the released accelerator, wheel of share 1; 0: it coasts */
        .lift_off_torque_mNm    = 0,
        /* share of the accelerator over which lift-off braking fades out; default 0.15 */
        .lift_off_travel_q15    = 4915,
        /* [mNm] whole brake pedal, motor and hydraulic, wheel of share 1; default both
         * limits' sum, within the range */
        .brake_torque_mNm       = 69000,
        /* share of the brake pedal that is the friction brake's free travel; default 0.3 */
        .free_travel_q15        = 9830,
        /* [mNm] braking torque at its end; default brake.electric_rated_torque_mNm */
        .free_travel_torque_mNm = 10000,
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
        .overcurrent_pu_q15        = 25817,
        .overcurrent_periods       = 2, /* PWM periods in a row that trip; default 2 */
        .current_sum_pu_q15        = 1638, /* [pu] largest |i_a + i_b + i_c| */
        .current_dead_periods      = 2, /* a current that vanishes: PWM periods; default 2 */
        .current_missing_pu_q15    = 5037, /* [pu ms] reference times time without any current */
        /* largest distance of a current sensor's offset from mid-range */
        .offset_tolerance_codes    = 200,
        /* [mNm] largest excess of the estimated over the permitted torque */
        .torque_tolerance_mNm      = 1900,
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
        .winding_heat_capacity_mJ_K       = 150000,
        .winding_thermal_resistance_mK_W  = 400, /* [mK/W] winding to housing; 0: insulated */
        /* [mJ/K] of one motor's iron and housing; 0: none between winding and ambient */
        .housing_heat_capacity_mJ_K       = 1100000,
        .housing_thermal_resistance_mK_W  = 800, /* [mK/W] housing to ambient; 0: insulated */
        /* [mJ/K] of one inverter's switches; 0: as of the winding */
        .switch_heat_capacity_mJ_K        = 4000,
        .switch_thermal_resistance_mK_W   = 600, /* [mK/W] switches to heat sink; 0: insulated */
        /* [mJ/K] of one inverter's heat sink; 0: none between switches and ambient */
        .heatsink_heat_capacity_mJ_K      = 270000,
        .heatsink_thermal_resistance_mK_W = 1200, /* [mK/W] heat sink to ambient; 0: insulated */
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
        .speed_points          = 37, /* points along speed, from standstill */
        .speed_step_log2       = 11, /* distance of the points is 2^this mrad/s, mechanical */
        .temperature_points    = 3, /* points along winding temperature */
        .temperature_step_log2 = 13, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = -2000, /* [cC] winding temperature of the first point */
        /* the entries count in 2^this mNm, the finest in which the largest fits */
        .lsb_log2              = 3,
        .torque_lsb = {
            /* a column every 2.048 rad/s, mechanical; in 8 mN m */
            /* -20 degC */
            -174, 488, 1164, 1871, 2627, 3326, 4025, 4723, 5421, 6118, 6815, 7511, 8206, 8900, 9593,
            10286, 10977, 11674, 12371, 13067, 13763, 14459, 15154, 15849, 16544, 17239, 17933,
            18627, 19321, 20015, 20708, 21401, 22093, 22787, 23482, 24176, 24869,
            /* 61.92 degC */
            -132, 371, 880, 1403, 1948, 2524, 3063, 3595, 4126, 4657, 5187, 5718, 6247, 6777, 7306,
            7834, 8362, 8894, 9426, 9959, 10491, 11023, 11556, 12088, 12620, 13153, 13685, 14218,
            14750, 15283, 15816, 16348, 16881, 17415, 17950, 18484, 19019,
            /* 143.84 degC */
            -107, 300, 709, 1125, 1552, 1995, 2459, 2903, 3332, 3761, 4190, 4618, 5046, 5474, 5902,
            6329, 6756, 7187, 7617, 8048, 8479, 8910, 9342, 9773, 10205, 10636, 11068, 11500, 11932,
            12365, 12797, 13230, 13662, 14097, 14531, 14966, 15401,
        },
    },
    .current_map = {
        /* odd: points along torque in the direction of rotation, braking first; the middle
         * one is zero torque */
        .torque_points         = 21,
        .torque_step_log2      = 11, /* distance of the points is 2^this mNm at the airgap */
        .speed_points          = 4, /* points along speed, from standstill */
        .speed_step_log2       = 15, /* distance of the points is 2^this mrad/s, mechanical */
        /* points along winding temperature; 1: the map does not depend on it */
        .temperature_points    = 1,
        .temperature_step_log2 = 6, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = 5000, /* [cC] winding temperature of the first point */
        /* the entries count in 2^this mA, the finest in which the largest fits */
        .lsb_log2              = 0,
        .current_d_lsb = {
            /* a column every 2.048 N m from -20.48 N m on; in 1 mA */
            /* 0 rad/s, 50 degC */
            -8432, -6937, -5559, -4311, -3202, -2243, -1444, -813, -357, -81, 0, -81, -357, -813,
            -1444, -2243, -3202, -4311, -5559, -6937, -8432,
            /* 32.768 rad/s, 50 degC */
            -9211, -7742, -6390, -5166, -4079, -3137, -2347, -1710, -1216, -793, -305, -955, -1385,
            -1936, -2637, -3494, -4503, -5657, -6948, -8365, -9899,
            /* 65.536 rad/s, 50 degC */
            -11168, -9700, -8345, -7115, -6016, -5054, -4228, -3527, -2911, -2158, -1349, -2580,
            -3207, -3868, -4639, -5545, -6592, -7776, -9093, -10533, -12087,
            /* 98.304 rad/s, 50 degC */
            -13352, -11878, -10516, -9275, -8159, -7170, -6305, -5541, -4818, -3877, -3308, -4442,
            -5218, -5966, -6796, -7744, -8823, -10033, -11370, -12827, -14396,
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
    .crc32 = 0x85870E43,
};
