/* SPDX-License-Identifier: Apache-2.0 */
/*
 * app.h: the controller on a core: who calls what, when, and how the parts exchange data.
 *
 *     high   app_pwm_period_isr    hal samples -> controller_fast_step -> bridge   PWM period
 *     low    app_millisecond_isr   temperatures, demand -> controller_slow_step    1 kHz
 *     none   app_background        CAN, serial line, watchdog                      as it can
 *
 *                 wish               fast_setpoint
 *     background ------> millisecond -------------> PWM period
 *                <------             <-------------
 *                 snapshot               fast_report            each arrow one double_buffer.h
 *
 * The two interrupts are declared in hal/upcall.h.
 */
#ifndef APP_APP_H
#define APP_APP_H

#include <stdbool.h>

/* From reset to running interrupts, or to a refusal that says why. May be called again by tests:
 * everything starts anew. */
void app_boot(void);

/* One pass of the background. */
void app_background(void);

/* Writes the closing line, "result: READY, no limit" or what went wrong, and pushes it out. True if
 * the control steps run and no fault is latched. For ports whose time_running() ends. */
bool app_finish(void);

#endif
