/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hall_doubt.h: the angle while the hall sensors contradict themselves (hall.h): dead reckoning,
 * corrected by the edges that fit, until a turn of edges in order.
 */
#ifndef FOC_HALL_DOUBT_H
#define FOC_HALL_DOUBT_H

#include "foc/hall.h"

/* The sensors contradict themselves from now on. */
void hall_begin_doubt(hall_t *hall);

/* A period in doubt; sector: what the sensors say, HALL_NO_SECTOR for a state that cannot be. True
 * when the doubt is over. */
bool hall_reckon(hall_t *hall, const config_t *config, uint8_t sector);

/* They are believed again. */
void hall_end_doubt(hall_t *hall);

#endif
