/* SPDX-License-Identifier: Apache-2.0 */
/* Clocks and their enable bits (RM0440 section 7), core supply with boost and supply detector (6),
 * external interrupt 16, wait states of the flash (3.3.3). */
#include "parts.h"

enum {
    TICKS_MHZ = 1360,    /* of 1 MHz */
    TICKS_INTERNAL = 85, /* 16 MHz */
    CRYSTAL_MHZ = 8,
    CRYSTAL_START_us = 2000,
    PLL_LOCK_us = 40,
    SOURCE_INTERNAL = 1,
    SOURCE_PLL = 3,
    PLL_FROM_CRYSTAL = 3,
    BOOST_MHZ = 34,    /* a wait state more for each (table 9) */
    NO_BOOST_MHZ = 30, /* the same without */
    MOST_WITHOUT_BOOST_MHZ = 150,
    LARGEST_STEP_MHZ = 80, /* 7.2.7 */
    STEP_us = 1
};
/* The description's masks and reset values of these are another chip's (6.4.22, 7.4.1). */
static const uint32_t NO_BOOST = 1U << 8, CONTROL_AT_RESET = CHIP_RCC_CR_HSION | CHIP_RCC_CR_HSIRDY;

/* Which bit lets a peripheral's registers be used. */
typedef struct {
    uint32_t first, last, enable_register, bit;
} gate_t;
static const gate_t GATES[] = {
    {CHIP_GPIOA_MODER, CHIP_GPIOA_BRR, CHIP_RCC_AHB2ENR, CHIP_RCC_AHB2ENR_GPIOAEN},
    {CHIP_GPIOB_MODER, CHIP_GPIOB_BRR, CHIP_RCC_AHB2ENR, CHIP_RCC_AHB2ENR_GPIOBEN},
    {CHIP_GPIOC_MODER, CHIP_GPIOC_BRR, CHIP_RCC_AHB2ENR, CHIP_RCC_AHB2ENR_GPIOCEN},
    {CHIP_GPIOF_MODER, CHIP_GPIOF_BRR, CHIP_RCC_AHB2ENR, CHIP_RCC_AHB2ENR_GPIOFEN},
    {CHIP_ADC1_ISR, CHIP_ADC12_COMMON_CDR, CHIP_RCC_AHB2ENR, CHIP_RCC_AHB2ENR_ADC12EN},
    {CHIP_DAC3_DAC_CR, CHIP_DAC3_DAC_STMODR, CHIP_RCC_AHB2ENR, CHIP_RCC_AHB2ENR_DAC3EN},
    {CHIP_SYSCFG_MEMRMP, CHIP_OPAMP_OPAMP3_TCMR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_SYSCFGEN},
    {CHIP_TIM1_CR1, CHIP_TIM1_DMAR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_TIM1EN},
    {CHIP_TIM8_CR1, CHIP_TIM8_DMAR, CHIP_RCC_APB2ENR, CHIP_RCC_APB2ENR_TIM8EN},
    {CHIP_TIM4_CR1, CHIP_TIM4_DMAR, CHIP_RCC_APB1ENR1, CHIP_RCC_APB1ENR1_TIM4EN},
    {CHIP_USART2_CR1, CHIP_USART2_PRESC, CHIP_RCC_APB1ENR1, CHIP_RCC_APB1ENR1_USART2EN},
    {CHIP_FDCAN1_CREL, CHIP_FDCAN1_CKDIV, CHIP_RCC_APB1ENR1, CHIP_RCC_APB1ENR1_FDCANEN},
    {CHIP_FDCAN1_RAM_000, CHIP_FDCAN1_RAM_211, CHIP_RCC_APB1ENR1, CHIP_RCC_APB1ENR1_FDCANEN},
    {CHIP_DMA1_ISR, CHIP_DMA1_CMAR8, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_DMA1EN},
    {CHIP_DMAMUX_C0CR, CHIP_DMAMUX_RGCFR, CHIP_RCC_AHB1ENR, CHIP_RCC_AHB1ENR_DMAMUXEN},
    {CHIP_PWR_CR1, CHIP_PWR_CR5, CHIP_RCC_APB1ENR1, CHIP_RCC_APB1ENR1_PWREN},
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

/* Flags of RCC_CSR (7.4.28). Every reset pulls the pin; they last until RMVF or the supply goes. */
static uint32_t reset_flags(chip_reset_t cause, uint32_t status)
{
    static const uint32_t FLAGS[CHIP_RESETS] = {
        [CHIP_RESET_SUPPLY] = CHIP_RCC_CSR_BORRSTF,
        [CHIP_RESET_BROWN_OUT] = CHIP_RCC_CSR_BORRSTF,
        [CHIP_RESET_WATCHDOG] = CHIP_RCC_CSR_IWDGRSTF,
        [CHIP_RESET_WINDOW_WATCHDOG] = CHIP_RCC_CSR_WWDGRSTF,
        [CHIP_RESET_LOW_POWER] = CHIP_RCC_CSR_LPWRSTF,
        [CHIP_RESET_PROGRAM] = CHIP_RCC_CSR_SFTRSTF,
        [CHIP_RESET_OPTION_BYTES] = CHIP_RCC_CSR_OBLRSTF,
    };
    const uint32_t before = cause == CHIP_RESET_SUPPLY ? 0U : status & 0xFE000000U;
    return before | FLAGS[cause] | CHIP_RCC_CSR_PINRSTF;
}

void chip_clocks_reset(chip_t *chip, chip_reset_t cause, uint32_t status)
{
    chip->ticks_per_cycle = TICKS_INTERNAL;
    chip->crystal_ready = CHIP_NEVER;
    chip->pll_ready = CHIP_NEVER;
    chip->watchdog_end = CHIP_NEVER;
    chip->stepped = 0;
    *chip_at(chip, CHIP_RCC_CR) = CONTROL_AT_RESET;
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
    return chip_field(chip, CHIP_RCC_CFGR, CHIP_RCC_CFGR_SW);
}

static bool runs_on_pll(const chip_t *chip)
{
    return clock_source(chip) == SOURCE_PLL && chip->now >= chip->pll_ready;
}

static bool supply_is_low(const chip_t *chip)
{
    return chip->fault.supply_low && chip_field(chip, CHIP_PWR_CR2, CHIP_PWR_CR2_PVDE) != 0;
}

uint32_t chip_clocks_read(chip_t *chip, uint32_t address)
{
    const uint32_t value = chip_get(chip, address);
    switch (address) {
    case CHIP_RCC_CR:
        return control(chip);
    case CHIP_RCC_CFGR:
        return (value & ~CHIP_RCC_CFGR_SWS) |
               (runs_on_pll(chip) ? SOURCE_PLL : SOURCE_INTERNAL) * 4U;
    case CHIP_PWR_SR2:
        return (value & ~CHIP_PWR_SR2_PVDO) | (supply_is_low(chip) ? CHIP_PWR_SR2_PVDO : 0);
    default:
        return value;
    }
}

/* Ticks of a cycle of the PLL's output R (7.4.4): 8 MHz / M x N / R. */
static uint32_t pll_ticks(chip_t *chip)
{
    const uint32_t m = chip_field(chip, CHIP_RCC_PLLCFGR, CHIP_RCC_PLLCFGR_PLLM) + 1U;
    const uint32_t n = chip_field(chip, CHIP_RCC_PLLCFGR, CHIP_RCC_PLLCFGR_PLLN);
    const uint32_t r = 2U * (chip_field(chip, CHIP_RCC_PLLCFGR, CHIP_RCC_PLLCFGR_PLLR) + 1U);
    const bool fed =
        chip_field(chip, CHIP_RCC_PLLCFGR, CHIP_RCC_PLLCFGR_PLLSRC) == PLL_FROM_CRYSTAL &&
        (chip_get(chip, CHIP_RCC_PLLCFGR) & CHIP_RCC_PLLCFGR_PLLREN) != 0;
    /* Input 2.66 to 16 MHz, oscillator 96 to 344 MHz (data sheet, PLL in range 1). */
    const bool in_range =
        100U * CRYSTAL_MHZ >= 266U * m && CRYSTAL_MHZ * n >= 96U * m && CRYSTAL_MHZ * n <= 344U * m;
    if (!fed || n < 8 || !in_range) {
        chip_note(chip, "PLL: M %u, N %u, %s", m, n, fed ? "crystal" : "no source or output");
        return TICKS_INTERNAL;
    }
    const uint32_t ticks = TICKS_MHZ * r * m / (CRYSTAL_MHZ * n);
    if (ticks < TICKS_MHZ / 170U || ticks * CRYSTAL_MHZ * n != TICKS_MHZ * r * m) {
        chip_note(chip, "PLL: above 170 MHz, or not modelled");
        return TICKS_MHZ / 170U;
    }
    return ticks;
}

static bool is_boosted(const chip_t *chip)
{
    return (chip_get(chip, CHIP_PWR_CR5) & NO_BOOST) == 0;
}

static void check_speed(chip_t *chip)
{
    const uint32_t mhz = TICKS_MHZ / chip->ticks_per_cycle;
    const uint32_t each = is_boosted(chip) ? BOOST_MHZ : NO_BOOST_MHZ;
    const uint32_t needed = (mhz + each - 1U) / each - 1U;
    if (chip_field(chip, CHIP_FLASH_ACR, CHIP_FLASH_ACR_LATENCY) < needed) {
        chip_note(chip, "flash read at %u MHz with %u of %u wait states", mhz,
                  chip_field(chip, CHIP_FLASH_ACR, CHIP_FLASH_ACR_LATENCY), needed);
    }
    if (!is_boosted(chip) && mhz > MOST_WITHOUT_BOOST_MHZ) {
        chip_note(chip, "%u MHz without boost", mhz);
    }
}

uint32_t chip_bus_ticks(const chip_t *chip, uint32_t prescaler_mask)
{
    const uint32_t code = chip_field(chip, CHIP_RCC_CFGR, prescaler_mask);
    return chip->ticks_per_cycle << (code < 4U ? 0U : code - 3U);
}

static uint32_t core_divider(const chip_t *chip)
{
    static const uint16_t DIVIDER[8] = {2, 4, 8, 16, 64, 128, 256, 512};
    const uint32_t code = chip_field(chip, CHIP_RCC_CFGR, CHIP_RCC_CFGR_HPRE);
    return code < 8U ? 1U : DIVIDER[code - 8U];
}

/* 7.2.7: above 80 MHz the core gets half the frequency first, for a microsecond. */
static void check_step(chip_t *chip, uint32_t ticks_before)
{
    const uint32_t before = TICKS_MHZ / ticks_before;
    const uint32_t after = TICKS_MHZ / chip->ticks_per_cycle;
    if (after > LARGEST_STEP_MHZ && before <= TICKS_MHZ / TICKS_INTERNAL &&
        core_divider(chip) == 1U) {
        chip_note(chip, "the core's clock steps from %u to %u MHz", before, after);
    }
    if (after > 2U * LARGEST_STEP_MHZ && chip->now < chip->stepped + STEP_us * CHIP_TICKS_PER_US) {
        chip_note(chip, "full frequency less than a microsecond after half of it");
    }
    chip->stepped = after != before ? chip->now : chip->stepped;
}

static void switch_clock(chip_t *chip)
{
    const uint32_t before = chip->ticks_per_cycle;
    const uint32_t source = clock_source(chip);
    if (source == SOURCE_PLL && chip->now < chip->pll_ready) {
        chip_note(chip, "switched to a PLL that is not ready");
    }
    if (source != SOURCE_PLL && source != SOURCE_INTERNAL) {
        chip_note(chip, "clock source %u is reserved or not modelled", source);
    }
    chip->ticks_per_cycle =
        (runs_on_pll(chip) ? pll_ticks(chip) : TICKS_INTERNAL) * core_divider(chip);
    check_speed(chip);
    check_step(chip, before);
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
    case CHIP_RCC_CSR:
        if ((value & CHIP_RCC_CSR_RMVF) != 0) {
            *chip_at(chip, address) = 0;
        }
        return true;
    case CHIP_RCC_CICR:
        *chip_at(chip, CHIP_RCC_CIFR) &= ~value;
        return true;
    case CHIP_PWR_CR5:
        *chip_at(chip, address) = value & NO_BOOST;
        return true;
    case CHIP_IWDG_KR:
    case CHIP_IWDG_PR:
    case CHIP_IWDG_RLR:
        return chip_watchdog_write(chip, address, value);
    case CHIP_EXTI_PR1: /* cleared by writing 1 */
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

/* 7.2.9: the core goes on with the internal oscillator, and the non-maskable interrupt comes. */
static void watch_crystal(chip_t *chip)
{
    const bool watched = (chip_get(chip, CHIP_RCC_CR) & CHIP_RCC_CR_CSSON) != 0;
    if (!chip->fault.crystal_dead || chip->crystal_ready > chip->now) {
        return;
    }
    chip->crystal_ready = CHIP_NEVER;
    chip->pll_ready = CHIP_NEVER;
    chip->ticks_per_cycle = TICKS_INTERNAL * core_divider(chip);
    if (watched) {
        *chip_at(chip, CHIP_RCC_CR) &= ~(CHIP_RCC_CR_HSEON | CHIP_RCC_CR_PLLON);
        *chip_at(chip, CHIP_RCC_CFGR) =
            (chip_get(chip, CHIP_RCC_CFGR) & ~CHIP_RCC_CFGR_SW) | SOURCE_INTERNAL;
        *chip_at(chip, CHIP_RCC_CIFR) |= CHIP_RCC_CIFR_CSSF;
        chip_pend(chip, EXCEPTION_NMI);
    }
}

void chip_clocks_events(chip_t *chip)
{
    chip_watchdog_events(chip);
    watch_crystal(chip);
    /* 6.2.2: an edge, of which there is none if the supply is low when the detector starts. */
    const bool low = supply_is_low(chip);
    const bool known = (chip_get(chip, CHIP_PWR_SR2) & CHIP_PWR_SR2_PVDO) != 0;
    if (low == known) {
        return;
    }
    *chip_at(chip, CHIP_PWR_SR2) ^= CHIP_PWR_SR2_PVDO;
    if (low && (chip_get(chip, CHIP_EXTI_RTSR1) & CHIP_EXTI_RTSR1_RT16) != 0) {
        *chip_at(chip, CHIP_EXTI_PR1) |= CHIP_EXTI_PR1_PIF16;
        chip->needs_attention = true;
    }
}
