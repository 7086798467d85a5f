/* SPDX-License-Identifier: Apache-2.0 */
/*
 * short_exit.h: whether the energy of an active short circuit's current fits into the bus when the
 * bridge opens. Slow loop, only while the bridge is shorted.
 *
 * The current of a short circuit that has just begun circles around the settled one once an
 * electrical turn, and the bridge opens up to 500 us after the sample (age of the report, slow
 * step, and period in which it acts): the largest energy in that time counts (DERIVATIONS.md, The
 * safe state). Nothing wraps for any input.
 */
#ifndef MONITOR_SHORT_EXIT_H
#define MONITOR_SHORT_EXIT_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

enum { SHORT_EXIT_POINTS = 4 /* of that time, after its beginning */ };

typedef struct {
    int32_t i_d_mA, i_q_mA; /* of the latest period, peak phase */
    int32_t turning_mrad_s; /* mechanical, forward positive; 0: the angle of the current in the
                               rotor's frame is unknown */
    int32_t bus_mV;         /* 0 .. 2 000 000 */
} short_exit_input_t;

/* True where 3/2 of 3/4 (L_d i_d^2 + L_q i_q^2) keep the bus a sixteenth below the devices' rating:
 * half as much as is stored comes from the EMF while the current falls. Of iron that saturates, a
 * drive with a flux map, twice that counts. With an unknown angle the larger inductance counts for
 * the whole present current. */
bool short_exit_fits(const config_t *config, const short_exit_input_t *in);

#endif
