/* SPDX-License-Identifier: Apache-2.0 */
/*
 * USART3 (RM0090 section 30.3). Received bytes come by interrupt into a ring; bytes to send are
 * handed over one at a time as the line takes them, because their source is the background's own
 * buffer.
 */
#include "hal/serial.h"

#include "board.h"
#include "clock.h"
#include "interrupts.h"
#include "registers/rcc.h"
#include "registers/usart.h"
#include "ring.h"
#include "vectors.h"

static ring_t incoming;

void serial_init(uint32_t bit_rate)
{
    gpio_init();
    gpio_make_alternate(BOARD_SERIAL_TRANSMIT, BOARD_AF_USART3, GPIO_PULL_UP);
    gpio_make_alternate(BOARD_SERIAL_RECEIVE, BOARD_AF_USART3, GPIO_PULL_UP);
    RCC->APB1ENR |= RCC_APB1ENR_USART3EN;
    (void)RCC->APB1ENR;
    /* 16 samples a bit: the register holds the divider in sixteenths, which is clock / rate
     * (30.3.4). */
    USART3->BRR = (clock_apb1_Hz() + bit_rate / 2U) / bit_rate;
    USART3->CR1 = USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE;
    interrupts_enable(INTERRUPT_USART3, PRIORITY_SERIAL);
}

void usart3_handler(void)
{
    if ((USART3->SR & (USART_SR_RXNE | USART_SR_ORE)) != 0) {
        (void)ring_put(&incoming, (uint8_t)USART3->DR); /* reading clears the overrun as well */
    }
}

uint32_t serial_write(const char *bytes, uint32_t size)
{
    uint32_t accepted = 0;
    while (accepted < size && (USART3->SR & USART_SR_TXE) != 0) {
        USART3->DR = (uint8_t)bytes[accepted];
        accepted++;
    }
    return accepted;
}

bool serial_read(uint8_t *byte)
{
    return ring_get(&incoming, byte);
}
