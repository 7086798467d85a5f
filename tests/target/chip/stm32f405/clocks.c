/* SPDX-License-Identifier: Apache-2.0 */
/* Clocks and their enable bits (RM0090 section 7), a crystal that stops (7.2.7), supply detector
 * (5.2.3), external interrupt 16, wait states of the flash (3.5.1). */
#include "parts.h"

enum {
    TICKS_INTERNAL = 21, /* 16 MHz */
    TICKS_AT_168_MHZ = 2,
    TICKS_PLL_INPUT = 336, /* 1 MHz */
    CRYSTAL_START_us = 2000,
    PLL_LOCK_us = 200,
    CRYSTAL_HZ = 8000000,
    MOST_VCO_MHZ = 432,
    LEAST_VCO_MHZ = 100,
    MHZ_PER_WAIT_STATE = 30 /* table 10, at 2.7 to 3.6 V */
};

/* Which bit lets a peripheral's registers be used. */
typedef struct {
    uint32_t first, last, enable_register, bit;
} gate_t;
static const gate_t GATES[] = {
    {CHIP_GPIOA_MODER, CHIP_GPIOA_AFRH, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_GPIOAEN},
    {CHIP_GPIOB_MODER, CHIP_GPIOB_AFRH, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_GPIOBEN},
    {CHIP_GPIOC_MODER, CHIP_GPIOC_AFRH, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_GPIOCEN},
    {CHIP_GPIOD_MODER, CHIP_GPIOD_AFRH, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_GPIODEN},
    {CHIP_SYSCFG_MEMRM, CHIP_SYSCFG_EXTICR4, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_SYSCFGEN},
    {CHIP_TIM1_CR1, CHIP_TIM1_DMAR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_TIM1EN},
    {CHIP_TIM8_CR1, CHIP_TIM8_DMAR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_TIM8EN},
    {CHIP_TIM3_CR1, CHIP_TIM3_DMAR, CHIP_RCC_APB1ENR, CHIP_RCC_APB1ENR_TIM3EN},
    {CHIP_ADC1_SR, CHIP_ADC1_DR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_ADC1EN},
    {CHIP_ADC2_SR, CHIP_ADC2_DR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_ADC2EN},
    {CHIP_ADC3_SR, CHIP_ADC3_DR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_ADC3EN},
    {CHIP_CAN1_MCR, CHIP_CAN1_F27R2, CHIP_RCC_APB1ENR, CHIP_RCC_APB1ENR_CAN1EN},
    {CHIP_USART3_SR, CHIP_USART3_GTPR, CHIP_RCC_APB1ENR, CHIP_RCC_APB1ENR_USART3EN},
    {CHIP_DMA1_LISR, CHIP_DMA1_S7FCR, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_DMA1EN},
    {CHIP_DMA2_LISR, CHIP_DMA2_S7FCR, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_DMA2EN},
    {CHIP_RNG_CR, CHIP_RNG_DR, CHIP_RCC_AHB2ENR, CHIP_RCC_AHB2ENR_RNGEN},
    {CHIP_PWR_CR, CHIP_PWR_CSR, CHIP_RCC_APB1ENR, CHIP_RCC_APB1ENR_PWREN},
};

bool chip_has_clock(const chip_t *chip, uint32_t address)
{
    for (unsigned i = 0; i < sizeof GATES / sizeof GATES[0]; i++) {
        if (address >= GATES[i].first && address <= GATES[i].last) {
            return (chip_get(chip, GATES[i].enable_register) & GATES[i].bit) != 0;
        }
    }
    return true;
}

/* Flags of RCC_CSR (7.3.21). Every reset pulls the pin; they last until RMVF or the supply goes. */
static uint32_t reset_flags(chip_reset_t cause, uint32_t status)
{
    static const uint32_t FLAGS[CHIP_RESETS] = {
        [CHIP_RESET_SUPPLY] = CHIP_RCC_CSR_PORRSTF | CHIP_RCC_CSR_BORRSTF,
        [CHIP_RESET_BROWN_OUT] = CHIP_RCC_CSR_BORRSTF,
        [CHIP_RESET_WATCHDOG] = CHIP_RCC_CSR_WDGRSTF,
        [CHIP_RESET_WINDOW_WATCHDOG] = CHIP_RCC_CSR_WWDGRSTF,
        [CHIP_RESET_LOW_POWER] = CHIP_RCC_CSR_LPWRRSTF,
        [CHIP_RESET_PROGRAM] = CHIP_RCC_CSR_SFTRSTF,
    };
    const uint32_t before = cause == CHIP_RESET_SUPPLY ? 0U : status & 0xFE000000U;
    return before | FLAGS[cause] | CHIP_RCC_CSR_PADRSTF;
}

