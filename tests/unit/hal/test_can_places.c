/* SPDX-License-Identifier: Apache-2.0 */
/* Which of three places a frame gets, against a set of frames without places. */
#include "can_places.h"

#include <string.h>

#include "unity.h"

static can_places_t places;

void setUp(void)
{
    memset(&places, 0, sizeof places);
}

void tearDown(void) {}

static uint32_t put(uint32_t identifier)
{
    const uint32_t place = can_places_for(&places, identifier);
    if (place < CAN_PLACES) {
        can_places_take(&places, place, identifier);
    }
    return place;
}

void test_three_frames_fill_the_places_and_the_least_urgent_gives_its_place(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, put(0x190));
    TEST_ASSERT_EQUAL_UINT32(1, put(0x198));
    TEST_ASSERT_EQUAL_UINT32(2, put(0x18C));
    TEST_ASSERT_EQUAL_UINT32(CAN_PLACES, put(0x1A0));
    TEST_ASSERT_EQUAL_UINT32(1, put(0x184));
    TEST_ASSERT_EQUAL_UINT32(CAN_PLACES, can_places_of(&places, 0x198));
    TEST_ASSERT_EQUAL_UINT32(1, can_places_of(&places, 0x184));
}

void test_a_frame_takes_the_place_of_its_own_identifier(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, put(0x190));
    TEST_ASSERT_EQUAL_UINT32(1, put(0x180));
    TEST_ASSERT_EQUAL_UINT32(0, put(0x190));
    places.taken[0] = false;
    TEST_ASSERT_EQUAL_UINT32(CAN_PLACES, can_places_of(&places, 0x190));
}

/* Whatever its number is: its leading zeros would win each arbitration. */
void test_a_frame_of_29_bits_comes_after_all_others_and_gives_its_place(void)
{
    const uint32_t extended = CAN_EXTENDED | 0x90A;
    TEST_ASSERT_EQUAL_UINT32(0, put(0x7FF));
    TEST_ASSERT_EQUAL_UINT32(CAN_PLACES, put(extended));
    places.taken[0] = false;
    TEST_ASSERT_EQUAL_UINT32(0, put(extended));
    TEST_ASSERT_EQUAL_UINT32(CAN_PLACES, put(CAN_EXTENDED | 0x100A));
    TEST_ASSERT_EQUAL_UINT32(1, put(0x184));
    TEST_ASSERT_EQUAL_UINT32(0, put(extended));
    TEST_ASSERT_EQUAL_UINT32(2, put(0x190));
    TEST_ASSERT_EQUAL_UINT32(0, put(0x7FF));
    TEST_ASSERT_EQUAL_UINT32(CAN_PLACES, can_places_of(&places, extended));
}

/* After any sequence of frames and ends the places hold the most urgent of those that were put and
 * have not ended: the reference is a bit for each of 32 identifiers. */
void test_the_places_hold_the_most_urgent_frames(void)
{
    uint32_t waits = 0;
    uint32_t random = 1;
    for (int k = 0; k < 100000; k++) {
        random = random * 1664525U + 1013904223U;
        const uint16_t identifier = (uint16_t)(random >> 27);
        if ((random >> 20 & 3U) == 0) { /* the frame of a place has ended */
            const uint32_t place = random >> 10 & 1U;
            waits &= places.taken[place] ? ~(1U << places.identifier[place]) : UINT32_MAX;
            places.taken[place] = false;
        } else {
            (void)put(identifier);
            waits |= 1U << identifier;
        }
        int kept = 0;
        for (uint32_t other = 0; other < 32; other++) {
            const bool waiting = (waits >> other & 1U) != 0 && kept < CAN_PLACES;
            kept += waiting ? 1 : 0;
            TEST_ASSERT_EQUAL(waiting, can_places_of(&places, (uint16_t)other) < CAN_PLACES);
            waits = waiting ? waits : waits & ~(1U << other); /* given up */
        }
    }
}
