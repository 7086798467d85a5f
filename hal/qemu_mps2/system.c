/* SPDX-License-Identifier: Apache-2.0 */
/* Time, serial line, watchdog and flash of the emulated board. */
#include "../cortex_m/mpu.h"
#include "hal/crash.h"
#include "hal/flash.h"
#include "hal/serial.h"
#include "hal/time.h"
#include "hal/upcall.h"
#include "hal/watchdog.h"
#include "memory_map.h"
#include "provoke.h"
#include "semihost.h"
#include "vectors.h"

enum {
    TIMER_RUN = 0x9, /* enable, interrupt */
    UART_TRANSMIT_AND_RECEIVE = 0x3,
    UART_TRANSMIT_FULL = 0x1,
    UART_RECEIVE_FULL = 0x2,
    UART_DIVIDER_SMALLEST = 16,
    MILLISECOND_PRIORITY = 0x80,
    RUN_ms_DEFAULT = 500, /* run_ms=NUMBER on the command line overrides it */
    WATCHDOG_INTERRUPT = 1
};

extern const uint32_t link_image_begin[], link_image_end[], link_image_crc32[];
extern const uint32_t link_configuration_begin[], link_configuration_end[];
extern uint32_t link_guard_begin[];

static volatile uint32_t milliseconds;
static uint32_t run_ms;
static uint32_t crashes_at_start;

/* Flash is not written and RAM not executed. */
static void protect_memory(void)
{
    const mpu_region_t regions[] = {
        {(const void *)0U, MPU_READ_ONLY | MPU_SIZE(22U)},
        {(const void *)0x20000000U, MPU_READ_WRITE | MPU_NO_EXECUTE | MPU_SIZE(22U)},
        {link_guard_begin, MPU_NO_ACCESS | MPU_NO_EXECUTE | MPU_SIZE(5U)},
    };
    mpu_start(regions, sizeof regions / sizeof regions[0]);
}

bool time_init(void)
{
    protect_memory();
    provoke_init();
    const crash_record_t *crash = crash_record();
    crashes_at_start = crash != 0 ? crash->value[CRASH_COUNT] : 0U;
    run_ms = semihost_option("run_ms", RUN_ms_DEFAULT);
    return semihost_option("clock_fault", 0) == 0;
}

void time_start_tick(void)
{
    CMSDK_TIMER0->RELOAD = PROCESSOR_CLOCK_Hz / 1000 - 1;
    CMSDK_TIMER0->VALUE = PROCESSOR_CLOCK_Hz / 1000 - 1;
    CMSDK_TIMER0->CTRL =
        semihost_option("tick_fault", 0) == 0 ? TIMER_RUN : 0; /* tick_fault=1: a dead timer */
    NVIC_IPR[INTERRUPT_TIMER0] = MILLISECOND_PRIORITY;
    NVIC_ISER[0] = 1U << INTERRUPT_TIMER0;
}

void timer0_handler(void)
{
    CMSDK_TIMER0->INTCLEAR = 1;
    milliseconds = milliseconds + 1U;
    app_millisecond_isr();
}

uint32_t time_ms(void)
{
    return milliseconds;
}

uint32_t time_cycles(void)
{
    return 0; /* QEMU counts no cycles */
}

bool time_running(void)
{
    provoke_now();
    return milliseconds < run_ms;
}

void serial_init(uint32_t bit_rate)
{
    const uint32_t divider = PROCESSOR_CLOCK_Hz / bit_rate;
    CMSDK_UART0->BAUDDIV = divider < UART_DIVIDER_SMALLEST ? UART_DIVIDER_SMALLEST : divider;
    CMSDK_UART0->CTRL = UART_TRANSMIT_AND_RECEIVE;
}

uint32_t serial_write(const char *bytes, uint32_t size)
{
    uint32_t accepted = 0;
    while (accepted < size && (CMSDK_UART0->STATE & UART_TRANSMIT_FULL) == 0) {
        CMSDK_UART0->DATA = (uint8_t)bytes[accepted];
        accepted++;
    }
    return accepted;
}

bool serial_read(uint8_t *byte)
{
    if ((CMSDK_UART0->STATE & UART_RECEIVE_FULL) == 0) {
        return false;
    }
    *byte = (uint8_t)CMSDK_UART0->DATA;
    return true;
}

/* The watchdog's interrupt is the NMI. A board would start anew; so does this after a crash, and
 * any other starved watchdog fails the run. */
void watchdog_start(uint32_t timeout_ms)
{
    *CMSDK_WATCHDOG_LOCK = CMSDK_WATCHDOG_UNLOCK;
    CMSDK_WATCHDOG->LOAD = timeout_ms * (PROCESSOR_CLOCK_Hz / 1000);
    CMSDK_WATCHDOG->CTRL = WATCHDOG_INTERRUPT;
}

void watchdog_feed(void)
{
    CMSDK_WATCHDOG->INTCLR = 1; /* also loads the counter anew */
}

void watchdog_handler(void)
{
    const crash_record_t *crash = crash_record();
    if (crash != 0 && crash->value[CRASH_COUNT] != crashes_at_start) {
        *SCB_AIRCR = SCB_AIRCR_RESET;
    }
    semihost_print("watchdog: not fed in time\n");
    semihost_exit(false);
}

reset_cause_t watchdog_reset_cause(void)
{
    return RESET_UNKNOWN;
}

static flash_image_t between(const uint32_t *begin, const uint32_t *end)
{
    const flash_image_t image = {begin, (uint32_t)((uintptr_t)end - (uintptr_t)begin)};
    return image;
}

flash_image_t flash_sector(flash_sector_t sector)
{
    return sector == FLASH_CONFIGURATION_A
               ? between(link_configuration_begin, link_configuration_end)
               : between(link_configuration_end, link_configuration_end);
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
    return false;
}

flash_status_t flash_erase(flash_sector_t sector)
{
    (void)sector;
    return FLASH_UNSUPPORTED;
}

flash_status_t flash_program(flash_sector_t sector, uint32_t at_bytes, const void *words,
                             uint32_t size_bytes)
{
    (void)sector;
    (void)at_bytes;
    (void)words;
    (void)size_bytes;
    return FLASH_UNSUPPORTED;
}
