/* SPDX-License-Identifier: Apache-2.0 */
/* flash.h: flash interface; RM0090 section 3.9 (STM32F405xx). */
#ifndef STM32F405_REGISTERS_FLASH_H
#define STM32F405_REGISTERS_FLASH_H

#include <stdint.h>

typedef struct {
    volatile uint32_t ACR;  /* 3.9.1 */
    volatile uint32_t KEYR; /* 3.9.3 */
    volatile uint32_t OPTKEYR;
    volatile uint32_t SR;    /* 3.9.5 */
    volatile uint32_t CR;    /* 3.9.6 */
    volatile uint32_t OPTCR; /* 3.9.10 */
} flash_registers_t;

#define FLASH ((flash_registers_t *)0x40023C00U)

#define FLASH_ACR_LATENCY_Pos 0
#define FLASH_ACR_LATENCY (0x7U << 0)
#define FLASH_ACR_PRFTEN (1U << 8)
#define FLASH_ACR_ICEN (1U << 9)
#define FLASH_ACR_DCEN (1U << 10)
#define FLASH_ACR_ICRST (1U << 11)
#define FLASH_ACR_DCRST (1U << 12)
#define FLASH_KEYR_KEY 0xFFFFFFFFU
#define FLASH_SR_EOP (1U << 0)
#define FLASH_SR_OPERR (1U << 1)
#define FLASH_SR_WRPERR (1U << 4)
#define FLASH_SR_PGAERR (1U << 5)
#define FLASH_SR_PGPERR (1U << 6)
#define FLASH_SR_PGSERR (1U << 7)
#define FLASH_SR_BSY (1U << 16)
#define FLASH_CR_PG (1U << 0)
#define FLASH_CR_SER (1U << 1)
#define FLASH_CR_SNB_Pos 3
#define FLASH_CR_SNB (0xFU << 3)
#define FLASH_CR_PSIZE_Pos 8
#define FLASH_CR_PSIZE (0x3U << 8)
#define FLASH_CR_STRT (1U << 16)
#define FLASH_CR_LOCK (1U << 31)
#define FLASH_OPTCR_BOR_LEV (0x3U << 2)

/* Not fields: the key sequence of KEYR (3.6.1). */
#define FLASH_UNLOCK_FIRST 0x45670123U
#define FLASH_UNLOCK_SECOND 0xCDEF89ABU

#endif
