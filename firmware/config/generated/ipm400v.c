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
    .format_version = 4,
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
        .hydraulic_dead_time_ms      = 30, /* [ms] from a changed command until the hydraulic brake begins to move */
        .hydraulic_time_constant_ms  = 60, /* [ms] first-order lag of the hydraulic torque after the dead time; 0: none */
        .hydraulic_rate_mNm_s        = 3000000, /* [mNm/s] fastest change of hydraulic torque */
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
            -2236, 1, 9, 235, 1084, 2000, 2969, 4025, 5194, 6446,
            7840, 9451, 11189, 13199, 15526, 18002, 21284, 25170, 29828, 37356,
            45090, 57561, 74501, 100758, 139771, 145783, 151803, 157836, 163879, 169931,
            175991, 182062, 188141, 194227, 200323, 206428, 212540, 218658, 224786, 230921,
            237061, 243211, 249368, 255532, 261700, 267877, 274062,
            /* 0.48 degC */
            -2031, 1, 8, 175, 914, 1710, 2566, 3489, 4485, 5560,
            6759, 8026, 9458, 11038, 12890, 14922, 17119, 20039, 23401, 27459,
            33612, 39990, 48096, 60881, 77939, 104078, 138735, 144240, 149754, 155278,
            160808, 166349, 171898, 177453, 183017, 188589, 194168, 199753, 205347, 210948,
            216553, 222168, 227789, 233416, 239048, 244688, 250335,
            /* 20.96 degC */
            -1854, 1, 5, 126, 786, 1495, 2253, 3018, 3927, 4836,
            5831, 6917, 8105, 9398, 10865, 12490, 14323, 16382, 18860, 21844,
            25365, 29606, 35803, 42521, 52302, 63743, 80887, 106854, 137534, 142600,
            147673, 152755, 157845, 162941, 168045, 173157, 178276, 183399, 188531, 193670,
            198813, 203964, 209121, 214285, 219453, 224628, 229810,
            /* 41.44 degC */
            -1699, 1, 5, 77, 665, 1287, 1958, 2660, 3418, 4225,
            5092, 6001, 7019, 8097, 9293, 10616, 12083, 13750, 15624, 17749,
            20360, 23452, 27122, 31480, 37720, 44711, 54477, 67263, 84551, 108542,
            136200, 140883, 145572, 150267, 154970, 159679, 164396, 169117, 173845, 178580,
            183320, 188067, 192819, 197578, 202340, 207110, 211885,
            /* 61.92 degC */
            -1563, 1, 5, 47, 556, 1121, 1702, 2351, 3018, 3682,
            4455, 5250, 6110, 7026, 8022, 9119, 10314, 11642, 13120, 14794,
            16690, 18972, 21665, 24876, 28704, 33612, 39330, 46514, 56201, 69039,
            86104, 109867, 134763, 139105, 143455, 147811, 152173, 156539, 160913, 165293,
            169676, 174067, 178464, 182866, 187271, 191683, 196101,
            /* 82.4 degC */
            -1441, 1, 5, 35, 477, 986, 1506, 2060, 2660, 3267,
            3919, 4605, 5341, 6136, 7019, 7890, 8900, 9975, 11167, 12497,
            13987, 15666, 17688, 20046, 22826, 26134, 30070, 34785, 40730, 48148,
            57697, 70162, 87023, 110424, 133239, 137281, 141330, 145382, 149441, 153506,
            157574, 161650, 165730, 169815, 173904, 178000, 182100,
            /* 102.88 degC */
            -1332, 1, 5, 28, 405, 857, 1344, 1823, 2351, 2890,
            3467, 4078, 4715, 5401, 6129, 6902, 7747, 8648, 9628, 10718,
            11882, 13205, 14693, 16446, 18484, 20881, 23781, 27201, 31272, 35707,
            41862, 49153, 58756, 70920, 87413, 110396, 131648, 135420, 139199, 142982,
            146769, 150563, 154361, 158164, 161971, 165783, 169601,
            /* 123.36 degC */
            -1234, 1, 5, 20, 333, 733, 1170, 1615, 2072, 2558,
            3067, 3580, 4176, 4764, 5401, 6057, 6774, 7539, 8384, 9251,
            10216, 11276, 12438, 13747, 15214, 17062, 19180, 21647, 24560, 28088,
            32267, 36430, 42698, 49404, 59350, 71095, 87191, 109501, 131072, 133532,
            137066, 140607, 144152, 147702, 151255, 154813, 158376,
            /* 143.84 degC */
            -1146, 1, 5, 13, 276, 642, 1035, 1442, 1842, 2274,
            2724, 3195, 3697, 4225, 4764, 5341, 5959, 6615, 7305, 8056,
            8863, 9730, 10686, 11715, 12868, 14135, 15587, 17512, 19601, 22127,
            25255, 28781, 32767, 36731, 43313, 49640, 59664, 71026, 86282, 108041,
            131070, 131620, 134937, 138258, 141582, 144911, 148245,
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
            -133392, -121568, -108920, -95248, -80265, -63520, -44256, -20729, 0, -20729,
            -44256, -63520, -80265, -95248, -108920, -121568, -133392,
            /* 131.072 rad/s */
            -145606, -133124, -119771, -105337, -89516, -71834, -51483, -26763, -1752, -28644,
            -54425, -75614, -94006, -110451, -125451, -139324, -152290,
            /* 262.144 rad/s */
            -168226, -154538, -139897, -124075, -106740, -87377, -65116, -38029, -12452, -40535,
            -68984, -92339, -112631, -130786, -147350, -162673, -176996,
            /* 393.216 rad/s */
            -187341, -172708, -157063, -140167, -121673, -101047, -77408, -48819, -24226, -51549,
            -81643, -106491, -128143, -147544, -165261, -181661, -196997,
            /* 524.288 rad/s */
            -202876, -187527, -171125, -153425, -134075, -112539, -87951, -58532, -35136, -61325,
            -92336, -118195, -140811, -161114, -179677, -196872, -212960,
            /* 655.36 rad/s */
            -215588, -199688, -182708, -164399, -144408, -122206, -96963, -67130, -44906, -69921,
            -101403, -127955, -151268, -172241, -191437, -209234, -225894,
            /* 786.432 rad/s */
            -226140, -209808, -192376, -173596, -153116, -130418, -104717, -74719, -53564, -77483,
            -109169, -136203, -160033, -181513, -201197, -219460, -236566,
            /* 917.504 rad/s */
            -235030, -218352, -200560, -181407, -160544, -137470, -111448, -81432, -61228, -84161,
            -115890, -143263, -167484, -189357, -209425, -228059, -245520,
            /* 1048.58 rad/s */
            -242618, -225658, -207574, -188121, -166955, -143591, -117339, -87396, -68026, -90088,
            -121761, -149376, -173897, -196083, -216459, -235391, -253141,
            /* 1179.65 rad/s */
            -249172, -231978, -213653, -193954, -172544, -148951, -122537, -92719, -74079, -95374,
            -126935, -154722, -179478, -201915, -222542, -241721, -259710,
            /* 1310.72 rad/s */
            -254891, -237500, -218974, -199071, -177460, -153686, -127156, -97492, -79492, -100114,
            -131529, -159437, -184380, -207022, -227858, -247242, -265432,
            /* 1441.79 rad/s */
            -259925, -242366, -223669, -203595, -181818, -157899, -131287, -101794, -84357, -104384,
            -135634, -163629, -188722, -211534, -232545, -252103, -270462,
            /* 1572.86 rad/s */
            -264391, -246688, -227845, -207625, -185710, -161672, -135004, -105687, -88747, -108249,
            -139326, -167380, -192595, -215550, -236709, -256415, -274920,
            /* 1703.94 rad/s */
            -268380, -250553, -231584, -211239, -189205, -165070, -138366, -109226, -92726, -111761,
            -142664, -170758, -196072, -219147, -240433, -260267, -278900,
            /* 1835.01 rad/s */
            -271966, -254030, -234951, -214498, -192363, -168147, -141420, -112455, -96349, -114966,
            -145695, -173815, -199212, -222389, -243785, -263731, -282474,
            /* 1966.08 rad/s */
            -275207, -257174, -237999, -217451, -195230, -170948, -144208, -115412, -99658, -117901,
            -148462, -176595, -202061, -225327, -246819, -266862, -285703,
            /* 2097.15 rad/s */
            -278151, -260033, -240772, -220141, -197844, -173506, -146763, -118130, -102693, -120599,
            -150996, -179135, -204658, -228001, -249577, -269707, -288634,
        },
    },
    .crc32 = 0x60EECEB0,
};
