/* SPDX-License-Identifier: Apache-2.0 */
#include "app/config_lines.h"

#include <stddef.h>
#include <string.h>

typedef struct {
    const char *name;
    size_t offset_bytes;
    uint32_t count;
} field_t;

/* clang-format off */
#define FIELD(section, name, count) {#section "." #name, offsetof(config_t, section.name), (count)},
#define MOTOR_FIELD(name, lowest, highest, unit, text) FIELD(motor, name, 1)
#define DRIVE_FIELD(name, lowest, highest, unit, text) FIELD(drive, name, 1)
#define CURRENT_LOOP_FIELD(name, lowest, highest, unit, text) FIELD(current_loop, name, 1)
#define ROTOR_FIELD(name, lowest, highest, unit, text) FIELD(rotor, name, 1)
#define BATTERY_FIELD(name, lowest, highest, unit, text) FIELD(battery, name, 1)
#define BRAKE_FIELD(name, lowest, highest, unit, text) FIELD(brake, name, 1)
#define VEHICLE_FIELD(name, lowest, highest, unit, text) FIELD(vehicle, name, 1)
#define DRIVER_FIELD(name, lowest, highest, unit, text) FIELD(driver, name, 1)
#define PEDALS_FIELD(name, lowest, highest, unit, text) FIELD(pedals, name, 1)
#define PEDALS_ARRAY(name, count, lowest, highest, unit, text) FIELD(pedals, name, count)
#define MODES_FIELD(name, lowest, highest, unit, text) FIELD(modes, name, 1)
#define MONITOR_FIELD(name, lowest, highest, unit, text) FIELD(monitor, name, 1)
#define THERMAL_FIELD(name, lowest, highest, unit, text) FIELD(thermal, name, 1)
#define REGEN_MAP_FIELD(name, lowest, highest, unit, text) FIELD(regen_map, name, 1)
#define CURRENT_MAP_FIELD(name, lowest, highest, unit, text) FIELD(current_map, name, 1)
#define ROTOR_ARRAY(name, count, lowest, highest, unit, text) FIELD(rotor, name, count)

static const field_t FIELDS[] = {
    CONFIG_MOTOR_FIELDS(MOTOR_FIELD)
    CONFIG_DRIVE_FIELDS(DRIVE_FIELD)
    CONFIG_CURRENT_LOOP_FIELDS(CURRENT_LOOP_FIELD)
    CONFIG_ROTOR_FIELDS(ROTOR_FIELD)
    CONFIG_HALL_ARRAY(ROTOR_ARRAY)
    CONFIG_BATTERY_FIELDS(BATTERY_FIELD)
    CONFIG_BRAKE_FIELDS(BRAKE_FIELD)
    CONFIG_VEHICLE_FIELDS(VEHICLE_FIELD)
    CONFIG_DRIVER_FIELDS(DRIVER_FIELD)
    CONFIG_PEDALS_FIELDS(PEDALS_FIELD)
    CONFIG_PEDALS_ARRAY(PEDALS_ARRAY)
    CONFIG_MODES_FIELDS(MODES_FIELD)
    CONFIG_MONITOR_FIELDS(MONITOR_FIELD)
    CONFIG_THERMAL_FIELDS(THERMAL_FIELD)
    CONFIG_REGEN_MAP_FIELDS(REGEN_MAP_FIELD)
    CONFIG_CURRENT_MAP_FIELDS(CURRENT_MAP_FIELD)
};
/* clang-format on */

static bool begins_with(const char *name, const char *prefix)
{
    return strncmp(name, prefix, strlen(prefix)) == 0;
}

static void add(const config_t *config, const field_t *field, text_t *line)
{
    text_add(line, field->name);
    for (uint32_t i = 0; i < field->count; i++) {
        int32_t value;
        memcpy(&value, (const char *)config + field->offset_bytes + i * sizeof value, sizeof value);
        text_add(line, " ");
        text_add_integer(line, value);
    }
}

bool config_lines_get(const config_t *config, const char *prefix, uint32_t number, text_t *line)
{
    uint32_t left = number;
    for (size_t i = 0; i < sizeof FIELDS / sizeof FIELDS[0]; i++) {
        if (!begins_with(FIELDS[i].name, prefix)) {
            continue;
        }
        if (left == 0) {
            add(config, &FIELDS[i], line);
            return true;
        }
        left--;
    }
    return false;
}
