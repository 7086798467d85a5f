/* SPDX-License-Identifier: Apache-2.0 */
/*
 * winding.h: the winding as current controller and EMF observer count it at one pair of currents,
 * per unit. Slow loop, 1 kHz. DERIVATIONS.md, Tuning.
 */
#ifndef CONTROLLER_WINDING_H
#define CONTROLLER_WINDING_H

#include "config/config.h"
#include "controller/operating_point.h"

/* Of a motor whose inductances are constant. Divides. */
winding_t winding_constants(const config_t *config);

#endif
