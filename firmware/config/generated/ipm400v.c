/*
 * Configuration "ipm400v": 400 V interior-magnet traction motor.
 *
 * Written by tools/regen_table 0.1.0 from ipm400v.toml; the same bytes as ipm400v.bin. Not edited by hand: change the
 * TOML file and run ./tools/dev table. CONFIG_SECTION places the constant into the section that can be flashed alone.
 */
#include "config/config.h"

#ifndef CONFIG_SECTION
#define CONFIG_SECTION
#endif

extern const config_t CONFIG_IPM400V;

CONFIG_SECTION const config_t CONFIG_IPM400V = {
    .magic = CONFIG_MAGIC,
    .format_version = 3,
    .size_bytes = sizeof(config_t),
    .generator_version = 0x00000100,
    .name = "ipm400v",
    .motor = {
        .type                              = 1, /* 0 surface magnets (L_d = L_q), 1 interior magnets */
        .pole_pairs                        = 3, /* electrical turns in a mechanical turn */
        .phase_resistance_uOhm             = 18000, /* [uOhm] one phase, at reference_temperature_cC */
        .reference_temperature_cC          = 2500, /* [cC] winding temperature at which the resistance holds */
        .resistance_coefficient_ppm_K      = 3930, /* [ppm/K] rise of resistance with temperature; copper 3930 */
        .d_inductance_nH                   = 370000, /* [nH] direct axis */
        .q_inductance_nH                   = 1200000, /* [nH] quadrature axis */
        .flux_linkage_nWb                  = 66000000, /* [nWb] peak phase flux linkage of the magnets (amplitude-invariant) */
        .flux_coefficient_ppm_K            = -1100, /* [ppm/K] fall of the flux with temperature, magnets at winding temperature; NdFeB -1100; 0: constant */
        .iron_loss_resistance_mOhm         = 15000, /* [mOhm] constant part of R_i = a0 + a1 omega_e; both parts 0: no iron loss */
        .iron_loss_resistance_slope_nOhm_s = 20000000, /* [nOhm s] part of R_i proportional to electrical speed */
        .friction_torque_mNm               = 300, /* [mNm] Coulomb friction of bearings and seals */
        .viscous_friction_uNm_s            = 200, /* [uNm s] friction proportional to mechanical speed */
        .rated_torque_mNm                  = 70000, /* [mNm] continuous torque */
        .max_torque_mNm                    = 115000, /* [mNm] largest torque in either direction */
        .max_power_mW                      = 60000000, /* [mW] largest electromagnetic power in either direction */
        .max_phase_current_mA              = 200000, /* [mA] peak */
        .max_speed_mrad_s                  = 1151917, /* [mrad/s] driving torque fades out here; braking torque does not */
        .derate_winding_temperature_cC     = 13500, /* [cC] torque limit starts to shrink */
        .max_winding_temperature_cC        = 15500, /* [cC] torque limit reaches zero */
    },
    .drive = {
        .current_full_scale_mA        = 280000, /* [mA] base of current: what half the converter's range stands for */
        .voltage_full_scale_mV        = 500000, /* [mV] base of voltage: what the converter's whole range stands for */
        .pwm_frequency_Hz             = 10000, /* [Hz] rate of the fast reach; base of speed is a sixteenth of it */
        .pwm_period_counts            = 8400, /* timer counts from 0 to the top of the centre-aligned count */
        .dead_time_ns                 = 500, /* [ns] between the two switches of a leg */
        .min_pulse_counts             = 168, /* shortest low-side pulse: sampling window of the shunts */
        .derate_switch_temperature_cC = 13000, /* [cC] torque limit starts to shrink */
        .max_switch_temperature_cC    = 15000, /* [cC] torque limit reaches zero */
    },
    .current_loop = {
        .bandwidth_Hz                   = 500, /* [Hz] closed loop, first order after 1.5 periods of delay; for the record, the gains below realise it */
        .proportional_d_pu_q16          = 26199, /* [pu] L_d omega_c / (1 + 2 omega_c T), volts per ampere; raising: faster, less damped */
        .proportional_q_pu_q16          = 84969, /* [pu] L_q omega_c / (1 + 2 omega_c T), volts per ampere; raising: faster, less damped */
        .integral_d_pu_q24              = 39879, /* [pu] k_p R T / L, volts per ampere and PWM period: the regulator's zero on the winding's pole */
        .integral_q_pu_q24              = 39879, /* [pu] k_p R T / L, volts per ampere and PWM period: the regulator's zero on the winding's pole */
        .inductance_d_pu_q16            = 53325, /* [pu] omega_base L_d I_base / V_base, cross-coupling */
        .inductance_q_pu_q16            = 172945, /* [pu] omega_base L_q I_base / V_base, cross-coupling */
        .flux_pu_q16                    = 33971, /* [pu] omega_base psi / V_base, back-EMF */
        .modulation_limit_pu_q15        = 31113, /* [pu] largest |u| over u_dc/sqrt(3); below 1 keeps the sampling window */
        .max_current_pu_q15             = 23406, /* [pu] largest |i| the loop is asked for */
        .field_weakening_gain_pu_q15    = 146, /* [pu] current per unit of missing squared voltage and period; 0: no field weakening; raising: faster, less damped */
        .field_weakening_current_pu_q15 = 19895, /* [pu] largest demagnetising current */
        .dead_time_zone_pu_q15          = 128, /* [pu] current below which the dead-time compensation is proportional */
    },
    .rotor = {
        .sensor                         = 0, /* 0 absolute electrical angle, 1 three hall sensors, 2 incremental encoder with index */
        .pll_bandwidth_Hz               = 50, /* [Hz] tracking of the angle, for the record */
        .pll_proportional_q16           = 4118, /* share of the angle error corrected in one PWM period */
        .pll_integral_q24               = 16558, /* share of the angle error added to the speed in one PWM period */
        .encoder_counts                 = 0, /* counts in a mechanical turn, four to a line; 0: no encoder */
        .encoder_index_turn             = 0, /* [turn] electrical angle at the index pulse */
        .encoder_index_tolerance_counts = 4, /* how far beside its place an index pulse is still the expected one: the width of the pulse */
        .encoder_reversed               = 0, /* 1: the count falls when turning forward */
        .edge_turn = {0, 10923, 21845, 32768, 43691, 54613},
    },
    .battery = {
        .driven_wheels            = 1, /* motors that share the pack; limits below are one motor's share */
        .max_charge_current_mA    = 150000, /* [mA] 0: no regeneration into the battery */
        .max_discharge_current_mA = 300000, /* [mA] */
        .foldback_voltage_mV      = 394940, /* [mV] charge limit starts to shrink */
        .max_voltage_mV           = 403000, /* [mV] charge limit reaches zero */
        .min_voltage_mV           = 300000, /* [mV] discharge limit reaches zero */
        .overvoltage_trip_mV      = 423150, /* [mV] bridge goes to its safe state */
        .undervoltage_trip_mV     = 270000, /* [mV] bridge goes to its safe state */
    },
    .brake = {
        .strategy                    = 2, /* 0 parallel_ratio, 1 parallel_free_travel, 2 series_optimal */
        .parallel_electric_share_q15 = 6554, /* electric part of the whole demand (parallel_ratio) */
        .electric_rated_torque_mNm   = 70000, /* [mNm] electric torque before the hydraulic brake adds (parallel) */
        .max_hydraulic_torque_mNm    = 700000, /* [mNm] 0: no hydraulic brake under this controller's command */
        .handover_start_mrad_s       = 24086, /* [mrad/s] electric braking starts to fade below this speed */
        .handover_end_mrad_s         = 9425, /* [mrad/s] no electric braking below this speed */
        .torque_rate_mNm_s           = 1500000, /* [mNm/s] fastest change of motor torque that is asked for */
        .shortfall_band_mNm          = 5750, /* [mNm] missing motor torque tolerated before the hydraulic brake fills it */
        .demand_timeout_ms           = 100, /* [ms] older demands count as lost */
    },
    .vehicle = {
        .wheel_radius_um = 57500, /* [um] rolling radius */
        .mass_g          = 1450000, /* [g] for plausibility only */
        .wheel_position  = 0, /* address on CAN: 0 front left, 1 front right, 2 rear left, 3 rear right */
    },
    .monitor = {
        .overcurrent_pu_q15     = 30427, /* [pu] length of the current vector that trips, the peak of three sinusoidal phases */
        .current_sum_pu_q15     = 1638, /* [pu] largest |i_a + i_b + i_c| */
        .offset_tolerance_codes = 200, /* distance of a current sensor's zero from mid-range */
        .torque_tolerance_mNm   = 11500, /* [mNm] estimate against permitted torque */
        .torque_fault_time_ms   = 50, /* [ms] how long the torque may be wrong */
    },
    .regen_map = {
        .speed_points          = 47, /* points along speed, from standstill */
        .speed_step_log2       = 9, /* distance of the points is 2^this mrad/s, mechanical */
        .temperature_points    = 9, /* points along winding temperature */
        .temperature_step_log2 = 11, /* distance of the points is 2^this hundredths of a degree */
        .temperature_origin_cC = -2000, /* [cC] winding temperature of the first point */
        .torque_mNm = {
            /* a column every 0.512 rad/s, mechanical */
            /* -20 degC */
            -2236, 1, 9, 235, 1071, 1958, 2959, 4025, 5194, 6446,
            7863, 9444, 11189, 13201, 15531, 18081, 21298, 25205, 29971, 37355,
            45140, 57640, 74535, 100723, 139784, 145799, 151825, 157861, 163908, 169964,
            176030, 182106, 188188, 194281, 200383, 206493, 212611, 218737, 224871, 231013,
            237162, 243319, 249483, 255654, 261833, 268016, 274208,
            /* 0.48 degC */
            -2031, 1, 8, 162, 914, 1707, 2572, 3481, 4478, 5559,
            6731, 8027, 9459, 11062, 12876, 14917, 17199, 20025, 23447, 27587,
            33584, 39974, 48268, 60895, 77854, 104064, 138754, 144263, 149781, 155308,
            160845, 166389, 171941, 177503, 183072, 188649, 194234, 199826, 205426, 211032,
            216646, 222267, 227895, 233529, 239170, 244816, 250470,
            /* 20.96 degC */
            -1854, 1, 5, 115, 779, 1495, 2236, 3039, 3868, 4829,
            5817, 6917, 8097, 9400, 10868, 12497, 14351, 16382, 18895, 21843,
            25402, 29656, 35705, 42549, 52137, 63786, 80852, 106675, 137559, 142629,
            147707, 152793, 157885, 162987, 168096, 173213, 178336, 183467, 188604, 193748,
            198899, 204056, 209220, 214390, 219566, 224746, 229935,
            /* 41.44 degC */
            -1699, 1, 5, 71, 670, 1287, 1958, 2660, 3412, 4211,
            5048, 6001, 7001, 8097, 9291, 10616, 12090, 13738, 15626, 17756,
            20360, 23454, 27151, 31560, 37693, 44697, 54470, 67263, 84502, 108528,
            136232, 140917, 145609, 150310, 155017, 159731, 164452, 169179, 173913, 178653,
            183400, 188152, 192911, 197675, 202445, 207220, 212001,
            /* 61.92 degC */
            -1563, 1, 5, 49, 549, 1130, 1714, 2338, 2996, 3692,
            4449, 5278, 6103, 7027, 8005, 9119, 10302, 11653, 13136, 14808,
            16712, 18979, 21664, 24875, 28711, 33557, 39315, 46550, 56237, 68934,
            86053, 109967, 134798, 139145, 143499, 147859, 152225, 156598, 160976, 165361,
            169751, 174147, 178549, 182956, 187369, 191786, 196210,
            /* 82.4 degC */
            -1441, 1, 5, 34, 491, 980, 1495, 2057, 2660, 3266,
            3912, 4606, 5343, 6143, 7001, 7910, 8907, 9981, 11182, 12518,
            14008, 15693, 17662, 20024, 22793, 26112, 30090, 34770, 40739, 48186,
            57697, 70161, 86998, 110346, 133280, 137327, 141379, 145437, 149500, 153569,
            157644, 161724, 165810, 169900, 173996, 178096, 182202,
            /* 102.88 degC */
            -1332, 1, 5, 27, 407, 856, 1327, 1823, 2346, 2890,
            3467, 4069, 4708, 5387, 6125, 6910, 7739, 8633, 9637, 10704,
            11890, 13227, 14707, 16468, 18476, 20889, 23779, 27171, 31277, 35673,
            41918, 49153, 58813, 70984, 87316, 110367, 131694, 135472, 139254, 143042,
            146835, 150633, 154436, 158244, 162057, 165873, 169696,
            /* 123.36 degC */
            -1234, 1, 5, 20, 334, 735, 1166, 1615, 2072, 2572,
            3053, 3605, 4157, 4763, 5394, 6066, 6782, 7545, 8370, 9265,
            10222, 11295, 12472, 13768, 15258, 17083, 19101, 21612, 24518, 28038,
            32302, 36359, 42711, 49461, 59536, 71199, 87177, 109694, 131072, 133588,
            137128, 140673, 144223, 147777, 151336, 154898, 158466,
            /* 143.84 degC */
            -1146, 1, 5, 16, 268, 648, 1020, 1429, 1842, 2273,
            2725, 3204, 3681, 4211, 4763, 5343, 5950, 6618, 7319, 8082,
            8871, 9743, 10701, 11738, 12881, 14199, 15635, 17527, 19627, 22076,
            24983, 28731, 32767, 36775, 43314, 49418, 59779, 71020, 86447, 108206,
            131070, 131682, 135003, 138329, 141659, 144992, 148330,
        },
    },
    .current_map = {
        .torque_points    = 17, /* odd: points along torque in the direction of rotation, braking first; the middle one is no torque */
        .torque_step_log2 = 14, /* distance of the points is 2^this mNm at the airgap */
        .speed_points     = 17, /* points along speed, from standstill */
        .speed_step_log2  = 17, /* distance of the points is 2^this mrad/s, mechanical */
        .current_d_mA = {
            /* a column every 16.384 N m from -131.072 N m on */
            /* 0 rad/s */
            -133349, -121517, -108855, -95165, -80153, -63361, -44018, -20871, 0, -20871,
            -44018, -63361, -80153, -95165, -108855, -121517, -133349,
            /* 131.072 rad/s */
            -146129, -133608, -120210, -105722, -89835, -72061, -51581, -27025, -1752, -28791,
            -54395, -75686, -94145, -110635, -125666, -139565, -152551,
            /* 262.144 rad/s */
            -168002, -154317, -139676, -123850, -106501, -87105, -64782, -38085, -12452, -40501,
            -68594, -92009, -112328, -130492, -147054, -162372, -176686,
            /* 393.216 rad/s */
            -187070, -172440, -156795, -139894, -121384, -100725, -77030, -48961, -24226, -51612,
            -81229, -106140, -127827, -147242, -164963, -181362, -196693,
            /* 524.288 rad/s */
            -202645, -187295, -170889, -153179, -133808, -112234, -87595, -58784, -35136, -61505,
            -91951, -117869, -140527, -160852, -179424, -196624, -212713,
            /* 655.36 rad/s */
            -215396, -199492, -182504, -164182, -144167, -121925, -96642, -67478, -44906, -70202,
            -101056, -127657, -151015, -172013, -191224, -209029, -225693,
            /* 786.432 rad/s */
            -225978, -209640, -192198, -173402, -152896, -130158, -104431, -75145, -53564, -77847,
            -108857, -135929, -159803, -181310, -201012, -219285, -236397,
            /* 917.504 rad/s */
            -234890, -218204, -200401, -181230, -160342, -137229, -111193, -81921, -61228, -84592,
            -115610, -143008, -167271, -189173, -209260, -227906, -245375,
            /* 1048.58 rad/s */
            -242494, -225526, -207429, -187958, -166766, -143365, -117112, -87934, -68026, -90571,
            -121511, -149136, -173698, -195913, -216309, -235254, -253013,
            /* 1179.65 rad/s */
            -249060, -231857, -213519, -193802, -172365, -148739, -122336, -93298, -74079, -95901,
            -126710, -154495, -179290, -201756, -222403, -241596, -259594,
            /* 1310.72 rad/s */
            -254788, -237387, -218848, -198926, -177290, -153485, -126977, -98104, -79492, -100676,
            -131326, -159222, -184201, -206872, -227728, -247126, -265325,
            /* 1441.79 rad/s */
            -259829, -242261, -223550, -203457, -181655, -157707, -131129, -102432, -84357, -104975,
            -135452, -163424, -188550, -211390, -232421, -251993, -270363,
            /* 1572.86 rad/s */
            -264300, -246588, -227732, -207493, -185552, -161488, -134864, -106347, -88747, -108863,
            -139162, -167183, -192429, -215411, -236590, -256311, -274827,
            /* 1703.94 rad/s */
            -268295, -250457, -231474, -211111, -189053, -164894, -138241, -109904, -92726, -112395,
            -142515, -170568, -195911, -219013, -240319, -260168, -278811,
            /* 1835.01 rad/s */
            -271884, -253937, -234845, -214373, -192215, -167978, -141310, -113148, -96349, -115616,
            -145562, -173632, -199055, -222258, -243674, -263635, -282389,
            /* 1966.08 rad/s */
            -275128, -257085, -237896, -217330, -195085, -170784, -144111, -116118, -99658, -118566,
            -148341, -176418, -201907, -225199, -246710, -266769, -285620,
            /* 2097.15 rad/s */
            -278074, -259946, -240671, -220022, -197703, -173348, -146677, -118846, -102693, -121275,
            -150887, -178964, -204508, -227876, -249471, -269616, -288554,
        },
    },
    .crc32 = 0x4509B30E,
};
