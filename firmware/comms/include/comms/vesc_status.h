/* SPDX-License-Identifier: Apache-2.0 */
/*
 * vesc_status.h: what a wheel does, in the status frames of a VESC, for displays and loggers made
 * for those. Background context. Pure.
 *
 * The identifier has 29 bits: packet number times 256, plus the controller id. Big endian, signed:
 *
 *     frame     packet  bytes 0 .. 3               bytes 4, 5              bytes 6, 7
 *     STATUS         9  electrical speed, 1/min    current, 0.1 A          duty cycle, 0.001
 *     STATUS_2      14  charge drawn, 0.1 mAh      returned, 0.1 mAh (bytes 4 .. 7)
 *     STATUS_3      15  energy drawn, 0.1 mWh      returned, 0.1 mWh (bytes 4 .. 7)
 *     STATUS_4      16  temperatures of switches   bus current, 0.1 A      position, 0.02 degree
 *                       and winding, 0.1 degC each
 *     STATUS_5      27  1/6 electrical turns       bus voltage, 0.1 V      0
 *
 * Source: bldc, documentation/comm_can.md, "Status Commands". A value beyond its range is sent as
 * the end of the range. A temperature that is not available is sent as 300 degC. The position, of a
 * position controller, is always 0. STATUS_6 carries inputs that a wheel does not have, and does
 * not exist here.
 */
#ifndef COMMS_VESC_STATUS_H
#define COMMS_VESC_STATUS_H

#include <stdint.h>

#include "core/frames.h"
#include "core/slow_messages.h"

typedef enum {
    VESC_STATUS,
    VESC_STATUS_2,
    VESC_STATUS_3,
    VESC_STATUS_4,
    VESC_STATUS_5,
    VESC_STATUS_KINDS
} vesc_status_kind_t;

/* Positive: forward, or out of the battery. Sums are since the start. */
typedef struct {
    int32_t speed_mrad_s;   /* mechanical */
    int32_t pole_pairs;     /* 1 .. 60 */
    int32_t i_d_mA, i_q_mA; /* peak phase values */
    dq_t u_pu;              /* applied voltage, Q15 of the voltage circle; zero: bridge off */
    int32_t bus_voltage_mV, bus_current_mA;
    wheel_temperatures_t temperature;
    int64_t turned_urad;              /* mechanical angle */
    uint64_t drawn_uC, returned_uC;   /* charge out of the battery and into it */
    uint32_t drawn_10J, returned_10J; /* likewise energy */
} vesc_status_values_t;

typedef struct {
    uint32_t identifier; /* 29 bits */
    uint8_t data[8];
} vesc_status_frame_t;

uint32_t vesc_status_identifier(vesc_status_kind_t kind, uint8_t controller_id);

/* The current is the length of the current vector, positive while the motor drives, negative while
 * it brakes, in both directions of rotation; the duty cycle the length of the voltage vector, 1
 * being the voltage circle, with the sign of its q component. */
vesc_status_frame_t vesc_status_frame(vesc_status_kind_t kind, uint8_t controller_id,
                                      const vesc_status_values_t *values);

#endif
