/* SPDX-License-Identifier: Apache-2.0 */
/*
 * analog.h: phase currents, bus voltage, temperatures.
 *
 * The three phase currents are sampled at the same instant, in the middle of the low pulses, half
 * the dead time after the top of the centre-aligned count. Codes are right-aligned 12-bit. Full
 * scales are properties of the board; the configuration gives them too
 * (drive.current_full_scale_mA, drive.voltage_full_scale_mV), and start-up compares the two. Ports
 * do not scale.
 */
#ifndef HAL_ANALOG_H
#define HAL_ANALOG_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/analog_curve.h"

typedef struct {
    /* Phases a, b, c: 2048 = zero current, rising with current into the motor. */
    uint16_t phase_current_code[3];
    uint16_t bus_voltage_code; /* 4096 = full scale */
} analog_sample_t;

/* By shunt, gain, divider and reference of the board. 0: any, this port has no such parts. */
typedef struct {
    int32_t current_full_scale_mA; /* half the range of the codes */
    int32_t voltage_full_scale_mV; /* all of it */
    /* Without the dead time, how long a low side has to conduct before the sample; 0: the shunts
     * carry the current all the time. */
    int32_t low_side_least_ns;
    int32_t switch_25C_code; /* of the switches' sensor at 25 degrees Celsius, by its divider */
} analog_scale_t;

/* Constant. Any context. */
analog_scale_t analog_scale(void);

/* The sample of this PWM period. Only from app_pwm_period_isr(). */
void analog_read(analog_sample_t *sample);

/* Hundredths of a degree Celsius or ANALOG_TEMPERATURE_BROKEN_cC, from the latest sample,
 * unfiltered. curve: of the sensor; a port without converters does not look at it. Any context. */
int32_t analog_winding_temperature_cC(const analog_curve_t *curve);
int32_t analog_switch_temperature_cC(const analog_curve_t *curve);

enum { ANALOG_PEDAL_CHANNELS = 4 };

/* Codes of accelerator a and b, brake pedal a and b, 4096 = the sensors' supply, which is the
 * converters' reference as well. A channel that the board lacks is 0, as an open one. False, and
 * the codes untouched, if there is no new sample since the last call. Only from
 * app_millisecond_isr(). */
bool analog_pedals(uint16_t code[ANALOG_PEDAL_CHANNELS]);

#endif
