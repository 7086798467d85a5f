/* SPDX-License-Identifier: Apache-2.0 */
/* The validator: every field at both ends of its range and one beyond, every relation between
 * fields, and damaged images. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "config/validate.h"
#include "derive.h"
#include "refusal.h"
#include "unity.h"

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

void test_the_papers_vehicle_is_accepted(void)
{
    const config_result_t result = config_validate(&CONFIG_LU2013, sizeof(config_t));
    TEST_ASSERT_EQUAL_STRING("", result.field);
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, result.code);
}

void test_memory_longer_than_the_image_is_accepted(void)
{
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, config_validate(&CONFIG_LU2013, UINT32_MAX).code);
}

void test_a_shorter_image_is_refused_without_being_read(void)
{
    for (uint32_t size = 0; size < sizeof(config_t); size += 4) {
        /* A block of exactly that size: the address sanitizer would see a read beyond it. */
        config_t *image = malloc(size + 1U);
        TEST_ASSERT_NOT_NULL(image);
        memcpy(image, &CONFIG_LU2013, size);
        const config_result_t result = config_validate(image, size);
        free(image);
        TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_SIZE, result.code);
    }
}

void test_wrong_magic_version_and_size_have_separate_codes(void)
{
    config.magic ^= 1U;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_MAGIC, sealed_result().code);
    config = CONFIG_LU2013;
    config.format_version++;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_VERSION, sealed_result().code);
    config = CONFIG_LU2013;
    config.size_bytes -= 4U;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_SIZE, sealed_result().code);
}

void test_an_erased_flash_sector_is_refused(void)
{
    memset(&config, 0xFF, sizeof(config));
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_MAGIC, config_validate(&config, sizeof(config)).code);
    memset(&config, 0, sizeof(config));
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_MAGIC, config_validate(&config, sizeof(config)).code);
}

/* But of the key, without which a right one is refused. */
void test_any_single_flipped_bit_is_refused(void)
{
    uint8_t *bytes = (uint8_t *)&config;
    for (size_t bit = 0; bit < 8U * offsetof(config_t, service_key); bit += 11U) {
        bytes[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
        TEST_ASSERT_NOT_EQUAL(CONFIG_RESULT_OK, config_validate(&config, sizeof(config)).code);
        bytes[bit / 8U] ^= (uint8_t)(1U << (bit % 8U));
    }
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, config_validate(&config, sizeof(config)).code);
}

/* Printable, because the shell sends it to a terminal. */
void test_name_must_be_printable_not_empty_and_terminated(void)
{
    static const char *const NAMES[] = {" ~", "", "\x1B", "x\x1F", "\x7F", "x\x80", "x\xFF", "\n"};
    for (unsigned k = 0; k < sizeof NAMES / sizeof NAMES[0]; k++) {
        memset(config.name, 0, sizeof(config.name));
        memcpy(config.name, NAMES[k], strlen(NAMES[k]));
        TEST_ASSERT_EQUAL_INT(k == 0 ? CONFIG_RESULT_OK : CONFIG_RESULT_NAME, sealed_result().code);
    }
    memset(config.name, 'x', sizeof(config.name));
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_NAME, sealed_result().code);
}

/* One beyond an end must be refused with field, value and range; the end itself must not be refused
 * as beyond that range (a relation with other fields may still object). */
static void assert_range(const char *field, int32_t *value, int32_t lowest, int32_t highest)
{
    const int32_t good = *value;
    const int32_t beyond[] = {lowest == INT32_MIN ? lowest : lowest - 1,
                              highest == INT32_MAX ? highest : highest + 1};
    for (int i = 0; i < 2; i++) {
        *value = beyond[i];
        const config_result_t result = sealed_result();
        TEST_ASSERT_EQUAL_INT_MESSAGE(CONFIG_RESULT_RANGE, result.code, field);
        const char *const section = result.section;
        TEST_ASSERT_EQUAL_STRING_LEN(section, field, strlen(section));
        TEST_ASSERT_EQUAL_STRING(field + strlen(section), result.field);
        TEST_ASSERT_EQUAL_INT32(beyond[i], result.value);
        TEST_ASSERT_EQUAL_INT32(lowest, result.lowest);
        TEST_ASSERT_EQUAL_INT32(highest, result.highest);
    }
    const int32_t ends[] = {lowest, highest};
    for (int i = 0; i < 2; i++) {
        *value = ends[i];
        const config_result_t result = sealed_result();
        TEST_ASSERT_TRUE_MESSAGE(result.code != CONFIG_RESULT_RANGE || result.lowest > lowest ||
                                     result.highest < highest,
                                 field);
    }
    *value = good;
}

