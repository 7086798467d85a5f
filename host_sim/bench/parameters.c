/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/parameters.h"

#include <stddef.h>
#include <string.h>

typedef struct {
    parameter_info_t info;
    size_t offset;
} line_t;

#define LINE(section, field, least, most, what, meaning)                                           \
    {.info = {.name = #section "." #field,                                                         \
              .unit = (what),                                                                      \
              .text = (meaning),                                                                   \
              .lowest = (least),                                                                   \
              .highest = (most)},                                                                  \
     .offset = offsetof(bench_params_t, section.field)},

#define MOTOR(name, lowest, highest, unit, text) LINE(motor, name, lowest, highest, unit, text)
#define INVERTER(name, lowest, highest, unit, text)                                                \
    LINE(inverter, name, lowest, highest, unit, text)
#define BATTERY(name, lowest, highest, unit, text) LINE(battery, name, lowest, highest, unit, text)
#define VEHICLE(name, lowest, highest, unit, text) LINE(vehicle, name, lowest, highest, unit, text)
#define ROAD(name, lowest, highest, unit, text) LINE(road, name, lowest, highest, unit, text)
#define BRAKE(name, lowest, highest, unit, text) LINE(brake, name, lowest, highest, unit, text)
#define SENSORS(name, lowest, highest, unit, text) LINE(sensors, name, lowest, highest, unit, text)
#define ENCODER(name, lowest, highest, unit, text) LINE(encoder, name, lowest, highest, unit, text)
#define THERMAL(name, lowest, highest, unit, text) LINE(thermal, name, lowest, highest, unit, text)
#define DRIVER(name, lowest, highest, unit, text) LINE(driver, name, lowest, highest, unit, text)
#define RUN(name, lowest, highest, unit, text) LINE(run, name, lowest, highest, unit, text)
#define BRAKE_SENSOR(name, lowest, highest, unit, text)                                            \
    LINE(brake_sensor, name, lowest, highest, unit, text)
#define PEDAL_SENSORS(name, lowest, highest, unit, text)                                           \
    LINE(pedal_sensors, name, lowest, highest, unit, text)
#define BMS(name, lowest, highest, unit, text) LINE(bms, name, lowest, highest, unit, text)
#define CHASSIS(name, lowest, highest, unit, text) LINE(chassis, name, lowest, highest, unit, text)
#define TYRE(name, lowest, highest, unit, text) LINE(tyre, name, lowest, highest, unit, text)
#define WINDING_SENSOR(name, lowest, highest, unit, text)                                          \
    LINE(winding_sensor, name, lowest, highest, unit, text)
#define WHEEL_SPEED(name, lowest, highest, unit, text)                                             \
    LINE(wheel_speed, name, lowest, highest, unit, text)
#define ANTI_LOCK(name, lowest, highest, unit, text)                                               \
    LINE(anti_lock, name, lowest, highest, unit, text)
#define SWITCH_SENSOR(name, lowest, highest, unit, text)                                           \
    LINE(switch_sensor, name, lowest, highest, unit, text)
#define FAULT(name, lowest, highest, unit, text) LINE(fault, name, lowest, highest, unit, text)
#define BUS(name, lowest, highest, unit, text) LINE(bus, name, lowest, highest, unit, text)

#define ONE_WHEEL(k, field, least, most, what, meaning)                                            \
    {.info = {.name = "wheel" #k "." #field,                                                       \
              .unit = (what),                                                                      \
              .text = (meaning),                                                                   \
              .lowest = (least),                                                                   \
              .highest = (most)},                                                                  \
     .offset = offsetof(bench_params_t, wheel[k].field)},
#define WHEEL(k) ONE_WHEEL_PARAMETERS(ONE_WHEEL, k)

static const line_t LINES[] = {
    BRAKE_SENSOR_PARAMETERS(BRAKE_SENSOR) PEDAL_SENSORS_PARAMETERS(PEDAL_SENSORS)
        PMSM_PARAMETERS(MOTOR) INVERTER_PARAMETERS(INVERTER) BATTERY_PARAMETERS(BATTERY)
            VEHICLE_PARAMETERS(VEHICLE) ROAD_PARAMETERS(ROAD) HYDRAULIC_BRAKE_PARAMETERS(BRAKE)
                SENSORS_PARAMETERS(SENSORS) ENCODER_PARAMETERS(ENCODER) THERMAL_PARAMETERS(THERMAL)
                    DRIVER_PARAMETERS(DRIVER) RUN_PARAMETERS(RUN) BUS_PARAMETERS(BUS)
                        BMS_PARAMETERS(BMS) CHASSIS_PARAMETERS(CHASSIS) TYRE_PARAMETERS(TYRE)
                            WINDING_SENSOR_PARAMETERS(WINDING_SENSOR) FAULT_PARAMETERS(FAULT)
                                WINDING_SENSOR_PARAMETERS(SWITCH_SENSOR)
                                    WHEEL_SPEED_PARAMETERS(WHEEL_SPEED)
                                        ANTI_LOCK_PARAMETERS(ANTI_LOCK) WHEEL(0) WHEEL(1) WHEEL(2)
                                            WHEEL(3) WHEEL(4) WHEEL(5) WHEEL(6) WHEEL(7) WHEEL(8)
                                                WHEEL(9) WHEEL(10) WHEEL(11) WHEEL(12) WHEEL(13)
                                                    WHEEL(14) WHEEL(15)};

int parameters_count(void)
{
    return (int)(sizeof(LINES) / sizeof(LINES[0]));
}

parameter_info_t parameters_info(int index)
{
    return LINES[index].info;
}

int parameters_find(const char *name)
{
    for (int k = 0; k < parameters_count(); k++) {
        if (strcmp(LINES[k].info.name, name) == 0) {
            return k;
        }
    }
    return -1;
}

double parameters_get(const bench_params_t *params, int index)
{
    double out;
    memcpy(&out, (const unsigned char *)params + LINES[index].offset, sizeof(out));
    return out;
}

bool parameters_set(bench_params_t *params, int index, double value)
{
    const line_t *line = &LINES[index];
    if (!(value >= line->info.lowest && value <= line->info.highest)) {
        return false;
    }
    memcpy((unsigned char *)params + line->offset, &value, sizeof(value));
    return true;
}
