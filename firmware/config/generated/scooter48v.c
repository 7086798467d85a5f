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
    .format_version = 4,
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
        .hydraulic_dead_time_ms      = 50, /* [ms] from a changed command until the hydraulic brake begins to move */
        .hydraulic_time_constant_ms  = 80, /* [ms] first-order lag of the hydraulic torque after the dead time; 0: none */
        .hydraulic_rate_mNm_s        = 300000, /* [mNm/s] fastest change of hydraulic torque */
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
            -1392, 3903, 9307, 14969, 21056, 27759, 34691, 40685, 46676, 52674,
            58669, 64659, 70645, 76636, 82624, 88608, 94587, 100572, 106552, 112530,
            118504, 124482, 130457, 136430, 142399, 148373, 154342, 160310, 166275, 172243,
            178208, 184171, 190131, 196094, 202054, 208013, 213968,
            /* 61.92 degC */
            -1057, 2970, 7040, 11222, 15578, 20186, 25128, 30505, 35529, 40094,
            44658, 49221, 53783, 58350, 62917, 67483, 72047, 76618, 81187, 85756,
            90324, 94898, 99472, 104045, 108618, 113197, 117775, 122353, 126932, 131515,
            136098, 140682, 145266, 149854, 154443, 159032, 163622,
            /* 143.84 degC */
            -852, 2400, 5671, 9001, 12417, 15959, 19668, 23584, 27762, 32256,
            36071, 39757, 43442, 47134, 50825, 54517, 58208, 61905, 65603, 69301,
            72999, 76703, 80408, 84115, 87821, 91533, 95246, 98960, 102675, 106395,
            110116, 113840, 117564, 121292, 125022, 128754, 132487,
        },
    },
    .current_map = {
        .torque_points    = 17, /* odd: points along torque in the direction of rotation, braking first; the middle one is no torque */
        .torque_step_log2 = 12, /* distance of the points is 2^this mNm at the airgap */
        .speed_points     = 17, /* points along speed, from standstill */
        .speed_step_log2  = 13, /* distance of the points is 2^this mrad/s, mechanical */
        .current_d_mA = {
            /* a column every 4.096 N m from -32.768 N m on */
            /* 0 rad/s */
            -19298, -15371, -11718, -8412, -5535, -3174, -1413, -323, 0, -323,
            -1413, -3174, -5535, -8412, -11718, -15371, -19298,
            /* 8.192 rad/s */
            -19205, -15300, -11670, -8386, -5533, -3195, -1456, -386, -12, -439,
            -1560, -3351, -5739, -8641, -11972, -15649, -19598,
            /* 16.384 rad/s */
            -19349, -15458, -11841, -8572, -5732, -3406, -1675, -602, -67, -698,
            -1853, -3670, -6080, -9003, -12352, -16046, -20012,
            /* 24.576 rad/s */
            -19624, -15742, -12134, -8875, -6043, -3723, -1991, -901, -166, -1036,
            -2226, -4068, -6498, -9436, -12801, -16509, -20489,
            /* 32.768 rad/s */
            -19985, -16109, -12508, -9254, -6427, -4108, -2372, -1253, -305, -1426,
            -2652, -4518, -6964, -9917, -13294, -17014, -21005,
            /* 40.96 rad/s */
            -20404, -16532, -12936, -9685, -6860, -4541, -2795, -1642, -487, -1851,
            -3114, -5002, -7464, -10430, -13818, -17548, -21549,
            /* 49.152 rad/s */
            -20865, -16996, -13402, -10154, -7330, -5007, -3250, -2055, -716, -2301,
            -3601, -5511, -7988, -10965, -14362, -18101, -22110,
            /* 57.344 rad/s */
            -21356, -17489, -13897, -10649, -7824, -5497, -3727, -2488, -1000, -2768,
            -4107, -6037, -8528, -11515, -14921, -18668, -22684,
            /* 65.536 rad/s */
            -21869, -18003, -14411, -11164, -8337, -6005, -4220, -2934, -1349, -3248,
            -4625, -6576, -9079, -12076, -15490, -19244, -23267,
            /* 73.728 rad/s */
            -22398, -18533, -14941, -11694, -8864, -6526, -4726, -3390, -1765, -3736,
            -5154, -7124, -9639, -12645, -16066, -19826, -23855,
            /* 81.92 rad/s */
            -22940, -19075, -15483, -12234, -9402, -7057, -5242, -3857, -2239, -4232,
            -5691, -7679, -10206, -13219, -16647, -20413, -24448,
            /* 90.112 rad/s */
            -23491, -19625, -16033, -12782, -9947, -7595, -5765, -4332, -2758, -4734,
            -6233, -8238, -10776, -13798, -17231, -21003, -25042,
            /* 98.304 rad/s */
            -24048, -20182, -16589, -13337, -10499, -8140, -6294, -4817, -3308, -5242,
            -6779, -8801, -11349, -14378, -17818, -21594, -25638,
            /* 106.496 rad/s */
            -24611, -20744, -17150, -13896, -11054, -8688, -6827, -5310, -3879, -5756,
            -7328, -9366, -11924, -14960, -18405, -22186, -26234,
            /* 114.688 rad/s */
            -25177, -21309, -17714, -14458, -11613, -9239, -7364, -5812, -4463, -6275,
            -7880, -9933, -12501, -15543, -18993, -22778, -26830,
            /* 122.88 rad/s */
            -25746, -21877, -18280, -15023, -12173, -9793, -7904, -6322, -5056, -6800,
            -8433, -10501, -13077, -16126, -19580, -23369, -27425,
            /* 131.072 rad/s */
            -26316, -22446, -18848, -15589, -12736, -10349, -8446, -6840, -5655, -7329,
            -8988, -11069, -13654, -16708, -20167, -23959, -28019,
        },
    },
    .crc32 = 0x3E285F5D,
};
