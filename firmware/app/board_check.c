/* SPDX-License-Identifier: Apache-2.0 */
#include "app/board_check.h"

#include <stdbool.h>

#include "hal/analog.h"
#include "hal/inverter.h"

/* Shunts and dividers have a tolerance, and a configuration may hold what was measured. */
enum { SCALE_TOLERANCE = 20 };

/* 5 K are a fifth of a divider's resistance; sensor and resistor are within a tenth. */
enum { DIVIDER_LEAST_cC = 2000, DIVIDER_MOST_cC = 3000 };

static bool scale_fits(const char *field, int32_t value, int32_t of_board, config_result_t *result)
{
    const int32_t tolerance = of_board / SCALE_TOLERANCE;
    if (of_board == 0 || (value >= of_board - tolerance && value <= of_board + tolerance)) {
        return true;
    }
    *result = config_result_range("", field, value, of_board - tolerance, of_board + tolerance);
    return false;
}

/* Below the least of the board both switches of a leg could conduct together. */
static bool dead_time_fits(const config_drive_t *drive, int32_t least_ns, config_result_t *result)
{
    if (drive->dead_time_ns >= least_ns) {
        return true;
    }
    *result = config_result_range("", "drive.dead_time_ns on this board", drive->dead_time_ns,
                                  least_ns, 125000000 / drive->pwm_frequency_Hz);
    return false;
}

/* drive.min_pulse_ns is half of the shortest low pulse, in whose middle the currents are sampled;
 * with current into the board it is shorter by half the dead time on either side. */
static bool window_fits(const config_drive_t *drive, int32_t least_ns, config_result_t *result)
{
    const int32_t half_ns = least_ns + drive->dead_time_ns / 2;
    if (least_ns == 0 || drive->min_pulse_ns >= half_ns) {
        return true;
    }
    *result = config_result_range("", "drive.min_pulse_ns on this board", drive->min_pulse_ns,
                                  half_ns, 100000000 / drive->pwm_frequency_Hz);
    return false;
}

/* The configured curve of the switches' sensor has to be that of the board's divider. */
static bool divider_fits(const config_temperature_t *sensors, int32_t code, config_result_t *result)
{
    const analog_curve_t curve = {.point_cC = sensors->switch_cC,
                                  .lowest_code = sensors->switch_lowest_code,
                                  .highest_code = sensors->switch_highest_code};
    if (code == 0 || curve.lowest_code > curve.highest_code) {
        return true;
    }
    const int32_t shown_cC = analog_curve_cC(&curve, code);
    if (shown_cC >= DIVIDER_LEAST_cC && shown_cC <= DIVIDER_MOST_cC) {
        return true;
    }
    *result = config_result_range("", "temperature.switch_cC of this board's divider at 25 degC",
                                  shown_cC, DIVIDER_LEAST_cC, DIVIDER_MOST_cC);
    return false;
}

config_result_t board_check_config(const config_t *config, uint32_t size_bytes)
{
    config_result_t result = config_validate(config, size_bytes);
    const analog_scale_t board = analog_scale();
    if (result.code == CONFIG_RESULT_OK &&
        scale_fits("drive.current_full_scale_mA on this board", config->drive.current_full_scale_mA,
                   board.current_full_scale_mA, &result) &&
        scale_fits("drive.voltage_full_scale_mV on this board", config->drive.voltage_full_scale_mV,
                   board.voltage_full_scale_mV, &result) &&
        divider_fits(&config->temperature, board.switch_25C_code, &result) &&
        dead_time_fits(&config->drive, (int32_t)inverter_dead_time_least_ns(), &result)) {
        (void)window_fits(&config->drive, board.low_side_least_ns, &result);
    }
    return result;
}
