/* SPDX-License-Identifier: Apache-2.0 */
#include "exchange/variables.h"
#include "config/bases.h"

#include <math.h>
#include <string.h>

enum { CODE_MID = 2048, CODES = 4096, ONE_Q15 = 32768, TURN_STEPS = 65536 };

#define LINE(message, label, raw, where, kind, conversion, lowest, highest, start, what, meaning)  \
    {.name = #label,                                                                               \
     .raw_name = #raw,                                                                             \
     .unit = (what),                                                                               \
     .text = (meaning),                                                                            \
     .type = EXCHANGE_##kind,                                                                      \
     .scale = EXCHANGE_##conversion,                                                               \
     .lowest_raw = (lowest),                                                                       \
     .highest_raw = (highest),                                                                     \
     .start_raw = (start),                                                                         \
     .member = #where,                                                                             \
     .offset = offsetof(message, where),                                                           \
     .bytes = sizeof(((message *)NULL)->where)},
#define FAST_INPUT_LINE(...) LINE(fast_input_t, __VA_ARGS__)
#define FAST_OUTPUT_LINE(...) LINE(fast_output_t, __VA_ARGS__)
#define FAST_VIEW_LINE(...) LINE(fast_view_t, __VA_ARGS__)
#define SLOW_INPUT_LINE(...) LINE(slow_input_t, __VA_ARGS__)
#define SLOW_OUTPUT_LINE(...) LINE(slow_output_t, __VA_ARGS__)
static const variable_info_t FAST_INPUTS[] = {SIGNALS_FAST_INPUTS(FAST_INPUT_LINE)};
static const variable_info_t FAST_OUTPUTS[] = {SIGNALS_FAST_OUTPUTS(FAST_OUTPUT_LINE)};
static const variable_info_t FAST_VIEW[] = {SIGNALS_FAST_VIEW(FAST_VIEW_LINE)};
static const variable_info_t SLOW_INPUTS[] = {SIGNALS_SLOW_INPUTS(SLOW_INPUT_LINE)};
static const variable_info_t SLOW_OUTPUTS[] = {SIGNALS_SLOW_OUTPUTS(SLOW_OUTPUT_LINE)};

_Static_assert((int)SIGNALS_FAST_INPUT_COUNT <= (int)EXCHANGE_PORT_MAX &&
                   (int)SIGNALS_FAST_OUTPUT_COUNT <= (int)EXCHANGE_PORT_MAX &&
                   (int)SIGNALS_FAST_VIEW_COUNT <= (int)EXCHANGE_PORT_MAX &&
                   (int)SIGNALS_SLOW_INPUT_COUNT <= (int)EXCHANGE_PORT_MAX &&
                   (int)SIGNALS_SLOW_OUTPUT_COUNT <= (int)EXCHANGE_PORT_MAX,
               "arrays of a port are too short");

int variables_count(exchange_port_t port)
{
    switch (port) {
    case EXCHANGE_PORT_FAST_INPUT:
        return SIGNALS_FAST_INPUT_COUNT;
    case EXCHANGE_PORT_FAST_OUTPUT:
        return SIGNALS_FAST_OUTPUT_COUNT;
    case EXCHANGE_PORT_SLOW_INPUT:
        return SIGNALS_SLOW_INPUT_COUNT;
    case EXCHANGE_PORT_SLOW_OUTPUT:
        return SIGNALS_SLOW_OUTPUT_COUNT;
    case EXCHANGE_PORT_FAST_VIEW:
        return SIGNALS_FAST_VIEW_COUNT;
    }
    return 0;
}

variable_info_t variables_info(exchange_port_t port, int index)
{
    static const variable_info_t *const LISTS[EXCHANGE_PORTS] = {
        FAST_INPUTS, FAST_OUTPUTS, SLOW_INPUTS, SLOW_OUTPUTS, FAST_VIEW};
    return LISTS[port][index];
}

/* Members of one and two bytes are unsigned or bool, those of four bytes int32_t, uint32_t or an
 * enumeration, whose values all fit int32_t. */
static void store(unsigned char *at, size_t bytes, int32_t value)
{
    const uint8_t one = (uint8_t)value;
    const uint16_t two = (uint16_t)value;
    if (bytes == sizeof(one)) {
        memcpy(at, &one, sizeof(one));
    } else if (bytes == sizeof(two)) {
        memcpy(at, &two, sizeof(two));
    } else {
        memcpy(at, &value, sizeof(value));
    }
}

static int32_t load(const unsigned char *at, size_t bytes)
{
    uint16_t two;
    int32_t four;
    if (bytes == 1) {
        return *at;
    }
    if (bytes == sizeof(two)) {
        memcpy(&two, at, sizeof(two));
        return two;
    }
    memcpy(&four, at, sizeof(four));
    return four;
}

void variables_to_message(exchange_port_t port, const int32_t *raw, void *message)
{
    for (int k = 0; k < variables_count(port); k++) {
        const variable_info_t info = variables_info(port, k);
        store((unsigned char *)message + info.offset, info.bytes, raw[k]);
    }
}

void variables_from_message(exchange_port_t port, const void *message, int32_t *raw)
{
    for (int k = 0; k < variables_count(port); k++) {
        const variable_info_t info = variables_info(port, k);
        raw[k] = load((const unsigned char *)message + info.offset, info.bytes);
    }
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
    case EXCHANGE_CURRENT_PU:
        out.per_unit = ONE_Q15 * 1000.0 / config->drive.current_full_scale_mA;
        break;
    case EXCHANGE_SHARE:
        out.per_unit = ONE_Q15;
        break;
    case EXCHANGE_DUTY:
        out.per_unit = bases_pwm_period_counts(config, BASES_MODEL_TIMER_Hz);
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
