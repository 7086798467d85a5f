/* SPDX-License-Identifier: Apache-2.0 */
/*
 * winding.h: the winding as current controller and EMF observer count it around one pair of
 * currents, per unit. Slow loop, 1 kHz. DERIVATIONS.md, Winding.
 */
#ifndef CONTROLLER_WINDING_H
#define CONTROLLER_WINDING_H

#include <stdint.h>

#include "config/config.h"
#include "controller/operating_point.h"
#include "core/frames.h"
#include "core/scaled.h"

/* k_i/k_p, which does not depend on the bus voltage: Q24 over Q20 is Q4, times 2^24. */
static inline int32_t winding_anti_windup_q28(int32_t integral_pu_q24, int32_t proportional_pu_q16)
{
    return scaled_ratio(integral_pu_q24, proportional_pu_q16 * 16);
}

/* Of a motor whose inductances are constant. Divides. */
winding_t winding_constants(const config_t *config);

/* Sampled currents between which a setpoint moves, Q15 of the current base, 18 bits. */
typedef struct {
    dq_t from_pu, to_pu;
} winding_path_t;

/* Around the middle of a path, of a motor with a flux map: written to out, and returned. constants:
 * winding_constants(), which are returned where the port leaves maps out. Divides. */
const winding_t *winding_at(const config_t *config, const winding_t *constants, winding_path_t path,
                            int32_t winding_temperature_cC, winding_t *out);

#endif
