/* SPDX-License-Identifier: Apache-2.0 */
/* The two images, and programming of the configuration's sector (RM0090 section 3.6). */
#include "hal/flash.h"

#include "registers/flash.h"
#include "registers/iwdg.h"

enum {
    CONFIGURATION_SECTOR = 1, /* 16 KiB at 0x0800 4000, see link.ld */
    PARALLELISM_32_BITS = 2,  /* allowed at 2.7 .. 3.6 V */
    POLLS_ERASE = 30000000,   /* 1 s and more; the data sheet says 0.5 s at most */
    POLLS_WORD = 100000       /* 3 ms; the data sheet says 0.1 ms */
};

extern const uint32_t link_image_begin[];
extern const uint32_t link_image_end[];
extern const uint32_t link_image_crc32[];
extern const uint32_t link_configuration_begin[];
extern const uint32_t link_configuration_end[];

flash_image_t flash_configuration(void)
{
    const flash_image_t image = {
        link_configuration_begin,
        (uint32_t)((uintptr_t)link_configuration_end - (uintptr_t)link_configuration_begin)};
    return image;
}

flash_image_t flash_firmware(void)
{
    const flash_image_t image = {
        link_image_begin, (uint32_t)((uintptr_t)link_image_end - (uintptr_t)link_image_begin)};
    return image;
}

uint32_t flash_firmware_crc32(void)
{
    return *(const volatile uint32_t *)link_image_crc32;
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

IN_RAM static flash_status_t ram_replace(volatile uint32_t *to, const uint32_t *from,
                                         uint32_t words)
{
    flash_status_t status = FLASH_OK;
    /* Without the caches, so that what is read back has been in the flash: a line that was read
     * before the sector was erased would take the new words by itself (3.6.5). */
    const uint32_t access = FLASH->ACR;
    FLASH->ACR = access & ~(uint32_t)(FLASH_ACR_ICEN | FLASH_ACR_DCEN);
    (void)ram_wait(POLLS_WORD); /* drops errors left behind by a debugger */
    FLASH->CR = FLASH_CR_SER | ((uint32_t)CONFIGURATION_SECTOR << FLASH_CR_SNB_Pos) |
                ((uint32_t)PARALLELISM_32_BITS << FLASH_CR_PSIZE_Pos);
    FLASH->CR |= FLASH_CR_STRT;
    if (!ram_wait(POLLS_ERASE)) {
        status = FLASH_ERASE_FAILED;
    }
    FLASH->CR = FLASH_CR_PG | ((uint32_t)PARALLELISM_32_BITS << FLASH_CR_PSIZE_Pos);
    for (uint32_t i = 0; i < words && status == FLASH_OK; i++) {
        to[i] = from[i];
        if (!ram_wait(POLLS_WORD) || to[i] != from[i]) {
            status = FLASH_WRITE_FAILED;
        }
    }
    FLASH->CR = FLASH_CR_LOCK;
    /* The caches still hold what was there before: reset is allowed only while they are off
     * (3.9.1). */
    FLASH->ACR |= FLASH_ACR_ICRST | FLASH_ACR_DCRST;
    FLASH->ACR = access;
    return status;
}

flash_status_t flash_write_configuration(const void *bytes, uint32_t size_bytes)
{
    if (size_bytes > flash_configuration().size_bytes || size_bytes % 4U != 0) {
        return FLASH_TOO_LARGE;
    }
    __asm volatile("cpsid i" ::: "memory"); /* every handler is in flash */
    FLASH->KEYR = FLASH_UNLOCK_FIRST;
    FLASH->KEYR = FLASH_UNLOCK_SECOND;
    volatile uint32_t *const sector = (volatile uint32_t *)(uintptr_t)link_configuration_begin;
    const flash_status_t status = ram_replace(sector, (const uint32_t *)bytes, size_bytes / 4U);
    __asm volatile("cpsie i" ::: "memory");
    return status;
}
