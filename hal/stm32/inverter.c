/* SPDX-License-Identifier: Apache-2.0 */
/*
 * TIM1, centre-aligned, complementary outputs with dead time and break (RM0090 section 17.3,
 * whose numbers are below; RM0440 section 28.3).
 *
 * One update event a period, at the overflow, that is at the top (17.3.3): the counter starts with
 * repetition counter 0, which gives an event at both ends, and the 1 that is written while it
 * counts up is taken over at the next top, so that from there on every second event is left out.
 * Editions of the manual disagree about which end it is, so inverter_init() checks it. Channel 4
 * has no pin: its reference rises near the top and starts the converters (17.4.2, MMS = OC4REF;
 * README, Sampling). In the interrupt, 2 us later, the compare values written one period ago are
 * active and those written now become active at the next top.
 */
#include "hal/inverter.h"

#include "analog_start.h"
#include "board.h"
#include "clock.h"
#include "dead_time.h"
#include "gate_driver.h"
#include "overcurrent.h"
#define COLD __attribute__((cold)) /* optimised for size */
#include "registers/iwdg.h"
#include "registers/rcc.h"
#include "registers/tim.h"
#include "stop_timer.h"
#include "supply.h"
#include "vectors.h"
#include "wait.h"

enum {
    CENTRE_ALIGNED_1 = 1,
    PWM_MODE_1 = 6, /* active while count < compare */
    PWM_MODE_2 = 7, /* active while count >= compare */
    TRIGGER_OUTPUT_OC4REF = 7,
    LOCK_LEVEL_1 = 1, /* dead time, break and idle states cannot be changed until the next reset */
    POLLS_PERIOD = 20000 /* 0.6 ms, more than a period of 4 kHz */
};

#define BREAK_FLAGS (TIM_SR_BIF | OVERCURRENT_FLAG)

static uint16_t top_counts;
static int32_t trigger_counts; /* from the top to the converters' trigger */
static bool armed;             /* a mode other than OFF was requested in the previous period */
static volatile bool tripped;
static volatile uint32_t driver_faults; /* times that the gate driver reported one */
static uint32_t driver_faults_served;
static uint32_t driver_status;
static bool driver_good; /* it holds what was written to it */

uint32_t inverter_timer_Hz(void)
{
    return CLOCK_TIMER1_Hz;
}

uint32_t inverter_dead_time_least_ns(void)
{
    return BOARD_DEAD_TIME_LEAST_ns;
}

static bool frequency_fits(const inverter_settings_t *settings)
{
    const uint32_t frequency_Hz = CLOCK_TIMER1_Hz / (2U * settings->pwm_period_counts);
    const uint32_t tolerance_Hz = settings->pwm_frequency_Hz / 1000U;
    return frequency_Hz + tolerance_Hz >= settings->pwm_frequency_Hz &&
           frequency_Hz <= settings->pwm_frequency_Hz + tolerance_Hz;
}

COLD static void connect_pins(void)
{
    /* Pulled down, so that a gate input is low also while its pin is not driven. */
    gpio_make_alternate(BOARD_GATE_HIGH_A, BOARD_AF_GATES_HIGH, GPIO_PULL_DOWN);
    gpio_make_alternate(BOARD_GATE_HIGH_B, BOARD_AF_GATES_HIGH, GPIO_PULL_DOWN);
    gpio_make_alternate(BOARD_GATE_HIGH_C, BOARD_AF_GATES_HIGH, GPIO_PULL_DOWN);
    gpio_make_alternate(BOARD_GATE_LOW_A, BOARD_AF_GATE_LOW_A, GPIO_PULL_DOWN);
    gpio_make_alternate(BOARD_GATE_LOW_B, BOARD_AF_GATE_LOW_B, GPIO_PULL_DOWN);
    gpio_make_alternate(BOARD_GATE_LOW_C, BOARD_AF_GATE_LOW_C, GPIO_PULL_DOWN);
    if (pin_is_wired(BOARD_BREAK)) {
        gpio_make_alternate(BOARD_BREAK, BOARD_AF_BREAK, GPIO_PULL_UP);
    }
}

