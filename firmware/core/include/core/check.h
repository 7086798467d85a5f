/* SPDX-License-Identifier: Apache-2.0 */
/*
 * check.h: assertions, for conditions that only a programming error or a memory fault can break.
 *
 * They stay on in release. Each has its module and a stable number; all end in one handler,
 * supplied by app/ (or by a test), which switches the bridge off. Errors that a sensor, a message
 * or a user can cause are not asserted: they have a reason (reason.h).
 */
#ifndef CORE_CHECK_H
#define CORE_CHECK_H

#include <stdint.h>

typedef enum {
    CHECK_MODULE_CORE = 1,
    CHECK_MODULE_CONFIG = 2,
    CHECK_MODULE_FOC = 3,
    CHECK_MODULE_TORQUE = 4,
    CHECK_MODULE_MONITOR = 5,
    CHECK_MODULE_MODES = 6,
    CHECK_MODULE_CONTROLLER = 7,
    CHECK_MODULE_APP = 8
} check_module_t;

/* Called on a failed check; must not return. Any context. */
void check_failed(check_module_t module, uint16_t number);

#define CHECK(module, number, condition) ((condition) ? (void)0 : check_failed((module), (number)))

#endif
