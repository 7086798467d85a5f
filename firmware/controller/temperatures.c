/* SPDX-License-Identifier: Apache-2.0 */
#include "controller/temperatures.h"

#include "core/q15.h"

void temperatures_init(temperatures_t *state, const config_t *config)
{
    thermal_model_init(&state->model, config);
    state->kept_cC = TEMPERATURE_NONE_cC;
    state->winding_offset_q16 = 0;
    state->switch_offset_q16 = 0;
}

/* What is known of one temperature. */
typedef struct {
    int32_t shown_cC;
    bool expected; /* a sensor is fitted, and its limit is on */
    bool shows;    /* a sensor is fitted, and its reading lies within its range */
} sensor_t;

static sensor_t sensor_of(const config_t *config, bool fitted, int32_t limit_cC, int32_t shown_cC)
{
    const config_monitor_t *monitor = &config->monitor;
    const bool inside =
        shown_cC <= monitor->highest_temperature_cC && shown_cC >= monitor->lowest_temperature_cC;
    const sensor_t out = {.shown_cC = shown_cC,
                          .expected = fitted && limit_cC < CONFIG_TEMPERATURE_OFF_cC,
                          .shows = fitted && inside};
    return out;
}

/* The model's temperature, corrected by what the sensor shows. */
static int32_t modelled_cC(int32_t *offset_q16, const thermal_lumps_t *row, const sensor_t *sensor)
{
    const int32_t model_cC = thermal_model_inner_cC(row);
    if (sensor->shows) {
        const int32_t apart_cC =
            q_clamp(sensor->shown_cC - model_cC, TEMPERATURES_COLDER_cC, TEMPERATURES_HOTTER_cC);
        *offset_q16 += (apart_cC * (1 << 16) - *offset_q16) >> TEMPERATURES_OFFSET_LOG2;
    }
    return model_cC + (*offset_q16 >> 16);
}

/* The hotter of sensor and model. */
static int32_t hotter_cC(int32_t *offset_q16, const thermal_lumps_t *row, const sensor_t *sensor,
                         int32_t unknown_cC)
{
    if (row->known) {
        const int32_t model_cC = modelled_cC(offset_q16, row, sensor);
        return sensor->shows ? q_max(sensor->shown_cC, model_cC) : model_cC;
    }
    return sensor->shows      ? sensor->shown_cC
           : sensor->expected ? TEMPERATURES_BROKEN_cC
                              : unknown_cC;
}

/* By which braking torque may be taken away: a sensor, or what is left without one and model. */
static int32_t sensed_cC(const thermal_lumps_t *row, const sensor_t *sensor, int32_t used_cC)
{
    const int32_t without_cC = row->known ? TEMPERATURE_NONE_cC : used_cC;
    return sensor->shows ? sensor->shown_cC : without_cC;
}

static void start(temperatures_t *state, const config_t *config, const sensor_t *winding,
                  const sensor_t *switches)
{
    const int32_t by_winding_cC = winding->shows ? winding->shown_cC : TEMPERATURE_NONE_cC;
    const int32_t by_switches_cC = switches->shows ? switches->shown_cC : TEMPERATURE_NONE_cC;
    const int32_t unknown_cC = winding->shows || switches->shows
                                   ? TEMPERATURE_NONE_cC
                                   : config->monitor.warmest_ambient_cC;
    thermal_model_start(
        &state->model, config,
        q_max(q_max(by_winding_cC, by_switches_cC), q_max(state->kept_cC, unknown_cC)));
}

/* That of resistance and magnets: the sensor's, else the model's, else as it was. It changes no
 * faster than a winding can while there is PWM: the current controllers would have to follow a
 * broken wire's step of the magnets. */
static int32_t of_parameters_cC(const thermal_lumps_t *row, const sensor_t *sensor,
                                int32_t hotter_cC, int32_t last_cC, bool follows)
{
    const bool lost = sensor->expected && !sensor->shows && !row->known;
    const int32_t now_cC = sensor->shows ? sensor->shown_cC : lost ? last_cC : hotter_cC;
    return follows ? now_cC : last_cC + q_limit(now_cC - last_cC, TEMPERATURES_STEP_cC);
}

/* What flows where that share of it is not shown. */
static int32_t flowing_mA(int32_t shown_mA, int32_t missing_q15)
{
    return missing_q15 > 0 ? q_scale(shown_mA, 1 << 15, (1 << 15) - missing_q15) : shown_mA;
}

void temperatures_step(temperatures_t *state, const config_t *config, const last_t *last,
                       measured_t *now, findings_t *findings)
{
    const wheel_temperatures_t *const shown = &now->in->temperature;
    thermal_model_state_t *const model = &state->model;
    const sensor_t winding = sensor_of(config, config->monitor.winding_sensor_fitted != 0,
                                       config->motor.max_winding_temperature_cC, shown->winding_cC);
    const sensor_t switches = sensor_of(config, config->monitor.switch_sensor_fitted != 0,
                                        config->drive.max_switch_temperature_cC, shown->switch_cC);
    const bool follows = !model->started || !measured_switching(now);
    if (!model->started) {
        start(state, config, &winding, &switches);
    }
    const int32_t unknown_cC = config->motor.reference_temperature_cC;
    const int32_t hotter =
        hotter_cC(&state->winding_offset_q16, &model->winding, &winding, unknown_cC);
    now->winding_temperature_cC =
        of_parameters_cC(&model->winding, &winding, hotter, last->temperature.winding_cC, follows);
    now->winding_hotter_cC = hotter - now->winding_temperature_cC;
    now->switch_temperature_cC =
        hotter_cC(&state->switch_offset_q16, &model->switches, &switches, unknown_cC);
    now->sensed.winding_cC = sensed_cC(&model->winding, &winding, hotter);
    now->sensed.switch_cC = sensed_cC(&model->switches, &switches, now->switch_temperature_cC);
    now->winding_lasting_mA = model->winding_lasting_mA;
    now->switch_lasting_mA = model->switch_lasting_mA;
    findings_set(findings, FINDING_WINDING_THERMISTOR, winding.expected && !winding.shows);
    findings_set(findings, FINDING_SWITCH_THERMISTOR, switches.expected && !switches.shows);
    thermal_model_step(model, config, flowing_mA(now->i_d_mA, last->current_missing_q15),
                       flowing_mA(now->i_q_mA, last->current_missing_q15), now->speed_mrad_s);
}
