/* SPDX-License-Identifier: Apache-2.0 */
/* What is read out of the raw report and the battery's message. */
#include "core/measured.h"

#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

void test_the_bridge_has_switched_in_pwm_only(void)
{
    static const bridge_mode_t BRIDGES[] = {BRIDGE_OFF, BRIDGE_PWM, BRIDGE_SHORT,
                                            BRIDGE_SHORT_HIGH};
    for (int k = 0; k < 4; k++) {
        const fast_report_t report = {.bridge = BRIDGES[k]};
        const measured_t now = {.report = &report};
        TEST_ASSERT_EQUAL(BRIDGES[k] == BRIDGE_PWM, measured_switching(&now));
    }
}

/* A state that is not reported counts as closed. */
void test_the_battery_is_gone_where_its_contactor_is_reported_open_only(void)
{
    static const contactor_t CONTACTORS[] = {CONTACTOR_NOT_REPORTED, CONTACTOR_CLOSED,
                                             CONTACTOR_OPEN};
    for (int k = 0; k < 3; k++) {
        const battery_limits_t battery = {.contactor = CONTACTORS[k]};
        const measured_t now = {.battery = &battery};
        TEST_ASSERT_EQUAL(CONTACTORS[k] == CONTACTOR_OPEN, measured_battery_open(&now));
    }
}