#define CHECK_SCALAR(section, name, lowest, highest)                                               \
    assert_range(#section "." #name, &config.section.name, lowest, highest);
#define CHECK_ARRAY(section, name, count, lowest, highest)                                         \
    for (int i = 0; i < (count); i++) {                                                            \
        assert_range(#section "." #name, &config.section.name[i], lowest, highest);                \
    }
#define CHECK_MOTOR(name, lowest, highest, unit, text) CHECK_SCALAR(motor, name, lowest, highest)
#define CHECK_DRIVE(name, lowest, highest, unit, text) CHECK_SCALAR(drive, name, lowest, highest)
#define CHECK_CURRENT_LOOP(name, lowest, highest, unit, text)                                      \
    CHECK_SCALAR(current_loop, name, lowest, highest)
#define CHECK_ROTOR(name, lowest, highest, unit, text) CHECK_SCALAR(rotor, name, lowest, highest)
#define CHECK_HALL(name, count, lowest, highest, unit, text)                                       \
    CHECK_ARRAY(rotor, name, count, lowest, highest)
#define CHECK_BATTERY(name, lowest, highest, unit, text)                                           \
    CHECK_SCALAR(battery, name, lowest, highest)
#define CHECK_BRAKE(name, lowest, highest, unit, text) CHECK_SCALAR(brake, name, lowest, highest)
#define CHECK_VEHICLE(name, lowest, highest, unit, text)                                           \
    CHECK_SCALAR(vehicle, name, lowest, highest)
#define CHECK_DRIVER(name, lowest, highest, unit, text) CHECK_SCALAR(driver, name, lowest, highest)
#define CHECK_PEDALS(name, lowest, highest, unit, text) CHECK_SCALAR(pedals, name, lowest, highest)
#define CHECK_PEDALS_ARRAY(name, count, lowest, highest, unit, text)                               \
    CHECK_ARRAY(pedals, name, count, lowest, highest)
#define CHECK_SERVICE(name, lowest, highest, unit, text)                                           \
    CHECK_SCALAR(service, name, lowest, highest)
#define CHECK_CAN(name, lowest, highest, unit, text) CHECK_SCALAR(can, name, lowest, highest)
#define CHECK_TOLERANCE(name, lowest, highest, unit, text)                                         \
    CHECK_SCALAR(tolerance, name, lowest, highest)
#define CHECK_MODES(name, lowest, highest, unit, text) CHECK_SCALAR(modes, name, lowest, highest)
#define CHECK_MONITOR(name, lowest, highest, unit, text)                                           \
    CHECK_SCALAR(monitor, name, lowest, highest)

void test_every_field_is_checked_against_the_range_of_the_header(void)
{
    CONFIG_MOTOR_FIELDS(CHECK_MOTOR)
    CONFIG_DRIVE_FIELDS(CHECK_DRIVE)
    CONFIG_CURRENT_LOOP_FIELDS(CHECK_CURRENT_LOOP)
    CONFIG_ROTOR_FIELDS(CHECK_ROTOR)
    CONFIG_HALL_ARRAY(CHECK_HALL)
    CONFIG_BATTERY_FIELDS(CHECK_BATTERY)
    CONFIG_BRAKE_FIELDS(CHECK_BRAKE)
    CONFIG_VEHICLE_FIELDS(CHECK_VEHICLE)
    CONFIG_DRIVER_FIELDS(CHECK_DRIVER)
    CONFIG_PEDALS_FIELDS(CHECK_PEDALS)
    CONFIG_PEDALS_ARRAY(CHECK_PEDALS_ARRAY)
    CONFIG_SERVICE_FIELDS(CHECK_SERVICE)
    CONFIG_CAN_FIELDS(CHECK_CAN)
    CONFIG_TOLERANCE_FIELDS(CHECK_TOLERANCE)
    CONFIG_MODES_FIELDS(CHECK_MODES)
    CONFIG_MONITOR_FIELDS(CHECK_MONITOR)
}

void test_torques_and_temperatures_must_be_in_order(void)
{
    config.motor.rated_torque_mNm = config.motor.max_torque_mNm + 1;
    assert_relation("motor.rated_torque_mNm <= motor.max_torque_mNm");
    config.motor.derate_winding_temperature_cC = config.motor.max_winding_temperature_cC;
    assert_relation("motor.derate_winding_temperature_cC < motor.max_winding_temperature_cC");
    config.drive.max_switch_temperature_cC = 9000;
    config.drive.derate_switch_temperature_cC = 9001;
    assert_relation("drive.derate_switch_temperature_cC <= drive.max_switch_temperature_cC");
}

void test_a_surface_magnet_motor_has_one_inductance(void)
{
    config.motor.type = CONFIG_MOTOR_SPMSM;
    config.motor.q_inductance_nH = config.motor.d_inductance_nH + 1;
    assert_relation("motor.d_inductance_nH = motor.q_inductance_nH");
    config.motor.type = CONFIG_MOTOR_IPMSM;
    config.motor.q_inductance_nH = config.motor.d_inductance_nH + 1;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
}

void test_overcurrent_trip_must_be_above_the_phase_current_limit(void)
{
    config.motor.max_phase_current_mA = config.drive.current_full_scale_mA;
    assert_relation("motor.max_phase_current_mA");
    config.monitor.overcurrent_pu_q15 = config.current_loop.max_current_pu_q15;
    assert_relation("current_loop.max_current_pu_q15 < monitor.overcurrent_pu_q15");
    config.current_loop.field_weakening_current_pu_q15 = config.current_loop.max_current_pu_q15 + 1;
    assert_relation(
        "current_loop.field_weakening_current_pu_q15 <= current_loop.max_current_pu_q15");
}

/* 12 bits, zero current at code 2048. With an offset of 200 codes the ADC saturates 1847 codes of
 * 16 above zero: a larger overcurrent limit could not trip. */
void test_overcurrent_trip_must_be_within_the_adc_range(void)
{
    config.monitor.offset_tolerance_codes = 200;
    config.monitor.overcurrent_pu_q15 = 1847 * 16;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.monitor.overcurrent_pu_q15++;
    assert_relation("monitor.overcurrent_pu_q15 within the converter's range");
}

/* The ADC saturates at code 4095 of 4096: a larger overvoltage limit could not trip. */
void test_overvoltage_trip_must_be_within_the_adc_range(void)
{
    config.battery.overvoltage_trip_mV =
        config.drive.voltage_full_scale_mV - config.drive.voltage_full_scale_mV / 4096;
    assert_relation("battery.overvoltage_trip_mV < drive.voltage_full_scale_mV");
}

/* 2 pi 20 kHz / 16 = 7854 rad/s electrical, for 23 pole pairs 341.477 rad/s; the winding is made
 * small enough to allow it. */
void test_max_speed_must_be_within_the_speed_base(void)
{
    /* Magnets and inductances weak enough for it. */
    config.motor.d_inductance_nH /= 4;
    config.motor.q_inductance_nH /= 4;
    config.motor.flux_linkage_nWb /= 4;
    config.motor.iron_loss_resistance_mOhm = 0;
    config.motor.iron_loss_resistance_slope_nOhm_s = 0;
    config.current_map.speed_step_log2 = 16; /* reaches it */
    config.motor.max_speed_mrad_s = 341477;
    TEST_ASSERT_TRUE(derive(&config));
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.motor.max_speed_mrad_s = 341478;
    assert_relation("motor.max_speed_mrad_s within a sixteenth");
}

void test_voltages_must_be_in_order(void)
{
    config.battery.undervoltage_trip_mV = config.battery.min_voltage_mV;
    assert_relation("battery.undervoltage_trip_mV < battery.min_voltage_mV");
    config.battery.min_voltage_mV = config.battery.foldback_voltage_mV;
    assert_relation("battery.min_voltage_mV < battery.foldback_voltage_mV");
    config.battery.foldback_voltage_mV = config.battery.max_voltage_mV;
    assert_relation("battery.foldback_voltage_mV < battery.max_voltage_mV");
    config.battery.discharge_foldback_voltage_mV = config.battery.min_voltage_mV;
    assert_relation("battery.min_voltage_mV < battery.discharge_foldback_voltage_mV");
    config.battery.discharge_foldback_voltage_mV = config.battery.max_voltage_mV;
    assert_relation("battery.discharge_foldback_voltage_mV < battery.max_voltage_mV");
    config.battery.overvoltage_trip_mV = config.battery.max_voltage_mV;
    assert_relation("battery.max_voltage_mV < battery.overvoltage_trip_mV");
    config.battery.overvoltage_trip_mV = config.drive.voltage_full_scale_mV;
    assert_relation("battery.overvoltage_trip_mV < drive.voltage_full_scale_mV");
}

/* The lowest two bits of an identifier say which wheel it is of; those of profile 2 differ within
 * 32 (README of comms). */
void test_the_base_of_the_identifiers_is_a_multiple_of_32(void)
{
    config.vehicle.can_base = 0x740;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.vehicle.can_base = 0x110;
    assert_relation("vehicle.can_base a multiple of 32");
}

/* Identifiers of the messages: up to 0x9F above the base (README of comms). */
void test_xcp_is_less_urgent_than_every_message(void)
{
    static const int32_t GOOD[] = {0, 0x1A0, 0x7F8};
    static const int32_t BAD[] = {0x198, 0x1A4, 0x7F4};
    config.vehicle.can_base = 0x100;
    for (int k = 0; k < 3; k++) {
        config.service.can_base = GOOD[k];
        TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    }
    for (int k = 0; k < 3; k++) {
        config.vehicle.can_base = 0x100;
        config.service.can_base = BAD[k];
        assert_relation("service.can_base 0, or a multiple of 8 and 160 above vehicle.can_base");
    }
}

/* It is no parameter, and its change needs no other checksum. */
void test_the_key_is_not_covered_by_the_checksum(void)
{
    config.service_key[3] = 1;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, config_validate(&config, sizeof config).code);
}

static bool has_address(void)
{
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    return config_has_address(&config, config_validate(&config, sizeof config).code);
}

/* A refused image names its wheel only if it is the one that was written, and its address exists.
 */
void test_a_refused_image_has_an_address_if_it_is_intact_and_the_address_is_in_range(void)
{
    TEST_ASSERT_TRUE(has_address());
    config.motor.pole_pairs = 0;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_RANGE, sealed_result().code);
    TEST_ASSERT_TRUE(has_address());
    config.motor.pole_pairs = 1;
    TEST_ASSERT_FALSE(
        config_has_address(&config, config_validate(&config, sizeof config).code)); /* CRC */
    TEST_ASSERT_FALSE(
        config_has_address(&config, config_validate(&config, sizeof config - 4U).code));
    static const int32_t WHEELS[] = {-1, 4};
    static const int32_t BASES[] = {-32, 0x110, 0x760};
    for (int k = 0; k < 2; k++) {
        config = CONFIG_LU2013;
        config.vehicle.wheel_position = WHEELS[k];
        TEST_ASSERT_FALSE(has_address());
    }
    for (int k = 0; k < 3; k++) {
        config = CONFIG_LU2013;
        config.vehicle.can_base = BASES[k];
        TEST_ASSERT_FALSE(has_address());
    }
    config = CONFIG_LU2013;
    config.vehicle.wheel_position = 3;
    config.vehicle.can_base = 0x740;
    TEST_ASSERT_TRUE(has_address());
    config.magic ^= 1U;
    TEST_ASSERT_FALSE(has_address());
    config.magic ^= 1U;
    config.format_version++;
    TEST_ASSERT_FALSE(has_address());
}

