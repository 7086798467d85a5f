/* SPDX-License-Identifier: Apache-2.0 */
/*
 * freewheel.h: what the bridge does with all switches open, whether that is chosen or not.
 */
#ifndef FREEWHEEL_H
#define FREEWHEEL_H

#include "monitor/safe_state.h"

static inline letting_go_t freewheel_of(const config_t *config, const safe_state_input_t *in)
{
    safe_state_input_t open = *in;
    open.bridge = BRIDGE_OFF;
    return safe_state_step(config, &open).freewheel;
}

#endif
