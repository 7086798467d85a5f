/* SPDX-License-Identifier: Apache-2.0 */
/*
 * app.h: the controller on a core: interrupts, background, and the exchange between them.
 *
 *     priority  context               runs                                           rate
 *     high      app_pwm_period_isr    hal samples -> controller_fast_step -> bridge  PWM period
 *     low       app_millisecond_isr   temperatures, command -> controller_slow_step  1 kHz
 *     none      app_background        CAN, serial line, watchdog                     continuously
 *
 *                node_command_t         fast_setpoint_t
 *     background ---------> millisecond ---------> PWM period
 *                <---------             <---------
 *                 snapshot_t             fast_report_t           each arrow one double_buffer.h
 *
 * The two interrupts are declared in hal/upcall.h.
 */
#ifndef APP_APP_H
#define APP_APP_H

#include <stdbool.h>

/* Milliseconds without a slow step after which no more frames are sent but WheelState, with the
 * fault PROGRAM_FLOW. */
enum { APP_SLOW_STOPPED_ms = 5 };

/* Background context, once after reset: self-tests, then either running interrupts or BOOT with the
 * reason on the serial line. Tests may call it again; all state is initialised. */
void app_boot(void);

/* Background context: one pass, repeated by main(). */
void app_background(void);

/* Background context, for ports whose time_running() ends: prints and flushes the closing line,
 * "result: READY, no limit" or the failure. True if the control steps run and no fault is latched.
 */
bool app_finish(void);

#endif
