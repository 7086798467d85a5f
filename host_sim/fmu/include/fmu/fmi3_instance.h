/* SPDX-License-Identifier: Apache-2.0 */
/* fmi3_instance.h: what fmi3.c and fmi3_absent.c share. */
#ifndef FMU_FMI3_INSTANCE_H
#define FMU_FMI3_INSTANCE_H

#include "fmi3FunctionTypes.h"

fmi3Status fmi3_refuse(fmi3Instance instance, const char *what);

#endif
