/* SPDX-License-Identifier: Apache-2.0 */
/* dma.h: DMA controller 1 (RM0440 section 12.6) and the multiplexer of its requests (13.6). */
#ifndef STM32G431_REGISTERS_DMA_H
#define STM32G431_REGISTERS_DMA_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CCR;   /* 12.6.3 */
    volatile uint32_t CNDTR; /* 12.6.4 */
    volatile uint32_t CPAR;
    volatile uint32_t CMAR;
    uint32_t reserved_10;
} dma_channel_t;

typedef struct {
    volatile uint32_t ISR;
    volatile uint32_t IFCR;
    dma_channel_t channel[8]; /* numbered from 1 in the manual */
} dma_registers_t;

typedef struct {
    volatile uint32_t CCR[16]; /* 13.6.1; the first eight are DMA1's channels 1 to 8 */
} dmamux_registers_t;

#define DMA1 ((dma_registers_t *)0x40020000U)
#define DMAMUX ((dmamux_registers_t *)0x40020800U)

#define DMA_CCR1_EN (1U << 0) /* alike in all channels */
#define DMA_CCR1_DIR (1U << 4)
#define DMA_CCR1_CIRC (1U << 5)
#define DMA_CCR1_MINC (1U << 7)
#define DMA_CCR1_PSIZE_Pos 8
#define DMA_CCR1_PSIZE (0x3U << 8)
#define DMA_CCR1_MSIZE_Pos 10
#define DMA_CCR1_MSIZE (0x3U << 10)

#endif
