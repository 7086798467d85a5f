/* SPDX-License-Identifier: Apache-2.0 */
/*
 * upcall.h: the two functions that every port calls and the application supplies. There are no
 * other up-calls.
 *
 * Both are called from interrupt context of a single core. app_pwm_period_isr() has the higher
 * priority: it may interrupt app_millisecond_isr() and the background loop, and no interrupt
 * that calls into the application interrupts it. app_millisecond_isr() may interrupt the background
 * loop only. Neither is re-entered. The exchange between the three contexts (firmware/app
 * double_buffer.h) relies on this order.
 *
 * app_pwm_period_isr() is called only after inverter_start(), app_millisecond_isr() only after
 * time_start_tick().
 */
#ifndef HAL_UPCALL_H
#define HAL_UPCALL_H

/* Once per PWM period, as soon as the samples taken at the top of the centre-aligned count are
 * converted. Values given to inverter_set() before the next top take effect at that top. */
void app_pwm_period_isr(void);

/* Once per millisecond. */
void app_millisecond_isr(void);

#endif
