/* SPDX-License-Identifier: Apache-2.0 */
/*
 * temperatures.h: the temperatures that the controller uses: the hotter of what a sensor shows and
 * what the thermal model estimates from the losses. Slow loop, 1 kHz.
 *
 * A sensor at an end of its range is named and leaves the temperature to the model; one that lags
 * or reads low is not told from a cold motor, and need not be: the model is hotter then. A good
 * sensor corrects the model slowly and by little, so that it takes over without a step.
 * motor/DERIVATIONS.md, Thermal model.
 */
#ifndef CONTROLLER_TEMPERATURES_H
#define CONTROLLER_TEMPERATURES_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "core/findings.h"
#include "core/last.h"
#include "core/measured.h"
#include "core/slow_messages.h"
#include "motor/thermal_model.h"

enum {
    /* Of a broken sensor without a model: no torque. As hal/analog.h reports. */
    TEMPERATURES_BROKEN_cC = 29999,
    /* By how much a sensor corrects the model, over 2^14 ms. */
    TEMPERATURES_COLDER_cC = -500,
    TEMPERATURES_HOTTER_cC = 2000,
    TEMPERATURES_OFFSET_LOG2 = 14,
    /* A millisecond: 20 K/s, faster than any winding heats. */
    TEMPERATURES_STEP_cC = 2
};

typedef struct {
    thermal_model_state_t model;
    int32_t kept_cC; /* warmest estimate before a reset, TEMPERATURE_NONE_cC: not known */
    int32_t winding_offset_q16, switch_offset_q16; /* sensor less model, cC */
} temperatures_t;

/* Divides; once at start. */
void temperatures_init(temperatures_t *state, const config_t *config);

/* Writes the temperatures of now and sets the findings of the sensors; now has this millisecond's
 * currents, speed, report and input already, of which the temperatures are -1000 .. 1000 degC.
 * last: winding temperature, -347 .. 347 degC, and share of the current that heats unseen,
 * 0 .. 16 384. The first step starts the model with the warmest of both sensors and state->kept_cC.
 */
void temperatures_step(temperatures_t *state, const config_t *config, const last_t *last,
                       measured_t *now, findings_t *findings);

#endif
