/* SPDX-License-Identifier: Apache-2.0 */
/* can.h: bxCAN; RM0090 section 32.9. */
#ifndef STM32F405_REGISTERS_CAN_H
#define STM32F405_REGISTERS_CAN_H

#include <stdint.h>

typedef struct {
    volatile uint32_t TIR;
    volatile uint32_t TDTR;
    volatile uint32_t TDLR;
    volatile uint32_t TDHR;
} can_transmit_mailbox_t;

typedef struct {
    volatile uint32_t RIR;
    volatile uint32_t RDTR;
    volatile uint32_t RDLR;
    volatile uint32_t RDHR;
} can_receive_mailbox_t;

typedef struct {
    volatile uint32_t FR1;
    volatile uint32_t FR2;
} can_filter_bank_t;

typedef struct {
    volatile uint32_t MCR; /* 32.9.2 */
    volatile uint32_t MSR;
    volatile uint32_t TSR;
    volatile uint32_t RF0R;
    volatile uint32_t RF1R;
    volatile uint32_t IER;
    volatile uint32_t ESR;
    volatile uint32_t BTR;
    uint32_t reserved_20[88];
    can_transmit_mailbox_t transmit[3]; /* 32.9.3 */
    can_receive_mailbox_t receive[2];
    uint32_t reserved_1D0[12];
    volatile uint32_t FMR; /* 32.9.4 */
    volatile uint32_t FM1R;
    uint32_t reserved_208;
    volatile uint32_t FS1R;
    uint32_t reserved_210;
    volatile uint32_t FFA1R;
    uint32_t reserved_218;
    volatile uint32_t FA1R;
    uint32_t reserved_220[8];
    can_filter_bank_t filter[28];
} can_registers_t;

#define CAN1 ((can_registers_t *)0x40006400U)

#define CAN_MCR_INRQ (1U << 0)
#define CAN_MCR_SLEEP (1U << 1)
#define CAN_MCR_ABOM (1U << 6)
#define CAN_MSR_INAK (1U << 0)
#define CAN_MSR_SLAK (1U << 1)
#define CAN_TSR_TXOK0 (1U << 1)
#define CAN_TSR_ABRQ0 (1U << 7)
#define CAN_TSR_TME0 (1U << 26)
#define CAN_RF0R_FMP0 (0x3U << 0)
#define CAN_RF0R_FOVR0 (1U << 4)
#define CAN_RF0R_RFOM0 (1U << 5)
#define CAN_ESR_BOFF (1U << 2)
#define CAN_BTR_BRP_Pos 0
#define CAN_BTR_BRP (0x3FFU << 0)
#define CAN_BTR_TS1_Pos 16
#define CAN_BTR_TS1 (0xFU << 16)
#define CAN_BTR_TS2_Pos 20
#define CAN_BTR_TS2 (0x7U << 20)
#define CAN_BTR_SJW_Pos 24
#define CAN_BTR_SJW (0x3U << 24)
#define CAN_TIR_TXRQ (1U << 0)
#define CAN_TIR_IDE (1U << 2)
#define CAN_TIR_EXID_Pos 3 /* with IDE: STID and EXID are one identifier of 29 bits */
#define CAN_TIR_STID_Pos 21
#define CAN_TIR_STID (0x7FFU << 21)
#define CAN_TDTR_DLC (0xFU << 0)
#define CAN_RIR_RTR (1U << 1)
#define CAN_RIR_IDE (1U << 2)
#define CAN_RIR_STID_Pos 21
#define CAN_RIR_STID (0x7FFU << 21)
#define CAN_RDTR_DLC (0xFU << 0)
#define CAN_FMR_FINIT (1U << 0)

#endif
