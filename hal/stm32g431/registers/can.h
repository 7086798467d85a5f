/* SPDX-License-Identifier: Apache-2.0 */
/* can.h: FDCAN; RM0440 section 46.4. */
#ifndef STM32G431_REGISTERS_CAN_H
#define STM32G431_REGISTERS_CAN_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    volatile uint32_t CREL;
    volatile uint32_t ENDN;
    uint32_t reserved_08;
    volatile uint32_t DBTP;
    volatile uint32_t TEST;
    volatile uint32_t RWD;
    volatile uint32_t CCCR;
    volatile uint32_t NBTP;
    volatile uint32_t TSCC;
    volatile uint32_t TSCV;
    volatile uint32_t TOCC;
    volatile uint32_t TOCV;
    uint32_t reserved_30[4];
    volatile uint32_t ECR;
    volatile uint32_t PSR;
    volatile uint32_t TDCR;
    uint32_t reserved_4C;
    volatile uint32_t IR;
    volatile uint32_t IE;
    volatile uint32_t ILS;
    volatile uint32_t ILE;
    uint32_t reserved_60[8];
    volatile uint32_t RXGFC;
    volatile uint32_t XIDAM;
    volatile uint32_t HPMS;
    uint32_t reserved_8C;
    volatile uint32_t RXF0S;
    volatile uint32_t RXF0A;
    volatile uint32_t RXF1S;
    volatile uint32_t RXF1A;
    uint32_t reserved_A0[8];
    volatile uint32_t TXBC;
    volatile uint32_t TXFQS;
    volatile uint32_t TXBRP;
    volatile uint32_t TXBAR;
    volatile uint32_t TXBCR;
    volatile uint32_t TXBTO;
    volatile uint32_t TXBCF;
    volatile uint32_t TXBTIE;
    volatile uint32_t TXBCIE;
    volatile uint32_t TXEFS;
    volatile uint32_t TXEFA;
    uint32_t reserved_EC[5];
    volatile uint32_t CKDIV;
} fdcan_registers_t;

#define FDCAN1 ((fdcan_registers_t *)0x40006400U)

#define FDCAN1_CCCR_INIT (1U << 0)
#define FDCAN1_CCCR_CCE (1U << 1)
#define FDCAN1_NBTP_NTSEG2_Pos 0
#define FDCAN1_NBTP_NTSEG2 (0x7FU << 0)
#define FDCAN1_NBTP_NTSEG1_Pos 8
#define FDCAN1_NBTP_NTSEG1 (0xFFU << 8)
#define FDCAN1_NBTP_NBRP_Pos 16
#define FDCAN1_NBTP_NBRP (0x1FFU << 16)
#define FDCAN1_NBTP_NSJW_Pos 25
#define FDCAN1_NBTP_NSJW (0x7FU << 25)
#define FDCAN1_PSR_ACT (0x3U << 3)
#define FDCAN1_PSR_BO (1U << 7)
#define FDCAN1_RXGFC_RRFE (1U << 0)
#define FDCAN1_RXGFC_RRFS (1U << 1)
#define FDCAN1_RXGFC_ANFE_Pos 2
#define FDCAN1_RXGFC_ANFE (0x3U << 2)
#define FDCAN1_RXGFC_ANFS_Pos 4
#define FDCAN1_RXGFC_ANFS (0x3U << 4)
#define FDCAN1_RXGFC_LSS_Pos 16
#define FDCAN1_RXGFC_LSS (0x1FU << 16)
#define FDCAN1_RXF0S_F0FL (0x7FU << 0)
#define FDCAN1_RXF0S_F0GI_Pos 8
#define FDCAN1_RXF0S_F0GI (0x3FU << 8)
#define FDCAN1_TXBC_TFQM (1U << 24) /* 46.4.25 */
#define FDCAN1_TXFQS_TFQPI_Pos 16
#define FDCAN1_TXFQS_TFQPI (0x3U << 16)
#define FDCAN1_TXFQS_TFQF (1U << 21)

/* The message memory, whose layout is fixed on this chip (46.3.6). */
typedef struct {
    volatile uint32_t identifier;
    volatile uint32_t length;
    volatile uint32_t data[16];
} fdcan_element_t;

typedef struct {
    volatile uint32_t standard_filter[28];
    uint32_t extended_filter[16];
    fdcan_element_t receive_0[3];
    fdcan_element_t receive_1[3];
    uint32_t transmit_event[6];
    fdcan_element_t transmit[3];
} fdcan_memory_t;

_Static_assert(offsetof(fdcan_memory_t, receive_0) == 0xB0 &&
                   offsetof(fdcan_memory_t, transmit) == 0x278 && sizeof(fdcan_memory_t) == 0x350,
               "the addresses of 46.3.6");

#define FDCAN1_MEMORY ((fdcan_memory_t *)0x4000A400U)

#endif
