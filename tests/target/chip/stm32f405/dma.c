/* SPDX-License-Identifier: Apache-2.0 */
/* DMA1 (RM0090 section 10) with the requests of USART3: bytes, direct mode, one memory. DMA2 with
 * that of TIM8's update: words, circular. */
#include "parts.h"

enum { STREAMS = 8, REGISTERS_OF_A_STREAM = 0x18, FLAGS_OF_A_STREAM = 0x3D };

/* Of stream 0; alike in the others. */
enum { EN = CHIP_DMA1_S0CR_EN, PROTECTED = (int)~(uint32_t)(EN | 0x1E) };

static uint32_t of(unsigned stream, uint32_t address_in_0)
{
    return address_in_0 + REGISTERS_OF_A_STREAM * stream;
}

/* Where a stream's flags are: low and high register, 0, 6, 16 or 22 (10.5.1). */
static uint32_t *status(chip_t *chip, unsigned stream)
{
    return chip_at(chip, stream < 4 ? CHIP_DMA1_LISR : CHIP_DMA1_HISR);
}

static uint32_t flags(unsigned stream, uint32_t of_stream_0)
{
    static const uint8_t PLACE[4] = {0, 6, 16, 22};
    return of_stream_0 << PLACE[stream % 4U];
}

/* 10.3.17: with a flag of the last transfer the stream is not enabled. */
static void enable(chip_t *chip, unsigned stream, uint32_t control)
{
    uint32_t *to = chip_at(chip, of(stream, CHIP_DMA1_S0CR));
    *to = control;
    if ((*status(chip, stream) & flags(stream, FLAGS_OF_A_STREAM)) != 0) {
        chip_note(chip, "DMA1 stream %u enabled with flags of its last transfer", stream);
        *to &= ~(uint32_t)EN;
    }
    if ((control & (CHIP_DMA1_S0CR_PSIZE | CHIP_DMA1_S0CR_MSIZE | CHIP_DMA1_S0CR_PINC |
                    CHIP_DMA1_S0CR_DBM | CHIP_DMA1_S0CR_PFCTRL)) != 0 ||
        chip_field(chip, of(stream, CHIP_DMA1_S0FCR), CHIP_DMA1_S0FCR_DMDIS) != 0) {
        chip_note(chip, "DMA1 stream %u: control 0x%08X is not modelled", stream, control);
    }
    chip->dma.size[stream] = chip_get(chip, of(stream, CHIP_DMA1_S0NDTR));
}

static void write_control(chip_t *chip, unsigned stream, uint32_t value)
{
    uint32_t *control = chip_at(chip, of(stream, CHIP_DMA1_S0CR));
    const bool was_on = (*control & EN) != 0;
    if (was_on && (value & EN) != 0 && ((*control ^ value) & (uint32_t)PROTECTED) != 0) {
        chip_note(chip, "DMA1 stream %u: control changed while it is enabled", stream);
    } else if (!was_on && (value & EN) != 0) {
        enable(chip, stream, value);
    } else {
        *control = value;
    }
}

bool chip_dma_write(chip_t *chip, uint32_t address, uint32_t value)
{
    switch (address) {
    case CHIP_DMA1_LIFCR:
        *chip_at(chip, CHIP_DMA1_LISR) &= ~value;
        return true;
    case CHIP_DMA1_HIFCR:
        *chip_at(chip, CHIP_DMA1_HISR) &= ~value;
        return true;
    default:
        break;
    }
    const unsigned stream = (address - CHIP_DMA1_S0CR) / REGISTERS_OF_A_STREAM;
    if (address == of(stream, CHIP_DMA1_S0CR)) {
        write_control(chip, stream, value);
        return true;
    }
    if ((chip_get(chip, of(stream, CHIP_DMA1_S0CR)) & EN) != 0) {
        chip_note(chip, "DMA1 stream %u: 0x%08X written while it is enabled", stream, address);
        return true;
    }
    return false;
}

uint32_t chip_dma_read(chip_t *chip, uint32_t address)
{
    return chip_get(chip, address);
}

