/* SPDX-License-Identifier: Apache-2.0 */
/* The flashable port's bridge, its code unchanged, on a model of the timer: gate signals. */
#include "analog_start.h"
#include "board.h"
#include "dead_time.h"
#include "gate_driver.h"
#include "hal/inverter.h"
#include "interrupts.h"
#include "registers/gpio.h"
#include "registers/power.h"
#include "registers/tim.h"
#include "timer1_model.h"
#include "unity.h"
#include "vectors.h"

enum { TOP = 4200, MIDDLE = TOP / 2 };

static const uint16_t COMPARE[3] = {1000, 3000, 4200};
static bool analog_started;
static uint32_t enabled_interrupt, enabled_priority;
static bool driver_holds_settings, driver_watched;
static int recoveries, releases;

/* The gate driver's own protocol is tested on the model of the chip (tests/target/chip). */
bool gate_driver_start(void)
{
    return driver_holds_settings;
}

void gate_driver_watch(void)
{
    driver_watched = true;
}

void gate_driver_acknowledge(void) {}

void gate_driver_release(void)
{
    TEST_ASSERT_BITS_LOW(TIM_BDTR_MOE, TIM1->BDTR);
    releases++;
}

bool gate_driver_recover(uint32_t *status)
{
    recoveries++;
    *status = INVERTER_DRIVER_OVER_CURRENT_LOW_B;
    return driver_holds_settings;
}

bool analog_init(void)
{
    return true;
}

void analog_start(void)
{
    analog_started = true;
}

void interrupts_enable(uint32_t number, uint32_t priority)
{
    enabled_interrupt = number;
    enabled_priority = priority;
}

static inverter_status_t init_with_dead_time(uint32_t dead_time_ns)
{
    const inverter_settings_t settings = {
        .pwm_frequency_Hz = 20000, .pwm_period_counts = TOP, .dead_time_ns = dead_time_ns};
    const inverter_status_t status = inverter_init(&settings);
    timer1_settle();
    return status;
}

static void begin(void)
{
    TEST_ASSERT_EQUAL_INT(INVERTER_OK, init_with_dead_time(1000));
    const uint16_t none[3] = {0, 0, 0};
    inverter_set(INVERTER_MODE_OFF, none);
    inverter_start();
    while (!timer1_at_top()) {
        timer1_half_period();
    }
}

void setUp(void)
{
    timer1_break_rises_after(0);
    timer1_reset();
    driver_holds_settings = true;
    driver_watched = false;
    (void)inverter_driver_status(); /* the port's own memory of the test before */
    inverter_clear_fault();
    recoveries = 0;
    releases = 0;
    analog_started = false;
}

void tearDown(void) {}

/* One period: the interrupt at the top sets mode and compare values, then the count goes down, up,
 * and to the next top. */
static void period(inverter_mode_t mode, const uint16_t compare_counts[3])
{
    inverter_set(mode, compare_counts);
    timer1_half_period();
    timer1_half_period();
}

static void assert_off(void)
{
    for (uint32_t count = 0; count <= TOP; count += 100) {
        const gates_t gates = timer1_gates(count);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_FALSE(gates.high[x]);
            TEST_ASSERT_FALSE(gates.low[x]);
        }
    }
}

static void assert_short(void)
{
    for (uint32_t count = 0; count <= TOP; count += 100) {
        const gates_t gates = timer1_gates(count);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_FALSE(gates.high[x]);
            TEST_ASSERT_TRUE(gates.low[x]);
        }
    }
}

static void assert_pwm(void)
{
    for (uint32_t count = 0; count <= TOP; count += 100) {
        const gates_t gates = timer1_gates(count);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_EQUAL(count < COMPARE[x] || COMPARE[x] == TOP, gates.high[x]);
            TEST_ASSERT_EQUAL(!gates.high[x], gates.low[x]);
        }
    }
}

void test_timer_updates_once_per_period_at_the_top(void)
{
    begin();
    TEST_ASSERT_TRUE(analog_started);
    for (int half = 0; half < 20; half++) {
        timer1_half_period();
        TEST_ASSERT_EQUAL(timer1_at_top(), timer1_updated());
    }
}

void test_timer_without_clock_is_reported_as_unready(void)
{
    timer1_stop_clock();
    TEST_ASSERT_EQUAL_INT(INVERTER_TIMER_UNREADY, init_with_dead_time(1000));
    TEST_ASSERT_FALSE(analog_started);
}

