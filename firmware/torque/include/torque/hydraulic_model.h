/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_model.h: estimate of the hydraulic brake torque from its commands. 1 kHz.
 *
 *     command -> dead time -> first-order lag, no faster than a rate in either direction
 *
 * with brake.hydraulic_dead_time_ms, hydraulic_time_constant_ms and hydraulic_rate_mNm_s. The
 * brake torque is not measured, and the model contains neither the pads nor temperature nor air in
 * the fluid. Users of the estimate must tolerate an error of +-30 %.
 */
#ifndef TORQUE_HYDRAULIC_MODEL_H
#define TORQUE_HYDRAULIC_MODEL_H

#include <stdint.h>

#include "config/config.h"

enum { HYDRAULIC_MODEL_DEAD_TIME_MOST_ms = 250 };

typedef struct {
    int32_t commands_mNm[HYDRAULIC_MODEL_DEAD_TIME_MOST_ms + 1]; /* within the dead time */
    int32_t next;
    int32_t torque_q6_mNm; /* six more bits: the lag's last step is below 1/64 of it */
} hydraulic_model_t;

void hydraulic_model_init(hydraulic_model_t *model);

/* One millisecond with a command, 0 .. brake.max_hydraulic_torque_mNm. */
void hydraulic_model_step(hydraulic_model_t *model, const config_t *config, int32_t command_mNm);

/* Present torque, magnitude. */
static inline int32_t hydraulic_model_torque_mNm(const hydraulic_model_t *model)
{
    return model->torque_q6_mNm / 64;
}

#endif
