/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The chip's generator (RM0090 section 24): analogue noise of ring oscillators, clocked with 48 MHz
 * from the crystal's PLL. Its own monitors watch clock and seed; a value equal to the one before is
 * refused here, as section 24.3.1 asks. On the internal oscillator there is no 48 MHz: nothing is
 * drawn then. The maker names no entropy per bit.
 */
#include "hal/random.h"

#include "registers/rcc.h"
#include "registers/rng.h"
#include "wait.h"

enum { LOOKS = 200 /* a value takes 40 periods of 48 MHz, 0.8 us */ };

static bool next_word(uint32_t *word)
{
    const uint32_t errors = RNG_SR_CECS | RNG_SR_SECS | RNG_SR_CEIS | RNG_SR_SEIS;
    if (!wait_for(&RNG->SR, RNG_SR_DRDY | errors, RNG_SR_DRDY, LOOKS)) {
        return false;
    }
    const uint32_t before = *word;
    *word = RNG->DR;
    return *word != before;
}

bool random_draw(uint64_t *bits)
{
    RCC->AHB2ENR |= RCC_AHB2ENR_RNGEN;
    (void)RCC->AHB2ENR;
    RNG->SR = 0; /* errors of before */
    RNG->CR = RNG_CR_RNGEN;
    uint32_t word = 0; /* the first value is only compared with */
    bool good = next_word(&word);
    good = next_word(&word) && good;
    const uint32_t low = word;
    good = next_word(&word) && good;
    RNG->CR = 0;
    *bits = low | (uint64_t)word << 32;
    return good;
}