void chip_clocks_reset(chip_t *chip, chip_reset_t cause, uint32_t status)
{
    chip->ticks_per_cycle = TICKS_INTERNAL;
    chip->crystal_ready = CHIP_NEVER;
    chip->pll_ready = CHIP_NEVER;
    chip->watchdog_end = CHIP_NEVER;
    *chip_at(chip, CHIP_RCC_CSR) = reset_flags(cause, status);
}

static uint32_t control(const chip_t *chip)
{
    uint32_t value = chip_get(chip, CHIP_RCC_CR) & ~(CHIP_RCC_CR_HSERDY | CHIP_RCC_CR_PLLRDY);
    value |= chip->now >= chip->crystal_ready ? CHIP_RCC_CR_HSERDY : 0;
    value |= chip->now >= chip->pll_ready ? CHIP_RCC_CR_PLLRDY : 0;
    return value;
}

static uint32_t clock_source(const chip_t *chip)
{
    return chip_field(chip, CHIP_RCC_CFGR, CHIP_RCC_CFGR_SW0 | CHIP_RCC_CFGR_SW1);
}

static bool runs_on_pll(const chip_t *chip)
{
    return clock_source(chip) == 2U && chip->now >= chip->pll_ready;
}

static bool supply_is_low(const chip_t *chip)
{
    return chip->fault.supply_low && chip_field(chip, CHIP_PWR_CR, CHIP_PWR_CR_PVDE) != 0;
}

uint32_t chip_clocks_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    const uint32_t status_bits = CHIP_RCC_CFGR_SWS0 | CHIP_RCC_CFGR_SWS1;
    switch (address) {
    case CHIP_RCC_CR:
        return control(chip);
    case CHIP_RCC_CFGR:
        return (value & ~status_bits) | (runs_on_pll(chip) ? CHIP_RCC_CFGR_SWS1 : 0);
    case CHIP_PWR_CSR:
        return (value & ~CHIP_PWR_CSR_PVDO) | (supply_is_low(chip) ? CHIP_PWR_CSR_PVDO : 0);
    default:
        return value;
    }
}

/* Ticks of a cycle of the PLL's output (7.3.2): 8 MHz / M x N / P. */
static uint32_t pll_ticks(chip_t *chip)
{
    const uint32_t settings = chip_get(chip, CHIP_RCC_PLLCFGR);
    const uint32_t m = settings & 0x3FU;
    const uint32_t n = settings >> 6 & 0x1FFU;
    const uint32_t p = 2U * ((settings >> 16 & 3U) + 1U);
    const bool from_crystal = (settings >> 22 & 1U) != 0;
    if (m < 2 || !from_crystal || CRYSTAL_HZ / m != 1000000 || n < LEAST_VCO_MHZ ||
        n > MOST_VCO_MHZ) {
        chip_note(chip, "PLL: M %u, N %u, from the %s", m, n, from_crystal ? "crystal" : "HSI");
        return TICKS_INTERNAL;
    }
    const uint32_t ticks = TICKS_PLL_INPUT * p / n;
    if (ticks < TICKS_AT_168_MHZ || ticks * n != TICKS_PLL_INPUT * p) {
        chip_note(chip, "PLL: %u MHz is above 168 MHz, or not modelled", n / p);
        return TICKS_AT_168_MHZ;
    }
    return ticks;
}

static void check_wait_states(chip_t *chip)
{
    const uint32_t mhz = TICKS_PLL_INPUT / chip->ticks_per_cycle;
    const uint32_t needed = (mhz + MHZ_PER_WAIT_STATE - 1U) / MHZ_PER_WAIT_STATE - 1U;
    if (chip_field(chip, CHIP_FLASH_ACR, CHIP_FLASH_ACR_LATENCY) < needed) {
        chip_note(chip, "flash read at %u MHz with %u of %u wait states", mhz,
                  chip_field(chip, CHIP_FLASH_ACR, CHIP_FLASH_ACR_LATENCY), needed);
    }
}

uint32_t chip_bus_ticks(const chip_t *chip, uint32_t prescaler_mask)
{
    const uint32_t code = chip_field(chip, CHIP_RCC_CFGR, prescaler_mask);
    return chip->ticks_per_cycle << (code < 4U ? 0U : code - 3U);
}

static void check_buses(chip_t *chip)
{
    const uint32_t first = chip_bus_ticks(chip, CHIP_RCC_CFGR_PPRE1);
    const uint32_t second = chip_bus_ticks(chip, CHIP_RCC_CFGR_PPRE2);
    if (first < 8U || second < 4U) { /* 42 and 84 MHz at most */
        chip_note(chip, "APB1 at %u MHz, APB2 at %u MHz", TICKS_PLL_INPUT / first,
                  TICKS_PLL_INPUT / second);
    }
}

