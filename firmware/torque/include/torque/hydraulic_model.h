/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hydraulic_model.h: what a hydraulic brake of gain one makes of its commands. 1 kHz.
 *
 *     command -> dead time -> first-order lag, no faster than a rate in either direction
 *
 * with brake.hydraulic_dead_time_ms, hydraulic_time_constant_ms and hydraulic_rate_mNm_s. Two more
 * models have half and twice the dead time and lag, as a report shows them that comes
 * brake.hydraulic_report_delay later: what is reported of a brake whose lateness is known within
 * these factors lies between them. Pads, temperature and air in the fluid are not modelled.
 */
#ifndef TORQUE_HYDRAULIC_MODEL_H
#define TORQUE_HYDRAULIC_MODEL_H

#include <stdint.h>

#include "config/config.h"

enum {
    HYDRAULIC_MODEL_DEAD_TIME_MOST_ms = 250,
    HYDRAULIC_MODEL_REPORT_DELAY_MOST_ms = 40,
    HYDRAULIC_MODEL_BETWEEN_MOST_ms = 63,
    HYDRAULIC_MODEL_COMMANDS =
        2 * HYDRAULIC_MODEL_DEAD_TIME_MOST_ms + HYDRAULIC_MODEL_REPORT_DELAY_MOST_ms + 1
};

/* Ends of some commands. */
typedef struct {
    int32_t least_mNm, most_mNm;
} hydraulic_range_t;

typedef struct {
    int32_t commands_mNm[HYDRAULIC_MODEL_COMMANDS]; /* of the last milliseconds */
    int32_t next;
    /* Six more bits: the lag's last step is below 1/64 of it. */
    int32_t torque_q6_mNm, early_q6_mNm, late_q6_mNm;
    hydraulic_range_t recent, before; /* of two times after each other */
    int32_t recent_ms;
} hydraulic_model_t;

void hydraulic_model_init(hydraulic_model_t *model);

/* One millisecond with a command; it is clamped to 0 .. brake.max_hydraulic_torque_mNm. */
void hydraulic_model_step(hydraulic_model_t *model, const config_t *config, int32_t command_mNm);

/* Of all commands that may move the reports of the last HYDRAULIC_MODEL_BETWEEN_MOST_ms: of a brake
 * up to twice as late, up to twice the time in all. */
hydraulic_range_t hydraulic_model_commanded(const hydraulic_model_t *model);

/* Present torque, magnitude. */
static inline int32_t hydraulic_model_torque_mNm(const hydraulic_model_t *model)
{
    return model->torque_q6_mNm / 64;
}

/* Reported of a brake twice as early, and of one twice as late. */
static inline int32_t hydraulic_model_early_mNm(const hydraulic_model_t *model)
{
    return model->early_q6_mNm / 64;
}

static inline int32_t hydraulic_model_late_mNm(const hydraulic_model_t *model)
{
    return model->late_q6_mNm / 64;
}

#endif
