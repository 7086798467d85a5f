/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Frames of 16 bits, most significant first: read bit, four bits of address, eleven of data. The
 * driver takes SDI at the falling edge of the clock and changes SDO at the rising one; the answer
 * to a frame comes in the next. Section numbers are those of SLOS719.
 *
 * A driver without any line of its own is left alone. A DRV8302 has no bus: a short low pulse at
 * its enable pin releases its latch (7.4.1 of SLES267).
 */
#include "gate_driver.h"

#include "clock.h"
#include "hal/inverter.h"
#include "interrupts.h"
#include "registers/power.h"
#include "registers/rcc.h"
#include "registers/syscfg.h"
#include "wait.h"

enum { /* 7.6: addresses, fields */
       STATUS_1 = 0,
       STATUS_2 = 1,
       CONTROL_1 = 2,
       CONTROL_2 = 3,
       READ = 1 << 15,
       ADDRESS_Pos = 11,
       DATA = 0x7FF,
       GATE_RESET = 1 << 2,
       LATCHED_SHUTDOWN = 1 << 4, /* OCP_MODE */
       OC_ADJ_SET_Pos = 6,
       SWITCH_BITS = 0x3FF, /* of status 1: as hal/inverter.h has them */
       GVDD_OV = 1 << 7,    /* of status 2 */
       /* Gate current 1.7 A, six PWM inputs: zero. */
       CONTROL_1_VALUE = BOARD_DRIVER_V_DS_CODE << OC_ADJ_SET_Pos | LATCHED_SHUTDOWN,
       CONTROL_2_VALUE = 0 /* nOCTW is not wired; the amplifiers are not used */
};
enum {
    POLLS_START = 340000, /* 10 ms: t_SPI_READY (6.9) */
    POLLS_FAULT = 600000, /* 20 ms: it holds its fault line down while it starts */
    POLLS_HALF_CLOCK = 4, /* 0.12 us; the whole clock needs 0.1 us */
    POLLS_BETWEEN = 20,   /* 0.6 us; nSCS has to be high for 0.4 us between frames */
    POLLS_RELEASE = 80,   /* 2.4 us at least */
    RELEASE_MOST_us = 10  /* a longer pulse may switch the gate supply off as well */
};
_Static_assert(POLLS_RELEASE *WAIT_POLL_CYCLES_MOST < RELEASE_MOST_us * (CLOCK_CORE_Hz / 1000000),
               "a pulse that only releases the latch");

static bool has_bus(void)
{
    return BOARD_DRIVER_KIND == BOARD_DRIVER_DRV8301;
}

/* At least so many times 30 ns (wait.h). */
static void pause_for(uint32_t polls)
{
    (void)wait_for(&BOARD_DRIVER_FAULT.port->IDR, 0, 1, polls);
}

static uint32_t exchange(uint32_t frame)
{
    uint32_t answer = 0;
    gpio_write(BOARD_DRIVER_SELECT, false);
    pause_for(POLLS_HALF_CLOCK);
    for (uint32_t bit = 1U << 15; bit != 0; bit >>= 1) {
        gpio_write(BOARD_DRIVER_SDI, (frame & bit) != 0);
        gpio_write(BOARD_DRIVER_CLOCK, true);
        pause_for(POLLS_HALF_CLOCK);
        answer |= gpio_read(BOARD_DRIVER_SDO) ? bit : 0U;
        gpio_write(BOARD_DRIVER_CLOCK, false);
        pause_for(POLLS_HALF_CLOCK);
    }
    gpio_write(BOARD_DRIVER_SELECT, true);
    pause_for(POLLS_BETWEEN);
    return answer;
}

/* The second frame only fetches the answer; reading a control register changes nothing. */
static uint32_t read_register(uint32_t address)
{
    (void)exchange(READ | address << ADDRESS_Pos);
    return exchange(READ | (uint32_t)CONTROL_1 << ADDRESS_Pos) & DATA;
}

static bool write_register(uint32_t address, uint32_t value)
{
    (void)exchange(address << ADDRESS_Pos | value);
    return read_register(address) == value;
}

/* A bus that is stuck at either level cannot answer with the value of control register 1. */
static bool configure(void)
{
    const bool first = write_register(CONTROL_1, CONTROL_1_VALUE);
    const bool second = write_register(CONTROL_2, CONTROL_2_VALUE);
    return first && second;
}

bool gate_driver_start(void)
{
    if (!GATE_DRIVER_IS_WIRED) {
        return true;
    }
    gpio_make_input(BOARD_DRIVER_FAULT, GPIO_PULL_UP);
    if (has_bus()) {
        gpio_make_output(BOARD_DRIVER_SELECT, true);
        gpio_make_output(BOARD_DRIVER_CLOCK, false);
        gpio_make_output(BOARD_DRIVER_SDI, false);
        gpio_make_input(BOARD_DRIVER_SDO, GPIO_PULL_UP);
    }
    gpio_make_output(BOARD_DRIVER_ENABLE, true);
    pause_for(POLLS_START);
    /* A driver that stays in fault is not an error here: inverter_fault() reports it. */
    (void)wait_for(&BOARD_DRIVER_FAULT.port->IDR, 1U << BOARD_DRIVER_FAULT.number,
                   1U << BOARD_DRIVER_FAULT.number, POLLS_FAULT);
    return !has_bus() || configure();
}

void gate_driver_watch(void)
{
    if (!GATE_DRIVER_IS_WIRED) {
        return;
    }
    const uint32_t line = BOARD_DRIVER_FAULT.number;
    const uint32_t port = (uint32_t)(((uintptr_t)BOARD_DRIVER_FAULT.port - (uintptr_t)GPIOA) /
                                     ((uintptr_t)GPIOB - (uintptr_t)GPIOA));
    RCC->APB2ENR |= RCC_APB2ENR_SYSCFGEN;
    (void)RCC->APB2ENR;
    volatile uint32_t *const source = &SYSCFG->EXTICR1 + line / 4U;
    const uint32_t shift = 4U * (line % 4U);
    *source = (*source & ~(0xFU << shift)) | port << shift;
    EXTI->FTSR |= 1U << line;
    EXTI->PR = 1U << line;
    EXTI->IMR |= 1U << line;
    interrupts_enable(line < 10U ? INTERRUPT_PINS_5_TO_9 : INTERRUPT_PINS_10_TO_15,
                      PRIORITY_DRIVER_FAULT);
}

void gate_driver_acknowledge(void)
{
    EXTI->PR = 1U << BOARD_DRIVER_FAULT.number;
}

bool gate_driver_recover(uint32_t *status)
{
    if (!has_bus()) {
        *status = 0;
        return true;
    }
    *status = (read_register(STATUS_1) & SWITCH_BITS) |
              ((read_register(STATUS_2) & GVDD_OV) != 0 ? INVERTER_DRIVER_GATE_SUPPLY_HIGH : 0U);
    (void)exchange((uint32_t)CONTROL_1 << ADDRESS_Pos | CONTROL_1_VALUE | GATE_RESET);
    const bool good = configure();
    *status |= good ? 0U : INVERTER_DRIVER_LOST;
    return good;
}

/* Without interrupts, which would make the pulse longer. */
void gate_driver_release(void)
{
    if (has_bus() || !gate_driver_pulls_fault()) {
        return;
    }
    uint32_t masked;
    __asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(masked)::"memory");
    gpio_write(BOARD_DRIVER_ENABLE, false);
    pause_for(POLLS_RELEASE);
    gpio_write(BOARD_DRIVER_ENABLE, true);
    __asm volatile("msr primask, %0" ::"r"(masked) : "memory");
}
