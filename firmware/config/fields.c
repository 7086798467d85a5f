/* SPDX-License-Identifier: Apache-2.0 */
#include "config/fields.h"

#include <stddef.h>

/* Ranges, names and sizes are lists of their own: in flash they are a third smaller than one
 * structure a field. */

/* X(x, bound): the numbers with which the fields' ranges begin and end, in rising order. A range is
 * stored as the places of both in this list: two bytes instead of eight. */
/* clang-format off */
#define BOUND_LIST(X, x)                                                                           \
    X(x, -32767) X(x, -20000) X(x, -10000) X(x, -5000) X(x, 0) X(x, 1) X(x, 2) X(x, 3) X(x, 5)     \
    X(x, 6) X(x, 8) X(x, 10) X(x, 15) X(x, 16) X(x, 17) X(x, 20) X(x, 40) X(x, 60) X(x, 65)        \
    X(x, 100) X(x, 128) X(x, 164) X(x, 250) X(x, 328) X(x, 500) X(x, 512) X(x, 999) X(x, 1000)     \
    X(x, 1024) X(x, 1856) X(x, 2000) X(x, 2040) X(x, 3276) X(x, 4000) X(x, 4031) X(x, 5000)        \
    X(x, 8192) X(x, 10000) X(x, 15000) X(x, 16384) X(x, 20000) X(x, 25000) X(x, 29998)             \
    X(x, 30000) X(x, 32112) X(x, 32440) X(x, 32767) X(x, 32768) X(x, 60000) X(x, 65520)            \
    X(x, 65535) X(x, 65536) X(x, 100000) X(x, 1000000) X(x, 1048576) X(x, 1638200)                 \
    X(x, 2000000) X(x, 3000000) X(x, 3276600) X(x, 3276700) X(x, 4000000) X(x, 5000000)            \
    X(x, 16777216) X(x, 20000000) X(x, 100000000) X(x, 1000000000) X(x, 2000000000)

/* A port without flux maps (flux_relations.h) knows no fields of theirs, which are the last. */
#ifdef CONFIG_WITHOUT_FLUX_MAP
#define FLUX_FIELDS(X, Y)
#else
#define FLUX_FIELDS(X, Y) CONFIG_FLUX_MAP_FIELDS(X) CONFIG_FLUX_MAP_ARRAY(Y)
#endif

/* In the order of config_t. */
#define ALL_FIELDS(X, Y)                                                                           \
    CONFIG_MOTOR_FIELDS(X) CONFIG_DRIVE_FIELDS(X) CONFIG_CURRENT_LOOP_FIELDS(X)                    \
    CONFIG_ROTOR_FIELDS(X) CONFIG_HALL_ARRAY(Y) CONFIG_BATTERY_FIELDS(X) CONFIG_BRAKE_FIELDS(X)    \
    CONFIG_VEHICLE_FIELDS(X) CONFIG_DRIVER_FIELDS(X) CONFIG_PEDALS_FIELDS(X)                       \
    CONFIG_PEDALS_ARRAY(Y) CONFIG_SERVICE_FIELDS(X) CONFIG_CAN_FIELDS(X)                           \
    CONFIG_TOLERANCE_FIELDS(X) CONFIG_MODES_FIELDS(X) CONFIG_MONITOR_FIELDS(X)                     \
    CONFIG_THERMAL_FIELDS(X) CONFIG_TEMPERATURE_FIELDS(X) CONFIG_TEMPERATURE_ARRAY(Y)              \
    CONFIG_REGEN_MAP_FIELDS(X) CONFIG_REGEN_MAP_ARRAY(Y) CONFIG_CURRENT_MAP_FIELDS(X)              \
    CONFIG_CURRENT_MAP_ARRAY(Y) FLUX_FIELDS(X, Y)
/* clang-format on */

#define BOUND(x, bound) (bound),
#define BOUND_BELOW(x, bound) +((bound) < (x))
#define BOUND_IS(x, bound) +((bound) == (x))
#define PLACE(x) (uint8_t)(0 BOUND_LIST(BOUND_BELOW, (x)))
#define LISTED(x) (0 BOUND_LIST(BOUND_IS, (x)) == 1)

static const int32_t BOUNDS[] = {BOUND_LIST(BOUND, 0)};

typedef struct {
    uint8_t lowest; /* places in BOUNDS */
    uint8_t highest;
} range_t;

#define SCALAR(name, lowest, highest, unit, text) {PLACE(lowest), PLACE(highest)},
#define ARRAY(name, count, lowest, highest, unit, text) SCALAR(name, lowest, highest, unit, text)
#define SCALAR_LISTED(name, lowest, highest, unit, text) &&LISTED(lowest) && LISTED(highest)
#define ARRAY_LISTED(name, count, lowest, highest, unit, text)                                     \
    SCALAR_LISTED(name, lowest, highest, unit, text)

static const range_t RANGES[] = {ALL_FIELDS(SCALAR, ARRAY)};
_Static_assert(1 ALL_FIELDS(SCALAR_LISTED, ARRAY_LISTED), "a range ends beside BOUND_LIST");

enum { FIELDS = sizeof RANGES / sizeof RANGES[0] };

typedef struct {
    uint16_t offset_bytes; /* in config_t */
    uint16_t count;
} array_t;

#define SIZE(section, name, count) {(uint16_t)offsetof(config_t, section.name), (count)},
#define ROTOR_SIZE(name, count, lowest, highest, unit, text) SIZE(rotor, name, count)
#define PEDALS_SIZE(name, count, lowest, highest, unit, text) SIZE(pedals, name, count)
#define CURVE_SIZE(name, count, lowest, highest, unit, text) SIZE(temperature, name, count)
#define REGEN_SIZE(name, count, lowest, highest, unit, text) SIZE(regen_map, name, count)
#define CURRENT_SIZE(name, count, lowest, highest, unit, text) SIZE(current_map, name, count)
#define NO_SIZE(name, lowest, highest, unit, text)
#define FLUX_SIZE(name, count, lowest, highest, unit, text) SIZE(flux_map, name, count)

