/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "config/validate.h"
#include "core/q15.h"
#include "derive.h"
#include "random_values.h"
#include "torque_rig.h"
#include "unity.h"

/*
 * Random configurations that the validator accepts: any number of fields anywhere in their ranges.
 * The assertions are bounds of the outputs; the sanitizer build detects overflows.
 */

typedef struct {
    size_t offset;
    int32_t lowest, highest;
} field_t;

#define MOTOR(name, lowest, highest, unit, text) {offsetof(config_t, motor.name), lowest, highest},
#define DRIVE(name, lowest, highest, unit, text) {offsetof(config_t, drive.name), lowest, highest},
#define BATTERY(name, lowest, highest, unit, text)                                                 \
    {offsetof(config_t, battery.name), lowest, highest},
#define BRAKE(name, lowest, highest, unit, text) {offsetof(config_t, brake.name), lowest, highest},
#define VEHICLE(name, lowest, highest, unit, text)                                                 \
    {offsetof(config_t, vehicle.name), lowest, highest},
#define DRIVER(name, lowest, highest, unit, text)                                                  \
    {offsetof(config_t, driver.name), lowest, highest},
#define CURRENT_MAP(name, lowest, highest, unit, text)                                             \
    {offsetof(config_t, current_map.name), lowest, highest},

static const field_t FIELDS[] = {CONFIG_MOTOR_FIELDS(MOTOR) CONFIG_DRIVE_FIELDS(DRIVE)
                                     CONFIG_BATTERY_FIELDS(BATTERY) CONFIG_BRAKE_FIELDS(BRAKE)
                                         CONFIG_VEHICLE_FIELDS(VEHICLE) CONFIG_DRIVER_FIELDS(DRIVER)
                                             CONFIG_CURRENT_MAP_FIELDS(CURRENT_MAP)};

enum { FIELD_COUNT = sizeof FIELDS / sizeof FIELDS[0] };

void setUp(void) {}

void tearDown(void) {}

/* One time in ten an end of the range; otherwise mostly uniform over the decades of the range. */
static int32_t random_in(random_t *random, const field_t *field)
{
    if (random_chance(random, 0.1)) {
        return random_chance(random, 0.5) ? field->lowest : field->highest;
    }
    if (field->lowest < 0 || random_chance(random, 0.3)) {
        return random_between(random, field->lowest, field->highest);
    }
    const double low = log(field->lowest < 1 ? 1.0 : field->lowest);
    return (int32_t)exp(random_real(random, low, log((double)field->highest)));
}

static const field_t *field_at(size_t offset)
{
    int f = 0;
    while (FIELDS[f].offset != offset) {
        f++;
    }
    return &FIELDS[f];
}

/* Returns whether the validator accepts the configuration. */
static bool random_configuration(random_t *random, double changed)
{
    config = paper_vehicle();
    for (int f = 0; f < FIELD_COUNT; f++) {
        if (random_chance(random, changed)) {
            const int32_t value = random_in(random, &FIELDS[f]);
            memcpy((char *)&config + FIELDS[f].offset, &value, sizeof value);
        }
    }
    if (random_chance(random, 0.5)) { /* weak magnets with reluctance, down to no flux at all */
        config.motor.type = CONFIG_MOTOR_IPMSM;
        config.motor.flux_linkage_nWb =
            random_in(random, field_at(offsetof(config_t, motor.flux_linkage_nWb)));
    }
    if (config.motor.type == CONFIG_MOTOR_SPMSM) {
        config.motor.q_inductance_nH = config.motor.d_inductance_nH;
    }
    config.driver.hold_torque_mNm =
        q_min(config.driver.hold_torque_mNm, config.brake.max_hydraulic_torque_mNm);
    for (int k = 0; k < CONFIG_CURRENT_MAP_POINTS_MAX && random_chance(random, 0.999); k++) {
        config.current_map.current_d_lsb[k] =
            (int16_t)(random_between(random, -1000, 1000) * exp(random_real(random, 0.0, 3.48)));
    }
    (void)derive(&config);
    config.crc32 = config_crc32(&config, (uint32_t)offsetof(config_t, crc32));
    return config_validate(&config, sizeof config).code == CONFIG_RESULT_OK;
}

static void random_input(random_t *random)
{
    in.drive_torque_mNm = random_wild(random);
    in.brake_torque_mNm = random_wild(random);
    in.demand_age_ms = random_chance(random, 0.9) ? 0U : 5000U;
    in.abs_active = random_chance(random, 0.1);
    in.speed_mrad_s = random_wild(random);
    in.current.d_mA = random_wild(random);
    in.current.q_mA = random_wild(random);
    in.bus_voltage_mV = random_wild(random);
    in.phase_voltage_mV = random_wild(random);
    in.voltage_use_q15 = random_wild(random);
    in.bms_charge_current_mA = random_wild(random);
    in.bms_discharge_current_mA = random_wild(random);
    in.winding_temperature_cC = random_wild(random);
    in.switch_temperature_cC = random_wild(random);
    in.i_d_weakening_mA = random_wild(random);
    in.current_missing_q15 = random_chance(random, 0.5) ? 0 : random_between(random, 0, 13107);
    in.angle_valid = random_chance(random, 0.9);
    const int32_t most_q15 = random_chance(random, 0.9) ? Q15_ONE : 0;
    in.torque_enable.drive_q15 = (int16_t)random_between(random, 0, most_q15);
    in.torque_enable.brake_q15 = (int16_t)random_between(random, 0, most_q15);
    in.torque_enable.reason = REASON_TORQUE_ENABLE;
}

static void assert_bounded(const torque_output_t *out)
{
    TEST_ASSERT_INT32_WITHIN(config.motor.max_torque_mNm, 0, out->command_mNm);
    TEST_ASSERT_INT32_WITHIN(config.motor.max_phase_current_mA, 0, out->current.i_q_mA);
    TEST_ASSERT_INT32_WITHIN(config.motor.max_phase_current_mA, 0, out->current.i_d_mA);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out->hydraulic_mNm);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(config.brake.max_hydraulic_torque_mNm, out->hydraulic_mNm);
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, out->available.torque_mNm);
    TEST_ASSERT_NOT_EQUAL_INT(REASON_NONE, out->available.reason);
}

void test_outputs_are_bounded_for_every_valid_configuration_and_any_input(void)
{
    random_t random = random_seeded(3); /* circle and ellipse that do not meet are among them */
    const double changed[] = {0.02, 0.08, 0.15};
    for (int k = 0; k < 3; k++) {
        int accepted = 0;
        for (int n = 0; n < 9000; n++) {
            if (!random_configuration(&random, changed[k])) {
                continue;
            }
            accepted++;
            const torque_case_t none = {.bridge = BRIDGE_PWM};
            torque_rig_start();
            in = none;
            for (int s = 0; s < 40; s++) {
                random_input(&random);
                const torque_output_t out = torque_case_step();
                assert_bounded(&out);
            }
        }
        TEST_ASSERT_GREATER_THAN_INT(200, accepted); /* enough configurations were compared */
    }
}
