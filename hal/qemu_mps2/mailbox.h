/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mailbox.h: the board this port does not have: a structure at a fixed place in RAM, where whoever
 * stands outside the emulator (a file-backed RAM, a plugin, a debugger) puts measurements and reads
 * what the bridge should do.
 *
 * Filled with a motor at rest by inverter_init(), unless MAILBOX_MAGIC already stands there.
 */
#ifndef QEMU_MPS2_MAILBOX_H
#define QEMU_MPS2_MAILBOX_H

#include <stdint.h>

#define MAILBOX_MAGIC 0x4D424F58U /* "XOBM" in memory */

typedef struct {
    uint32_t magic;
    /* in */
    uint16_t phase_current_code[3];
    uint16_t bus_voltage_code;
    uint16_t rotor_angle_turn;
    uint8_t hall_state;
    uint8_t power_stage_fault;
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    uint16_t encoder_count;
    uint16_t encoder_index_count;
    uint32_t encoder_index; /* not 0: an index pulse came; the firmware clears it */
    /* out, valid when `periods` has grown */
    uint16_t compare_counts[3];
    uint8_t mode; /* inverter_mode_t */
    uint8_t tripped;
    uint32_t periods; /* PWM periods since the start */
} mailbox_t;

#define MAILBOX ((volatile mailbox_t *)0x21000000U) /* first page of the machine's main RAM */

#endif
