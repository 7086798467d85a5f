/* SPDX-License-Identifier: Apache-2.0 */
/*
 * port.h: the host's board. Implements hal/ on a plant that a test or the bench supplies, so that
 * the application, up to main(), runs on a host exactly as on a board.
 *
 * One thread; interrupts are calls. A PWM period passes in host_step(), in this order, which is
 * that of a real board:
 *
 *     top of the count    the compare values of the period before become active     plant.drive
 *                         currents, bus voltage and rotor are sampled               plant.sample
 *                         app_pwm_period_isr()
 *     when one is due     app_millisecond_isr()
 *
 * main() needs no change: every call of time_running() advances one period. A caller with its own
 * clock, such as the bench, calls the two parts of a step itself instead.
 */
#ifndef HOST_PORT_H
#define HOST_PORT_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/can.h"
#include "hal/inverter.h"
#include "hal/packets.h"
#include "hal/rotor_sensor.h"
#include "hal/watchdog.h"

/* What the board measures, in the units of hal/analog.h and hal/rotor_sensor.h. */
typedef struct {
    uint16_t phase_current_code[3];
    uint16_t bus_voltage_code;
    uint16_t rotor_angle_turn;
    uint8_t hall_state;
    rotor_sensor_encoder_t encoder;
    bool power_stage_fault;
    int32_t winding_temperature_cC;
    int32_t switch_temperature_cC;
    uint16_t pedal_code[4]; /* accelerator a and b, brake pedal a and b */
} host_sample_t;

/* The plant: two functions and their context. */
typedef struct {
    void *context;
    host_sample_t (*sample)(void *context);
    /* Bridge mode and compare values of the period that begins now. */
    void (*drive)(void *context, inverter_mode_t mode, const uint16_t compare_counts[3]);
} host_plant_t;

enum { HOST_FLASH_BYTES = 16384, HOST_CAN_FRAMES = 32, HOST_SERIAL_BYTES = 65536 };

/* Resets the port, connects a plant and stores an image (of at most HOST_FLASH_BYTES) at the
 * address of the configuration; the rest of that memory is erased. Before app_boot(). */
void host_connect(const host_plant_t *plant, const void *configuration, uint32_t size_bytes);

/* A reset of the core: flash and what was written to the serial line stay, and the retained memory
 * unless the supply was away (RESET_POWER). Before app_boot(). */
void host_restart(reset_cause_t cause);

/* Number of PWM periods after which time_running() returns false; 0 (also after host_connect()):
 * never. */
void host_run_for(uint32_t periods);

/* Makes time_init() report a failed clock, as on a board without its crystal. */
void host_break_clock(bool broken);

/* Makes rotor_sensor_init() report a missing sensor. */
void host_remove_rotor_sensor(bool missing);

/* Advances one PWM period. Interrupts that were not started are not called. */
void host_step(void);

/* The two parts of it: the top of the count, and a millisecond of the clock, in whatever phase they
 * are to each other. */
void host_pwm_period(void);
void host_millisecond(void);

/* From now on the handler of an interrupt is not entered, the timers go on: the bridge keeps its
 * last compare values until the stop timer takes it. */
void host_hang(bool pwm_period, bool millisecond);

/* The vehicle's side of CAN. A frame whose identifier is not accepted, or for which the queue is
 * full, is lost. The controller's frames are acknowledged by receiving them, the lowest identifier
 * first; without a call none leaves. */
void host_can_send(const can_frame_t *frame);
bool host_can_receive(can_frame_t *frame);

/* The other end of hal/packets.h: false, there is no place, and there is none. */
bool host_packet_send(const packet_t *packet);
bool host_packet_receive(packet_t *packet);

/* Everything written to the serial line so far, zero terminated; and typing on it. */
const char *host_serial_output(void);
void host_serial_type(const char *text);
void host_serial_put(const char *bytes, uint32_t size);

/* A terminal: takes what was written, at most `size` bytes, which makes space for more. */
uint32_t host_serial_take(char *bytes, uint32_t size);

/* Has the watchdog, on the simulated clock, run out since host_connect() or host_restart()? */
bool host_watchdog_bit(void);

#endif
