/* SPDX-License-Identifier: Apache-2.0 */
/*
 * inverter.h: three half bridges, driven by one centre-aligned timer.
 *
 * The count runs 0 -> top -> 0 once per PWM period. A leg's high side conducts while count <
 * compare, its low side otherwise, with the dead time in between; so 0 is "low side always",
 * `pwm_period_counts` (= top) is "high side always", and the low sides conduct around the top,
 * which is where analog.h samples. Compare values and bridge mode given to inverter_set() take
 * effect together at the next top.
 *
 * The hardware break input switches all six switches off by itself, without software, and keeps
 * them off.
 *
 * Compare values that nobody renews are a voltage that stands still while the rotor turns on. Where
 * INVERTER_MODE_PWM is not renewed by inverter_set() for 1.5 periods, a timer of its own switches
 * all six switches off, without the core, and latches a fault. A short circuit needs no renewal.
 * Port without such a timer: qemu_mps2; there the caller's own watch is what bounds it.
 */
#ifndef HAL_INVERTER_H
#define HAL_INVERTER_H

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    INVERTER_MODE_OFF = 0, /* all six switches off; takes effect at once */
    INVERTER_MODE_PWM = 1, /* legs follow the compare values */
    /* Active short circuit: low sides on, high sides off; compare values are ignored. */
    INVERTER_MODE_SHORT = 2,
    /* The same with the high sides on and the low sides off. Low-side shunts show no current. */
    INVERTER_MODE_SHORT_HIGH = 3
} inverter_mode_t;

typedef struct {
    uint32_t pwm_frequency_Hz;  /* rate of the period; the port checks that its timer makes it from
                                   the counts */
    uint32_t pwm_period_counts; /* counts from 0 to the top, 256 .. 16384 */
    uint32_t dead_time_ns;      /* rounded up to what the timer can make, never down */
} inverter_settings_t;

typedef enum {
    INVERTER_OK = 0,
    INVERTER_FREQUENCY_UNSUPPORTED, /* the counts at this port's timer clock miss the frequency by
                                       more than 0.1 % */
    INVERTER_DEAD_TIME_UNSUPPORTED, /* longer than the timer can make, or shorter than the board's
                                       switches need */
    INVERTER_TIMER_UNREADY,         /* the timer's update event is missing or at the wrong count */
    INVERTER_CONVERTER_UNREADY,     /* the analog converters did not start */
    INVERTER_DRIVER_UNREADY,        /* the gate driver does not hold what was written to it */
    INVERTER_OVERCURRENT_UNREADY    /* the over-current comparators do not answer as they must */
} inverter_status_t;

/* What a gate driver that can tell reported. */
enum {
    INVERTER_DRIVER_OVER_CURRENT_LOW_C = 1 << 0, /* in a switch, by its voltage */
    INVERTER_DRIVER_OVER_CURRENT_HIGH_C = 1 << 1,
    INVERTER_DRIVER_OVER_CURRENT_LOW_B = 1 << 2,
    INVERTER_DRIVER_OVER_CURRENT_HIGH_B = 1 << 3,
    INVERTER_DRIVER_OVER_CURRENT_LOW_A = 1 << 4,
    INVERTER_DRIVER_OVER_CURRENT_HIGH_A = 1 << 5,
    INVERTER_DRIVER_WARM = 1 << 6, /* the driver itself; no fault yet */
    INVERTER_DRIVER_HOT = 1 << 7,
    INVERTER_DRIVER_SUPPLY_LOW = 1 << 8,
    INVERTER_DRIVER_GATE_SUPPLY_LOW = 1 << 9,
    INVERTER_DRIVER_GATE_SUPPLY_HIGH = 1 << 10,
    INVERTER_DRIVER_LOST = 1 << 11, /* it does not hold what was written to it */
    INVERTER_DRIVER_BITS = 12
};

/* Clock of the timer whose counts are meant here: they are inverter_timer_Hz() times seconds. Any
 * context, also before inverter_init(). */
uint32_t inverter_timer_Hz(void);

/* Least dead time at which the two switches of a leg of this board do not conduct together. 0: any,
 * this port has no switches. Constant. Any context, also before inverter_init(). */
uint32_t inverter_dead_time_least_ns(void);

/* Pins, timer, converters and their trigger; the bridge is off and there are no up-calls yet.
 * Background context, once. On anything but INVERTER_OK inverter_start() must not be called. */
inverter_status_t inverter_init(const inverter_settings_t *settings);

/* From here on app_pwm_period_isr() is called; the bridge stays off until inverter_set()
 * switches it on. */
void inverter_start(void);

/* Mode and compare values from the next top on. Only from app_pwm_period_isr(). Range of
 * compare_counts: 0 to top; larger values act as top. Ignored while a fault is latched. */
void inverter_set(inverter_mode_t mode, const uint16_t compare_counts[3]);

/* Switches all six switches off at once and latches a fault. Any context, also from fault handlers
 * and before inverter_init(). */
void inverter_trip(void);

/* True from the moment the break input acted, the gate driver reported a fault or inverter_trip()
 * was called until inverter_clear_fault() succeeds. Any context. */
bool inverter_fault(void);

/* What the gate driver reported at its latest fault, INVERTER_DRIVER_... bits; 0: no fault, or a
 * driver that cannot tell. After a fault it makes the driver ready again, without which
 * inverter_clear_fault() does not succeed. Background context, in every pass. */
uint32_t inverter_driver_status(void);

/* Releases the latch, if the cause is gone, and that of a gate driver that has one, which may take
 * until the next call; the bridge stays off until the next inverter_set(). Any context but the PWM
 * period's: interrupts may wait for 10 us. */
void inverter_clear_fault(void);

#endif
