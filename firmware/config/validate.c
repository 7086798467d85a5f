/* SPDX-License-Identifier: Apache-2.0 */
#include "config/validate.h"

#include <stdbool.h>
#include <stddef.h>

#include "config/bases.h"
#include "config/derived.h"
#include "config/fields.h"
#include "core/sqrt3.h"
#include "flux_relations.h"
#include "physics.h"

_Static_assert(sizeof(config_t) % sizeof(int32_t) == 0, "no padding at the end");
_Static_assert(offsetof(config_t, service_key) == offsetof(config_t, crc32) + sizeof(uint32_t) &&
                   offsetof(config_t, service_key) + sizeof(uint32_t) * CONFIG_SERVICE_KEY_WORDS ==
                       sizeof(config_t),
               "the checksum ends what is shown, the key is last");

uint32_t config_crc32(const void *data, uint32_t size_bytes)
{
    return config_crc32_continue(0, data, size_bytes);
}

uint32_t config_crc32_continue(uint32_t before, const void *data, uint32_t size_bytes)
{
    const uint8_t *bytes = data;
    uint32_t crc = before ^ UINT32_MAX;
    for (uint32_t i = 0; i < size_bytes; i++) {
        crc ^= bytes[i];
        for (unsigned bit = 0; bit < 8; bit++) {
            crc = (crc >> 1) ^ (UINT32_C(0xEDB88320) & (0U - (crc & 1U)));
        }
    }
    return crc ^ UINT32_MAX;
}

static void refuse(config_result_t *refusal, config_result_code_t code, const char *field)
{
    refusal->code = code;
    refusal->field = field;
}

config_result_t config_result_range(const char *section, const char *field, int32_t value,
                                    int32_t lowest, int32_t highest)
{
    const config_result_t out = {.code = CONFIG_RESULT_RANGE,
                                 .section = section,
                                 .field = field,
                                 .relation = "",
                                 .upper_section = "",
                                 .upper_field = "",
                                 .value = value,
                                 .lowest = lowest,
                                 .highest = highest};
    return out;
}

static bool ranges_hold(const config_t *config, config_result_t *refusal)
{
    config_field_t field = config_field_first();
    do {
        for (uint32_t i = 0; i < field.count; i++) {
            const int32_t value = config_field_value(config, &field, i);
            if (value < field.lowest || value > field.highest) {
                refuse(refusal, CONFIG_RESULT_RANGE, field.name);
                refusal->section = field.section;
                refusal->value = value;
                refusal->lowest = field.lowest;
                refusal->highest = field.highest;
                return false;
            }
        }
    } while (config_field_next(&field));
    return true;
}

/* Every sector wide enough to be seen and narrow enough to be interpolated, 30 to 90 degrees; then
 * the six make up exactly one turn in forward order. */
static bool hall_sectors_in_order(const config_rotor_t *rotor)
{
    bool good = true;
    for (int k = 0; k < CONFIG_HALL_EDGES; k++) {
        const uint32_t next = (uint32_t)rotor->edge_turn[(k + 1) % CONFIG_HALL_EDGES];
        const uint32_t width_turn = (next - (uint32_t)rotor->edge_turn[k]) & 0xFFFFU;
        good = good && width_turn >= 5461U && width_turn <= 16384U;
    }
    return good;
}

enum { ENCODER_COUNTS_A_POLE_PAIR = 32, INDEX_TOLERANCE_DIVISOR = 12 };

/* Fine enough for a torque within 0.5 % (half a count is at most 5.6 degrees electrical) and for
 * the tracking loop. */
static bool encoder_fine_enough(const config_t *c)
{
    return c->rotor.sensor != CONFIG_ROTOR_ENCODER ||
           c->rotor.encoder_counts >= ENCODER_COUNTS_A_POLE_PAIR * c->motor.pole_pairs;
}

/* An angle that is accepted may be wrong by the tolerance: 30 degrees electrical leave 87 % of the
 * torque. */
