/* SPDX-License-Identifier: Apache-2.0 */
/* can_places.h: which of a controller's three places for frames to be sent holds which one, and
 * which of them the next frame gets. */
#ifndef STM32_CAN_PLACES_H
#define STM32_CAN_PLACES_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/can.h"

enum { CAN_PLACES = 3 };

typedef struct {
    uint32_t identifier[CAN_PLACES]; /* as in can_frame_t: of 29 bits higher than any of 11 */
    bool taken[CAN_PLACES];          /* until its frame's end has been asked for */
} can_places_t;

/* The place of the frame with this identifier; CAN_PLACES: there is none. */
static inline uint32_t can_places_of(const can_places_t *places, uint32_t identifier)
{
    uint32_t i = 0;
    while (i < CAN_PLACES && !(places->taken[i] && places->identifier[i] == identifier)) {
        i++;
    }
    return i;
}

static inline bool can_places_are_free(const can_places_t *places)
{
    return !places->taken[0] && !places->taken[1] && !places->taken[2];
}

/* The place for a frame: that of its own identifier, a free one, or that of the highest identifier,
 * if that is higher; CAN_PLACES: none. If it is taken its frame has to be given up before. One with
 * a 29-bit identifier has no other place but its own while any is taken (hal/can.h). */
static inline uint32_t can_places_for(const can_places_t *places, uint32_t identifier)
{
    const uint32_t own = can_places_of(places, identifier);
    uint32_t highest = CAN_PLACES;
    if (own < CAN_PLACES || (identifier >= CAN_EXTENDED && !can_places_are_free(places))) {
        return own;
    }
    for (uint32_t i = 0; i < CAN_PLACES; i++) {
        if (!places->taken[i]) {
            return i;
        }
        const uint32_t least = highest < CAN_PLACES ? places->identifier[highest] : identifier;
        highest = places->identifier[i] > least ? i : highest;
    }
    return highest;
}

static inline void can_places_take(can_places_t *places, uint32_t place, uint32_t identifier)
{
    places->identifier[place] = identifier;
    places->taken[place] = true;
}

#endif