/* Push-pull outputs of the timer, pulled down for as long as they are not driven, and driven low
 * from the first moment. */
void test_after_start_up_every_gate_is_driven_low(void)
{
    static const pin_t GATES[6] = {{GPIOA, 8},  {GPIOA, 9},  {GPIOA, 10},
                                   {GPIOB, 13}, {GPIOB, 14}, {GPIOB, 15}};
    begin();
    assert_off();
    for (int i = 0; i < 6; i++) {
        const pin_t pin = GATES[i];
        TEST_ASSERT_EQUAL_HEX32(2, (pin.port->MODER >> 2U * pin.number) & 3U);
        TEST_ASSERT_EQUAL_HEX32(2, (pin.port->PUPDR >> 2U * pin.number) & 3U);
        TEST_ASSERT_EQUAL_HEX32(BOARD_AF_TIM1, (pin.port->AFRH >> 4U * (pin.number - 8U)) & 0xFU);
        TEST_ASSERT_EQUAL_HEX32(0, (pin.port->OTYPER >> pin.number) & 1U);
    }
    TEST_ASSERT_EQUAL_HEX32(0, TIM1->CR2 & 0x3F00U); /* OIS1 .. OIS3N (17.4.2): idle is off */
    TEST_ASSERT_EQUAL_HEX32(0, TIM1->CCER & 0xAAAU); /* CC1P .. CC3NP (17.4.9): active is high */
}

void test_after_switching_on_gates_follow_only_the_new_compare_values(void)
{
    begin();
    inverter_set(INVERTER_MODE_PWM, COMPARE);
    assert_off(); /* what is active now is from before */
    timer1_half_period();
    assert_off();
    timer1_half_period();
    assert_off(); /* active now, but the interrupt has not come yet */
    inverter_set(INVERTER_MODE_PWM, COMPARE);
    assert_pwm();
}

void test_switching_off_takes_effect_at_once(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    assert_pwm();
    inverter_set(INVERTER_MODE_OFF, COMPARE);
    assert_off();
}

void test_short_circuit_closes_low_sides_from_the_next_top_on(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    inverter_set(INVERTER_MODE_SHORT, COMPARE);
    assert_pwm();
    timer1_half_period();
    timer1_half_period();
    assert_short();
}

void test_short_circuit_on_the_high_side_follows_the_same_order(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    inverter_set(INVERTER_MODE_SHORT_HIGH, COMPARE);
    assert_pwm();
    timer1_half_period();
    timer1_half_period();
    for (uint32_t count = 0; count <= TOP; count += 100) {
        const gates_t gates = timer1_gates(count);
        for (int x = 0; x < 3; x++) {
            TEST_ASSERT_TRUE(gates.high[x]);
            TEST_ASSERT_FALSE(gates.low[x]);
        }
    }
    period(INVERTER_MODE_OFF, COMPARE);
    assert_off();
    period(INVERTER_MODE_SHORT_HIGH, COMPARE); /* not with the values from before */
    assert_off();
}

void test_short_circuit_from_off_never_drives_a_high_side(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_OFF, COMPARE);
    inverter_set(INVERTER_MODE_SHORT, COMPARE);
    assert_off();
    timer1_half_period();
    timer1_half_period();
    assert_off();
    inverter_set(INVERTER_MODE_SHORT, COMPARE);
    assert_short();
}

void test_break_input_switches_off_without_software_and_is_latched(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    timer1_set_break_pin(false);
    assert_off();
    TEST_ASSERT_TRUE(inverter_fault());
    inverter_clear_fault(); /* the cause is still there */
    timer1_settle();
    TEST_ASSERT_TRUE(inverter_fault());
    timer1_set_break_pin(true);
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    assert_off();
    inverter_clear_fault();
    timer1_settle();
    TEST_ASSERT_FALSE(inverter_fault());
    assert_off(); /* not by the release alone */
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    assert_pwm();
}

void test_the_gate_drivers_fault_switches_off_at_once_and_is_not_released_while_it_lasts(void)
{
    begin();
    TEST_ASSERT_TRUE(driver_watched);
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    timer1_set_driver_fault_pin(false);
    driver_fault_handler();
    assert_off();
    TEST_ASSERT_TRUE(inverter_fault());
    period(INVERTER_MODE_SHORT, COMPARE);
    period(INVERTER_MODE_SHORT, COMPARE);
    assert_off();
    TEST_ASSERT_EQUAL_HEX32(INVERTER_DRIVER_OVER_CURRENT_LOW_B, inverter_driver_status());
    TEST_ASSERT_EQUAL_INT(0, releases);
    inverter_clear_fault();
    TEST_ASSERT_EQUAL_INT(1, releases);
    TEST_ASSERT_TRUE(inverter_fault());
    timer1_set_driver_fault_pin(true);
    TEST_ASSERT_TRUE(inverter_fault()); /* never by itself */
    inverter_clear_fault();
    TEST_ASSERT_FALSE(inverter_fault());
}

