/* SPDX-License-Identifier: Apache-2.0 */
/* can_places.h: which of a controller's three places for frames to be sent holds which one, and
 * which of them the next frame gets. */
#ifndef STM32_CAN_PLACES_H
#define STM32_CAN_PLACES_H

#include <stdbool.h>
#include <stdint.h>

enum { CAN_PLACES = 3 };

typedef struct {
    uint16_t identifier[CAN_PLACES];
    bool taken[CAN_PLACES]; /* until its frame's end has been asked for */
} can_places_t;

/* The place of the frame with this identifier; CAN_PLACES: there is none. */
static inline uint32_t can_places_of(const can_places_t *places, uint16_t identifier)
{
    uint32_t i = 0;
    while (i < CAN_PLACES && !(places->taken[i] && places->identifier[i] == identifier)) {
        i++;
    }
    return i;
}

/* The place for a frame: that of its own identifier, a free one, or that of the highest identifier,
 * if that is higher; CAN_PLACES: none. If it is taken its frame has to be given up before. */
static inline uint32_t can_places_for(const can_places_t *places, uint16_t identifier)
{
    const uint32_t own = can_places_of(places, identifier);
    uint32_t highest = CAN_PLACES;
    if (own < CAN_PLACES) {
        return own;
    }
    for (uint32_t i = 0; i < CAN_PLACES; i++) {
        if (!places->taken[i]) {
            return i;
        }
        const uint16_t least = highest < CAN_PLACES ? places->identifier[highest] : identifier;
        highest = places->identifier[i] > least ? i : highest;
    }
    return highest;
}

static inline void can_places_take(can_places_t *places, uint32_t place, uint16_t identifier)
{
    places->identifier[place] = identifier;
    places->taken[place] = true;
}

#endif
