/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mpu.h: the memory protection unit of a Cortex-M3 or M4 (Arm DDI 0403, B3.5). All code is
 * privileged; the regions say what even that must not do. What is in no region has the core's
 * default map, and hard fault and NMI handlers have it everywhere.
 */
#ifndef HAL_CORTEX_M_MPU_H
#define HAL_CORTEX_M_MPU_H

#include <stdint.h>

/* Sizes are powers of two, at least 32 bytes, and a region begins at a multiple of its own. Of
 * regions that overlap the later one counts. */
typedef struct {
    const void *begin;
    uint32_t attributes; /* MPU_...() below */
} mpu_region_t;

#define MPU_NO_EXECUTE (1U << 28)
#define MPU_READ_WRITE (1U << 24) /* by privileged code */
#define MPU_READ_ONLY (5U << 24)
#define MPU_NO_ACCESS 0U
#define MPU_NORMAL_MEMORY (1U << 17)                      /* write-through, not shared */
#define MPU_WITHOUT_EIGHTHS(mask) ((uint32_t)(mask) << 8) /* of at least 256 bytes */
#define MPU_SIZE(log2_bytes) (((log2_bytes)-1U) << 1)

#define MPU_CTRL_ADDRESS 0xE000ED94U
#define MPU_RBAR_ADDRESS 0xE000ED9CU
#define MPU_RASR_ADDRESS 0xE000EDA0U

static inline void mpu_start(const mpu_region_t *regions, uint32_t count)
{
    enum { RBAR_VALID = 1 << 4, RASR_ENABLE = 1, CTRL_ENABLE = 1, CTRL_DEFAULT_MAP = 4 };
    for (uint32_t i = 0; i < count; i++) {
        *(volatile uint32_t *)MPU_RBAR_ADDRESS =
            (uint32_t)(uintptr_t)regions[i].begin | RBAR_VALID | i;
        *(volatile uint32_t *)MPU_RASR_ADDRESS =
            regions[i].attributes | MPU_NORMAL_MEMORY | RASR_ENABLE;
    }
    __asm volatile("dsb" ::: "memory");
    *(volatile uint32_t *)MPU_CTRL_ADDRESS = CTRL_ENABLE | CTRL_DEFAULT_MAP;
    __asm volatile("dsb\n\tisb" ::: "memory");
}

#endif
