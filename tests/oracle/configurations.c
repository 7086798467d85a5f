/* SPDX-License-Identifier: Apache-2.0 */
#include "configurations.h"

#include <stddef.h>

#include "config/validate.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V,
    CONFIG_WHEEL24V;

static const struct {
    const char *name;
    const config_t *config;
} SHIPPED[CONFIGURATIONS] = {{"lu2013", &CONFIG_LU2013},
                             {"ebike36v", &CONFIG_EBIKE36V},
                             {"scooter48v", &CONFIG_SCOOTER48V},
                             {"ipm400v", &CONFIG_IPM400V},
                             {"wheel24v", &CONFIG_WHEEL24V}};

const char *configuration_name(int index)
{
    return SHIPPED[index].name;
}

const config_t *configuration_shipped(int index)
{
    return SHIPPED[index].config;
}

/* A field becomes a number from low to high, or that many thousandths of what it is. */
typedef enum { ABSOLUTE, PER_MILLE } variation_kind_t;

typedef struct {
    size_t offset_bytes;
    variation_kind_t kind;
    int32_t low, high;
} variation_t;

#define VARY(field, kind, low, high)                                                               \
    {                                                                                              \
        offsetof(config_t, field), kind, low, high                                                 \
    }

/* Times and heat capacities become short, so that runs of a second get to their ends. */
static const variation_t VARIATIONS[] = {
    VARY(motor.max_torque_mNm, PER_MILLE, 500, 1200),
    VARY(motor.max_power_mW, PER_MILLE, 200, 1200),
    VARY(motor.max_phase_current_mA, PER_MILLE, 500, 1050),
    VARY(motor.max_speed_mrad_s, PER_MILLE, 500, 1100),
    VARY(motor.speed_fade_share_q15, ABSOLUTE, 0, 16384),
    VARY(motor.derate_winding_temperature_cC, PER_MILLE, 500, 1000),
    VARY(motor.friction_torque_mNm, PER_MILLE, 0, 3000),
    VARY(motor.flux_coefficient_ppm_K, ABSOLUTE, -2000, 0),
    VARY(motor.iron_loss_resistance_mOhm, PER_MILLE, 300, 3000),
    VARY(drive.derate_switch_temperature_cC, PER_MILLE, 500, 1000),
    VARY(drive.bus_capacitance_nF, PER_MILLE, 0, 2000),
    VARY(drive.diode_drop_mV, ABSOLUTE, 0, 1500),
    VARY(drive.loss_resistance_uOhm, PER_MILLE, 0, 3000),
    VARY(current_loop.modulation_reserve_pu_q15, ABSOLUTE, 0, 3276),
    VARY(current_loop.field_weakening_gain_pu_q15, ABSOLUTE, 0, 1000),
    VARY(current_loop.field_weakening_current_pu_q15, PER_MILLE, 0, 1200),
    VARY(current_loop.dead_time_zone_pu_q15, PER_MILLE, 300, 3000),
    VARY(rotor.sensor, ABSOLUTE, 0, 2),
    VARY(rotor.encoder_counts, ABSOLUTE, 4096, 65536),
    VARY(rotor.encoder_reversed, ABSOLUTE, 0, 1),
    VARY(rotor.observer_speed_mrad_s, PER_MILLE, 300, 3000),
    VARY(rotor.observer_takeover, ABSOLUTE, 0, 1),
    VARY(battery.driven_wheels, ABSOLUTE, 1, 4),
    VARY(battery.driven_wheels, ABSOLUTE, 1, 1),
    VARY(battery.max_charge_current_mA, PER_MILLE, 0, 1500),
    VARY(battery.max_discharge_current_mA, PER_MILLE, 200, 1500),
    VARY(battery.foldback_voltage_mV, PER_MILLE, 900, 1050),
    VARY(battery.discharge_foldback_voltage_mV, PER_MILLE, 950, 1100),
    VARY(battery.resistance_uOhm, PER_MILLE, 0, 4000),
    VARY(brake.strategy, ABSOLUTE, 0, 2),
    VARY(brake.strategy, ABSOLUTE, 0, 1),
    VARY(brake.parallel_electric_share_q15, ABSOLUTE, 0, 32767),
    VARY(brake.electric_rated_torque_mNm, PER_MILLE, 100, 1500),
    VARY(brake.max_hydraulic_torque_mNm, PER_MILLE, 0, 1000),
    VARY(brake.hydraulic_dead_time_ms, ABSOLUTE, 0, 250),
    VARY(brake.hydraulic_time_constant_ms, ABSOLUTE, 0, 300),
    VARY(brake.hydraulic_rate_mNm_s, PER_MILLE, 100, 3000),
    VARY(brake.hydraulic_timeout_ms, ABSOLUTE, 0, 200),
    VARY(brake.hydraulic_report_delay_ms, ABSOLUTE, 0, 40),
    VARY(brake.hydraulic_gain_band_q15, ABSOLUTE, 0, 16384),
    VARY(brake.hydraulic_tolerance_mNm, PER_MILLE, 300, 3000),
    VARY(brake.bridging_time_ms, ABSOLUTE, 0, 1000),
    VARY(brake.loss_braking, ABSOLUTE, 0, 1),
    VARY(brake.blend_out_start_mrad_s, PER_MILLE, 500, 3000),
    VARY(brake.blend_out_end_mrad_s, PER_MILLE, 300, 1000),
    VARY(brake.torque_rate_mNm_s, PER_MILLE, 100, 3000),
    VARY(brake.shortfall_band_mNm, PER_MILLE, 100, 2000),
    VARY(brake.demand_timeout_ms, ABSOLUTE, 5, 150),
    VARY(brake.motor_arrival_ms, ABSOLUTE, 1, 200),
    VARY(brake.abs_hold_ms, ABSOLUTE, 0, 300),
    VARY(brake.torque_growth_end_q15, ABSOLUTE, 28000, 32767),
    VARY(brake.stop_lamp_on_mm_s2, ABSOLUTE, 100, 2000),
    VARY(brake.stop_lamp_off_mm_s2, ABSOLUTE, 0, 1000),
    VARY(brake.stop_lamp_filter_log2, ABSOLUTE, 0, 8),
    VARY(driver.lost_hold_ms, ABSOLUTE, 0, 400),
    VARY(driver.no_other_brake, ABSOLUTE, 0, 1),
    VARY(driver.direction_change_mrad_s, PER_MILLE, 0, 3000),
    VARY(driver.hold_torque_mNm, ABSOLUTE, 0, 100000),
    VARY(driver.hold_release_ms, ABSOLUTE, 10, 500),
    VARY(modes.limp_drive_share_q15, ABSOLUTE, 0, 32767),
    VARY(modes.selftest_timeout_ms, ABSOLUTE, 10, 200),
    VARY(modes.coast_delay_ms, ABSOLUTE, 0, 200),
    VARY(modes.offset_wait_ms, ABSOLUTE, 10, 100),
    VARY(monitor.torque_tolerance_mNm, PER_MILLE, 300, 2000),
    VARY(monitor.torque_fault_time_ms, ABSOLUTE, 1, 60),
    VARY(monitor.sensor_fault_time_ms, ABSOLUTE, 1, 40),
    VARY(monitor.voltage_fault_time_ms, ABSOLUTE, 1, 30),
    VARY(monitor.rotor_fault_time_ms, ABSOLUTE, 1, 100),
    VARY(monitor.angle_fault_time_ms, ABSOLUTE, 8, 40),
    VARY(monitor.rotor_warning_time_ms, ABSOLUTE, 1, 400),
    VARY(monitor.battery_message_time_ms, ABSOLUTE, 5, 150),
    VARY(monitor.diode_fault_time_ms, ABSOLUTE, 1, 40),
    VARY(monitor.overtemperature_margin_cC, ABSOLUTE, 0, 1000),
    VARY(monitor.tyre_grip_mm_s2, PER_MILLE, 300, 1500),
    VARY(monitor.coasting_mm_s2, ABSOLUTE, 1, 2000),
    VARY(monitor.standstill_mrad_s, PER_MILLE, 200, 5000),
    VARY(monitor.short_release_permille, ABSOLUTE, 500, 999),
    VARY(monitor.flux_tolerance_permille, ABSOLUTE, 50, 300),
    VARY(monitor.coldest_ambient_cC, ABSOLUTE, -5000, 2000),
    VARY(thermal.winding_heat_capacity_mJ_K, PER_MILLE, 1, 100),
    VARY(thermal.winding_thermal_resistance_mK_W, PER_MILLE, 0, 2000),
    VARY(thermal.housing_heat_capacity_mJ_K, PER_MILLE, 0, 100),
    VARY(thermal.switch_heat_capacity_mJ_K, PER_MILLE, 1, 100),
    VARY(thermal.heatsink_heat_capacity_mJ_K, PER_MILLE, 0, 100),
};
enum { VARIATIONS_COUNT = sizeof VARIATIONS / sizeof VARIATIONS[0] };

bool configuration_is_accepted(config_t *config)
{
    config->crc32 = config_crc32(config, (uint32_t)offsetof(config_t, crc32));
    return config_validate(config, (uint32_t)sizeof *config).code == CONFIG_RESULT_OK;
}

void configuration_vary(config_t *config, random_t *random, int most)
{
    const int32_t changes = random_between(random, 0, most);
    for (int32_t k = 0; k < changes; k++) {
        const variation_t *variation = &VARIATIONS[random_between(random, 0, VARIATIONS_COUNT - 1)];
        const int32_t drawn = random_between(random, variation->low, variation->high);
        void *place = (char *)config + variation->offset_bytes;
        int32_t *field = place;
        const int32_t before = *field;
        const int64_t scaled = (int64_t)before * drawn / 1000;
        *field = variation->kind == ABSOLUTE ? drawn
                 : scaled <= INT32_MAX       ? (int32_t)scaled
                                             : INT32_MAX;
        if (!configuration_is_accepted(config)) {
            *field = before;
        }
    }
    (void)configuration_is_accepted(config); /* leaves the checksum of what is in force */
}
