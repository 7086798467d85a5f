/*
 * Configuration "scooter48v": 48 V scooter hub, low inductance.
 *
 * Written by tools/regen_table 0.1.0 from scooter48v.toml; the same bytes as scooter48v.bin. Not edited by hand: change the
 * TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t CONFIG_SCOOTER48V;

CONFIG_SECTION const config_t CONFIG_SCOOTER48V = {
    .magic = CONFIG_MAGIC,
    .format_version = 3,
    .size_bytes = sizeof(config_t),
    .generator_version = 0x00000100,
    .name = "scooter48v",
    .motor = {
        .type                              = 1, /* 0 surface magnets (L_d = L_q), 1 interior magnets */
        .pole_pairs                        = 15, /* electrical turns in a mechanical turn */
        .phase_resistance_uOhm             = 21000, /* [uOhm] one phase, at reference_temperature_cC */
        .reference_temperature_cC          = 2500, /* [cC] winding temperature at which the resistance holds */
        .resistance_coefficient_ppm_K      = 3930, /* [ppm/K] rise of resistance with temperature; copper 3930 */
        .d_inductance_nH                   = 85000, /* [nH] direct axis */
        .q_inductance_nH                   = 150000, /* [nH] quadrature axis */
        .flux_linkage_nWb                  = 18000000, /* [nWb] peak phase flux linkage of the magnets (amplitude-invariant) */
        .flux_coefficient_ppm_K            = 0, /* [ppm/K] fall of the flux with temperature, magnets at winding temperature; NdFeB -1100; 0: constant */
        .iron_loss_resistance_mOhm         = 6000, /* [mOhm] constant part of R_i = a0 + a1 omega_e; both parts 0: no iron loss */
        .iron_loss_resistance_slope_nOhm_s = 10000000, /* [nOhm s] part of R_i proportional to electrical speed */
        .friction_torque_mNm               = 80, /* [mNm] Coulomb friction of bearings and seals */
        .viscous_friction_uNm_s            = 0, /* [uNm s] friction proportional to mechanical speed */
        .rated_torque_mNm                  = 10000, /* [mNm] continuous torque */
        .max_torque_mNm                    = 19000, /* [mNm] largest torque in either direction */
        .max_power_mW                      = 1000000, /* [mW] largest electromagnetic power in either direction */
        .max_phase_current_mA              = 50000, /* [mA] peak */
        .max_speed_mrad_s                  = 73304, /* [mrad/s] driving torque fades out here; braking torque does not */
        .derate_winding_temperature_cC     = 10000, /* [cC] torque limit starts to shrink */
        .max_winding_temperature_cC        = 12000, /* [cC] torque limit reaches zero */
    },
    .drive = {
        .current_full_scale_mA        = 82500, /* [mA] base of current: what half the converter's range stands for */
        .voltage_full_scale_mV        = 72000, /* [mV] base of voltage: what the converter's whole range stands for */
        .pwm_frequency_Hz             = 24000, /* [Hz] rate of the fast reach; base of speed is a sixteenth of it */
        .pwm_period_counts            = 3500, /* timer counts from 0 to the top of the centre-aligned count */
        .dead_time_ns                 = 500, /* [ns] between the two switches of a leg */
        .min_pulse_counts             = 168, /* shortest low-side pulse: sampling window of the shunts */
        .derate_switch_temperature_cC = 30000, /* [cC] torque limit starts to shrink */
        .max_switch_temperature_cC    = 30000, /* [cC] torque limit reaches zero */
    },
    .current_loop = {
        .bandwidth_Hz                   = 1000, /* [Hz] closed loop, first order after 1.5 periods of delay; for the record, the gains below realise it */
        .proportional_d_pu_q16          = 26323, /* [pu] L_d omega_c / (1 + 2 omega_c T), volts per ampere; raising: faster, less damped */
        .proportional_q_pu_q16          = 46452, /* [pu] L_q omega_c / (1 + 2 omega_c T), volts per ampere; raising: faster, less damped */
        .integral_d_pu_q24              = 82581, /* [pu] k_p R T / L, volts per ampere and PWM period: the regulator's zero on the winding's pole */
        .integral_q_pu_q24              = 82581, /* [pu] k_p R T / L, volts per ampere and PWM period: the regulator's zero on the winding's pole */
        .inductance_d_pu_q16            = 60158, /* [pu] omega_base L_d I_base / V_base, cross-coupling */
        .inductance_q_pu_q16            = 106161, /* [pu] omega_base L_q I_base / V_base, cross-coupling */
        .flux_pu_q16                    = 154416, /* [pu] omega_base psi / V_base, back-EMF */
        .modulation_limit_pu_q15        = 28798, /* [pu] largest |u| over u_dc/sqrt(3); below 1 keeps the sampling window */
        .max_current_pu_q15             = 19859, /* [pu] largest |i| the loop is asked for */
        .field_weakening_gain_pu_q15    = 0, /* [pu] current per unit of missing squared voltage and period; 0: no field weakening; raising: faster, less damped */
        .field_weakening_current_pu_q15 = 0, /* [pu] largest demagnetising current */
        .dead_time_zone_pu_q15          = 128, /* [pu] current below which the dead-time compensation is proportional */
    },
    .rotor = {
        .sensor                         = 1, /* 0 absolute electrical angle, 1 three hall sensors, 2 incremental encoder with index */
        .pll_bandwidth_Hz               = 50, /* [Hz] tracking of the angle, for the record */
        .pll_proportional_q16           = 1716, /* share of the angle error corrected in one PWM period */
        .pll_integral_q24               = 2875, /* share of the angle error added to the speed in one PWM period */
        .encoder_counts                 = 0, /* counts in a mechanical turn, four to a line; 0: no encoder */
        .encoder_index_turn             = 0, /* [turn] electrical angle at the index pulse */
        .encoder_index_tolerance_counts = 4, /* how far beside its place an index pulse is still the expected one: the width of the pulse */
        .encoder_reversed               = 0, /* 1: the count falls when turning forward */
        .edge_turn = {0, 10923, 21845, 32768, 43691, 54613},
    },
    .battery = {
        .driven_wheels            = 1, /* motors that share the pack; limits below are one motor's share */
        .max_charge_current_mA    = 10000, /* [mA] 0: no regeneration into the battery */
        .max_discharge_current_mA = 30000, /* [mA] */
        .foldback_voltage_mV      = 53508, /* [mV] charge limit starts to shrink */
        .max_voltage_mV           = 54600, /* [mV] charge limit reaches zero */
        .min_voltage_mV           = 39000, /* [mV] discharge limit reaches zero */
        .overvoltage_trip_mV      = 57330, /* [mV] bridge goes to its safe state */
        .undervoltage_trip_mV     = 35100, /* [mV] bridge goes to its safe state */
    },
    .brake = {
        .strategy                    = 2, /* 0 parallel_ratio, 1 parallel_free_travel, 2 series_optimal */
        .parallel_electric_share_q15 = 9830, /* electric part of the whole demand (parallel_ratio) */
        .electric_rated_torque_mNm   = 10000, /* [mNm] electric torque before the hydraulic brake adds (parallel) */
        .max_hydraulic_torque_mNm    = 50000, /* [mNm] 0: no hydraulic brake under this controller's command */
        .handover_start_mrad_s       = 4189, /* [mrad/s] electric braking starts to fade below this speed */
        .handover_end_mrad_s         = 1571, /* [mrad/s] no electric braking below this speed */
        .torque_rate_mNm_s           = 80000, /* [mNm/s] fastest change of motor torque that is asked for */
        .shortfall_band_mNm          = 950, /* [mNm] missing motor torque tolerated before the hydraulic brake fills it */
        .demand_timeout_ms           = 100, /* [ms] older demands count as lost */
    },
    .vehicle = {
        .wheel_radius_um = 127000, /* [um] rolling radius */
        .mass_g          = 95000, /* [g] for plausibility only */
        .wheel_position  = 0, /* address on CAN: 0 front left, 1 front right, 2 rear left, 3 rear right */
    },
    .monitor = {
        .overcurrent_pu_q15     = 25817, /* [pu] length of the current vector that trips, the peak of three sinusoidal phases */
        .current_sum_pu_q15     = 1638, /* [pu] largest |i_a + i_b + i_c| */
        .offset_tolerance_codes = 200, /* distance of a current sensor's zero from mid-range */
        .torque_tolerance_mNm   = 1900, /* [mNm] estimate against permitted torque */
        .torque_fault_time_ms   = 50, /* [ms] how long the torque may be wrong */
    },
    .regen_map = {
        .speed_points          = 37, /* points along speed, from standstill */
        .speed_step_log2       = 11, /* distance of the points is 2^this mrad/s, mechanical */
        .temperature_points    = 3, /* points along winding temperature */
        .temperature_step_log2 = 13, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = -2000, /* [cC] winding temperature of the first point */
        .torque_mNm = {
            /* a column every 2.048 rad/s, mechanical */
            /* -20 degC */
            -1392, 3901, 9307, 14971, 21051, 27755, 34710, 40699, 46683, 52686,
            58686, 64683, 70675, 76663, 82646, 88624, 94598, 100586, 106572, 112554,
            118533, 124509, 130480, 136449, 142414, 148390, 154364, 160335, 166303, 172269,
            178232, 184192, 190149, 196115, 202078, 208039, 213996,
            /* 61.92 degC */
            -1057, 2972, 7043, 11220, 15578, 20184, 25131, 30500, 35534, 40103,
            44671, 49239, 53805, 58371, 62934, 67496, 72055, 76629, 81202, 85774,
            90347, 94918, 99489, 104059, 108629, 113210, 117791, 122372, 126953, 131535,
            136116, 140699, 145280, 149870, 154461, 159053, 163643,
            /* 143.84 degC */
            -852, 2398, 5674, 8999, 12414, 15963, 19670, 23590, 27764, 32258,
            36082, 39771, 43461, 47150, 50839, 54527, 58215, 61914, 65615, 69316,
            73018, 76720, 80422, 84126, 87830, 91543, 95259, 98975, 102692, 106412,
            110131, 113853, 117575, 121305, 125037, 128771, 132505,
        },
    },
    .current_map = {
        .torque_points    = 17, /* odd: points along torque in the direction of rotation, braking first; the middle one is no torque */
        .torque_step_log2 = 12, /* distance of the points is 2^this mNm at the airgap */
        .speed_points     = 9, /* points along speed, from standstill */
        .speed_step_log2  = 14, /* distance of the points is 2^this mrad/s, mechanical */
        .current_d_mA = {
            /* a column every 4.096 N m from -32.768 N m on */
            /* 0 rad/s */
            -19311, -15388, -11740, -8439, -5567, -3211, -1454, -368, 0, -368,
            -1454, -3211, -5567, -8439, -11740, -15388, -19311,
            /* 16.384 rad/s */
            -19371, -15483, -11871, -8606, -5771, -3450, -1721, -639, -67, -734,
            -1899, -3712, -6117, -9034, -12378, -16067, -20029,
            /* 32.768 rad/s */
            -20002, -16130, -12533, -9284, -6462, -4147, -2411, -1267, -305, -1436,
            -2692, -4556, -6998, -9946, -13318, -17033, -21020,
            /* 49.152 rad/s */
            -20880, -17015, -13426, -10182, -7362, -5044, -3284, -2050, -716, -2288,
            -3637, -5547, -8020, -10992, -14384, -18119, -22124,
            /* 65.536 rad/s */
            -21883, -18021, -14434, -11191, -8369, -6040, -4250, -2919, -1349, -3221,
            -4658, -6611, -9111, -12103, -15512, -19261, -23280,
            /* 81.92 rad/s */
            -22954, -19092, -15505, -12261, -9433, -7090, -5267, -3846, -2239, -4204,
            -5721, -7712, -10236, -13246, -16668, -20430, -24461,
            /* 98.304 rad/s */
            -24062, -20199, -16611, -13363, -10529, -8171, -6316, -4817, -3308, -5222,
            -6807, -8834, -11379, -14404, -17839, -21611, -25651,
            /* 114.688 rad/s */
            -25191, -21326, -17735, -14484, -11642, -9270, -7385, -5825, -4463, -6266,
            -7906, -9965, -12530, -15568, -19014, -22794, -26843,
            /* 131.072 rad/s */
            -26329, -22463, -18869, -15614, -12765, -10378, -8466, -6865, -5655, -7330,
            -9013, -11100, -13683, -16733, -20187, -23976, -28032,
        },
    },
    .crc32 = 0x65EF78DC,
};
