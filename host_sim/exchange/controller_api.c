/* SPDX-License-Identifier: Apache-2.0 */
#include "exchange/controller_api.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "config/validate.h"
#include "exchange/controller_instance.h"
#include "exchange/variables.h"

enum { API_OK = 0, API_REFUSED = -1, ERROR_LENGTH = 300 };

struct hubsim_controller {
    bool has_config;
    controller_instance_t instance;
    char error[ERROR_LENGTH];
};

static bool is_variable(int port, int index)
{
    return port >= 0 && port < EXCHANGE_PORTS && index >= 0 &&
           index < variables_count((exchange_port_t)port);
}

int hubsim_variable_count(int port)
{
    return port >= 0 && port < EXCHANGE_PORTS ? variables_count((exchange_port_t)port) : 0;
}

const char *hubsim_variable_name(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).name : NULL;
}

const char *hubsim_variable_raw_name(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).raw_name : NULL;
}

const char *hubsim_variable_unit(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).unit : NULL;
}

const char *hubsim_variable_text(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).text : NULL;
}

int hubsim_variable_type(int port, int index)
{
    return is_variable(port, index) ? (int)variables_info((exchange_port_t)port, index).type : 0;
}

int32_t hubsim_variable_lowest_raw(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).lowest_raw : 0;
}

int32_t hubsim_variable_highest_raw(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).highest_raw : 0;
}

int32_t hubsim_variable_start_raw(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).start_raw : 0;
}

const char *hubsim_variable_member(int port, int index)
{
    return is_variable(port, index) ? variables_info((exchange_port_t)port, index).member : NULL;
}

hubsim_controller_t *hubsim_controller_new(void)
{
    return calloc(1, sizeof(hubsim_controller_t));
}

void hubsim_controller_delete(hubsim_controller_t *controller)
{
    free(controller);
}

const char *hubsim_controller_error(const hubsim_controller_t *controller)
{
    return controller->error;
}

static int refuse(hubsim_controller_t *controller, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(controller->error, sizeof(controller->error), format, arguments);
    va_end(arguments);
    return API_REFUSED;
}

int hubsim_controller_load_config(hubsim_controller_t *controller, const void *image,
                                  uint32_t size_bytes)
{
    config_t config;
    memset(&config, 0, sizeof(config));
    memcpy(&config, image, size_bytes < sizeof(config) ? size_bytes : sizeof(config));
    const config_result_t result = config_validate(&config, size_bytes);
    if (result.code == CONFIG_RESULT_RANGE) {
        return refuse(controller, "configuration refused: %s%s: %ld, accepted: %ld to %ld",
                      result.section, result.field, (long)result.value, (long)result.lowest,
                      (long)result.highest);
    }
    if (result.code != CONFIG_RESULT_OK) {
        return refuse(controller, "configuration refused: %s%s%s%s%s",
                      CONFIG_RESULT_TEXTS(&result));
    }
    controller_instance_init(&controller->instance, &config);
    controller->has_config = true;
    return API_OK;
}

int hubsim_controller_scale(const hubsim_controller_t *controller, int port, int index,
                            double *zero, double *per_unit)
{
    if (!controller->has_config || !is_variable(port, index)) {
        return API_REFUSED;
    }
    const variable_info_t info = variables_info((exchange_port_t)port, index);
    const variables_affine_t affine = variables_affine(info.scale, &controller->instance.config);
    *zero = affine.zero;
    *per_unit = affine.per_unit;
    return API_OK;
}

int32_t hubsim_controller_fast_rate_hz(const hubsim_controller_t *controller)
{
    return controller->has_config ? controller->instance.config.drive.pwm_frequency_Hz : 0;
}