/* One byte of a stream, if it listens to this channel, in the request's direction or not. */
static bool serve(chip_t *chip, unsigned stream, unsigned channel)
{
    uint32_t *control = chip_at(chip, of(stream, CHIP_DMA1_S0CR));
    uint32_t *left = chip_at(chip, of(stream, CHIP_DMA1_S0NDTR));
    if ((*control & EN) == 0 || *left == 0 ||
        chip_field(chip, of(stream, CHIP_DMA1_S0CR), CHIP_DMA1_S0CR_CHSEL) != channel) {
        return false;
    }
    enum { TO_MEMORY = 0, TO_PERIPHERAL = 1 };
    const uint32_t direction = chip_field(chip, of(stream, CHIP_DMA1_S0CR), CHIP_DMA1_S0CR_DIR);
    if (direction != TO_MEMORY && direction != TO_PERIPHERAL) {
        chip_note(chip, "DMA1 stream %u: from memory to memory by a request", stream);
        return false;
    }
    const uint32_t done = chip->dma.size[stream] - *left;
    chip_dma_move(chip, chip_get(chip, of(stream, CHIP_DMA1_S0PAR)),
                  chip_get(chip, of(stream, CHIP_DMA1_S0M0AR)) +
                      ((*control & CHIP_DMA1_S0CR_MINC) != 0 ? done : 0U),
                  direction == TO_MEMORY);
    *left -= 1U;
    if (*left == chip->dma.size[stream] / 2U) {
        *status(chip, stream) |= flags(stream, CHIP_DMA1_LISR_HTIF0);
    }
    if (*left == 0) {
        *status(chip, stream) |= flags(stream, CHIP_DMA1_LISR_TCIF0);
        if ((*control & CHIP_DMA1_S0CR_CIRC) != 0) {
            *left = chip->dma.size[stream];
        } else {
            *control &= ~(uint32_t)EN; /* by hardware (10.3.17) */
        }
    }
    return true;
}

/* Table 42, of USART3's requests. */
void chip_dma_serve(chip_t *chip)
{
    const uint32_t wanted = chip_get(chip, CHIP_USART3_CR3);
    const bool on = (chip_get(chip, CHIP_USART3_CR1) & CHIP_USART3_CR1_UE) != 0;
    bool moved = on;
    while (moved) {
        const uint32_t serial = chip_get(chip, CHIP_USART3_SR);
        moved = (serial & CHIP_USART3_SR_RXNE) != 0 && (wanted & CHIP_USART3_CR3_DMAR) != 0 &&
                serve(chip, 1, 4);
        if ((serial & CHIP_USART3_SR_TXE) != 0 && (wanted & CHIP_USART3_CR3_DMAT) != 0) {
            moved = serve(chip, 3, 4) || serve(chip, 4, 7) || moved;
        }
    }
}

/* Table 43. */
void chip_dma_serve_timer8(chip_t *chip)
{
    enum { CHANNEL = 7, TO_PERIPHERAL = 1, WORD = 2 };
    const uint32_t control = chip_get(chip, CHIP_DMA2_S1CR);
    if ((control & CHIP_DMA2_S1CR_EN) == 0 ||
        chip_field(chip, CHIP_DMA2_S1CR, CHIP_DMA2_S1CR_CHSEL) != CHANNEL) {
        return;
    }
    if (chip_field(chip, CHIP_DMA2_S1CR, CHIP_DMA2_S1CR_DIR) != TO_PERIPHERAL ||
        chip_field(chip, CHIP_DMA2_S1CR, CHIP_DMA2_S1CR_PSIZE) != WORD ||
        chip_field(chip, CHIP_DMA2_S1CR, CHIP_DMA2_S1CR_MSIZE) != WORD ||
        (control & CHIP_DMA2_S1CR_CIRC) == 0 || chip_get(chip, CHIP_DMA2_S1NDTR) != 1U ||
        chip_field(chip, CHIP_DMA2_S1FCR, CHIP_DMA2_S1FCR_DMDIS) != 0) {
        chip_note(chip, "DMA2 stream 1: control 0x%08X is not modelled", control);
        return;
    }
    chip_dma_put_word(chip, chip_get(chip, CHIP_DMA2_S1PAR), chip_get(chip, CHIP_DMA2_S1M0AR));
}
