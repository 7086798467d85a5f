/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Configuration "wheel24v": hub wheel on a bench.
 *
 * Written by tools/regen_table 0.1.0; the same bytes as wheel24v.bin. Do not edit:
 * change the TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the
 * section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t CONFIG_WHEEL24V;

CONFIG_SECTION const config_t CONFIG_WHEEL24V = {
    .magic = CONFIG_MAGIC,
    .format_version = 23,
    .size_bytes = sizeof(config_t),
    .generator_version = 0x00000100,
    .name = "wheel24v",
    .motor = {
        /* 0 surface magnets (L_d = L_q), 1 interior magnets */
        .type                              = 0,
        .pole_pairs                        = 15, /* electrical turns in a mechanical turn */
        /* [uOhm] one phase, at reference_temperature_cC */
        .phase_resistance_uOhm             = 179300,
        /* [cC] winding temperature of phase_resistance_uOhm */
        .reference_temperature_cC          = 2500,
        /* [ppm/K] rise of resistance with temperature; copper 3930 */
        .resistance_coefficient_ppm_K      = 3930,
        .d_inductance_nH                   = 336000, /* [nH] direct axis */
        .q_inductance_nH                   = 336000, /* [nH] quadrature axis */
        /* [nWb] peak phase flux linkage of the magnets (amplitude-invariant) */
        .flux_linkage_nWb                  = 22970000,
        /* [ppm/K] fall of the flux with temperature, magnets at winding temperature; NdFeB
         * -1100; 0: constant */
        .flux_coefficient_ppm_K            = 0,
        /* [mOhm] constant part of R_i = a0 + a1 omega_e; both parts 0: no iron loss */
        .iron_loss_resistance_mOhm         = 20000,
        /* [nOhm s] part of R_i proportional to electrical speed */
        .iron_loss_resistance_slope_nOhm_s = 67000000,
        .friction_torque_mNm               = 50, /* [mNm] Coulomb friction of bearings and seals */
        /* [uNm s] friction proportional to mechanical speed */
        .viscous_friction_uNm_s            = 0,
        .rated_torque_mNm                  = 4000, /* [mNm] continuous torque */
        /* [mNm] largest torque in either direction; Demand carries no more for driving */
        .max_torque_mNm                    = 7000,
        /* [mW] largest electromagnetic power in either direction */
        .max_power_mW                      = 150000,
        .max_phase_current_mA              = 16000, /* [mA] peak */
        /* [mrad/s] driving torque fades out here; braking torque does not */
        .max_speed_mrad_s                  = 24086,
        /* last part of the speed range over which driving torque fades out; 0: a step at its
         * end; default 1/32 */
        .speed_fade_share_q15              = 1024,
        .derate_winding_temperature_cC     = 9000, /* [cC] start of the derating */
        /* [cC] end of the derating: torque limit zero */
        .max_winding_temperature_cC        = 11000,
    },
    .drive = {
        /* [mA] base of current: half the range of the converter */
        .current_full_scale_mA        = 60160,
        /* [mV] base of voltage: the whole range of the converter */
        .voltage_full_scale_mV        = 34280,
        /* [Hz] rate of the fast loop; base of speed is a sixteenth of it */
        .pwm_frequency_Hz             = 20000,
        .dead_time_ns                 = 500, /* [ns] between the two switches of a leg */
        /* [mV] forward voltage of the freewheeling diodes, opposes the current during the
         * dead time */
        .diode_drop_mV                = 800,
        /* [ns] half of the shortest low-side pulse: sampling window of the shunts */
        .min_pulse_ns                 = 1850,
        .derate_switch_temperature_cC = 8000, /* [cC] start of the derating */
        .max_switch_temperature_cC    = 10000, /* [cC] end of the derating: torque limit zero */
        /* [mV] rating of the bridge's devices and capacitors, which the bus must never reach;
         * not given: battery.overvoltage_trip_mV */
        .device_voltage_mV            = 34000,
        /* [nF] bus capacitors of this bridge; 0: unknown, a short circuit ends only without
         * current */
        .bus_capacitance_nF           = 0,
        .loss_per_ampere_uW_A         = 68755, /* [uW/A] of the bridge */
        .loss_resistance_uOhm         = 2452, /* [uOhm] of the switches */
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
        .proportional_d_pu_q16          = 97322,
        /* [pu] k_i / (1 - exp(-R T / L_q)), volts per ampere; raising: faster, less damped */
        .proportional_q_pu_q16          = 97322,
        /* [pu] a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the
         * regulator's zero on the winding's pole */
        .integral_d_pu_q24              = 664630,
        /* [pu] a (1 - a) R with a = exp(-omega_c T), volts per ampere and PWM period: the
         * regulator's zero on the winding's pole */
        .integral_q_pu_q24              = 664630,
        /* [pu] omega_base L_d I_base / V_base, cross-coupling */
        .inductance_d_pu_q16            = 303512,
        /* [pu] omega_base L_q I_base / V_base, cross-coupling */
        .inductance_q_pu_q16            = 303512,
        .flux_pu_q16                    = 344897, /* [pu] omega_base psi / V_base, back-EMF */
        /* [pu] largest |u| over u_dc/sqrt(3); below 1 keeps the sampling window */
        .modulation_limit_pu_q15        = 27170,
        /* [pu] |u| regulated by field weakening, over the radius of that circle; the
         * remaining voltage is for the loop's dynamics; raising: more torque at high speed,
         * slower torque changes; default 0.9689 */
        .modulation_target_pu_q15       = 31748,
        /* [pu] distance of |u| below the target in the torque limits, so that field weakening
         * only trims; default 1/128 of the target */
        .modulation_reserve_pu_q15      = 248,
        .max_current_pu_q15             = 8715, /* [pu] largest |i| of a current reference */
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
        .pll_proportional_q16           = 2059,
        /* share of the angle error added to the speed in one PWM period */
        .pll_integral_q24               = 4140,
        /* counts in a mechanical turn, four to a line; 0: no encoder */
        .encoder_counts                 = 0,
        .encoder_index_turn             = 0, /* [turn] electrical angle at the index pulse */
        /* largest distance of an index pulse from its expected count: the width of the pulse */
        .encoder_index_tolerance_counts = 4,
        .encoder_reversed               = 0, /* 1: the count falls when turning forward */
        /* [mrad/s] mechanical, from which the EMF observer watches the sensor and takes over
         * from it */
        .observer_speed_mrad_s          = 4800,
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
        .max_charge_current_mA         = 3000, /* [mA] 0: no regeneration into the battery */
        .max_discharge_current_mA      = 8000, /* [mA] */
        .foldback_voltage_mV           = 24500, /* [mV] start of the charge current fold-back */
        /* [mV] end of the charge current fold-back: limit zero */
        .max_voltage_mV                = 25000,
        /* [mV] end of the discharge current fold-back: limit zero */
        .min_voltage_mV                = 18000,
        /* [mV] start of the discharge current fold-back; default as far above min_voltage_mV
         * as foldback_voltage_mV is below max_voltage_mV */
        .discharge_foldback_voltage_mV = 18500,
        /* [uOhm] series resistance of the pack over this motor's share: voltage per ampere of
         * one motor when all motors take their shares; 0: not counted, the fold-back then
         * overshoots its line */
        .resistance_uOhm               = 80000,
        /* [ms] longest time constant of the current that the management reports: sensors of
         * the motor are compared with it over eight times this; counts only where it reports
         * one; default 2 s */
        .current_filter_ms             = 2000,
        .overvoltage_trip_mV           = 26250, /* [mV] bridge goes to its safe state */
        .undervoltage_trip_mV          = 16200, /* [mV] bridge goes to its safe state */
    },
    .brake = {
        /* 0 parallel_ratio, 1 parallel_free_travel, 2 series_optimal */
        .strategy                    = 2,
        /* electric part of the whole demand (parallel_ratio) */
        .parallel_electric_share_q15 = 6554,
        /* [mNm] electric torque above which the hydraulic brake adds torque (parallel
         * strategies) */
        .electric_rated_torque_mNm   = 4000,
        /* [mNm] 0: no hydraulic brake commanded by this controller; WheelBrake carries no
         * more */
        .max_hydraulic_torque_mNm    = 8000,
        /* [ms] from a changed command until the hydraulic brake begins to move */
        .hydraulic_dead_time_ms      = 50,
        /* [ms] first-order lag of the hydraulic torque after the dead time; 0: none */
        .hydraulic_time_constant_ms  = 80,
        .hydraulic_rate_mNm_s        = 50000, /* [mNm/s] fastest change of hydraulic torque */
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
        .hydraulic_tolerance_mNm     = 100,
        /* [ms] in which motor torque above a fallen deferrable limit goes down to a tenth,
         * with feedback at most twice as long; 0: at once; default hydraulic_dead_time_ms and
         * 2.3 hydraulic_time_constant_ms */
        .bridging_time_ms            = 234,
        /* 1: where the battery takes nothing, the motor brakes with what its own losses take;
         * default 1 */
        .loss_braking                = 1,
        /* [mrad/s] electric braking starts to fade below this speed */
        .blend_out_start_mrad_s      = 3142,
        .blend_out_end_mrad_s        = 1047, /* [mrad/s] no electric braking below this speed */
        .torque_rate_mNm_s           = 30000, /* [mNm/s] rate limit of the motor torque command */
        /* [mNm] shortfall of motor torque tolerated before the hydraulic brake adds it;
         * default 5 % of motor.max_torque_mNm */
        .shortfall_band_mNm          = 350,
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
        .wheel_radius_um = 82500, /* [um] rolling radius */
        .mass_g          = 10000, /* [g] the driven wheels share it in the estimate of the road */
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
        .direction_change_mrad_s = 10097,
        /* [mNm] hydraulic torque that holds the vehicle at standstill until it drives off; 0:
         * none */
        .hold_torque_mNm         = 0,
        /* [ms] from the driving demand until the hold is gone at the latest, unless the
         * vehicle rolls back; default 1000 */
        .hold_release_ms         = 1000,
        .largest_drive_mNm       = 8750, /* [mNm] a Demand beyond it is refused: README of comms */
        .largest_brake_mNm       = 18750, /* [mNm] a Demand beyond it is refused: README of comms */
        /* [ms] from zero to the largest, faster is refused; 0: none */
        .demand_rise_ms          = 20,
        .demand_lost_frames      = 2, /* Demand frames in a row that may be missing; default 2 */
    },
    .pedals = {
        .accelerator_channels   = 0, /* 0: the driving demand comes by CAN */
        .brake_channels         = 0, /* 0: the braking demand comes by CAN */
        .interpretation         = 0, /* brake pedal: 0 proportional, 1 free travel */
        /* [mNm] whole accelerator, wheel of share 1; default motor.max_torque_mNm */
        .drive_torque_mNm       = 7000,
        /* [mNm] braking torque of the released accelerator, wheel of share 1; 0: it coasts */
        .lift_off_torque_mNm    = 0,
        /* share of the accelerator over which lift-off braking fades out; default 0.15 */
        .lift_off_travel_q15    = 4915,
        /* [mNm] whole brake pedal, motor and hydraulic, wheel of share 1; default both
         * limits' sum, within the range */
        .brake_torque_mNm       = 15000,
        /* share of the brake pedal that is the friction brake's free travel; default 0.3 */
        .free_travel_q15        = 9830,
        /* [mNm] braking torque at its end; default brake.electric_rated_torque_mNm */
        .free_travel_torque_mNm = 4000,
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
        .overcurrent_pu_q15        = 11329,
        .overcurrent_periods       = 2, /* PWM periods in a row that trip; default 2 */
        .current_sum_pu_q15        = 1638, /* [pu] largest |i_a + i_b + i_c| */
        .current_dead_periods      = 2, /* a current that vanishes: PWM periods; default 2 */
        .current_missing_pu_q15    = 1440, /* [pu ms] reference times time without any current */
        /* largest distance of a current sensor's offset from mid-range */
        .offset_tolerance_codes    = 800,
        /* [mNm] largest excess of the estimated over the permitted torque */
        .torque_tolerance_mNm      = 700,
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
        .winding_sensor_fitted     = 0,
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
        .winding_heat_capacity_mJ_K       = 230000,
        .winding_thermal_resistance_mK_W  = 400, /* [mK/W] winding to housing; 0: insulated */
        /* [mJ/K] of one motor's iron and housing; 0: none between winding and ambient */
        .housing_heat_capacity_mJ_K       = 1500000,
        .housing_thermal_resistance_mK_W  = 1500, /* [mK/W] housing to ambient; 0: insulated */
        /* [mJ/K] of one inverter's switches; 0: as of the winding */
        .switch_heat_capacity_mJ_K        = 1000,
        .switch_thermal_resistance_mK_W   = 1000, /* [mK/W] switches to heat sink; 0: insulated */
        /* [mJ/K] of one inverter's heat sink; 0: none between switches and ambient */
        .heatsink_heat_capacity_mJ_K      = 15000,
        .heatsink_thermal_resistance_mK_W = 10000, /* [mK/W] heat sink to ambient; 0: insulated */
    },
    .temperature = {
        /* [code] least code of the winding's sensor; above winding_highest_code: none is
         * fitted */
        .winding_lowest_code  = 1,
        .winding_highest_code = 0, /* [code] its largest */
        .switch_lowest_code   = 77, /* [code] likewise of the switches' sensor */
        .switch_highest_code  = 3967, /* [code] its largest */
        .winding_cC = {0},
        .switch_cC = {-15442, -4291, -3138, -2396, -1832, -1369, -971, -619, -301, -8, 264, 519, 761, 992, 1214, 1427, 1634, 1835, 2032, 2224, 2413, 2600, 2784, 2966, 3148, 3328, 3508, 3687, 3867, 4048, 4230, 4413, 4597, 4784, 4974, 5167, 5363, 5563, 5767, 5977, 6192, 6414, 6643, 6881, 7128, 7385, 7655, 7938, 8237, 8554, 8892, 9255, 9648, 10075, 10547, 11072, 11665, 12348, 13151, 14128, 15367, 17049, 19612, 24663},
    },
    .regen_map = {
        .speed_points          = 7, /* points along speed, from standstill */
        .speed_step_log2       = 12, /* distance of the points is 2^this mrad/s, mechanical */
        .temperature_points    = 3, /* points along winding temperature */
        .temperature_step_log2 = 13, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = 0, /* [cC] winding temperature of the first point */
        /* the entries count in 2^this mNm, the finest in which the largest fits */
        .lsb_log2              = 0,
        .torque_lsb = {
            /* a column every 4.096 rad/s, mechanical; in 1 mN m */
            /* 0 degC */
            -72, 2180, 4422, 6656, 8885, 11109, 13329,
            /* 81.92 degC */
            -53, 1621, 3285, 4943, 6596, 8246, 9892,
            /* 163.84 degC */
            -42, 1292, 2618, 3937, 5252, 6563, 7872,
        },
    },
    .current_map = {
        /* odd: points along torque in the direction of rotation, braking first; the middle
         * one is zero torque */
        .torque_points         = 5,
        .torque_step_log2      = 12, /* distance of the points is 2^this mNm at the airgap */
        .speed_points          = 13, /* points along speed, from standstill */
        .speed_step_log2       = 11, /* distance of the points is 2^this mrad/s, mechanical */
        /* points along winding temperature; 1: the map does not depend on it */
        .temperature_points    = 1,
        .temperature_step_log2 = 6, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = 6000, /* [cC] winding temperature of the first point */
        /* the entries count in 2^this mA, the finest in which the largest fits */
        .lsb_log2              = 0,
        .current_d_lsb = {
            /* a column every 4.096 N m from -8.192 N m on; in 1 mA */
            /* 0 rad/s, 60 degC */
            0, 0, 0, 0, 0,
            /* 2.048 rad/s, 60 degC */
            6, 2, 0, -5, -9,
            /* 4.096 rad/s, 60 degC */
            8, 1, -2, -13, -19,
            /* 6.144 rad/s, 60 degC */
            7, -3, -5, -22, -31,
            /* 8.192 rad/s, 60 degC */
            3, -9, -10, -32, -43,
            /* 10.24 rad/s, 60 degC */
            -2, -16, -15, -43, -56,
            /* 12.288 rad/s, 60 degC */
            -9, -25, -22, -55, -70,
            /* 14.336 rad/s, 60 degC */
            -17, -34, -29, -68, -83,
            /* 16.384 rad/s, 60 degC */
            -26, -45, -37, -81, -98,
            /* 18.432 rad/s, 60 degC */
            -36, -56, -45, -94, -112,
            /* 20.48 rad/s, 60 degC */
            -46, -68, -54, -108, -127,
            /* 22.528 rad/s, 60 degC */
            -58, -80, -64, -122, -142,
            /* 24.576 rad/s, 60 degC */
            -69, -93, -74, -137, -157,
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
    .crc32 = 0x21A38476,
};