void test_the_drivers_latch_is_left_alone_without_a_fault(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    inverter_clear_fault();
    TEST_ASSERT_EQUAL_INT(0, releases);
    assert_pwm();
}

void test_a_fault_of_the_driver_is_released_only_when_it_holds_its_settings_again(void)
{
    begin();
    driver_holds_settings = false;
    driver_fault_handler();
    inverter_clear_fault(); /* its status has not been read yet */
    TEST_ASSERT_TRUE(inverter_fault());
    for (int pass = 0; pass < 3; pass++) {
        (void)inverter_driver_status();
        inverter_clear_fault();
        TEST_ASSERT_TRUE(inverter_fault());
    }
    TEST_ASSERT_EQUAL_INT(3, recoveries);
    driver_holds_settings = true;
    (void)inverter_driver_status();
    (void)inverter_driver_status(); /* once is enough */
    TEST_ASSERT_EQUAL_INT(4, recoveries);
    inverter_clear_fault();
    TEST_ASSERT_FALSE(inverter_fault());
}

void test_a_driver_in_fault_at_the_start_is_a_fault(void)
{
    timer1_set_driver_fault_pin(false);
    TEST_ASSERT_EQUAL_INT(INVERTER_OK, init_with_dead_time(1000));
    inverter_start();
    TEST_ASSERT_TRUE(inverter_fault());
}

void test_a_driver_that_does_not_hold_its_settings_is_refused(void)
{
    driver_holds_settings = false;
    TEST_ASSERT_EQUAL_INT(INVERTER_DRIVER_UNREADY, init_with_dead_time(1000));
}

void test_trip_switches_off_at_once_and_is_latched(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    inverter_trip();
    assert_off();
    period(INVERTER_MODE_SHORT, COMPARE);
    period(INVERTER_MODE_SHORT, COMPARE);
    assert_off();
    TEST_ASSERT_TRUE(inverter_fault());
}

/* ---- the stop timer ---- */

static void half_periods_without_renewal(int count)
{
    for (int n = 0; n < count; n++) {
        timer1_half_period();
    }
}

/* 1.5 periods after the last call, by the timer alone; a call that comes all the same finds a
 * fault. */
void test_compare_values_that_are_not_renewed_are_switched_off_and_that_is_latched(void)
{
    begin();
    for (int n = 0; n < 100; n++) {
        period(INVERTER_MODE_PWM, COMPARE);
    }
    assert_pwm(); /* two half periods since the last call */
    half_periods_without_renewal(1);
    assert_off();
    half_periods_without_renewal(100);
    assert_off();
    period(INVERTER_MODE_PWM, COMPARE);
    TEST_ASSERT_TRUE(inverter_fault());
    period(INVERTER_MODE_PWM, COMPARE);
    assert_off();
    period(INVERTER_MODE_OFF, COMPARE);
    inverter_clear_fault();
    TEST_ASSERT_FALSE(inverter_fault());
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    assert_pwm();
}

void test_the_timer_runs_from_the_first_compare_values_on(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    inverter_set(INVERTER_MODE_PWM, COMPARE);
    half_periods_without_renewal(3);
    assert_off();
}

/* Equal compare values are the state that a bridge is to be in without a program. */
void test_a_short_circuit_is_not_switched_off(void)
{
    for (int high = 0; high <= 1; high++) {
        setUp();
        begin();
        const inverter_mode_t mode = high == 1 ? INVERTER_MODE_SHORT_HIGH : INVERTER_MODE_SHORT;
        period(INVERTER_MODE_PWM, COMPARE);
        period(INVERTER_MODE_PWM, COMPARE);
        period(mode, COMPARE);
        half_periods_without_renewal(100);
        TEST_ASSERT_BITS_HIGH(TIM_BDTR_MOE, TIM1->BDTR);
        TEST_ASSERT_FALSE(inverter_fault());
        period(INVERTER_MODE_PWM, COMPARE);
        TEST_ASSERT_FALSE(inverter_fault());
        half_periods_without_renewal(1);
        assert_off();
    }
}

