/* SPDX-License-Identifier: Apache-2.0 */
#include "exchange/variables.h"

#include <math.h>

enum { CODE_MID = 2048, CODES = 4096, TURN_STEPS = 65536 };

#define LINE(label, member, kind, conversion, lowest, highest, what, meaning)                      \
    {.name = #label,                                                                               \
     .raw_name = #member,                                                                          \
     .unit = (what),                                                                               \
     .text = (meaning),                                                                            \
     .type = EXCHANGE_##kind,                                                                      \
     .scale = EXCHANGE_##conversion,                                                               \
     .lowest_raw = (lowest),                                                                       \
     .highest_raw = (highest)},
static const variable_info_t FAST_INPUTS[] = {EXCHANGE_FAST_INPUTS(LINE)};
static const variable_info_t FAST_OUTPUTS[] = {EXCHANGE_FAST_OUTPUTS(LINE)};
static const variable_info_t SLOW_INPUTS[] = {EXCHANGE_SLOW_INPUTS(LINE)};
static const variable_info_t SLOW_OUTPUTS[] = {EXCHANGE_SLOW_OUTPUTS(LINE)};

int variables_count(exchange_port_t port)
{
    switch (port) {
    case EXCHANGE_PORT_FAST_INPUT:
        return EXCHANGE_FAST_INPUT_COUNT;
    case EXCHANGE_PORT_FAST_OUTPUT:
        return EXCHANGE_FAST_OUTPUT_COUNT;
    case EXCHANGE_PORT_SLOW_INPUT:
        return EXCHANGE_SLOW_INPUT_COUNT;
    case EXCHANGE_PORT_SLOW_OUTPUT:
        return EXCHANGE_SLOW_OUTPUT_COUNT;
    }
    return 0;
}

variable_info_t variables_info(exchange_port_t port, int index)
{
    static const variable_info_t *const LISTS[EXCHANGE_PORTS] = {FAST_INPUTS, FAST_OUTPUTS,
                                                                 SLOW_INPUTS, SLOW_OUTPUTS};
    return LISTS[port][index];
}

variables_affine_t variables_affine(exchange_scale_t scale, const config_t *config)
{
    variables_affine_t out = {.zero = 0.0, .per_unit = 1.0};
    switch (scale) {
    case EXCHANGE_PLAIN:
        break;
    case EXCHANGE_MILLI:
        out.per_unit = 1000.0;
        break;
    case EXCHANGE_CENTI:
        out.per_unit = 100.0;
        break;
    case EXCHANGE_TURN:
        out.per_unit = TURN_STEPS;
        break;
    case EXCHANGE_CURRENT_CODE:
        out.zero = CODE_MID;
        out.per_unit = CODE_MID * 1000.0 / config->drive.current_full_scale_mA;
        break;
    case EXCHANGE_VOLTAGE_CODE:
        out.per_unit = CODES * 1000.0 / config->drive.voltage_full_scale_mV;
        break;
    case EXCHANGE_DUTY:
        out.per_unit = config->drive.pwm_period_counts;
        break;
    }
    return out;
}

int32_t variables_to_raw(const variable_info_t *info, variables_affine_t affine, double value)
{
    if (info->scale == EXCHANGE_TURN) {
        return (int32_t)floor((value - floor(value)) * TURN_STEPS + 0.5) % TURN_STEPS;
    }
    const double raw = floor(affine.zero + value * affine.per_unit + 0.5);
    if (!(raw > info->lowest_raw)) {
        return info->lowest_raw;
    }
    return raw < info->highest_raw ? (int32_t)raw : info->highest_raw;
}

double variables_from_raw(variables_affine_t affine, int32_t raw)
{
    return (raw - affine.zero) / affine.per_unit;
}
