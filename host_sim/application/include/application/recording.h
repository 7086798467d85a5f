/* SPDX-License-Identifier: Apache-2.0 */
/*
 * recording.h: what the controller's two steps are given in the application, and what they return.
 *
 * The calls of controller.h in the application go through functions of the same names here (the
 * linker's option --wrap), so firmware and board know nothing of it. Taken between two milliseconds
 * by whoever reads.
 */
#ifndef APPLICATION_RECORDING_H
#define APPLICATION_RECORDING_H

#include <stdbool.h>
#include <stdint.h>

#include "application/steps.h"
#include "config/config.h"

typedef struct {
    bool on;
    bool lost; /* a step found no memory */
    uint32_t count, capacity;
    hubsim_step_t *step; /* grows; whoever loaded the library frees it */
    config_t config;     /* of the latest boot */
} recording_t;

/* The one of this copy of the library. */
recording_t *recording(void);

#endif
