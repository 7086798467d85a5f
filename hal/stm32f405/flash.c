/* SPDX-License-Identifier: Apache-2.0 */
/* The images, and erasing and programming of the application's sectors (RM0090 section 3.6). */
#include "hal/flash.h"

#include "registers/flash.h"
#include "registers/iwdg.h"
#include "registers/rcc.h"
#include "registers/tim.h"

/* Of hal/flash.h, in its order; see link.ld. */
enum { FIRST_SECTOR = 1 };
enum {
    PARALLELISM_32_BITS = 2, /* allowed at 2.7 .. 3.6 V */
    POLLS_ERASE = 30000000,  /* 3 s; the data sheet says 0.5 s at most for 16 KiB, 1.1 for 64 */
    POLLS_WORD = 100000      /* 10 ms; the data sheet says 0.1 ms */
};

extern const uint32_t link_image_begin[];
extern const uint32_t link_image_end[];
extern const uint32_t link_image_crc32[];
/* Where sectors 1 to 5 begin. */
extern const uint32_t link_sector_1[], link_sector_2[], link_sector_3[], link_sector_4[],
    link_sector_5[];

static flash_image_t between(const uint32_t *begin, const uint32_t *end)
{
    const flash_image_t image = {begin, (uint32_t)((uintptr_t)end - (uintptr_t)begin)};
    return image;
}

flash_image_t flash_sector(flash_sector_t sector)
{
    static const uint32_t *const BEGIN[FLASH_SECTORS + 1] = {
        link_sector_1, link_sector_2, link_sector_3, link_sector_4, link_sector_5};
    return between(BEGIN[sector], BEGIN[sector + 1]);
}

flash_image_t flash_firmware(void)
{
    return between(link_image_begin, link_image_end);
}

uint32_t flash_firmware_crc32(void)
{
    return *(const volatile uint32_t *)link_image_crc32;
}

/* Code 0 is level 3, 2.7 V; 3, as delivered, is off: 1.7 V. */
bool flash_brown_out_low(void)
{
    return (FLASH->OPTCR & FLASH_OPTCR_BOR_LEV) != 0;
}

/* From here on code runs in RAM: the flash cannot be read while it is erased or written. */
/* the linker adds the long jump there */
#define IN_RAM __attribute__((section(".ram_code"), noinline))

IN_RAM static bool ram_wait(uint32_t polls)
{
    while ((FLASH->SR & FLASH_SR_BSY) != 0) {
        IWDG->KR = IWDG_KR_KEY_RELOAD;
        if (polls-- == 0) {
            return false;
        }
    }
    const uint32_t errors =
        FLASH_SR_OPERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_PGPERR | FLASH_SR_PGSERR;
    const bool good = (FLASH->SR & errors) == 0;
    FLASH->SR = errors | FLASH_SR_EOP; /* cleared by writing 1 */
    return good;
}

/* One operation: `control` is a sector's erase, or FLASH_CR_PG and `value` is programmed. */
IN_RAM static bool ram_operate(uint32_t control, volatile uint32_t *to, uint32_t value)
{
    /* Without the caches, so that what is read back has been in the flash: a line that was read
     * before the sector was erased would take the new words by itself (3.6.5). */
    const uint32_t access = FLASH->ACR;
    FLASH->ACR = access & ~(uint32_t)(FLASH_ACR_ICEN | FLASH_ACR_DCEN);
    (void)ram_wait(POLLS_WORD); /* drops errors left behind by a debugger */
    FLASH->CR = control | ((uint32_t)PARALLELISM_32_BITS << FLASH_CR_PSIZE_Pos);
    bool good;
    if ((control & FLASH_CR_PG) != 0) {
        *to = value;
        good = ram_wait(POLLS_WORD) && *to == value;
    } else {
        FLASH->CR |= FLASH_CR_STRT;
        good = ram_wait(POLLS_ERASE);
    }
    FLASH->CR = FLASH_CR_LOCK;
    /* The caches still hold what was there before: reset is allowed only while they are off
     * (3.9.1). */
    FLASH->ACR |= FLASH_ACR_ICRST | FLASH_ACR_DCRST;
    FLASH->ACR = access;
    return good;
}

static bool bridge_is_on(void)
{
    return (RCC->APB2ENR & RCC_APB2ENR_TIM1EN) != 0 && (TIM1->BDTR & TIM_BDTR_MOE) != 0;
}

/* Every handler is in flash, so interrupts wait; the PWM interrupt cannot switch the bridge on
 * between the look at it and the operation. */
static flash_status_t operate(uint32_t control, volatile uint32_t *to, uint32_t value)
{
    flash_status_t status = FLASH_BRIDGE_ON;
    uint32_t masked;
    __asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(masked)::"memory");
    if (!bridge_is_on()) {
        FLASH->KEYR = FLASH_UNLOCK_FIRST;
        FLASH->KEYR = FLASH_UNLOCK_SECOND;
        status = FLASH_OK;
        if (!ram_operate(control, to, value)) {
            status = (control & FLASH_CR_PG) != 0 ? FLASH_WRITE_FAILED : FLASH_ERASE_FAILED;
        }
    }
    __asm volatile("msr primask, %0" ::"r"(masked) : "memory");
    return status;
}

flash_status_t flash_erase(flash_sector_t sector)
{
    const uint32_t number = (uint32_t)FIRST_SECTOR + (uint32_t)sector;
    return operate(FLASH_CR_SER | (number << FLASH_CR_SNB_Pos), 0, 0);
}

flash_status_t flash_program(flash_sector_t sector, uint32_t at_bytes, const void *words,
                             uint32_t size_bytes)
{
    const flash_image_t whole = flash_sector(sector);
    if (at_bytes > whole.size_bytes || size_bytes > whole.size_bytes - at_bytes ||
        (at_bytes | size_bytes) % 4U != 0) {
        return FLASH_TOO_LARGE;
    }
    volatile uint32_t *const to =
        (volatile uint32_t *)((uintptr_t)whole.begin + (uintptr_t)at_bytes);
    const uint32_t *const from = (const uint32_t *)words;
    flash_status_t status = FLASH_OK;
    for (uint32_t i = 0; i < size_bytes / 4U && status == FLASH_OK; i++) {
        status = operate(FLASH_CR_PG, &to[i], from[i]);
    }
    return status;
}
