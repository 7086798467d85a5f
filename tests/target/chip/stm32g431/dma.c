/* SPDX-License-Identifier: Apache-2.0 */
/* DMA1 (RM0440 section 12) and the multiplexer of its requests (13) with those of USART2, bytes,
 * and with that of TIM8's update, words. */
#include "parts.h"

enum { CHANNELS = 8, REGISTERS_OF_A_CHANNEL = 0x14, FLAGS_OF_A_CHANNEL = 4 };
enum { USART2_RX = 26, USART2_TX = 27, TIM8_UP = 53 }; /* table 91 */
enum { WORDS = CHIP_DMA1_CCR1_MSIZE / 3 * 2 + CHIP_DMA1_CCR1_PSIZE / 3 * 2 };

static uint32_t of(unsigned channel, uint32_t address_in_1)
{
    return address_in_1 + REGISTERS_OF_A_CHANNEL * channel;
}

static bool is_enabled(const chip_t *chip, unsigned channel)
{
    return (chip_get(chip, of(channel, CHIP_DMA1_CCR1)) & CHIP_DMA1_CCR1_EN) != 0;
}

static void write_control(chip_t *chip, unsigned channel, uint32_t value)
{
    const uint32_t protected = CHIP_DMA1_CCR1_MEM2MEM | CHIP_DMA1_CCR1_MSIZE |
                               CHIP_DMA1_CCR1_PSIZE | CHIP_DMA1_CCR1_MINC | CHIP_DMA1_CCR1_PINC |
                               CHIP_DMA1_CCR1_CIRC | CHIP_DMA1_CCR1_DIR; /* 12.6.3 */
    uint32_t *control = chip_at(chip, of(channel, CHIP_DMA1_CCR1));
    if (is_enabled(chip, channel) && ((*control ^ value) & protected) != 0) {
        chip_note(chip, "DMA1 channel %u: control changed while it is enabled", channel + 1U);
        return;
    }
    if (!is_enabled(chip, channel) && (value & CHIP_DMA1_CCR1_EN) != 0) {
        const uint32_t sizes = value & (CHIP_DMA1_CCR1_MSIZE | CHIP_DMA1_CCR1_PSIZE);
        const bool word = sizes == WORDS && (value & CHIP_DMA1_CCR1_DIR) != 0;
        if ((sizes != 0 && !word) ||
            (value & (CHIP_DMA1_CCR1_PINC | CHIP_DMA1_CCR1_MEM2MEM)) != 0) {
            chip_note(chip, "DMA1 channel %u: control 0x%08X is not modelled", channel + 1U, value);
        }
        chip->dma.size[channel] = chip_get(chip, of(channel, CHIP_DMA1_CNDTR1));
    }
    *control = value;
}

bool chip_dma_write(chip_t *chip, uint32_t address, uint32_t value)
{
    if (address >= CHIP_DMAMUX_C0CR) {
        if ((value & ~CHIP_DMAMUX_C0CR_DMAREQ_ID) != 0) {
            chip_note(chip, "DMAMUX: 0x%08X is not modelled", value);
        }
        return false;
    }
    if (address == CHIP_DMA1_IFCR) {
        *chip_at(chip, CHIP_DMA1_ISR) &= ~value;
        return true;
    }
    const unsigned channel = (address - CHIP_DMA1_CCR1) / REGISTERS_OF_A_CHANNEL;
    if (address == of(channel, CHIP_DMA1_CCR1)) {
        write_control(chip, channel, value);
        return true;
    }
    if (is_enabled(chip, channel)) { /* 12.6.4 to 12.6.6 */
        chip_note(chip, "DMA1 channel %u: 0x%08X written while it is enabled", channel + 1U,
                  address);
        return true;
    }
    return false;
}

uint32_t chip_dma_read(chip_t *chip, uint32_t address)
{
    return chip_get(chip, address);
}

/* One byte of the channel that listens to this request. */
static bool serve(chip_t *chip, uint32_t request)
{
    unsigned channel = 0;
    while (channel < CHANNELS && chip_field(chip, CHIP_DMAMUX_C0CR + 4U * channel,
                                            CHIP_DMAMUX_C0CR_DMAREQ_ID) != request) {
        channel++;
    }
    if (channel == CHANNELS || !is_enabled(chip, channel)) {
        return false;
    }
    const uint32_t control = chip_get(chip, of(channel, CHIP_DMA1_CCR1));
    uint32_t *left = chip_at(chip, of(channel, CHIP_DMA1_CNDTR1));
    if (*left == 0) {
        return false;
    }
    const uint32_t done = chip->dma.size[channel] - *left;
    const uint32_t peripheral = chip_get(chip, of(channel, CHIP_DMA1_CPAR1));
    const uint32_t memory = chip_get(chip, of(channel, CHIP_DMA1_CMAR1)) +
                            ((control & CHIP_DMA1_CCR1_MINC) != 0 ? done : 0U);
    if ((control & CHIP_DMA1_CCR1_MSIZE) != 0) {
        chip_dma_put_word(chip, peripheral, memory);
    } else {
        chip_dma_move(chip, peripheral, memory, (control & CHIP_DMA1_CCR1_DIR) == 0);
    }
    *left -= 1U;
    if (*left == 0) {
        *chip_at(chip, CHIP_DMA1_ISR) |= (CHIP_DMA1_ISR_TCIF1 | CHIP_DMA1_ISR_GIF1)
                                         << FLAGS_OF_A_CHANNEL * channel;
        *left = (control & CHIP_DMA1_CCR1_CIRC) != 0 ? chip->dma.size[channel] : 0U;
    }
    return true;
}

void chip_dma_serve(chip_t *chip)
{
    const uint32_t wanted = chip_get(chip, CHIP_USART2_CR3);
    bool moved = (chip_get(chip, CHIP_USART2_CR1) & CHIP_USART2_CR1_UE) != 0;
    while (moved) {
        const uint32_t serial = chip_get(chip, CHIP_USART2_ISR);
        moved = (serial & CHIP_USART2_ISR_RXNE) != 0 && (wanted & CHIP_USART2_CR3_DMAR) != 0 &&
                serve(chip, USART2_RX);
        if ((serial & CHIP_USART2_ISR_TXE) != 0 && (wanted & CHIP_USART2_CR3_DMAT) != 0) {
            moved = serve(chip, USART2_TX) || moved;
        }
    }
}

void chip_dma_serve_timer8(chip_t *chip)
{
    (void)serve(chip, TIM8_UP);
}
