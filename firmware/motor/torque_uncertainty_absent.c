/* SPDX-License-Identifier: Apache-2.0 */
/* A port that does not say how uncertain its estimate is. */
#include "motor/torque_uncertainty.h"

int32_t torque_uncertainty_mNm(const motor_model_t *model, motor_point_t at)
{
    (void)model;
    (void)at;
    return INT32_MAX;
}
