/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Comparators 1, 2 and 4 (RM0440 section 24) at the amplifiers' inputs, thresholds from DAC 3 (22):
 *
 *     shunt a, PA1: COMP1 > DAC3 channel 1     shunts b, c, PA7, PB0: COMP2, COMP4 > channel 2
 *
 * The level of the inputs without current depends on resistors of the board. It is found with the
 * comparators themselves, which takes their offset out and shows that each of them works.
 */
#include "overcurrent.h"

#include "board.h"
#include "registers/comp.h"
#include "registers/dac.h"
#include "registers/rcc.h"
#include "wait.h"

#define COLD __attribute__((cold)) /* optimised for size */

enum {
    INSIDE = 3,         /* MODE: to the comparators, without buffer */
    ABOVE_160_MHz = 2,  /* HFSEL */
    THRESHOLD_DAC3 = 4, /* INMSEL: channel 1 for COMP1, 2 for COMP2 and COMP4 */
    CODE_HIGHEST_BIT = 2048,
    POLLS_SETTLE = 300, /* 9 us at least; the data sheet says 3 us for DAC and comparator */
    LEVEL_APART = 12,   /* codes, of shunts b and c: 9.7 mV, 5.6 A */
    CODES = 4096
};
#define COMPARATOR_SETTING ((uint32_t)THRESHOLD_DAC3 << COMP_C1CSR_INMSEL_Pos | COMP_C1CSR_EN)

/* Codes of the threshold above the level without current; what the inputs see of a shunt. */
enum {
    TRIP_uV = (int)((int64_t)BOARD_TRIP_A * BOARD_SHUNT_nOhm / 1000 * BOARD_NETWORK_NUMERATOR /
                    BOARD_NETWORK_DENOMINATOR),
    TRIP_CODES = TRIP_uV * CODES / (BOARD_REFERENCE_mV * 1000),
    LEVEL_LEAST_CODE = BOARD_NETWORK_LEVEL_LEAST_mV * CODES / BOARD_REFERENCE_mV,
    LEVEL_MOST_CODE = BOARD_NETWORK_LEVEL_MOST_mV * CODES / BOARD_REFERENCE_mV
};
_Static_assert(TRIP_uV < INT32_MAX / CODES, "computed in 32 bits");
_Static_assert(BOARD_TRIP_A >= BOARD_CURRENT_MOST_A, "what the board may carry is no fault");

void overcurrent_connect(void)
{
    TIM1_FURTHER->AF2 = TIM_AF2_BK2CMP1E | TIM_AF2_BK2CMP2E | TIM_AF2_BK2CMP4E;
}

COLD static void start_parts(void)
{
    gpio_make_analog(BOARD_CURRENT_A_IN);
    gpio_make_analog(BOARD_CURRENT_B_IN);
    gpio_make_analog(BOARD_CURRENT_C_IN);
    RCC->APB2ENR |= RCC_APB2ENR_SYSCFGEN; /* the comparators' clock */
    RCC->AHB2ENR |= RCC_AHB2ENR_DAC3EN;
    (void)RCC->AHB2ENR;
    DAC3->MCR = (uint32_t)INSIDE << DAC_MCR_MODE1_Pos | (uint32_t)INSIDE << DAC_MCR_MODE2_Pos |
                (uint32_t)ABOVE_160_MHz << DAC_MCR_HFSEL_Pos;
    DAC3->CR = DAC_CR_EN1 | DAC_CR_EN2;
    COMP->C1CSR = COMPARATOR_SETTING;
    COMP->C2CSR = COMPARATOR_SETTING;
    COMP->C4CSR = COMPARATOR_SETTING;
}

/* The largest threshold that the input is above. */
COLD static uint32_t level_code(const volatile uint32_t *comparator, volatile uint32_t *threshold)
{
    uint32_t code = 0;
    for (uint32_t bit = CODE_HIGHEST_BIT; bit > 0; bit >>= 1) {
        *threshold = code | bit;
        (void)wait_for(comparator, 0, 1, POLLS_SETTLE);
        code |= (*comparator & COMP_C1CSR_VALUE) != 0 ? bit : 0U;
    }
    return code;
}

static bool is_the_boards(uint32_t level)
{
    return level >= LEVEL_LEAST_CODE && level <= LEVEL_MOST_CODE;
}

/* Locked until the next reset, enabled, and with the input below the threshold. */
static bool is_set(const volatile uint32_t *comparator)
{
    return *comparator == (COMPARATOR_SETTING | COMP_C1CSR_LOCK);
}

bool overcurrent_start(void)
{
    start_parts();
    const uint32_t a = level_code(&COMP->C1CSR, &DAC3->DHR12R1);
    const uint32_t b = level_code(&COMP->C2CSR, &DAC3->DHR12R2);
    const uint32_t c = level_code(&COMP->C4CSR, &DAC3->DHR12R2);
    const uint32_t higher = b > c ? b : c;
    const uint32_t lower = b > c ? c : b;
    DAC3->DHR12R1 = a + TRIP_CODES;
    DAC3->DHR12R2 = higher + TRIP_CODES;
    (void)wait_for(&DAC3->DOR2, 0, UINT32_MAX, POLLS_SETTLE);
    COMP->C1CSR = COMPARATOR_SETTING | COMP_C1CSR_LOCK;
    COMP->C2CSR = COMPARATOR_SETTING | COMP_C1CSR_LOCK;
    COMP->C4CSR = COMPARATOR_SETTING | COMP_C1CSR_LOCK;
    const uint32_t wanted = OVERCURRENT_BREAK;
    return is_the_boards(a) && is_the_boards(b) && is_the_boards(c) &&
           higher - lower <= LEVEL_APART && is_set(&COMP->C1CSR) && is_set(&COMP->C2CSR) &&
           is_set(&COMP->C4CSR) && DAC3->DOR1 == a + TRIP_CODES &&
           DAC3->DOR2 == higher + TRIP_CODES && (TIM1->BDTR & wanted) == wanted &&
           TIM1_FURTHER->AF2 == (TIM_AF2_BK2CMP1E | TIM_AF2_BK2CMP2E | TIM_AF2_BK2CMP4E);
}