void test_stop_lamp_off_threshold_must_not_exceed_its_on_threshold(void)
{
    config.brake.stop_lamp_off_mm_s2 = config.brake.stop_lamp_on_mm_s2;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.brake.stop_lamp_off_mm_s2++;
    assert_relation("brake.stop_lamp_off_mm_s2 <= brake.stop_lamp_on_mm_s2");
}

void test_torque_must_still_grow_at_the_voltage_that_field_weakening_regulates(void)
{
    config.current_loop.modulation_target_pu_q15 = 29491; /* 0.9; its square is 26541 in Q15 */
    config.brake.torque_growth_end_q15 = 26542;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.current_loop.modulation_target_pu_q15 = 29491;
    config.brake.torque_growth_end_q15 = 26541;
    assert_relation("brake.torque_growth_end_q15 > square");
}

void test_a_vehicle_does_not_coast_to_a_stop_faster_than_its_tyres_can_brake(void)
{
    config.monitor.coasting_mm_s2 = 2000;
    config.monitor.tyre_grip_mm_s2 = 2000;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.monitor.tyre_grip_mm_s2 = 1999;
    assert_relation("monitor.coasting_mm_s2 <= monitor.tyre_grip_mm_s2");
}

void test_the_devices_must_stand_the_over_voltage_trip(void)
{
    config.drive.device_voltage_mV = config.battery.overvoltage_trip_mV;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.drive.device_voltage_mV = config.battery.overvoltage_trip_mV - 1;
    assert_relation("battery.overvoltage_trip_mV <= drive.device_voltage_mV");
}

