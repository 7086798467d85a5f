/* SPDX-License-Identifier: Apache-2.0 */
/* The validator on the section of the pedals. */
#include <stddef.h>
#include <string.h>

#include "config/validate.h"
#include "refusal.h"
#include "unity.h"

void setUp(void)
{
    config = CONFIG_LU2013;
}

void tearDown(void) {}

/* The travel lies inside the valid range, where a short or an open channel is never found, and
 * covers a tenth of the supply, 3277 of 32 768. Channels that are not wired do not count. */
void test_each_wired_pedal_channel_must_be_calibrated(void)
{
    const char *relation = "pedals.lowest_q15 < released_q15 and pressed_q15 < highest_q15";
    for (int channel = 0; channel < CONFIG_PEDAL_CHANNELS; channel++) {
        const int32_t wired = channel % 2 + 1;
        int32_t *channels =
            channel < 2 ? &config.pedals.accelerator_channels : &config.pedals.brake_channels;
        *channels = wired;
        config.pedals.released_q15[channel] = config.pedals.lowest_q15[channel];
        assert_relation(relation);
        *channels = wired;
        config.pedals.pressed_q15[channel] = config.pedals.highest_q15[channel];
        assert_relation(relation);
        *channels = wired;
        config.pedals.pressed_q15[channel] = config.pedals.released_q15[channel] + 3277;
        TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
        config.pedals.pressed_q15[channel]--;
        assert_relation(relation);
        /* The other way round: less voltage with more travel. */
        *channels = wired;
        const int32_t released = config.pedals.released_q15[channel];
        config.pedals.released_q15[channel] = config.pedals.pressed_q15[channel];
        config.pedals.pressed_q15[channel] = released;
        TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
        *channels = wired - 1;
        config.pedals.pressed_q15[channel] = config.pedals.released_q15[channel];
        TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
        config = CONFIG_LU2013;
    }
}

void test_free_travel_torque_must_not_exceed_that_of_the_whole_pedal(void)
{
    config.pedals.free_travel_torque_mNm = config.pedals.brake_torque_mNm;
    TEST_ASSERT_EQUAL_INT(CONFIG_RESULT_OK, sealed_result().code);
    config.pedals.free_travel_torque_mNm++;
    assert_relation("pedals.free_travel_torque_mNm <= pedals.brake_torque_mNm");
}