/* The fields of more than one value. */
static const array_t ARRAYS[] = {
    CONFIG_HALL_ARRAY(ROTOR_SIZE) CONFIG_PEDALS_ARRAY(PEDALS_SIZE)
        CONFIG_TEMPERATURE_ARRAY(CURVE_SIZE) CONFIG_REGEN_MAP_ARRAY(REGEN_SIZE)
            CONFIG_CURRENT_MAP_ARRAY(CURRENT_SIZE) FLUX_FIELDS(NO_SIZE, FLUX_SIZE)};

#define NAME(name, lowest, highest, unit, text) #name "\0"
#define ARRAY_NAME(name, count, lowest, highest, unit, text) #name "\0"

typedef struct {
    const char *fields; /* their names, one behind the other */
    uint16_t begin_bytes;
    char name[14];
} section_t;

#define SECTION(name, fields)                                                                      \
    {                                                                                              \
        fields, (uint16_t)offsetof(config_t, name), #name "."                                      \
    }

/* In the order of config_t. */
static const section_t SECTIONS[] = {
    SECTION(motor, CONFIG_MOTOR_FIELDS(NAME)),
    SECTION(drive, CONFIG_DRIVE_FIELDS(NAME)),
    SECTION(current_loop, CONFIG_CURRENT_LOOP_FIELDS(NAME)),
    SECTION(rotor, CONFIG_ROTOR_FIELDS(NAME) CONFIG_HALL_ARRAY(ARRAY_NAME)),
    SECTION(battery, CONFIG_BATTERY_FIELDS(NAME)),
    SECTION(brake, CONFIG_BRAKE_FIELDS(NAME)),
    SECTION(vehicle, CONFIG_VEHICLE_FIELDS(NAME)),
    SECTION(driver, CONFIG_DRIVER_FIELDS(NAME)),
    SECTION(pedals, CONFIG_PEDALS_FIELDS(NAME) CONFIG_PEDALS_ARRAY(ARRAY_NAME)),
    SECTION(service, CONFIG_SERVICE_FIELDS(NAME)),
    SECTION(can, CONFIG_CAN_FIELDS(NAME)),
    SECTION(tolerance, CONFIG_TOLERANCE_FIELDS(NAME)),
    SECTION(modes, CONFIG_MODES_FIELDS(NAME)),
    SECTION(monitor, CONFIG_MONITOR_FIELDS(NAME)),
    SECTION(thermal, CONFIG_THERMAL_FIELDS(NAME)),
    SECTION(temperature, CONFIG_TEMPERATURE_FIELDS(NAME) CONFIG_TEMPERATURE_ARRAY(ARRAY_NAME)),
    SECTION(regen_map, CONFIG_REGEN_MAP_FIELDS(NAME) CONFIG_REGEN_MAP_ARRAY(ARRAY_NAME)),
    SECTION(current_map, CONFIG_CURRENT_MAP_FIELDS(NAME) CONFIG_CURRENT_MAP_ARRAY(ARRAY_NAME)),
#ifndef CONFIG_WITHOUT_FLUX_MAP
    SECTION(flux_map, CONFIG_FLUX_MAP_FIELDS(NAME) CONFIG_FLUX_MAP_ARRAY(ARRAY_NAME)),
#endif
};

/* Range and size of the field with this number, and its section where one begins. */
static void describe(config_field_t *field)
{
    field->lowest = BOUNDS[RANGES[field->number].lowest];
    field->highest = BOUNDS[RANGES[field->number].highest];
    field->count = 1;
    for (uint32_t k = 0; k < sizeof ARRAYS / sizeof ARRAYS[0]; k++) {
        if (ARRAYS[k].offset_bytes == field->offset_bytes) {
            field->count = ARRAYS[k].count;
        }
    }
    for (uint32_t k = 0; k < sizeof SECTIONS / sizeof SECTIONS[0]; k++) {
        if (SECTIONS[k].begin_bytes == field->offset_bytes) {
            field->section = SECTIONS[k].name;
            field->name = SECTIONS[k].fields;
        }
    }
}

config_field_t config_field_first(void)
{
    config_field_t field;
    field.section = SECTIONS[0].name;
    field.name = SECTIONS[0].fields;
    field.offset_bytes = SECTIONS[0].begin_bytes;
    field.number = 0;
    describe(&field);
    return field;
}

static uint32_t value_bytes(const config_field_t *field)
{
    return field->count > CONFIG_FIELD_VALUES_MAX ? sizeof(int16_t) : sizeof(int32_t);
}

bool config_field_next(config_field_t *field)
{
    if (field->number + 1U >= FIELDS) {
        return false;
    }
    while (*field->name != '\0') {
        field->name++;
    }
    field->name++;
    field->offset_bytes += field->count * value_bytes(field);
    field->number++;
    describe(field);
    return true;
}

config_field_t config_field_at(uint32_t offset_bytes)
{
    config_field_t field = config_field_first();
    while (field.offset_bytes < offset_bytes && config_field_next(&field)) {
    }
    return field;
}

int32_t config_field_value(const config_t *config, const config_field_t *field, uint32_t place)
{
    const void *image = config;
    const uint32_t bytes = value_bytes(field);
    const uint32_t at = field->offset_bytes / bytes + place;
    return bytes == sizeof(int16_t) ? ((const int16_t *)image)[at] : ((const int32_t *)image)[at];
}