void test_stored_offsets_must_be_as_plausible_as_measured_ones(void)
{
    int32_t *const offsets[] = {&config.drive.offset_a_q4, &config.drive.offset_b_q4,
                                &config.drive.offset_c_q4};
    const int32_t tolerance_q4 = 16 * config.monitor.offset_tolerance_codes;
    for (int x = 0; x < 3; x++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            *offsets[x] = 32768 + sign * tolerance_q4;
            TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
            *offsets[x] += sign;
            assert_relation("drive.offset_a_q4, _b_q4, _c_q4 within");
            *offsets[x] = 32768;
        }
    }
}

void test_pulses_and_dead_time_must_fit_into_the_period(void)
{
    config.drive.pwm_frequency_Hz = 20000;
    config.drive.min_pulse_ns = 5001; /* half a pulse, of 50 us */
    assert_relation("drive.min_pulse_ns");
    config.drive.dead_time_ns = 10000; /* 20 % of the period at 20 kHz */
    assert_relation("drive.dead_time_ns");
    /* 12 % at 20 kHz, and twice 0.8 V over 24 V: 12.8 %. */
    config.drive.dead_time_ns = 6000;
    config.drive.diode_drop_mV = 800;
    config.battery.min_voltage_mV = 20000;
    config.battery.max_voltage_mV = 28000;
    assert_relation("drive.dead_time_ns, with drive.diode_drop_mV");
}

