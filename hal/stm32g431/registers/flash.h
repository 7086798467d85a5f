/* SPDX-License-Identifier: Apache-2.0 */
/* flash.h: flash interface; RM0440 section 3.7. */
#ifndef STM32G431_REGISTERS_FLASH_H
#define STM32G431_REGISTERS_FLASH_H

#include <stdint.h>

typedef struct {
    volatile uint32_t ACR;
    volatile uint32_t PDKEYR;
    volatile uint32_t KEYR;
    volatile uint32_t OPTKEYR;
    volatile uint32_t SR;
    volatile uint32_t CR;
    volatile uint32_t ECCR;
    uint32_t reserved_1C;
    volatile uint32_t OPTR;
} flash_registers_t;

#define FLASH ((flash_registers_t *)0x40022000U)

#define FLASH_ACR_LATENCY_Pos 0
#define FLASH_ACR_LATENCY (0xFU << 0)
#define FLASH_ACR_PRFTEN (1U << 8)
#define FLASH_ACR_ICEN (1U << 9)
#define FLASH_ACR_DCEN (1U << 10)
#define FLASH_ACR_ICRST (1U << 11)
#define FLASH_ACR_DCRST (1U << 12)
#define FLASH_KEYR_KEYR 0xFFFFFFFFU
#define FLASH_SR_EOP (1U << 0)
#define FLASH_SR_OPERR (1U << 1)
#define FLASH_SR_PROGERR (1U << 3)
#define FLASH_SR_WRPERR (1U << 4)
#define FLASH_SR_PGAERR (1U << 5)
#define FLASH_SR_SIZERR (1U << 6)
#define FLASH_SR_PGSERR (1U << 7)
#define FLASH_SR_BSY (1U << 16)
#define FLASH_CR_PG (1U << 0)
#define FLASH_CR_PER (1U << 1)
#define FLASH_CR_PNB_Pos 3
#define FLASH_CR_PNB (0x7FU << 3)
#define FLASH_CR_STRT (1U << 16)
#define FLASH_CR_LOCK (1U << 31)
#define FLASH_ECCR_ADDR_ECC (0x7FFFFU << 0)
#define FLASH_ECCR_SYSF_ECC (1U << 22)
#define FLASH_ECCR_ECCD (1U << 31)

/* Not fields: the key sequence of KEYR (3.3.5). */
#define FLASH_UNLOCK_FIRST 0x45670123U
#define FLASH_UNLOCK_SECOND 0xCDEF89ABU

#endif
