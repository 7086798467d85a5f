/* SPDX-License-Identifier: Apache-2.0 */
/* The part of the library's interface that needs no vehicle: what can be set, and words for codes.
 */
#include <stdbool.h>
#include <stddef.h>

#include "bench/engine.h"
#include "bench/parameters.h"
#include "core/operating_mode.h"
#include "core/reason.h"

int hubsim_parameter_count(void)
{
    return parameters_count();
}

static bool is_parameter(int index)
{
    return index >= 0 && index < parameters_count();
}

const char *hubsim_parameter_name(int index)
{
    return is_parameter(index) ? parameters_info(index).name : NULL;
}

const char *hubsim_parameter_unit(int index)
{
    return is_parameter(index) ? parameters_info(index).unit : NULL;
}

const char *hubsim_parameter_text(int index)
{
    return is_parameter(index) ? parameters_info(index).text : NULL;
}

double hubsim_parameter_lowest(int index)
{
    return is_parameter(index) ? parameters_info(index).lowest : 0.0;
}

double hubsim_parameter_highest(int index)
{
    return is_parameter(index) ? parameters_info(index).highest : 0.0;
}

const char *hubsim_mode_text(int mode)
{
    return operating_mode_text((operating_mode_t)mode);
}

const char *hubsim_reason_text(int reason)
{
    return reason_text((reason_t)reason);
}