/* While the flash is programmed the core stands still, with the bridge off. */
void test_a_bridge_that_is_off_needs_no_renewal(void)
{
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_OFF, COMPARE);
    half_periods_without_renewal(100);
    TEST_ASSERT_FALSE(inverter_fault());
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    assert_pwm();
    TEST_ASSERT_FALSE(inverter_fault());
}

/* Below 2.7 V the flash cannot be read at this speed; the chip's reset threshold is one volt lower.
 */
void test_falling_supply_voltage_interrupts_as_a_fault(void)
{
    begin();
    TEST_ASSERT_EQUAL_HEX32(6, (PWR->CR & PWR_CR_PLS) >> PWR_CR_PLS_Pos);
    TEST_ASSERT_TRUE((PWR->CR & PWR_CR_PVDE) != 0);
    TEST_ASSERT_TRUE((EXTI->IMR & EXTI->RTSR & EXTI_IMR_MR16) != 0);
    TEST_ASSERT_EQUAL_UINT32(INTERRUPT_SUPPLY, enabled_interrupt);
    TEST_ASSERT_LESS_THAN_UINT32(PRIORITY_PWM_PERIOD, enabled_priority);
    TEST_ASSERT_FALSE(inverter_fault());
}

void test_low_supply_at_start_is_a_fault_until_it_recovers(void)
{
    PWR->CSR = PWR_CSR_PVDO;
    begin();
    period(INVERTER_MODE_PWM, COMPARE);
    period(INVERTER_MODE_PWM, COMPARE);
    assert_off();
    inverter_clear_fault();
    TEST_ASSERT_TRUE(inverter_fault());
    PWR->CSR = 0;
    inverter_clear_fault();
    TEST_ASSERT_FALSE(inverter_fault());
}

/* Pull-up and wiring delay the edge by microseconds, which must not latch a fault. */
void test_slowly_rising_break_input_at_start_up_is_no_fault(void)
{
    timer1_break_rises_after(3);
    timer1_reset();
    begin();
    TEST_ASSERT_FALSE(inverter_fault());
}

void test_permanently_low_break_input_is_a_fault(void)
{
    timer1_break_rises_after(1000);
    timer1_reset();
    TEST_ASSERT_EQUAL_INT(INVERTER_OK, init_with_dead_time(1000));
    TEST_ASSERT_TRUE(inverter_fault());
}

/* Held 18 cycles of 21 MHz after the trigger (data sheet: 3 of latency, 15 of sampling), the sample
 * has to lie in the middle of the low pulses, half the dead time after the top. */
void test_currents_are_held_in_the_middle_of_the_low_pulses(void)
{
    for (uint32_t dead_ns = BOARD_DEAD_TIME_LEAST_ns; dead_ns <= 6000; dead_ns += 57) {
        TEST_ASSERT_EQUAL_INT(INVERTER_OK, init_with_dead_time(dead_ns));
        const uint32_t mode = (TIM1->CCMR2 >> TIM_CCMR2_OC4M_Pos) & 7U;
        const double before_top = (double)TOP - (double)TIM1->CCR4;
        const double trigger_counts = mode == 7 ? -before_top : before_top + 1.0;
        TEST_ASSERT_TRUE(mode == 7 || mode == 6);
        TEST_ASSERT_TRUE(TIM1->CCR4 > 0 && TIM1->CCR4 < TOP);
        const double made_ns = dead_time_clocks((uint8_t)(TIM1->BDTR & 0xFFU)) / 0.168;
        TEST_ASSERT_DOUBLE_WITHIN(12.0, made_ns / 2.0, trigger_counts / 0.168 + 18.0 / 0.021);
        timer1_reset();
    }
}

/* A configuration may not make both switches of a leg conduct together. */
void test_a_dead_time_too_short_for_the_boards_switches_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(INVERTER_DEAD_TIME_UNSUPPORTED, init_with_dead_time(0));
    TEST_ASSERT_EQUAL_INT(INVERTER_DEAD_TIME_UNSUPPORTED,
                          init_with_dead_time(BOARD_DEAD_TIME_LEAST_ns - 1));
    TEST_ASSERT_EQUAL_INT(INVERTER_DEAD_TIME_UNSUPPORTED, init_with_dead_time(6001));
    TEST_ASSERT_EQUAL_HEX32(0, TIM1->CCER);
    TEST_ASSERT_EQUAL_INT(INVERTER_OK, init_with_dead_time(BOARD_DEAD_TIME_LEAST_ns));
}