COLD static void configure_timer(uint32_t dead_time_code)
{
    TIM1->CR1 = ((uint32_t)CENTRE_ALIGNED_1 << TIM_CR1_CMS_Pos) | TIM_CR1_ARPE;
    TIM1->CR2 = (uint32_t)TRIGGER_OUTPUT_OC4REF
                << TIM_CR2_MMS_Pos; /* idle states all 0: both switches of a leg off */
    TIM1->PSC = 0;
    TIM1->ARR = top_counts;
    TIM1->RCR = 0;
    TIM1->CCMR1 = ((uint32_t)PWM_MODE_1 << TIM_CCMR1_OC1M_Pos) | TIM_CCMR1_OC1PE |
                  ((uint32_t)PWM_MODE_1 << TIM_CCMR1_OC2M_Pos) | TIM_CCMR1_OC2PE;
    /* Channel 4 becomes active at its value on the way up, or one below it on the way down. */
    const bool on_the_way_down = trigger_counts > 0;
    const uint32_t mode = on_the_way_down ? PWM_MODE_1 : PWM_MODE_2;
    TIM1->CCMR2 = ((uint32_t)PWM_MODE_1 << TIM_CCMR2_OC3M_Pos) | TIM_CCMR2_OC3PE |
                  (mode << TIM_CCMR2_OC4M_Pos) | TIM_CCMR2_OC4PE;
    TIM1->CCR1 = 0;
    TIM1->CCR2 = 0;
    TIM1->CCR3 = 0;
    TIM1->CCR4 =
        (uint32_t)(on_the_way_down ? top_counts - trigger_counts + 1 : top_counts + trigger_counts);
    TIM1->CCER = TIM_CCER_CC1E | TIM_CCER_CC1NE | TIM_CCER_CC2E | TIM_CCER_CC2NE | TIM_CCER_CC3E |
                 TIM_CCER_CC3NE;
    overcurrent_connect();
    /* Break, where it is wired, active low (BKP = 0) and never released by itself (AOE = 0); OSSI
     * and OSSR keep the pins driven to "off". */
    TIM1->BDTR = (dead_time_code << TIM_BDTR_DTG_Pos) |
                 (pin_is_wired(BOARD_BREAK) ? TIM_BDTR_BKE : 0U) | OVERCURRENT_BREAK |
                 TIM_BDTR_OSSI | TIM_BDTR_OSSR | ((uint32_t)LOCK_LEVEL_1 << TIM_BDTR_LOCK_Pos);
    stop_timer_init(top_counts);
    TIM1->EGR = TIM_EGR_UG; /* loads every preload register */
    TIM1->SR = 0;
    DBGMCU->APB2_FZ |=
        DBGMCU_APB2_FZ_TIM1_STOP; /* a halted core gets a switched-off bridge (17.3.21) */
}

static bool wait_for_update(void)
{
    TIM1->SR = ~(uint32_t)TIM_SR_UIF; /* the other flags are left alone by writing 1 */
    return wait_for(&TIM1->SR, TIM_SR_UIF, TIM_SR_UIF, POLLS_PERIOD);
}

/* Starts the counter with its update at the top and verifies it: right after an update at the top
 * the counter counts down. False if not. The bridge stays off. */
COLD static bool start_with_update_at_top(void)
{
    TIM1->CR1 |= TIM_CR1_CEN;
    bool seen = wait_for_update();
    while (seen && (TIM1->CR1 & TIM_CR1_DIR) != 0) {
        seen = wait_for_update(); /* until it is the one at the bottom: from here it counts up */
    }
    TIM1->RCR = 1;
    seen = seen && wait_for_update();
    for (int period = 0; period < 4 && seen; period++) {
        seen = wait_for_update() && (TIM1->CR1 & TIM_CR1_DIR) != 0;
    }
    return seen;
}

/* The middle of a leg's low pulse is half the dead time after the top, whichever way the current
 * flows; there the converters hold. At the top itself the trigger would last for one count only. */
static int32_t trigger_from_top(uint32_t dead_clocks)
{
    const int32_t counts = (int32_t)(dead_clocks / 2U) - ANALOG_HOLD_CLOCKS;
    return counts == 0 ? -1 : counts;
}

COLD inverter_status_t inverter_init(const inverter_settings_t *settings)
{
    if (!frequency_fits(settings)) {
        return INVERTER_FREQUENCY_UNSUPPORTED;
    }
    uint8_t dead_time_code;
    if (settings->dead_time_ns < inverter_dead_time_least_ns() ||
        !dead_time_encode(settings->dead_time_ns, CLOCK_TIMER1_Hz, &dead_time_code) ||
        dead_time_clocks(dead_time_code) >= settings->pwm_period_counts) {
        return INVERTER_DEAD_TIME_UNSUPPORTED;
    }
    RCC->APB2ENR |= RCC_APB2ENR_TIM1EN;
    RCC->APB2ENR |= RCC_APB2ENR_TIM8EN; /* of the stop timer */
    (void)RCC->APB2ENR;
    gpio_init();
    top_counts = (uint16_t)settings->pwm_period_counts;
    trigger_counts = trigger_from_top(dead_time_clocks(dead_time_code));
    configure_timer(dead_time_code);
    connect_pins();
    driver_good = gate_driver_start();
    if (!driver_good) {
        return INVERTER_DRIVER_UNREADY;
    }
    if (!start_with_update_at_top()) {
        return INVERTER_TIMER_UNREADY;
    }
    if (!overcurrent_start()) {
        return INVERTER_OVERCURRENT_UNREADY;
    }
    /* While the pins were being connected and pulled up the break input was low, and the
     * comparators have been tried. Some periods have passed since: a break that is still there sets
     * it again. */
    TIM1->SR = ~BREAK_FLAGS;
    return analog_init() ? INVERTER_OK : INVERTER_CONVERTER_UNREADY;
}

