/*
 * interrupts.h: who may interrupt whom. Smaller numbers win; the core implements sixteen levels.
 *
 *     0   the chip's supply falls: a fault
 *     1   the PWM period: ADC, end of the injected conversions
 *     8   the millisecond: SysTick
 *     12  the serial line
 *
 * The core's own faults have priority 0, too; the hard fault and the non-maskable interrupt stand above all of them.
 */
#ifndef STM32F405_INTERRUPTS_H
#define STM32F405_INTERRUPTS_H

#include <stdint.h>

enum { INTERRUPT_SUPPLY = 1, INTERRUPT_ADC = 18, INTERRUPT_USART3 = 39, INTERRUPT_COUNT = 82 }; /* RM0090 table 62 */
enum { PRIORITY_SUPPLY = 0, PRIORITY_PWM_PERIOD = 1, PRIORITY_MILLISECOND = 8, PRIORITY_SERIAL = 12 };

void interrupts_enable(uint32_t number, uint32_t priority);

/* Priority of SysTick. */
void interrupts_set_millisecond_priority(void);

#endif