void test_blend_out_must_end_below_its_start(void)
{
    config.brake.blend_out_end_mrad_s = config.brake.blend_out_start_mrad_s + 1;
    assert_relation("brake.blend_out_end_mrad_s <= brake.blend_out_start_mrad_s");
}

/* The lowest bus voltage, 36 V of 61.8 V full scale, and a circle of 0.919 of it over sqrt 3: one
 * modulation unit is 0.3091 of the voltage base. */
static double lowest_unit(void)
{
    return config.current_loop.modulation_limit_pu_q15 / 32768.0 *
           config.battery.undervoltage_trip_mV / config.drive.voltage_full_scale_mV / sqrt(3.0);
}

/* A value a thousandth below the limit breaks no relation (but is no longer what it follows from),
 * one a thousandth above it does. */
static void assert_edge(int32_t *value, double limit, const char *fields)
{
    const int32_t good = *value;
    *value = (int32_t)(limit * 0.999);
    TEST_ASSERT_EQUAL_INT_MESSAGE(CONFIG_RESULT_RANGE, sealed_result().code, fields);
    *value = (int32_t)(limit * 1.001);
    const config_result_t result = sealed_result();
    TEST_ASSERT_EQUAL_INT_MESSAGE(CONFIG_RESULT_RELATION, result.code, fields);
    assert_text_names(&result, fields);
    *value = good;
}

