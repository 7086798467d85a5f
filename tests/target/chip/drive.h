/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive.h: the chip with its image as the controller of one wheel of the bench: the plant's
 * currents, voltages, temperatures and rotor at the pins, the six gates at the plant's bridge, the
 * vehicle's messages on the CAN bus.
 *
 * How the board wires them: wiring.c of the chip.
 *
 * The bench's period ends with the update at the top of the count. What the program changes in
 * between that acts at once on a board (outputs on and off) reaches the plant at the next top.
 */
#ifndef CHIP_DRIVE_H
#define CHIP_DRIVE_H

#include "bench/vehicle_can.h"
#include "bench/wheel.h"
#include "chip.h"

typedef struct drive {
    chip_t *chip;
    vehicle_can_t vehicle;
    /* Not NULL: who is on the CAN bus instead of the bench's vehicle, once a millisecond; and is
     * given every frame of the chip. */
    void (*exchange)(struct drive *drive, const slow_input_t *in);
    void (*seen)(const chip_frame_t *frame);
    int32_t period_counts; /* of the plant's bridge */
    chip_ticks_t period;   /* PWM */
    uint32_t dead_time_ns; /* that the gates must keep, at least */
    bool driver_fails;     /* the gate driver reports a fault */
    unsigned periods_without_sample, switching_periods;
    unsigned lost_currents; /* sampled while the low side did not conduct for long enough */
    bool reported;          /* a violation of its own is noted once */
} drive_t;

/* Connects a chip with the pins at rest and lets it boot. `drive` has to stay where it is. */
void drive_begin(drive_t *drive, chip_t *chip, const config_t *config);

wheel_coupling_t drive_coupling(drive_t *drive);

#endif
