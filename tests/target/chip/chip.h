/* SPDX-License-Identifier: Apache-2.0 */
/*
 * chip.h: an STM32F405 or an STM32G431 as far as the flashable image uses it, from the reference
 * manual (RM0090, RM0440) and the vendor's description of its registers, around a core emulated by
 * Unicorn. It knows nothing of the drivers in hal. Which of the two is in force is decided by the
 * include path: part.h of stm32f405 or of stm32g431.
 *
 * Time is counted in ticks, of which every clock of the chip is a whole number. An
 * instruction takes one cycle of the core. Interrupts are taken at the boundaries of basic blocks,
 * by priority, with the stack frames of the architecture.
 *
 * What the manuals forbid is noted (chip_violations()) and has the effect they say, or none: a
 * register of a peripheral without its clock, a reserved register, a write to a read-only one, a
 * flash faster than its wait states, a locked field, both switches of a leg on.
 */
#ifndef CHIP_H
#define CHIP_H

#include <stdbool.h>
#include <stdint.h>

#include "part.h"

typedef uint64_t chip_ticks_t;

#define CHIP_TICKS_PER_SECOND (CHIP_TICKS_PER_US * 1000000ULL)

enum {
    CHIP_ANALOG_CHANNELS = 16,
    CHIP_FRAMES = 64,
    CHIP_MAILBOXES = 3,
    CHIP_TEXT_BYTES = 65536,
    CHIP_VIOLATIONS = 16,
    CHIP_VIOLATION_BYTES = 120
};

/* A register in the vendor's description. access: 1 readable, 2 writable. */
typedef struct {
    const char *name;
    uint32_t address, reset, bits;
    unsigned access;
} chip_register_t;

extern const chip_register_t CHIP_REGISTERS[];
extern const unsigned CHIP_REGISTER_COUNT;

#define CHIP_EXTENDED (UINT32_C(1) << 31)

typedef struct {
    uint32_t identifier; /* 11 bits, or 29 and CHIP_EXTENDED */
    uint8_t length;
    uint8_t data[8];
    chip_ticks_t ended; /* from the chip: when it had been on the bus */
} chip_frame_t;

/* Another node on the bus: a frame of eight bytes in each period. Its newest one replaces one that
 * has not left. */
typedef struct {
    uint16_t identifier;
    chip_ticks_t period;
    chip_ticks_t next;  /* when its next frame wants to begin */
    unsigned sent;      /* frames so far */
    chip_ticks_t delay; /* the longest from then to its end */
} chip_node_t;

/* What is connected to the pins. Analogue inputs by the channel that the converters share. */
typedef struct {
    uint16_t analog_code[CHIP_ANALOG_CHANNELS]; /* 0 .. 4095; STM32G431: bus, switch thermistor */
    double current_a[3];                        /* STM32G431: of the phases, into the motor */
    uint16_t driven[6];                         /* ports A to F: pins that the board drives */
    uint16_t level[6];                          /* and how */
    uint16_t spike[6];                          /* shown inverted at the port's next read alone */
    uint16_t encoder_count;                     /* of the quadrature signals at TIM3 */
    uint16_t encoder_index_count;               /* count at the latest index pulse */
    bool encoder_index;                         /* one has come since the last call */
} chip_inputs_t;

/* What six gates do in a PWM period. */
typedef enum { CHIP_BRIDGE_OFF, CHIP_BRIDGE_SWITCHES, CHIP_BRIDGE_FORBIDDEN } chip_bridge_t;
typedef struct {
    chip_bridge_t bridge;
    uint32_t high_on_counts[3]; /* of chip_gates_t.top_counts, without the dead time */
    uint32_t top_counts;
    uint32_t dead_time_ticks;
} chip_gates_t;

/* Faults of the chip and of its supply. */
typedef struct {
    bool crystal_dead; /* from the start, or from now on */
    bool pll_does_not_lock;
    bool converter_stuck;   /* injected conversions never end */
    bool timer_stuck;       /* TIM1 has no clock */
    bool core_stuck;        /* it executes nothing, until a reset and after it */
    bool can_silent;        /* the bus is held dominant: nothing is received or sent */
    bool can_mute;          /* the wire from the controller to the bus is cut: it only receives */
    bool gate_driver_fault; /* the driver's supply is low: it pulls its fault line, all gates low */
    bool driver_silent;     /* its SDO is stuck high */
    bool driver_mode_low;   /* DRV8302: M_OC is at ground, so it limits instead of latching */
    uint32_t low_side_a_mV; /* STM32F405: voltage across this switch while it is on */
    bool comparators_dead;  /* STM32G431: their outputs stay low */
    int32_t low_side_a_mA;  /* STM32G431: in its shunt to ground; 0: the phase's */
    uint64_t low_side_a_ends;  /* chip_now() at its end; 0: it stays */
    int32_t amplifier_bias_mV; /* STM32G431: at VINM0 of each amplifier */
    bool supply_low;
    bool brown_out_off;       /* option bytes as delivered */
    uint32_t flash_cut_after; /* from 1: the supply fails at this flash operation; 0: never */
} chip_faults_t;

typedef struct chip chip_t;

/* A chip with this ELF in its flash, at power-on. NULL and a line on stderr if the file cannot be
 * used. */
chip_t *chip_open(const char *elf_path);
void chip_close(chip_t *chip);

/* What is random from here on: content of the RAM at power-on, bits of a cut flash operation. */
void chip_seed(chip_t *chip, uint32_t seed);

/* Takes the supply away and gives it back: RAM is random, flash stays. */
void chip_power_cycle(chip_t *chip);

chip_inputs_t *chip_inputs(chip_t *chip);
chip_faults_t *chip_faults(chip_t *chip);