static int check_raw(hubsim_controller_t *controller, exchange_port_t port, const int32_t *in)
{
    if (!controller->has_config) {
        return refuse(controller, "no configuration was loaded");
    }
    for (int k = 0; k < variables_count(port); k++) {
        const variable_info_t info = variables_info(port, k);
        if (in[k] < info.lowest_raw || in[k] > info.highest_raw) {
            return refuse(controller, "%s: %ld, accepted: %ld to %ld", info.raw_name, (long)in[k],
                          (long)info.lowest_raw, (long)info.highest_raw);
        }
    }
    return API_OK;
}

static int to_raw(hubsim_controller_t *controller, exchange_port_t port, const double *in,
                  int32_t *raw)
{
    if (!controller->has_config) {
        return refuse(controller, "no configuration was loaded");
    }
    for (int k = 0; k < variables_count(port); k++) {
        const variable_info_t info = variables_info(port, k);
        if (!isfinite(in[k])) {
            return refuse(controller, "%s: not a finite number", info.name);
        }
        raw[k] = variables_to_raw(&info, variables_affine(info.scale, &controller->instance.config),
                                  in[k]);
    }
    return API_OK;
}

static void from_raw(const hubsim_controller_t *controller, exchange_port_t port,
                     const int32_t *raw, double *out)
{
    for (int k = 0; k < variables_count(port); k++) {
        const exchange_scale_t scale = variables_info(port, k).scale;
        out[k] = variables_from_raw(variables_affine(scale, &controller->instance.config), raw[k]);
    }
}

int hubsim_controller_fast_step_raw(hubsim_controller_t *controller, const int32_t *in,
                                    int32_t *out)
{
    const int status = check_raw(controller, EXCHANGE_PORT_FAST_INPUT, in);
    if (status == API_OK) {
        controller_instance_fast_step(&controller->instance, in, out);
    }
    return status;
}

int hubsim_controller_slow_step_raw(hubsim_controller_t *controller, const int32_t *in,
                                    int32_t *out)
{
    const int status = check_raw(controller, EXCHANGE_PORT_SLOW_INPUT, in);
    if (status == API_OK) {
        controller_instance_slow_step(&controller->instance, in, out);
    }
    return status;
}

int hubsim_controller_fast_step(hubsim_controller_t *controller, const double *in, double *out)
{
    int32_t raw_in[EXCHANGE_PORT_MAX];
    int32_t raw_out[EXCHANGE_PORT_MAX];
    const int status = to_raw(controller, EXCHANGE_PORT_FAST_INPUT, in, raw_in);
    if (status == API_OK) {
        controller_instance_fast_step(&controller->instance, raw_in, raw_out);
        from_raw(controller, EXCHANGE_PORT_FAST_OUTPUT, raw_out, out);
    }
    return status;
}

int hubsim_controller_slow_step(hubsim_controller_t *controller, const double *in, double *out)
{
    int32_t raw_in[EXCHANGE_PORT_MAX];
    int32_t raw_out[EXCHANGE_PORT_MAX];
    const int status = to_raw(controller, EXCHANGE_PORT_SLOW_INPUT, in, raw_in);
    if (status == API_OK) {
        controller_instance_slow_step(&controller->instance, raw_in, raw_out);
        from_raw(controller, EXCHANGE_PORT_SLOW_OUTPUT, raw_out, out);
    }
    return status;
}

uint32_t hubsim_controller_state_bytes(void)
{
    return (uint32_t)sizeof(controller_instance_t);
}

int hubsim_controller_save(const hubsim_controller_t *controller, void *state)
{
    if (!controller->has_config) {
        return API_REFUSED;
    }
    memcpy(state, &controller->instance, sizeof(controller_instance_t));
    return API_OK;
}

int hubsim_controller_restore(hubsim_controller_t *controller, const void *state)
{
    controller_instance_t found;
    memcpy(&found, state, sizeof(found));
    if (config_validate(&found.config, (uint32_t)sizeof(found.config)).code != CONFIG_RESULT_OK) {
        return refuse(controller, "these bytes are no controller's state");
    }
    controller->instance = found;
    controller->has_config = true;
    return API_OK;
}
