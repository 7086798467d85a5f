/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Configuration "ipm400v": 400 V interior-magnet traction motor.
 *
 * Written by tools/regen_table 0.1.0 from ipm400v.toml; the same bytes as ipm400v.bin. Do not
 * edit: change the TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the
 * section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t CONFIG_IPM400V;

CONFIG_SECTION const config_t CONFIG_IPM400V = {
    .magic = CONFIG_MAGIC,
    .format_version = 16,
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
        .max_torque_mNm                    = 115000, /* [mNm] largest torque in either direction */
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
        .edge_turn = {0, 10923, 21845, 32768, 43691, 54613},
    },
    .battery = {
        /* motors that share the pack; limits below are one motor's share */
        .driven_wheels                 = 1,
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
        /* [uOhm] series resistance of the pack times driven_wheels: voltage per ampere of one
         * motor when all motors take the same; 0: not counted, the fold-back then overshoots
         * its line */
        .resistance_uOhm               = 60000,
        .overvoltage_trip_mV           = 423150, /* [mV] bridge goes to its safe state */
        .undervoltage_trip_mV          = 270000, /* [mV] bridge goes to its safe state */
    },
    .brake = {
        /* 0 parallel_ratio, 1 parallel_free_travel, 2 series_optimal */
        .strategy                      = 2,
        /* electric part of the whole demand (parallel_ratio) */
        .parallel_electric_share_q15   = 6554,
        /* [mNm] electric torque above which the hydraulic brake adds torque (parallel
         * strategies) */
        .electric_rated_torque_mNm     = 70000,
        /* [mNm] 0: no hydraulic brake commanded by this controller */
        .max_hydraulic_torque_mNm      = 700000,
        /* [ms] from a changed command until the hydraulic brake begins to move */
        .hydraulic_dead_time_ms        = 30,
        /* [ms] first-order lag of the hydraulic torque after the dead time; 0: none */
        .hydraulic_time_constant_ms    = 60,
        .hydraulic_rate_mNm_s          = 3000000, /* [mNm/s] fastest change of hydraulic torque */
        /* [ms] reports of the measured hydraulic torque that are missing or implausible for
         * longer are not used; 0: none is used; default 70 */
        .hydraulic_timeout_ms          = 70,
        /* [ms] from the hydraulic torque to its report; default 10 */
        .hydraulic_report_delay_ms     = 10,
        /* the gain of the hydraulic brake is learned within 1 -+ this; 0: not learned;
         * default 0.25 */
        .hydraulic_gain_band_q15       = 8192,
        /* [mNm] a report is implausible farther from what the commands explain; default 5 %
         * of max_hydraulic_torque_mNm */
        .hydraulic_tolerance_mNm       = 35000,
        .hydraulic_watch_inertia_g_m2  = 4794, /* [g m^2] vehicle's share here; 0: no watch */
        .hydraulic_watch_speed_mrad_s  = 2087, /* [mrad/s] lost or gained beyond the tolerance */
        .hydraulic_watch_floor_mrad_s2 = 1739, /* [mrad/s^2] tolerated; default 0.1 m/s^2 */
        .hydraulic_watch_share_q15     = 4915, /* and of the hydraulic torque; default 0.15 */
        .hydraulic_watch_road_mrad_s2  = 10, /* [mrad/s^2] of a road, per rad; default 0.001/m */
        .hydraulic_watch_drag_uNm_s2   = 73, /* [uN m s^2] air drag over the squared speed */
        /* [ms] in which motor torque above a fallen deferrable limit goes down to a tenth,
         * with feedback at most twice as long; 0: at once; default hydraulic_dead_time_ms and
         * 2.3 hydraulic_time_constant_ms */
        .bridging_time_ms              = 168,
        /* 1: where the battery takes nothing, the motor brakes with what its own losses take;
         * default 1 */
        .loss_braking                  = 1,
        /* [mrad/s] electric braking starts to fade below this speed */
        .blend_out_start_mrad_s        = 24086,
        .blend_out_end_mrad_s          = 9425, /* [mrad/s] no electric braking below this speed */
        /* [mNm/s] rate limit of the motor torque command */
        .torque_rate_mNm_s             = 1500000,
        /* [mNm] shortfall of motor torque tolerated before the hydraulic brake adds it;
         * default 5 % of motor.max_torque_mNm */
        .shortfall_band_mNm            = 5750,
        /* [ms] largest age of a demand; an older one has timed out; default 100 */
        .demand_timeout_ms             = 100,
        /* [ms] torque that the motor reaches within this time counts as available; raising:
         * the hydraulic brake adds torque later for a motor short of voltage; default 100 */
        .motor_arrival_ms              = 100,
        /* [ms] time without electric braking after an anti-lock intervention; default 300 */
        .abs_hold_ms                   = 300,
        /* squared modulation index at which the torque no longer grows; default 0.96 */
        .torque_growth_end_q15         = 31457,
        /* share of torque_rate_mNm_s per unit of that square below its end; raising: full
         * rate up to a higher modulation index; default 1/0.07 */
        .torque_growth_slope_q9        = 25600,
        /* [mm/s^2] deceleration without a braking demand above which the stop lamp is lit;
         * default 1300 */
        .stop_lamp_on_mm_s2            = 1300,
        /* [mm/s^2] deceleration below which it is switched off; default 700 */
        .stop_lamp_off_mm_s2           = 700,
        /* time constant of its low-passes of speed and of deceleration, 2^this ms; default 6 */
        .stop_lamp_filter_log2         = 6,
    },
    .vehicle = {
        .wheel_radius_um = 57500, /* [um] rolling radius */
        .mass_g          = 1450000, /* [g] for plausibility only */
        /* address on CAN: 0 front left, 1 front right, 2 rear left, 3 rear right */
        .wheel_position  = 0,
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
         * limits' sum */
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
        /* [cC] the ambient of the estimate is the colder sensor's reading at the start, at
         * most this; default 4000 */
        .warmest_ambient_cC        = 4000,
        /* [permille] the back-EMF differs this much, and its uncertainty, from the magnets':
         * a warning; default 150 */
        .flux_tolerance_permille   = 150,
        /* [cC] a temperature sensor that moves less than a quarter of it while the estimate
         * moves by it is stuck; 0: not checked; default 1500 */
        .stuck_rise_cC             = 1500,
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
    .regen_map = {
        .speed_points          = 47, /* points along speed, from standstill */
        .speed_step_log2       = 9, /* distance of the points is 2^this mrad/s, mechanical */
        .temperature_points    = 17, /* points along winding temperature */
        .temperature_step_log2 = 10, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = -2000, /* [cC] winding temperature of the first point */
        .torque_mNm = {
            /* a column every 0.512 rad/s, mechanical */
            /* -20 degC */
            -2236, 3, 7, 347, 1256, 2200, 3210, 4271, 5388, 6579, 7861, 9350, 11051, 13013, 15303,
            18065, 21393, 25528, 30673, 37349, 46127, 58183, 75217, 100435, 126094, 131510, 136935,
            142369, 147810, 153260, 158717, 164180, 169650, 175126, 180609, 186097, 191592, 197094,
            202600, 208111, 213628, 219150, 224677, 230209, 235746, 241290, 246837,
            /* -9.76 degC */
            -2130, 3, 5, 305, 1137, 2037, 2975, 3968, 5012, 6114, 7306, 8626, 10136, 11881, 13885,
            16254, 19087, 22494, 26723, 31996, 38802, 47780, 60044, 77167, 102496, 126278, 131481,
            136692, 141910, 147136, 152368, 157608, 162854, 168104, 173362, 178625, 183895, 189169,
            194449, 199735, 205025, 210320, 215620, 220925, 226235, 231549, 236868,
            /* 0.48 degC */
            -2031, 3, 5, 254, 1048, 1885, 2776, 3704, 4662, 5699, 6814, 7982, 9342, 10895, 12676,
            14736, 17172, 20061, 23546, 27895, 33327, 40218, 49411, 61668, 78928, 104214, 126417,
            131420, 136432, 141450, 146476, 151506, 156543, 161587, 166636, 171689, 176750, 181815,
            186885, 191959, 197039, 202124, 207214, 212306, 217404, 222507, 227615,
            /* 10.72 degC */
            -1940, 2, 5, 218, 970, 1749, 2576, 3440, 4352, 5320, 6345, 7438, 8640, 10036, 11610,
            13428, 15524, 18022, 20970, 24511, 28971, 34508, 41576, 50835, 63163, 80508, 105587,
            126515, 131333, 136159, 140990, 145828, 150672, 155520, 160375, 165234, 170100, 174970,
            179844, 184724, 189607, 194496, 199387, 204285, 209187, 214091, 219002,
            /* 20.96 degC */
            -1854, 2, 5, 182, 891, 1630, 2394, 3218, 4068, 4969, 5910, 6941, 8028, 9271, 10695,
            12296, 14157, 16289, 18844, 21857, 25521, 29978, 35624, 42772, 52137, 64537, 82082,
            107183, 126576, 131221, 135872, 140530, 145192, 149861, 154533, 159211, 163895, 168582,
            173275, 177971, 182672, 187378, 192087, 196802, 201519, 206239, 210966,
            /* 31.2 degC */
            -1774, 2, 5, 147, 812, 1507, 2239, 2996, 3796, 4640, 5535, 6479, 7490, 8597, 9871,
            11309, 12949, 14829, 17040, 19602, 22650, 26421, 30936, 36653, 43883, 53253, 65968,
            83359, 108170, 126603, 131086, 135575, 140068, 144567, 149070, 153578, 158092, 162610,
            167131, 171657, 176187, 180722, 185260, 189802, 194347, 198898, 203451,
            /* 41.44 degC */
            -1699, 2, 5, 118, 750, 1406, 2093, 2803, 3545, 4354, 5173, 6064, 6994, 8003, 9141,
            10437, 11896, 13563, 15466, 17728, 20339, 23433, 27258, 31824, 37594, 44925, 54348,
            67102, 84386, 109072, 126600, 130930, 135265, 139605, 143950, 148299, 152653, 157011,
            161373, 165740, 170110, 174484, 178862, 183243, 187628, 192016, 196408,
            /* 51.68 degC */
            -1629, 2, 5, 97, 690, 1302, 1950, 2622, 3316, 4061, 4856, 5678, 6544, 7481, 8491, 9663,
            10974, 12448, 14150, 16067, 18371, 21013, 24160, 28034, 32610, 38492, 45830, 55336,
            68000, 85230, 109630, 126569, 130755, 134947, 139143, 143341, 147546, 151754, 155966,
            160183, 164402, 168624, 172852, 177082, 181316, 185554, 189794,
            /* 61.92 degC */
            -1563, 2, 4, 77, 620, 1206, 1814, 2451, 3109, 3804, 4551, 5327, 6136, 7001, 7924, 8963,
            10150, 11482, 12983, 14693, 16698, 18965, 21641, 24876, 28747, 33506, 39236, 46670,
            56151, 68870, 85960, 110195, 126511, 130562, 134618, 138676, 142740, 146808, 150878,
            154953, 159032, 163113, 167198, 171287, 175378, 179473, 183571,
            /* 72.16 degC */
            -1500, 2, 4, 64, 569, 1120, 1692, 2293, 2916, 3567, 4261, 4969, 5749, 6558, 7424, 8348,
            9414, 10615, 11953, 13471, 15201, 17241, 19539, 22243, 25528, 29413, 34208, 39973,
            47415, 56903, 69460, 86534, 110388, 126429, 130353, 134279, 138211, 142145, 146084,
            150024, 153970, 157917, 161870, 165823, 169782, 173742, 177706,
            /* 82.4 degC */
            -1441, 2, 4, 25, 526, 1048, 1585, 2150, 2737, 3352, 3989, 4683, 5399, 6157, 6944, 7810,
            8755, 9835, 11044, 12397, 13936, 15675, 17721, 20067, 22801, 26121, 30006, 34814, 40647,
            48076, 57682, 70161, 86958, 110474, 126326, 130128, 133934, 137743, 141555, 145372,
            149191, 153012, 156839, 160666, 164497, 168330, 172168,
            /* 92.64 degC */
            -1385, 2, 4, 25, 483, 977, 1470, 2014, 2572, 3130, 3739, 4397, 5055, 5778, 6522, 7323,
            8168, 9144, 10237, 11448, 12820, 14372, 16124, 18193, 20546, 23287, 26644, 30544, 35404,
            41364, 48652, 58284, 70576, 87173, 110346, 126201, 129890, 133580, 137274, 140971,
            144671, 148374, 152079, 155788, 159499, 163215, 166931,
            /* 102.88 degC */
            -1332, 1, 4, 18, 433, 905, 1385, 1878, 2393, 2944, 3524, 4125, 4740, 5413, 6107, 6858,
            7649, 8515, 9506, 10609, 11828, 13205, 14759, 16575, 18607, 20997, 23766, 27125, 31059,
            35916, 41839, 49339, 58734, 70934, 87406, 110167, 126058, 129637, 133218, 136803,
            140390, 143981, 147574, 151169, 154768, 158368, 161972,
            /* 113.12 degC */
            -1282, 1, 4, 13, 404, 828, 1284, 1764, 2257, 2763, 3302, 3867, 4456, 5079, 5756, 6436,
            7173, 7960, 8848, 9844, 10946, 12182, 13566, 15130, 16954, 19023, 21413, 24189, 27567,
            31494, 36320, 42313, 49711, 59092, 71188, 87427, 109795, 125897, 129372, 132849, 136330,
            139814, 143300, 146787, 150278, 153772, 157268,
            /* 123.36 degC */
            -1234, 1, 4, 11, 361, 772, 1201, 1650, 2116, 2601, 3109, 3646, 4193, 4777, 5393, 6050,
            6733, 7459, 8253, 9156, 10158, 11266, 12511, 13903, 15480, 17319, 19381, 21771, 24649,
            27954, 31866, 36734, 42683, 50048, 59357, 71306, 87336, 109272, 125719, 129096, 132474,
            135857, 139240, 142627, 146016, 149407, 152801,
            /* 133.6 degC */
            -1189, 1, 4, 11, 326, 719, 1127, 1551, 1993, 2451, 2928, 3427, 3953, 4497, 5075, 5685,
            6324, 7001, 7731, 8532, 9441, 10444, 11559, 12805, 14200, 15788, 17621, 19702, 22122,
            24970, 28275, 32210, 37033, 42936, 50298, 59514, 71306, 87124, 108549, 125525, 128807,
            132093, 135380, 138671, 141962, 145256, 148553,
            /* 143.84 degC */
            -1146, 1, 4, 9, 297, 670, 1057, 1458, 1874, 2302, 2751, 3231, 3722, 4232, 4765, 5343,
            5945, 6575, 7253, 7968, 8796, 9705, 10715, 11832, 13083, 14487, 16060, 17914, 19995,
            22400, 25249, 28553, 32503, 37320, 43215, 50484, 59586, 71292, 86734, 107805, 125316,
            128510, 131706, 134903, 138102, 141303, 144508,
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
        .current_d_mA = {
            /* a column every 8.192 N m from -122.88 N m on */
            /* 0 rad/s, -20 degC */
            -123012, -117035, -110855, -104451, -97799, -90866, -83615, -76002, -67967, -59439,
            -50325, -40509, -29857, -18287, -6271, 0, -6271, -18287, -29857, -40509, -50325, -59439,
            -67967, -76002, -83615, -90866, -97799, -104451, -110855, -117035, -123012,
            /* 65.536 rad/s, -20 degC */
            -127252, -121161, -114864, -108339, -101560, -94495, -87106, -79347, -71158, -62465,
            -53174, -43164, -32297, -20477, -8191, -271, -8836, -21566, -33752, -44932, -55217,
            -64758, -73681, -82083, -90043, -97622, -104867, -111819, -118509, -124965, -131209,
            /* 131.072 rad/s, -20 degC */
            -139558, -133115, -126454, -119552, -112380, -104905, -97088, -88878, -80212, -71012,
            -61175, -50571, -39046, -26475, -13274, -2582, -14374, -28189, -41307, -53304, -64327,
            -74545, -84096, -93088, -101605, -109712, -117463, -124898, -132053, -138958, -145635,
            /* 196.608 rad/s, -20 degC */
            -152905, -146098, -139060, -131768, -124192, -116297, -108040, -99371, -90221, -80509,
            -70129, -58943, -46790, -33537, -19442, -9694, -20844, -35625, -49522, -62236, -73922,
            -84758, -94889, -104430, -113467, -122071, -130297, -138189, -145785, -153115, -160204,
            /* 262.144 rad/s, -20 degC */
            -165449, -158318, -150946, -143308, -135375, -127110, -118469, -109398, -99830, -89680,
            -78841, -67176, -54528, -40788, -26263, -17700, -27801, -43092, -57537, -70800, -83016,
            -94357, -104970, -114969, -124446, -133471, -142101, -150383, -158356, -166050, -173493,
            /* 327.68 rad/s, -20 degC */
            -176753, -169345, -161689, -153758, -145523, -136946, -127982, -118578, -108664, -98156,
            -86949, -74912, -61904, -47863, -33299, -25639, -34865, -50284, -65074, -78736, -91358,
            -103097, -114097, -124469, -134305, -143677, -152643, -161249, -169535, -177534,
            -185273,
            /* 393.216 rad/s, -20 degC */
            -186812, -179171, -171276, -163100, -154612, -145775, -136544, -126864, -116668,
            -105873, -94376, -82058, -68800, -54602, -40222, -33250, -41769, -57080, -72062, -86002,
            -98930, -110982, -122289, -132963, -143092, -152749, -161991, -170866, -179413, -187665,
            -195651,
            /* 458.752 rad/s, -20 degC */
            -195750, -187912, -179816, -171433, -162734, -153680, -144227, -134320, -123894,
            -112869, -101146, -88618, -75193, -60941, -46850, -40424, -48364, -63441, -78505,
            -92634, -105791, -118085, -129639, -140557, -150926, -160817, -170288, -179386, -188150,
            -196615, -204808,
            /* 524.288 rad/s, -20 degC */
            -203711, -195706, -187439, -178882, -170004, -160768, -151130, -141037, -130423,
            -119212, -107313, -94630, -81100, -66864, -53105, -47128, -54584, -69366, -84436,
            -98687, -112014, -124498, -136249, -147366, -157932, -168018, -177680, -186965, -195912,
            -204556, -212923,
            /* 589.824 rad/s, -20 degC */
            -210830, -202682, -194269, -185564, -176535, -167146, -157353, -147104, -136336,
            -124975, -112938, -100142, -86553, -72379, -58964, -53364, -60410, -74872, -89897,
            -104221, -117673, -130305, -142215, -153495, -164226, -174474, -184297, -193740,
            -202842, -211638, -220154,
            /* 655.36 rad/s, -20 degC */
            -217226, -208955, -200417, -191585, -182427, -172908, -162984, -152605, -141709,
            -130227, -118082, -105205, -91590, -77507, -64432, -59152, -65847, -79985, -94932,
            -109293, -122835, -135584, -147623, -159038, -169905, -180291, -190249, -199827,
            -209062, -217987, -226632,
            /* 720.896 rad/s, -20 degC */
            -222999, -214622, -205975, -197033, -187765, -178134, -168099, -157610, -146608,
            -135027, -122798, -109864, -96247, -82275, -69525, -64522, -70913, -84735, -99582,
            -113954, -127560, -140400, -152544, -164071, -175054, -185556, -195630, -205323,
            -214672, -223710, -232466,
            /* 786.432 rad/s, -20 degC */
            -228234, -219763, -211022, -201985, -192621, -182894, -172764, -162181, -151090,
            -139429, -127134, -114163, -100562, -86711, -74268, -69506, -75631, -89151, -103885,
            -118249, -131898, -144810, -157040, -168660, -179741, -190342, -200517, -210309,
            -219757, -228893, -237745,
            /* 851.968 rad/s, -20 degC */
            -233000, -224447, -215624, -206503, -197055, -187245, -177033, -166371, -155205,
            -143478, -131132, -118138, -104565, -90841, -78687, -74135, -80028, -93262, -107875,
            -122216, -135895, -148861, -161162, -172861, -184025, -194712, -204973, -214853,
            -224387, -233609, -242545,
            /* 917.504 rad/s, -20 degC */
            -237357, -228732, -219835, -210641, -201121, -191238, -180955, -170224, -158996,
            -147214, -134830, -121823, -108288, -94692, -82807, -78441, -84128, -97093, -111583,
            -125892, -139586, -152596, -164954, -176720, -187956, -198717, -209054, -219009,
            -228619, -237917, -246928,
            /* 983.04 rad/s, -20 degC */
            -241355, -232665, -223704, -214446, -204860, -194914, -184569, -173780, -162497,
            -150671, -138257, -125247, -111756, -98288, -86653, -82451, -87956, -100670, -115036,
            -129304, -143006, -156049, -168455, -180278, -191575, -202401, -212804, -222826,
            -232503, -241867, -250945,
            /* 1048.58 rad/s, -20 degC */
            -245036, -236289, -227270, -217954, -208311, -198309, -187910, -177069, -165742,
            -153879, -141443, -128436, -114992, -101651, -90248, -86193, -91535, -104015, -118257,
            -132481, -146183, -159251, -171697, -183567, -194918, -205800, -216261, -226343,
            -236080, -245503, -254640,
            /* 1114.11 rad/s, -20 degC */
            -248436, -239638, -230567, -221199, -211506, -201454, -191007, -180122, -168756,
            -156863, -144411, -131413, -118019, -104800, -93614, -89690, -94885, -107147, -121269,
            -135445, -149141, -162228, -174706, -186618, -198015, -208947, -219460, -229594,
            -239384, -248861, -258051,
            /* 1179.65 rad/s, -20 degC */
            -251586, -242741, -233624, -224211, -214472, -204376, -193886, -182963, -171563,
            -159645, -147182, -134196, -120855, -107755, -96769, -92963, -98027, -110086, -124090,
            -138216, -151902, -165002, -177507, -189454, -200892, -211868, -222427, -232608,
            -242446, -251970, -261209,
            /* 0 rad/s, 143.84 degC */
            -132362, -126325, -120078, -113598, -106857, -99821, -92448, -84687, -76469, -67706,
            -58280, -48025, -36705, -23990, -9519, 0, -9519, -23990, -36705, -48025, -58280, -67706,
            -76469, -84687, -92448, -99821, -106857, -113598, -120078, -126325, -132362,
            /* 65.536 rad/s, 143.84 degC */
            -134181, -128102, -121811, -115285, -108497, -101412, -93988, -86172, -77897, -69074,
            -59583, -49257, -37861, -25060, -10531, -177, -11249, -26252, -39426, -51139, -61744,
            -71487, -80542, -89032, -97051, -104666, -111933, -118895, -125587, -132039, -138273,
            /* 131.072 rad/s, 143.84 degC */
            -141803, -135499, -128977, -122212, -115174, -107828, -100130, -92026, -83446, -74297,
            -64455, -53746, -41923, -28635, -13573, -1232, -14730, -30514, -44382, -56699, -67843,
            -78079, -87589, -96506, -104926, -112923, -120553, -127863, -134888, -141661, -148206,
            /* 196.608 rad/s, 143.84 degC */
            -150842, -144277, -137483, -130437, -123106, -115455, -107439, -98999, -90063, -80536,
            -70287, -59137, -46827, -32992, -17260, -4533, -18708, -35296, -49833, -62742, -74422,
            -85149, -95117, -104463, -113288, -121669, -129666, -137328, -144692, -151790, -158650,
            /* 262.144 rad/s, 143.84 degC */
            -159866, -153045, -145988, -138667, -131052, -123105, -114778, -106013, -96735, -86843,
            -76205, -64634, -51868, -37534, -21206, -8880, -22840, -40104, -55218, -68650, -80809,
            -91981, -102363, -112099, -121293, -130026, -138359, -146342, -154016, -161414, -168563,
            /* 327.68 rad/s, 143.84 degC */
            -168368, -161312, -154013, -146442, -138567, -130349, -121739, -112678, -103088, -92866,
            -81878, -69933, -56766, -42008, -25239, -13392, -26985, -44748, -60337, -74214, -86787,
            -98345, -109091, -119169, -128689, -137732, -146363, -154632, -162581, -170244, -177650,
            /* 393.216 rad/s, 143.84 degC */
            -176205, -168939, -161422, -153626, -145518, -137058, -128197, -118872, -109005, -98492,
            -87196, -74926, -61417, -46312, -29248, -17871, -31054, -49159, -65131, -79381, -92308,
            -104199, -115259, -125636, -135440, -144754, -153645, -162165, -170355, -178252,
            -185885,
            /* 458.752 rad/s, 143.84 degC */
            -183373, -175920, -168209, -160213, -151899, -143224, -134139, -124581, -114470,
            -103702, -92138, -79588, -65791, -50407, -33166, -22232, -35000, -53321, -69598, -84159,
            -97386, -109563, -120895, -131532, -141583, -151135, -160254, -168993, -177396, -185498,
            -193329,
            /* 524.288 rad/s, 143.84 degC */
            -189918, -182297, -174415, -166241, -157743, -148878, -139595, -129831, -119506,
            -108515, -96718, -83927, -69887, -54282, -36955, -26432, -38795, -57236, -73754, -88574,
            -102057, -114481, -126049, -136912, -147180, -156940, -166259, -175191, -183781,
            -192064, -200070,
            /* 589.824 rad/s, 143.84 degC */
            -195899, -188130, -180094, -171762, -163100, -154066, -144608, -134663, -124149,
            -112961, -100961, -87963, -73720, -57942, -40594, -30452, -42429, -60917, -77624,
            -92661, -106362, -118999, -130773, -141833, -152292, -162235, -171731, -180834, -189588,
            -198031, -206193,
            /* 655.36 rad/s, 143.84 degC */
            -201379, -193476, -185303, -176830, -168022, -158837, -149223, -139116, -128435,
            -117075, -104898, -91721, -77308, -61394, -44075, -34285, -45897, -64379, -81233,
            -96450, -110339, -123161, -135116, -146350, -156976, -167082, -176734, -185988, -194890,
            -203475, -211775,
            /* 720.896 rad/s, 143.84 degC */
            -206413, -198390, -190094, -181494, -172555, -163235, -153482, -143231, -132402,
            -120889, -108556, -95226, -80669, -64653, -47396, -37931, -49201, -67638, -84604,
            -99974, -114024, -127008, -139121, -150509, -161284, -171533, -181325, -190715, -199747,
            -208460, -216884,
            /* 786.432 rad/s, 143.84 degC */
            -211052, -202921, -194513, -185798, -176742, -167301, -157423, -147043, -136082,
            -124433, -111964, -98500, -83822, -67730, -50560, -41396, -52347, -70710, -87761,
            -103258, -117447, -130573, -142826, -154351, -165259, -175637, -185553, -195064,
            -204214, -213041, -221577,
            /* 851.968 rad/s, 143.84 degC */
            -215339, -207110, -198601, -189783, -180621, -171070, -161079, -150585, -139504,
            -127736, -115146, -101565, -86786, -70638, -53573, -44687, -55340, -73609, -90722,
            -106326, -120637, -133887, -146264, -157911, -168938, -179431, -189460, -199080,
            -208337, -217267, -225903,
            /* 917.504 rad/s, 143.84 degC */
            -219313, -210995, -202395, -193483, -184223, -174574, -164481, -153882, -142696,
            -130819, -118123, -104440, -89576, -73389, -56440, -47812, -58188, -76349, -93506,
            -109199, -123615, -136976, -149464, -161220, -172354, -182952, -193082, -202801,
            -212153, -221177, -229905,
            /* 983.04 rad/s, 143.84 degC */
            -223007, -214607, -205923, -196926, -187579, -177839, -167654, -156961, -145678,
            -133705, -120914, -107142, -92206, -75995, -59170, -50781, -60899, -78942, -96128,
            -111896, -126404, -139863, -152450, -164305, -175535, -186227, -196450, -206258,
            -215698, -224807, -233618,
            /* 1048.58 rad/s, 143.84 degC */
            -226450, -217975, -209215, -200139, -190712, -180890, -170621, -159842, -148473,
            -136413, -123536, -109686, -94690, -78466, -61770, -53603, -63480, -81399, -98601,
            -114433, -129022, -142568, -155244, -167187, -178505, -189283, -199589, -209479,
            -218999, -228186, -237073,
            /* 1114.11 rad/s, 143.84 degC */
            -229666, -221123, -212292, -203145, -193644, -183747, -173401, -162544, -151096,
            -138957, -126005, -112086, -97040, -80813, -64247, -56286, -65940, -83730, -100939,
            -116823, -131483, -145107, -157864, -169887, -181285, -192141, -202524, -212489,
            -222082, -231340, -240297,
            /* 1179.65 rad/s, 143.84 degC */
            -232679, -224072, -215176, -205963, -196394, -186428, -176012, -165083, -153563,
            -141354, -128333, -114354, -99266, -83043, -66609, -58839, -68285, -85945, -103152,
            -119080, -133803, -147497, -160326, -172422, -183892, -194820, -205273, -215307,
            -224967, -234291, -243312,
        },
    },
    .crc32 = 0x6523EA0E,
};
