/* SPDX-License-Identifier: Apache-2.0 */
#include "config/fields.h"

#include <stddef.h>

/* Ranges, names and sizes are lists of their own: in flash they are a third smaller than one
 * structure a field. */
typedef struct {
    int32_t lowest;
    int32_t highest;
} range_t;

#define SCALAR(name, lowest, highest, unit, text) {(lowest), (highest)},
#define ARRAY(name, count, lowest, highest, unit, text) {(lowest), (highest)},

/* In the order of config_t. */
static const range_t RANGES[] = {
    CONFIG_MOTOR_FIELDS(SCALAR) CONFIG_DRIVE_FIELDS(SCALAR) CONFIG_CURRENT_LOOP_FIELDS(SCALAR)
        CONFIG_ROTOR_FIELDS(SCALAR) CONFIG_HALL_ARRAY(ARRAY) CONFIG_BATTERY_FIELDS(SCALAR)
            CONFIG_BRAKE_FIELDS(SCALAR) CONFIG_VEHICLE_FIELDS(SCALAR) CONFIG_DRIVER_FIELDS(SCALAR)
                CONFIG_PEDALS_FIELDS(SCALAR) CONFIG_PEDALS_ARRAY(ARRAY) CONFIG_MODES_FIELDS(SCALAR)
                    CONFIG_MONITOR_FIELDS(SCALAR) CONFIG_THERMAL_FIELDS(SCALAR)
                        CONFIG_REGEN_MAP_FIELDS(SCALAR) CONFIG_REGEN_MAP_ARRAY(ARRAY)
                            CONFIG_CURRENT_MAP_FIELDS(SCALAR) CONFIG_CURRENT_MAP_ARRAY(ARRAY)};

enum { FIELDS = sizeof RANGES / sizeof RANGES[0] };

typedef struct {
    uint16_t offset_bytes; /* in config_t */
    uint16_t count;
} array_t;

#define SIZE(section, name, count) {(uint16_t)offsetof(config_t, section.name), (count)},
#define ROTOR_SIZE(name, count, lowest, highest, unit, text) SIZE(rotor, name, count)
#define PEDALS_SIZE(name, count, lowest, highest, unit, text) SIZE(pedals, name, count)
#define REGEN_SIZE(name, count, lowest, highest, unit, text) SIZE(regen_map, name, count)
#define CURRENT_SIZE(name, count, lowest, highest, unit, text) SIZE(current_map, name, count)

/* The fields of more than one value. */
static const array_t ARRAYS[] = {CONFIG_HALL_ARRAY(ROTOR_SIZE) CONFIG_PEDALS_ARRAY(
    PEDALS_SIZE) CONFIG_REGEN_MAP_ARRAY(REGEN_SIZE) CONFIG_CURRENT_MAP_ARRAY(CURRENT_SIZE)};

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
    SECTION(modes, CONFIG_MODES_FIELDS(NAME)),
    SECTION(monitor, CONFIG_MONITOR_FIELDS(NAME)),
    SECTION(thermal, CONFIG_THERMAL_FIELDS(NAME)),
    SECTION(regen_map, CONFIG_REGEN_MAP_FIELDS(NAME) CONFIG_REGEN_MAP_ARRAY(ARRAY_NAME)),
    SECTION(current_map, CONFIG_CURRENT_MAP_FIELDS(NAME) CONFIG_CURRENT_MAP_ARRAY(ARRAY_NAME))};

/* Range and size of the field with this number, and its section where one begins. */
static void describe(config_field_t *field)
{
    field->lowest = RANGES[field->number].lowest;
    field->highest = RANGES[field->number].highest;
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

bool config_field_next(config_field_t *field)
{
    if (field->number + 1U >= FIELDS) {
        return false;
    }
    while (*field->name != '\0') {
        field->name++;
    }
    field->name++;
    field->offset_bytes += field->count * (uint32_t)sizeof(int32_t);
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

const int32_t *config_field_values(const config_t *config, const config_field_t *field)
{
    return (const int32_t *)(const void *)config + field->offset_bytes / sizeof(int32_t);
}