/* What resets the chip but its supply; not all chips have all. */
typedef enum {
    CHIP_RESET_SUPPLY,
    CHIP_RESET_BROWN_OUT,
    CHIP_RESET_WATCHDOG,
    CHIP_RESET_WINDOW_WATCHDOG,
    CHIP_RESET_LOW_POWER,
    CHIP_RESET_PROGRAM,
    CHIP_RESET_OPTION_BYTES,
    CHIP_RESET_PIN,
    CHIP_RESETS
} chip_reset_t;
void chip_reset_by(chip_t *chip, chip_reset_t cause);

/* Its maker's bootloader runs, with its own stack, its vectors at address 0 and the clocks as after
 * a reset. It does nothing here. */
bool chip_in_bootloader(const chip_t *chip);

/* Runs for so long. */
void chip_run(chip_t *chip, chip_ticks_t duration);

/* Runs to the next trigger of the converters, or for `most` if there is none. Returns whether there
 * was one; the converters sample with the next chip_run...(). */
bool chip_run_to_sample(chip_t *chip, chip_ticks_t most);

/* From the top of the count to the moment at which the latest currents were held. */
int64_t chip_hold_from_top_ticks(const chip_t *chip);

/* Converts what is at the pins now and goes on to the update of TIM1 that follows, if a trigger is
 * due. */
void chip_sample(chip_t *chip);

chip_gates_t chip_gates(chip_t *chip);
/* The program drives this pin high; low. */
bool chip_drives_high(chip_t *chip, char port, unsigned pin);
bool chip_drives_low(chip_t *chip, char port, unsigned pin);

/* The converters' interrupt is being handled. */
bool chip_in_interrupt(const chip_t *chip);
/* The timer's outputs are enabled. */
bool chip_outputs_on(const chip_t *chip);
/* Whether a leg's low side, its diode included, carries the phase's current from so long before the
 * converters' next sampling to its end; all gates off: its diode may. */
bool chip_low_side_conducts(chip_t *chip, unsigned leg, bool into_motor, int64_t before_ticks);
chip_ticks_t chip_now(const chip_t *chip);

/* CAN: a frame for the chip, at the end of the vehicle's queue; a frame from it, oldest first. */
void chip_send(chip_t *chip, const chip_frame_t *frame);
bool chip_receive(chip_t *chip, chip_frame_t *frame);
/* Other nodes from now on; the array stays the caller's and changes with what they send. */
void chip_traffic(chip_t *chip, chip_node_t *nodes, unsigned count);
/* How long a frame with an identifier of 11 bits is on the bus, with the three bits between two
 * frames. */
chip_ticks_t chip_can_frame_ticks(unsigned bytes);

/* Disturbances, from the next instruction on: r0 to r12 hold this value; the next instruction is
 * fetched from this address. */
void chip_spoil_registers(chip_t *chip, uint32_t value);
void chip_derail(chip_t *chip, uint32_t address);
/* Accesses so far that no memory has answered, and the latest instruction with one. */
unsigned chip_bus_faults(const chip_t *chip, uint32_t *instruction);

/* The serial line: all that the chip has written, and typing on it. */
const char *chip_text(const chip_t *chip);
void chip_type(chip_t *chip, const char *text);

/* ---- what interrupts execute (meter.c) ---- */

/* Instructions one behind the other, entered at the first and left behind the last. */
typedef struct {
    uint32_t address, bytes;
} chip_block_t;

enum { CHIP_EXCEPTION_MILLISECOND = 15 }; /* SysTick */

/* From a handler's first instruction to its return. What interrupted it is not in it, nor the
 * core's stacking. An instruction whose condition fails counts. */
typedef struct {
    unsigned exception; /* as in the vector table */
    uint32_t instructions;
    const chip_block_t *block; /* in the order of their execution */
    uint32_t count;
} chip_handled_t;
typedef void chip_handled_call_t(void *context, const chip_handled_t *handled);

/* From now on `call` is called at each handler's return; NULL: no more. False: no memory. */
bool chip_meter(chip_t *chip, chip_handled_call_t *call, void *context);

/* Whether this is the converters' interrupt, in which the PWM period is worked out. */
bool chip_is_pwm_interrupt(unsigned exception);

/* A register of a peripheral as last written or set; false: it is the core's. */
bool chip_register(const chip_t *chip, uint32_t address, uint32_t *value);

/* Bytes of the memories; false if there are none. */
bool chip_read(chip_t *chip, uint32_t address, void *bytes, uint32_t size);
bool chip_write(chip_t *chip, uint32_t address, const void *bytes, uint32_t size);

/* What the memory protection unit lets privileged code do now, in the handlers of NMI and hard
 * fault what it lets them do. */
typedef enum { CHIP_READ, CHIP_WRITE, CHIP_EXECUTE } chip_access_t;
bool chip_mpu_lets(const chip_t *chip, uint32_t address, chip_access_t access);

/* Resets so far, the first included; by the watchdog. */
unsigned chip_resets(const chip_t *chip);
unsigned chip_watchdog_resets(const chip_t *chip);
/* Erases and writes of the flash since power-on. */
uint32_t chip_flash_operations(const chip_t *chip);
/* STM32G431: reads of the flash whose error could not be corrected. */
unsigned chip_unreadable(const chip_t *chip);
bool chip_has_power(const chip_t *chip);

/* Notes something forbidden that is seen from outside of the chip. */
void chip_violate(chip_t *chip, const char *text);
unsigned chip_violations(const chip_t *chip);
/* The first ones in words; NULL beyond the last. */
const char *chip_violation_text(const chip_t *chip, unsigned number);

#endif
