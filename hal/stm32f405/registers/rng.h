/* SPDX-License-Identifier: Apache-2.0 */
/* rng.h: random number generator, RM0090 section 24.4. */
#ifndef STM32F405_REGISTERS_RNG_H
#define STM32F405_REGISTERS_RNG_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR;
    volatile uint32_t SR;
    volatile uint32_t DR;
} rng_registers_t;

#define RNG ((rng_registers_t *)0x50060800U)
#define RNG_CR_RNGEN (1U << 2)
#define RNG_SR_DRDY (1U << 0)
#define RNG_SR_CECS (1U << 1)
#define RNG_SR_SECS (1U << 2)
#define RNG_SR_CEIS (1U << 5)
#define RNG_SR_SEIS (1U << 6)

#endif
