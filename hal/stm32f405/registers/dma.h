/* SPDX-License-Identifier: Apache-2.0 */
/* dma.h: DMA controllers; RM0090 section 10.5. */
#ifndef STM32F405_REGISTERS_DMA_H
#define STM32F405_REGISTERS_DMA_H

#include <stdint.h>

typedef struct {
    volatile uint32_t CR;   /* 10.5.5 */
    volatile uint32_t NDTR; /* 10.5.6 */
    volatile uint32_t PAR;  /* 10.5.7 */
    volatile uint32_t M0AR; /* 10.5.8 */
    volatile uint32_t M1AR;
    volatile uint32_t FCR;
} dma_stream_t;

typedef struct {
    volatile uint32_t LISR; /* 10.5.1 */
    volatile uint32_t HISR;
    volatile uint32_t LIFCR; /* 10.5.3 */
    volatile uint32_t HIFCR;
    dma_stream_t stream[8];
} dma_registers_t;

#define DMA1 ((dma_registers_t *)0x40026000U)
#define DMA2 ((dma_registers_t *)0x40026400U)

#define DMA_LIFCR_CFEIF3 (1U << 22)
#define DMA_LIFCR_CDMEIF3 (1U << 24)
#define DMA_LIFCR_CTEIF3 (1U << 25)
#define DMA_LIFCR_CHTIF3 (1U << 26)
#define DMA_LIFCR_CTCIF3 (1U << 27)
#define DMA_S0CR_EN (1U << 0) /* alike in all streams */
#define DMA_S0CR_DIR_Pos 6
#define DMA_S0CR_DIR (0x3U << 6)
#define DMA_S0CR_CIRC (1U << 8)
#define DMA_S0CR_MINC (1U << 10)
#define DMA_S0CR_PSIZE_Pos 11
#define DMA_S0CR_PSIZE (0x3U << 11)
#define DMA_S0CR_MSIZE_Pos 13
#define DMA_S0CR_MSIZE (0x3U << 13)
#define DMA_S0CR_CHSEL_Pos 25
#define DMA_S0CR_CHSEL (0x7U << 25)

#endif