static bool encoder_index_sharp_enough(const config_t *c)
{
    return c->rotor.sensor != CONFIG_ROTOR_ENCODER || c->rotor.encoder_index_tolerance_counts *
                                                              INDEX_TOLERANCE_DIVISOR *
                                                              c->motor.pole_pairs <=
                                                          c->rotor.encoder_counts;
}

/* Hall sensors measure no speed without an edge in a quarter of a second. A sector is at most a
 * quarter turn wide, so above one electrical turn a second, 2 pi rad/s, edges are frequent enough.
 * Electric braking must end above that speed. */
static bool halls_measure_the_blend_out_speed(const config_t *c)
{
    return c->rotor.sensor != CONFIG_ROTOR_HALL ||
           (int64_t)c->brake.blend_out_end_mrad_s * c->motor.pole_pairs >= 6284;
}

/* One modulation unit at the lowest bus voltage, limit * v_dc / sqrt 3, per unit of voltage in Q15,
 * times 10^4 sqrt 3. */
static int64_t lowest_unit(const config_t *c)
{
    return (int64_t)c->current_loop.modulation_limit_pu_q15 * c->battery.undervoltage_trip_mV /
           c->drive.voltage_full_scale_mV * 10000;
}

enum { SQRT3_1E4 = (10000 * SQRT3_Q30 + (1 << 29)) >> 30 };