void test_gains_must_fit_the_current_loop_s_formats_at_the_lowest_bus_voltage(void)
{
    /* Proportional below 16 and integral below 1/2 in modulation units, with k_i / k_p below 1/4.
     */
    assert_edge(&config.current_loop.proportional_d_pu_q16, 16.0 * lowest_unit() * 65536.0,
                "gains fit");
    assert_edge(&config.current_loop.proportional_q_pu_q16, 16.0 * lowest_unit() * 65536.0,
                "gains fit");
    config.current_loop.proportional_d_pu_q16 = (int32_t)(15.0 * lowest_unit() * 65536.0);
    config.current_loop.proportional_q_pu_q16 = config.current_loop.proportional_d_pu_q16;
    assert_edge(&config.current_loop.integral_d_pu_q24, 0.5 * lowest_unit() * 16777216.0,
                "gains fit");
    assert_edge(&config.current_loop.integral_q_pu_q24, 0.5 * lowest_unit() * 16777216.0,
                "gains fit");
}

void test_cross_coupling_must_fit_its_format_at_the_highest_speed(void)
{
    /* w L I_base below 16 modulation units; w over its base of 2 pi 20 kHz / 16. */
    config.motor.max_speed_mrad_s *= 2; /* so that the limit lies inside the range of the field */
    const double speed = config.motor.max_speed_mrad_s * 1e-3 * config.motor.pole_pairs /
                         (2.0 * 3.14159265 * 1250.0);
    const double limit = 16.0 * lowest_unit() / speed * 65536.0;
    assert_edge(&config.current_loop.inductance_d_pu_q16, limit, "inductances fit");
    assert_edge(&config.current_loop.inductance_q_pu_q16, limit, "inductances fit");
}

void test_the_winding_s_time_constant_must_be_longer_than_four_periods(void)
{
    /* k_i / k_p = R T / L below 1/4: Q24 over Q16 */
    config.current_loop.proportional_d_pu_q16 /= 2; /* so that k_i itself still fits */
    config.current_loop.proportional_q_pu_q16 /= 2;
    assert_edge(&config.current_loop.integral_d_pu_q24,
                config.current_loop.proportional_d_pu_q16 * 64.0, "L / R");
    assert_edge(&config.current_loop.integral_q_pu_q24,
                config.current_loop.proportional_q_pu_q16 * 64.0, "L / R");
}

void test_hall_sectors_must_be_ordered_and_30_to_90_degrees_wide(void)
{
    const int32_t edge = config.rotor.edge_turn[2];
    config.rotor.edge_turn[2] = config.rotor.edge_turn[1] + 5460; /* 29.99 degrees */
    assert_relation("rotor.edge_turn");
    config.rotor.edge_turn[2] = config.rotor.edge_turn[1] + 16385;
    assert_relation("rotor.edge_turn");
    config.rotor.edge_turn[2] = config.rotor.edge_turn[3];
    config.rotor.edge_turn[3] = edge;
    assert_relation("rotor.edge_turn");
}

void test_encoder_must_have_enough_counts_and_a_narrow_index(void)
{
    config.rotor.encoder_counts = 0;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code); /* no encoder, no demand on it */
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_index_tolerance_counts = 2;
    config.rotor.encoder_counts = 32 * 23;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.rotor.encoder_counts = 32 * 23 - 1;
    assert_relation("rotor.encoder_counts");
    config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    config.rotor.encoder_counts = 4096; /* 178 counts an electrical turn, 14.8 in 30 degrees */
    config.rotor.encoder_index_tolerance_counts = 14;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.rotor.encoder_index_tolerance_counts = 15;
    assert_relation("rotor.encoder_index_tolerance_counts");
}

void test_blend_out_must_end_above_the_lowest_hall_speed(void)
{
    /* One electrical turn a second of 23 pole pairs: 2 pi / 23 = 0.27318 rad/s. */
    config.brake.blend_out_end_mrad_s = 274;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.brake.blend_out_end_mrad_s = 273;
    assert_relation("brake.blend_out_end_mrad_s at least one electrical turn");
    config.brake.blend_out_end_mrad_s = 0;
    config.rotor.sensor = CONFIG_ROTOR_ANGLE;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
}