static void switch_clock(chip_t *chip)
{
    if (clock_source(chip) == 2U && chip->now < chip->pll_ready) {
        chip_note(chip, "switched to a PLL that is not ready");
    }
    chip->ticks_per_cycle = runs_on_pll(chip) ? pll_ticks(chip) : TICKS_INTERNAL;
    check_wait_states(chip);
    check_buses(chip);
}

static void write_control(chip_t *chip, uint32_t value)
{
    const uint32_t before = chip_get(chip, CHIP_RCC_CR);
    *chip_at(chip, CHIP_RCC_CR) = value;
    if ((value & ~before & CHIP_RCC_CR_HSEON) != 0) {
        chip->crystal_ready = chip->fault.crystal_dead
                                  ? CHIP_NEVER
                                  : chip->now + (chip_ticks_t)CRYSTAL_START_us * CHIP_TICKS_PER_US;
    }
    if ((value & ~before & CHIP_RCC_CR_PLLON) != 0) {
        const bool locks = chip->now >= chip->crystal_ready && !chip->fault.pll_does_not_lock;
        chip->pll_ready =
            locks ? chip->now + (chip_ticks_t)PLL_LOCK_us * CHIP_TICKS_PER_US : CHIP_NEVER;
    }
}

bool chip_clocks_write(chip_t *chip, uint32_t address, uint32_t value)
{
    switch (address) {
    case CHIP_RCC_CR:
        write_control(chip, value);
        return true;
    case CHIP_RCC_PLLCFGR:
        if ((chip_get(chip, CHIP_RCC_CR) & CHIP_RCC_CR_PLLON) != 0) {
            chip_note(chip, "PLLCFGR written while the PLL runs");
            return true;
        }
        return false;
    case CHIP_RCC_CFGR:
        *chip_at(chip, address) = value;
        switch_clock(chip);
        return true;
    case CHIP_RCC_CIR: /* the flag is cleared by CSSC; the rest is not modelled */
        if ((value & CHIP_RCC_CIR_CSSC) != 0) {
            *chip_at(chip, address) &= ~CHIP_RCC_CIR_CSSF;
        }
        return true;
    case CHIP_RCC_CSR:
        if ((value & CHIP_RCC_CSR_RMVF) != 0) {
            *chip_at(chip, address) = 0;
        }
        return true;
    case CHIP_IWDG_KR:
    case CHIP_IWDG_PR:
    case CHIP_IWDG_RLR:
        return chip_watchdog_write(chip, address, value);
    case CHIP_EXTI_PR: /* cleared by writing 1 */
        *chip_at(chip, address) &= ~value;
        return true;
    default:
        return false;
    }
}

chip_ticks_t chip_clocks_next(chip_t *chip)
{
    return chip->watchdog_end;
}

/* 7.2.7: the oscillator and the PLL that it feeds are switched off, the core goes on with the
 * internal oscillator, and the flag is wired to the non-maskable interrupt. Without CSSON nothing
 * says so; the frequency of a PLL without input is not specified, and taken to be as low. */
static void watch_crystal(chip_t *chip)
{
    if (!chip->fault.crystal_dead || chip->crystal_ready > chip->now) {
        return;
    }
    chip->crystal_ready = CHIP_NEVER;
    chip->pll_ready = CHIP_NEVER;
    chip->ticks_per_cycle = TICKS_INTERNAL;
    if ((chip_get(chip, CHIP_RCC_CR) & CHIP_RCC_CR_CSSON) != 0) {
        *chip_at(chip, CHIP_RCC_CR) &= ~(CHIP_RCC_CR_HSEON | CHIP_RCC_CR_PLLON);
        *chip_at(chip, CHIP_RCC_CFGR) &= ~(CHIP_RCC_CFGR_SW0 | CHIP_RCC_CFGR_SW1);
        *chip_at(chip, CHIP_RCC_CIR) |= CHIP_RCC_CIR_CSSF;
        chip->needs_attention = true;
    }
}

void chip_clocks_events(chip_t *chip)
{
    chip_watchdog_events(chip);
    watch_crystal(chip);
    /* 5.2.3: an edge, of which there is none if the supply is low when the detector starts. */
    const bool low = supply_is_low(chip);
    const bool known = (chip_get(chip, CHIP_PWR_CSR) & CHIP_PWR_CSR_PVDO) != 0;
    if (low == known) {
        return;
    }
    *chip_at(chip, CHIP_PWR_CSR) ^= CHIP_PWR_CSR_PVDO;
    if (low && (chip_get(chip, CHIP_EXTI_RTSR) & CHIP_EXTI_RTSR_TR16) != 0) {
        *chip_at(chip, CHIP_EXTI_PR) |= CHIP_EXTI_PR_PR16;
        chip->needs_attention = true;
    }
}