void inverter_start(void)
{
    supply_watch();
    gate_driver_watch();
    if (gate_driver_pulls_fault()) { /* before its edge was watched */
        driver_fault_handler();
    }
    if (supply_low()) {
        inverter_trip();
    }
    analog_start();
}

static inline bool break_acted(void)
{
    return (pin_is_wired(BOARD_BREAK) || OVERCURRENT_FLAG != 0U) && (TIM1->SR & BREAK_FLAGS) != 0;
}

static inline bool fault(void)
{
    return tripped || break_acted();
}

static void switch_off(void)
{
    TIM1->BDTR &= ~(uint32_t)TIM_BDTR_MOE;
    stop_timer_stop();
}

/* Compare beyond the top holds the high side on; equal to the top would switch it off for one count
 * and two dead times. */
static uint32_t register_value(uint16_t compare_counts, uint32_t top)
{
    return compare_counts + (compare_counts >= top ? 1U : 0U);
}

static void write_compare(const uint16_t compare_counts[3])
{
    const uint32_t top = top_counts;
    TIM1->CCR1 = register_value(compare_counts[0], top);
    TIM1->CCR2 = register_value(compare_counts[1], top);
    TIM1->CCR3 = register_value(compare_counts[2], top);
}

/* The outputs are enabled when the first compare values have become active, one period after they
 * were written: the old ones, from before the bridge was switched off, must never be seen. Once
 * enabled they stay so until switch_off() or a break: there is nothing to enable again. */
static void enable_outputs(void)
{
    if (armed && (TIM1->BDTR & TIM_BDTR_MOE) == 0U) {
        TIM1->BDTR |= TIM_BDTR_MOE;
        /* A break between its check and this write must not be undone: the timer accepts an enable
         * as soon as the input is inactive again. */
        if (fault()) {
            switch_off();
        }
    }
    armed = true;
}

/* All legs alike: 0 is the low side, beyond the top the high side. */
static void write_equal(uint32_t value)
{
    TIM1->CCR1 = value;
    TIM1->CCR2 = value;
    TIM1->CCR3 = value;
}

/* Whatever is not the usual period of a bridge that is switching. */
static void change_mode(inverter_mode_t mode, const uint16_t compare_counts[3])
{
    if (stop_timer_acted()) {
        inverter_trip();
    }
    if (mode < INVERTER_MODE_PWM || mode > INVERTER_MODE_SHORT_HIGH || fault()) {
        switch_off();
        armed = false;
        return;
    }
    if (mode == INVERTER_MODE_PWM) {
        write_compare(compare_counts);
    } else {
        write_equal(mode == INVERTER_MODE_SHORT_HIGH ? top_counts + 1U : 0U);
    }
    enable_outputs();
    if (mode == INVERTER_MODE_PWM && (TIM1->BDTR & TIM_BDTR_MOE) != 0U) {
        stop_timer_run();
    } else {
        stop_timer_stop();
    }
}

/* The stop timer runs while a bridge that is on follows compare values. inverter_trip() ends that,
 * a fault of the gate driver, the timer itself; a break input takes the outputs, which nothing but
 * change_mode() enables. */
void inverter_set(inverter_mode_t mode, const uint16_t compare_counts[3])
{
    if (mode == INVERTER_MODE_PWM && stop_timer_runs()) {
        stop_timer_renew();
        write_compare(compare_counts);
    } else {
        change_mode(mode, compare_counts);
    }
}

void inverter_trip(void)
{
    tripped = true;
    switch_off();
}

bool inverter_fault(void)
{
    return fault();
}

/* The driver switches off one leg only (README, Gate driver); the other two must follow at once. */
void driver_fault_handler(void)
{
    gate_driver_acknowledge();
    inverter_trip();
    driver_faults = driver_faults + 1U;
}

uint32_t inverter_driver_status(void)
{
    const uint32_t faults = driver_faults;
    if (faults != driver_faults_served || (faults > 0 && !driver_good)) {
        driver_faults_served = faults;
        driver_good = gate_driver_recover(&driver_status);
    }
    return driver_status;
}

void inverter_clear_fault(void)
{
    const uint32_t faults = driver_faults;
    if (tripped) { /* the outputs are off */
        gate_driver_release();
    }
    const bool driver_ready =
        driver_good && faults == driver_faults_served && !gate_driver_pulls_fault();
    const bool break_released = !pin_is_wired(BOARD_BREAK) || gpio_read(BOARD_BREAK);
    if (driver_ready && break_released && !supply_low()) {
        TIM1->SR = ~BREAK_FLAGS;
        stop_timer_stop(); /* that a break has left running */
        tripped = false;
        if (faults != driver_faults) { /* one has come since */
            inverter_trip();
        }
    }
}