static int64_t larger(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* In the current loop's modulation units the proportional gain must stay below 16 and the integral
 * gain below 1/2. */
static bool gains_fit(const config_t *c)
{
    const config_current_loop_t *loop = &c->current_loop;
    const int64_t proportional_q16 =
        larger(loop->proportional_d_pu_q16, loop->proportional_q_pu_q16);
    const int64_t integral_q24 = larger(loop->integral_d_pu_q24, loop->integral_q_pu_q24);
    return proportional_q16 * SQRT3_1E4 / 2 < 16 * lowest_unit(c) &&
           integral_q24 * SQRT3_1E4 / 512 < lowest_unit(c) / 2;
}

/* A constant per unit of speed at the highest speed, in modulation units at the lowest bus voltage,
 * below a limit. Electrical speed over its base: 2 pi f / 16 = 392.7 mrad/s for each hertz. */
static bool fits_at_max_speed(const config_t *c, int64_t constant_q16, int32_t limit)
{
    const int64_t speed_1e6 = (int64_t)c->motor.max_speed_mrad_s * c->motor.pole_pairs * 10000000 /
                              (INT64_C(3927) * c->drive.pwm_frequency_Hz);
    return constant_q16 * speed_1e6 / 1000000 * SQRT3_1E4 / 2 < limit * lowest_unit(c);
}

/* w L I_base below 16, w psi below 8. */
static bool cross_coupling_fits(const config_t *c)
{
    const config_current_loop_t *loop = &c->current_loop;
    return fits_at_max_speed(c, larger(loop->inductance_d_pu_q16, loop->inductance_q_pu_q16), 16);
}

static bool back_emf_fits(const config_t *c)
{
    return fits_at_max_speed(c, c->current_loop.flux_pu_q16, 8);
}

/* k_i / k_p = R T / L of either axis below 1/4: the electrical time constant is longer than four
 * PWM periods. */
static bool time_constants_long_enough(const config_current_loop_t *loop)
{
    return loop->integral_d_pu_q24 / 64 < loop->proportional_d_pu_q16 &&
           loop->integral_q_pu_q24 / 64 < loop->proportional_q_pu_q16;
}

/* The speed base is a sixteenth of an electrical turn in a PWM period: 2 pi f / 16. The rotor
 * estimate is invalid beyond it. */
static bool speed_within_base(const config_t *c)
{
    return (int64_t)c->motor.max_speed_mrad_s * c->motor.pole_pairs * 1600 <=
           INT64_C(628319) * c->drive.pwm_frequency_Hz;
}

/* A sensor whose zero is as far beside the middle as is tolerated still has this many codes of 16
 * to the converter's end. A trip beyond them would wait for a sample that cannot come. */
static bool overcurrent_can_be_seen(const config_monitor_t *monitor)
{
    return monitor->overcurrent_pu_q15 <= (2047 - monitor->offset_tolerance_codes) * 16;
}

/* What the monitor would refuse as measured is not stored either. */
static bool stored_offsets_plausible(const config_t *c)
{
    const int32_t tolerance_q4 = 16 * c->monitor.offset_tolerance_codes;
    const int32_t offsets_q4[] = {c->drive.offset_a_q4, c->drive.offset_b_q4, c->drive.offset_c_q4};
    bool good = true;
    for (int x = 0; x < 3; x++) {
        const int32_t deviation_q4 = offsets_q4[x] - 32768;
        good = good && deviation_q4 <= tolerance_q4 && -deviation_q4 <= tolerance_q4;
    }
    return good;
}

/* A wired channel: both ends of the travel inside its valid range, a tenth of the supply apart. */
static bool pedal_channel_calibrated(const config_pedals_t *pedals, int channel)
{
    const int32_t released = pedals->released_q15[channel];
    const int32_t pressed = pedals->pressed_q15[channel];
    const int32_t low = released < pressed ? released : pressed;
    const int32_t high = released < pressed ? pressed : released;
    return pedals->lowest_q15[channel] < low && high < pedals->highest_q15[channel] &&
           high - low >= 3277;
}

static bool pedal_channels_calibrated(const config_pedals_t *pedals)
{
    bool good = true;
    for (int k = 0; k < CONFIG_PEDAL_CHANNELS / 2; k++) {
        good = good && (k >= pedals->accelerator_channels || pedal_channel_calibrated(pedals, k)) &&
               (k >= pedals->brake_channels ||
                pedal_channel_calibrated(pedals, CONFIG_PEDAL_CHANNELS / 2 + k));
    }
    return good;
}

static int32_t square_q15(int32_t x_q15)
{
    return (x_q15 * x_q15) >> 15;
}

/* At every stored i_d a quarter of the magnets' flux is left to make torque with, see
 * motor_model.h. */
static bool flux_left_everywhere(const config_t *c)
{
    const int64_t saliency_nH = (int64_t)c->motor.d_inductance_nH - c->motor.q_inductance_nH;
    const int64_t flux_pWb_lsb = saliency_nH * (int64_t)(UINT32_C(1) << c->current_map.lsb_log2);
    /* Where a negative i_d takes torque away, at every other one as well. */
    const int64_t largest_mA = saliency_nH > 0 ? c->motor.max_phase_current_mA : 0;
    bool good = 4 * saliency_nH * largest_mA / 1000 <= 3 * (int64_t)c->motor.flux_linkage_nWb;
    for (int i = 0; i < CONFIG_CURRENT_MAP_POINTS_MAX; i++) {
        const int64_t flux_nWb =
            c->motor.flux_linkage_nWb + flux_pWb_lsb * c->current_map.current_d_lsb[i] / 1000;
        good = good && flux_nWb >= c->motor.flux_linkage_nWb / 4;
    }
    return good;
}

/* The torque axis covers half of the largest torque at least, the speed axis half of the largest
 * speed. */
static bool map_reaches(const config_t *c)
{
    const config_current_map_t *map = &c->current_map;
    const int64_t torque_mNm =
        (int64_t)(map->torque_points / 2) * (int64_t)(UINT32_C(1) << map->torque_step_log2);
    const int64_t speed_mrad_s =
        (int64_t)(map->speed_points - 1) * (int64_t)(UINT32_C(1) << map->speed_step_log2);
    return 2 * torque_mNm >= c->motor.max_torque_mNm &&
           2 * speed_mrad_s >= c->motor.max_speed_mrad_s;
}

/* Up to half of the largest torque at most 15/16 of the current demagnetises, so that some is left
 * for the torque. Beyond, where the points may lie outside the current circle, at most twice of it.
 */
static bool map_within_current(const config_t *c)
{
    const config_current_map_t *map = &c->current_map;
    const int64_t most_mA = c->motor.max_phase_current_mA;
    const int64_t scale = (int64_t)(UINT32_C(1) << map->lsb_log2);
    const int64_t step_mNm = (int64_t)(UINT32_C(1) << map->torque_step_log2);
    const int32_t used = map->torque_points * map->speed_points * map->temperature_points;
    bool good = true;
    for (int32_t i = 0; i < used; i++) {
        const int64_t size_mA = q_abs(map->current_d_lsb[i]) * scale;
        const int32_t column = i % map->torque_points - map->torque_points / 2;
        const bool small = 2 * step_mNm * q_abs(column) <= c->motor.max_torque_mNm;
        good = good && (small ? 16 * size_mA <= 15 * most_mA : size_mA <= 2 * most_mA);
    }
    return good;
}

typedef struct {
    uint16_t lower_bytes; /* places in config_t */
    uint16_t upper_bytes;
    uint16_t distance; /* upper less lower at least this */
} order_t;

#define ORDER(lower, upper, distance)                                                              \
    {(uint16_t)offsetof(config_t, lower), (uint16_t)offsetof(config_t, upper), (distance)},
#define BELOW(lower, upper) ORDER(lower, upper, 1)
#define AT_MOST(lower, upper) ORDER(lower, upper, 0)

static const order_t ORDERS[] = {CONFIG_ORDERS(BELOW, AT_MOST)};

/* The fields are looked for only where their names are needed. In 64 bits the difference of two
 * values cannot overflow. */
static bool order_holds(const config_t *c, const order_t *order, config_result_t *refusal)
{
    const int32_t *values = (const int32_t *)(const void *)c;
    const int64_t distance = (int64_t)values[order->upper_bytes / sizeof(int32_t)] -
                             values[order->lower_bytes / sizeof(int32_t)];
    if (distance >= order->distance) {
        return true;
    }
    const config_field_t lower = config_field_at(order->lower_bytes);
    const config_field_t upper = config_field_at(order->upper_bytes);
    refuse(refusal, CONFIG_RESULT_RELATION, lower.name);
    refusal->section = lower.section;
    refusal->relation = order->distance > 0 ? " < " : " <= ";
    refusal->upper_section = upper.section;
    refusal->upper_field = upper.name;
    return false;
}

/* The text of the first relation that does not hold. */
#define REQUIRE(relation, text)                                                                    \
    if (!(relation)) {                                                                             \
        return text;                                                                               \
    }

static const char *broken_in_drive(const config_t *c)
{
    const int64_t max_current_pu_q15 =
        (int64_t)c->motor.max_phase_current_mA * 32768 / c->drive.current_full_scale_mA;
    REQUIRE(c->motor.type == CONFIG_MOTOR_IPMSM ||
                c->motor.d_inductance_nH == c->motor.q_inductance_nH,
            "motor.d_inductance_nH = motor.q_inductance_nH for surface magnets");
    REQUIRE((int64_t)c->drive.min_pulse_ns * c->drive.pwm_frequency_Hz <= 100000000,
            "drive.min_pulse_ns within a tenth of the PWM period");
    REQUIRE(bases_dead_time_share_1e9(c) <= 125000000,
            "drive.dead_time_ns, with drive.diode_drop_mV, within an eighth of the PWM period");
    REQUIRE(max_current_pu_q15 <= c->current_loop.max_current_pu_q15 + 1,
            "motor.max_phase_current_mA within current_loop.max_current_pu_q15");
    REQUIRE(overcurrent_can_be_seen(&c->monitor),
            "monitor.overcurrent_pu_q15 within the converter's "
            "range less monitor.offset_tolerance_codes");
    REQUIRE(speed_within_base(c),
            "motor.max_speed_mrad_s within a sixteenth of an electrical turn a PWM period");
    REQUIRE(c->current_loop.bandwidth_Hz <= c->drive.pwm_frequency_Hz / 12,
            "current_loop.bandwidth_Hz at most a twelfth of drive.pwm_frequency_Hz");
    REQUIRE(gains_fit(c), "current_loop gains fit their formats at battery.undervoltage_trip_mV");
    REQUIRE(cross_coupling_fits(c),
            "current_loop inductances fit their formats at motor.max_speed_mrad_s");
    REQUIRE(back_emf_fits(c), "current_loop.flux_pu_q16 fits its format at motor.max_speed_mrad_s");
    REQUIRE(time_constants_long_enough(&c->current_loop), "L / R longer than four PWM periods");
    REQUIRE(hall_sectors_in_order(&c->rotor),
            "rotor.edge_turn in forward order, 30 to 90 degrees apart");
    REQUIRE(encoder_fine_enough(c),
            "rotor.encoder_counts at least 32 for each of motor.pole_pairs");
    REQUIRE(encoder_index_sharp_enough(c),
            "rotor.encoder_index_tolerance_counts within 30 degrees electrical");
    REQUIRE(halls_measure_the_blend_out_speed(c),
            "brake.blend_out_end_mrad_s at least one electrical turn a second with halls");
    return NULL;
}

/* A temperature with a limit has a sensor or an estimate. */
static bool temperatures_known(const config_t *c)
{
    const bool winding = c->monitor.winding_sensor_fitted != 0 ||
                         c->thermal.winding_heat_capacity_mJ_K > 0 ||
                         c->motor.max_winding_temperature_cC >= CONFIG_TEMPERATURE_OFF_cC;
    const bool switches = c->monitor.switch_sensor_fitted != 0 ||
                          c->thermal.switch_heat_capacity_mJ_K > 0 ||
                          c->drive.max_switch_temperature_cC >= CONFIG_TEMPERATURE_OFF_cC;
    return winding && switches;
}

static const char *broken_in_battery(const config_t *c)
{
    REQUIRE(temperatures_known(c),
            "thermal.winding_heat_capacity_mJ_K, switch_heat_capacity_mJ_K where "
            "monitor.winding_sensor_fitted, switch_sensor_fitted is 0");
    REQUIRE(stored_offsets_plausible(c),
            "drive.offset_a_q4, _b_q4, _c_q4 within monitor.offset_tolerance_codes of mid-range");
    /* The converter's last code is 4095 of 4096. */
    REQUIRE((int64_t)c->battery.overvoltage_trip_mV * 4096 <
                (int64_t)c->drive.voltage_full_scale_mV * 4095,
            "battery.overvoltage_trip_mV < drive.voltage_full_scale_mV less one code");
    return NULL;
}

/* Less urgent than every message of the protocol. */
static bool service_below_messages(const config_t *c)
{
    const int32_t base = c->service.can_base;
    return base == 0 || (base % CONFIG_SERVICE_BASE_STEP == 0 &&
                         base >= c->vehicle.can_base + CONFIG_CAN_IDENTIFIERS);
}

static const char *broken_in_vehicle(const config_t *c)
{
    REQUIRE(c->vehicle.can_base % CONFIG_CAN_BASE_STEP == 0, "vehicle.can_base a multiple of 32");
    REQUIRE(service_below_messages(c),
            "service.can_base 0, or a multiple of 8 and 160 above vehicle.can_base");
    REQUIRE(c->brake.torque_growth_end_q15 > square_q15(c->current_loop.modulation_target_pu_q15),
            "brake.torque_growth_end_q15 > square of current_loop.modulation_target_pu_q15");
    REQUIRE(pedal_channels_calibrated(&c->pedals),
            "pedals.lowest_q15 < released_q15 and pressed_q15 < highest_q15, 0.1 apart");
    REQUIRE(c->regen_map.speed_points * c->regen_map.temperature_points <= CONFIG_REGEN_POINTS_MAX,
            "regen_map.speed_points * regen_map.temperature_points within the table");
    REQUIRE(c->current_map.torque_points % 2 == 1,
            "current_map.torque_points odd, so that the middle one is no torque");
    REQUIRE(c->current_map.torque_points * c->current_map.speed_points *
                    c->current_map.temperature_points <=
                CONFIG_CURRENT_MAP_POINTS_MAX,
            "current_map.torque_points * speed_points * temperature_points within the table");
    REQUIRE(map_reaches(c),
            "current_map covers half of motor.max_torque_mNm and motor.max_speed_mrad_s");
    REQUIRE(map_within_current(c),
            "current_map.current_d_lsb within 15/16 of motor.max_phase_current_mA for half of the "
            "torque, within twice beyond");
    REQUIRE(flux_left_everywhere(c),
            "current_map.current_d_lsb, and any i_d where L_d > L_q, leaves a quarter of "
            "motor.flux_linkage_nWb");
    return NULL;
}

/* What follows from other fields is what they say. */
static bool derived_hold(const config_t *c, config_result_t *refusal)
{
    const int32_t *values = (const int32_t *)(const void *)c;
    for (int k = 0; k < CONFIG_DERIVED_FIELDS; k++) {
        const config_derived_range_t range = config_derived_range(c, (config_derived_t)k);
        const int32_t value = values[range.offset_bytes / sizeof(int32_t)];
        if (value < range.lowest || value > range.highest) {
            const config_field_t field = config_field_at(range.offset_bytes);
            refuse(refusal, CONFIG_RESULT_RANGE, field.name);
            refusal->section = field.section;
            refusal->value = value;
            refusal->lowest = range.lowest;
            refusal->highest = range.highest;
            return false;
        }
    }
    return true;
}

static bool relations_hold(const config_t *c, config_result_t *refusal)
{
    const char *relation = physics_broken(c);
    relation = relation == NULL ? broken_in_drive(c) : relation;
    relation = relation == NULL ? broken_in_battery(c) : relation;
    relation = relation == NULL ? broken_in_vehicle(c) : relation;
    relation = relation == NULL ? flux_map_broken(c) : relation;
    if (relation != NULL) {
        refuse(refusal, CONFIG_RESULT_RELATION, relation);
        return false;
    }
    bool hold = true;
    for (uint32_t k = 0; hold && k < sizeof ORDERS / sizeof ORDERS[0]; k++) {
        hold = order_holds(c, &ORDERS[k], refusal);
    }
    return hold && derived_hold(c, refusal);
}

/* Printable ASCII, at least one character, and zero-terminated: the shell prints it. */
static bool name_is_text(const char name[CONFIG_NAME_LENGTH])
{
    uint32_t length = 0;
    while (length < CONFIG_NAME_LENGTH && name[length] >= ' ' && name[length] <= '~') {
        length++;
    }
    return length > 0 && length < CONFIG_NAME_LENGTH && name[length] == '\0';
}

bool config_has_address(const config_t *config, config_result_code_t code)
{
    const bool intact = code != CONFIG_RESULT_MAGIC && code != CONFIG_RESULT_VERSION &&
                        code != CONFIG_RESULT_SIZE && code != CONFIG_RESULT_CRC;
    if (!intact) {
        return false;
    }
    const config_vehicle_t *vehicle = &config->vehicle;
    const config_field_t base = config_field_at(offsetof(config_t, vehicle.can_base));
    return vehicle->wheel_position >= 0 && vehicle->wheel_position < CONFIG_WHEELS &&
           vehicle->can_base >= base.lowest && vehicle->can_base <= base.highest &&
           vehicle->can_base % CONFIG_CAN_BASE_STEP == 0;
}

config_result_t config_validate(const config_t *config, uint32_t size_bytes)
{
    config_result_t out = {.code = CONFIG_RESULT_OK,
                           .section = "",
                           .field = "",
                           .relation = "",
                           .upper_section = "",
                           .upper_field = ""};
    const bool readable = size_bytes >= sizeof(config_t);
    if (readable && config->magic != CONFIG_MAGIC) {
        refuse(&out, CONFIG_RESULT_MAGIC, "magic");
    } else if (readable && config->format_version != CONFIG_FORMAT_VERSION) {
        refuse(&out, CONFIG_RESULT_VERSION, "format_version");
    } else if (!readable || config->size_bytes != sizeof(config_t)) {
        refuse(&out, CONFIG_RESULT_SIZE, "size_bytes");
    } else if (config->crc32 != config_crc32(config, (uint32_t)offsetof(config_t, crc32))) {
        refuse(&out, CONFIG_RESULT_CRC, "crc32");
    } else if (!name_is_text(config->name)) {
        refuse(&out, CONFIG_RESULT_NAME, "name");
    } else if (ranges_hold(config, &out)) {
        (void)relations_hold(config, &out);
    }
    return out;
}
