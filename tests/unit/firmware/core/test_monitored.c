/* SPDX-License-Identifier: Apache-2.0 */
/* What the safe state charges. */
#include "core/monitored.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* The diodes of an open bridge do; a short circuit takes no bus current. */
void test_only_freewheel_charges_the_bus(void)
{
    static const bridge_mode_t BRIDGES[] = {BRIDGE_OFF, BRIDGE_SHORT, BRIDGE_SHORT_HIGH};
    for (int k = 0; k < 3; k++) {
        const safe_state_t safe = {.bridge = BRIDGES[k], .freewheel = {.charging_mA = 7000}};
        TEST_ASSERT_EQUAL_INT32(BRIDGES[k] == BRIDGE_OFF ? 7000 : 0, safe_state_charging_mA(&safe));
    }
}
