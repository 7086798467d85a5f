/* SPDX-License-Identifier: Apache-2.0 */
/* The images, and erasing and programming of the application's sectors (RM0090 section 3.6, RM0440
 * section 3.3; what differs is in the chip's flash_cells.h). */
#include "hal/flash.h"

#include "flash_cells.h"
#include "registers/flash.h"
#include "registers/iwdg.h"
#include "registers/rcc.h"
#include "registers/tim.h"

enum {
    POLLS_ERASE = 30000000, /* 3 s; the data sheets say 1.1 s at most for 64 KiB */
    POLLS_WORD = 100000     /* 10 ms; the data sheets say 0.1 ms */
};
_Static_assert(FLASH_UNIT_BYTES % (4 * FLASH_CELLS_WORDS) == 0, "what hal/flash.h promises");

extern const uint32_t link_image_begin[];
extern const uint32_t link_image_end[];
extern const uint32_t link_image_crc32[];
/* Where the four sectors begin and end, one behind the other; see link.ld. */
extern const uint32_t link_configuration_a[], link_configuration_b[], link_journal_a[],
    link_journal_b[], link_journal_end[];

static flash_image_t between(const uint32_t *begin, const uint32_t *end)
{
    const flash_image_t image = {begin, (uint32_t)((uintptr_t)end - (uintptr_t)begin)};
    return image;
}

flash_image_t flash_sector(flash_sector_t sector)
{
    static const uint32_t *const BEGIN[FLASH_SECTORS + 1] = {link_configuration_a,
                                                             link_configuration_b, link_journal_a,
                                                             link_journal_b, link_journal_end};
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

bool flash_brown_out_low(void)
{
    return flash_cells_brown_out_low();
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
    const bool good = (FLASH->SR & FLASH_CELLS_ERRORS) == 0;
    FLASH->SR = FLASH_CELLS_ERRORS | FLASH_SR_EOP; /* cleared by writing 1 */
    return good;
}

/* One operation: `control` erases, or is FLASH_CR_PG and the words are programmed. */
IN_RAM static bool ram_operate(uint32_t control, volatile uint32_t *to,
                               const uint32_t words[FLASH_CELLS_WORDS])
{
    /* Without the caches, so that what is read back has been in the flash: a line that was read
     * before the sector was erased would take the new words by itself (3.6.5). */
    const uint32_t access = FLASH->ACR;
    FLASH->ACR = access & ~(uint32_t)(FLASH_ACR_ICEN | FLASH_ACR_DCEN);
    (void)ram_wait(POLLS_WORD); /* drops errors left behind by a debugger */
    FLASH->CR = control | FLASH_CELLS_CONTROL;
    bool good;
    if ((control & FLASH_CR_PG) != 0) {
        for (int i = 0; i < FLASH_CELLS_WORDS; i++) {
            to[i] = words[i];
        }
        good = ram_wait(POLLS_WORD);
        for (int i = 0; i < FLASH_CELLS_WORDS; i++) {
            good = good && to[i] == words[i];
        }
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
static flash_status_t operate(uint32_t control, volatile uint32_t *to,
                              const uint32_t words[FLASH_CELLS_WORDS])
{
    flash_status_t status = FLASH_BRIDGE_ON;
    uint32_t masked;
    __asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(masked)::"memory");
    if (!bridge_is_on()) {
        FLASH->KEYR = FLASH_UNLOCK_FIRST;
        FLASH->KEYR = FLASH_UNLOCK_SECOND;
        status = FLASH_OK;
        if (!ram_operate(control, to, words)) {
            status = (control & FLASH_CR_PG) != 0 ? FLASH_WRITE_FAILED : FLASH_ERASE_FAILED;
        }
    }
    __asm volatile("msr primask, %0" ::"r"(masked) : "memory");
    return status;
}

flash_status_t flash_erase(flash_sector_t sector)
{
    const flash_image_t whole = flash_sector(sector);
    const uint32_t units = flash_cells_erases(whole.size_bytes);
    flash_status_t status = FLASH_OK;
    for (uint32_t i = 0; i < units && status == FLASH_OK; i++) {
        status = operate(flash_cells_erase(sector, (uint32_t)(uintptr_t)whole.begin, i), 0, 0);
    }
    return status;
}

flash_status_t flash_program(flash_sector_t sector, uint32_t at_bytes, const void *words,
                             uint32_t size_bytes)
{
    const flash_image_t whole = flash_sector(sector);
    if (at_bytes > whole.size_bytes || size_bytes > whole.size_bytes - at_bytes ||
        at_bytes % FLASH_UNIT_BYTES != 0 || size_bytes % 4U != 0) {
        return FLASH_TOO_LARGE;
    }
    volatile uint32_t *const to =
        (volatile uint32_t *)((uintptr_t)whole.begin + (uintptr_t)at_bytes);
    const uint32_t *const from = (const uint32_t *)words;
    const uint32_t count = size_bytes / 4U;
    flash_status_t status = FLASH_OK;
    for (uint32_t i = 0; i < count && status == FLASH_OK; i += FLASH_CELLS_WORDS) {
        uint32_t cells[FLASH_CELLS_WORDS];
        for (uint32_t k = 0; k < FLASH_CELLS_WORDS; k++) {
            cells[k] = i + k < count ? from[i + k] : UINT32_MAX;
        }
        status = operate(FLASH_CR_PG, &to[i], cells);
    }
    return status;
}
