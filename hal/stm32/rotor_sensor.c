/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Halls on three inputs, or an incremental encoder on a general-purpose timer (RM0090
 * section 18.3.12, RM0440 section 29.4.22): CH1 and CH2 count quadrature edges, CH3 captures the
 * count at the index pulse, so that the index is found at any speed without an interrupt.
 */
#include "hal/rotor_sensor.h"

#include "board.h"
#include "clock.h"
#include "registers/tim.h"
#include "rotor_sensor_sample.h"

#define COLD __attribute__((cold)) /* optimised for size */

enum {
    ENCODER_MODE_3 = 3, /* SMS: count on both edges of both inputs */
    INPUT_DIRECT = 1,   /* CCxS: input x on its own pin */
    FILTER_8_SAMPLES = 3
};

/* Levels at this period's first sample, and the latest that two samples of a period agreed on. */
static struct {
    uint8_t first, agreed;
} halls;

COLD static void init_halls(void)
{
    gpio_make_input(BOARD_ROTOR_A, GPIO_PULL_UP);
    gpio_make_input(BOARD_ROTOR_B, GPIO_PULL_UP);
    gpio_make_input(BOARD_ROTOR_C, GPIO_PULL_UP);
}

COLD static void init_encoder(void)
{
    clock_start_encoder();
    gpio_make_alternate(BOARD_ROTOR_A, BOARD_AF_ENCODER, GPIO_PULL_UP);
    gpio_make_alternate(BOARD_ROTOR_B, BOARD_AF_ENCODER, GPIO_PULL_UP);
    gpio_make_alternate(BOARD_ROTOR_C, BOARD_AF_ENCODER, GPIO_PULL_UP);
    ENCODER->CCMR1 = ((uint32_t)INPUT_DIRECT << TIM_CCMR1_CC1S_Pos) |
                     ((uint32_t)FILTER_8_SAMPLES << TIM_CCMR1_IC1F_Pos) |
                     ((uint32_t)INPUT_DIRECT << TIM_CCMR1_CC2S_Pos) |
                     ((uint32_t)FILTER_8_SAMPLES << TIM_CCMR1_IC2F_Pos);
    ENCODER->CCMR2 = ((uint32_t)INPUT_DIRECT << TIM_CCMR2_CC3S_Pos) |
                     ((uint32_t)FILTER_8_SAMPLES << TIM_CCMR2_IC3F_Pos);
    ENCODER->CCER = TIM_CCER_CC3E;
    ENCODER->SMCR = (uint32_t)ENCODER_MODE_3 << TIM_SMCR_SMS_Pos;
    ENCODER->ARR = 0xFFFF;
    ENCODER->SR = 0;
    ENCODER->CR1 = TIM_CR1_CEN;
}

COLD bool rotor_sensor_init(rotor_sensor_kind_t kind)
{
    gpio_init();
    switch (kind) {
    case ROTOR_SENSOR_HALL:
        init_halls();
        return true;
    case ROTOR_SENSOR_ENCODER:
        if (BOARD_ENCODER_WIRED == 0) {
            return false; /* its pins are another timer's */
        }
        init_encoder();
        return true;
    case ROTOR_SENSOR_ANGLE:
        break;
    }
    return false; /* no board of these reads a resolver */
}

uint16_t rotor_sensor_angle_turn(void)
{
    return 0;
}

/* Where A, B and C are next to each other, one read has all three. */
static bool are_adjacent(pin_t a, pin_t b, pin_t c)
{
    return a.port == b.port && b.port == c.port && b.number == a.number + 1 &&
           c.number == b.number + 1;
}

static uint8_t levels(void)
{
    if (are_adjacent(BOARD_ROTOR_A, BOARD_ROTOR_B, BOARD_ROTOR_C)) {
        return (uint8_t)((BOARD_ROTOR_A.port->IDR >> BOARD_ROTOR_A.number) & 7U);
    }
    return (uint8_t)((gpio_read(BOARD_ROTOR_A) ? 1U : 0U) | (gpio_read(BOARD_ROTOR_B) ? 2U : 0U) |
                     (gpio_read(BOARD_ROTOR_C) ? 4U : 0U));
}

void rotor_sensor_sample(void)
{
    halls.first = levels();
}

uint8_t rotor_sensor_hall_state(void)
{
    const uint8_t second = levels();
    if (second == halls.first) {
        halls.agreed = second;
    }
    return halls.agreed;
}

rotor_sensor_encoder_t rotor_sensor_encoder(void)
{
    rotor_sensor_encoder_t seen = {.index_count = 0};
    /* The flag before the count: an index pulse between the two is found in the next period.
     * Reading the capture register clears the flag (section 18.4.5). */
    seen.index = (ENCODER->SR & TIM_SR_CC3IF) != 0;
    if (seen.index) {
        seen.index_count = (uint16_t)ENCODER->CCR3;
    }
    seen.count = (uint16_t)ENCODER->CNT;
    return seen;
}
