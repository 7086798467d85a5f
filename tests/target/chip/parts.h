/* SPDX-License-Identifier: Apache-2.0 */
/* parts.h: what the parts of the chip share. A part has reset, read, write and event functions; its
 * registers are in chip->word, as last written or set. */
#ifndef CHIP_PARTS_H
#define CHIP_PARTS_H

#include <unicorn/unicorn.h>

#include "chip.h"

enum {
    CHIP_WINDOWS_MOST = 3,
    CHIP_WORDS = 0x84000 / 4, /* of all windows */
    CHIP_CORE_BASE = (int)0xE0000000,
    CHIP_CORE_BYTES = 0x100000,
    CHIP_FLASH_BASE = 0x08000000,
    CHIP_SYSTEM_BASE = 0x1FFF0000,
    CHIP_SYSTEM_BYTES = 32 << 10,
    CHIP_RAM_BASE = 0x20000000,
    CHIP_EXCEPTIONS = 16 + CHIP_INTERRUPTS,
    CHIP_NESTING = 16,
    CHIP_FLASH_FIXES = 8,
    CHIP_MPU_REGIONS = 8,
    EXCEPTION_NMI = 2,
    EXCEPTION_HARD_FAULT = 3,
    EXCEPTION_BUS_FAULT = 5,
    EXCEPTION_PENDSV = 14,
    EXCEPTION_SYSTICK = 15
};
#define CHIP_NEVER UINT64_MAX

typedef struct {
    chip_ticks_t next_end; /* of the count */
    chip_ticks_t trigger;  /* of the converters; CHIP_NEVER: none in this half */
    uint32_t repetitions;
    uint32_t active_compare[4], active_top;
    bool runs, down;
    bool break_active;
} chip_timer1_t;

typedef struct {
    chip_ticks_t injected_end, regular_end[2];
    bool is_triggered; /* chip_sample() is due */
    int64_t trigger_from_top, hold_from_top;
    int64_t sampling;                                   /* that ends with the hold */
    chip_ticks_t regulated[2], calibrated[2], ready[2]; /* STM32G431 */
} chip_converters_t;

/* Who is sending on the CAN bus. */
typedef enum { CHIP_IDLE, CHIP_ITSELF, CHIP_VEHICLE, CHIP_OTHER } chip_sender_t;

typedef struct {
    chip_ticks_t bus_free; /* when the next frame can begin */
    chip_sender_t sender;
    unsigned which; /* CHIP_ITSELF: mailbox; CHIP_OTHER: node */
    chip_frame_t on_bus;
    chip_ticks_t ends; /* of the frame on the bus */
    chip_frame_t to_chip[CHIP_FRAMES];
    chip_ticks_t to_chip_since[CHIP_FRAMES];
    unsigned first, count; /* of to_chip */
    chip_node_t *other;
    unsigned others;
    chip_ticks_t others_next; /* when the first of them wants to begin */
    chip_frame_t fifo[3];
    unsigned fifo_count;
    unsigned fifo_get, put; /* STM32G431: elements of the message memory */
    bool fifo_lost;
    unsigned order[CHIP_MAILBOXES], order_count; /* mailboxes in the order of their requests */
    chip_ticks_t requested[CHIP_MAILBOXES];
    chip_frame_t from_chip[CHIP_FRAMES];
    unsigned out_first, out_count;
    chip_ticks_t joined; /* eleven recessive bits after leaving initialisation */
} chip_can_t;

typedef struct {
    char text[CHIP_TEXT_BYTES];
    uint32_t size;
    chip_ticks_t shifted; /* the shift register is empty again */
    bool holds;           /* a byte waits behind it */
    uint8_t next;
    uint8_t in[8], out[8]; /* STM32G431: FIFO */
    unsigned in_count, out_count;
    char typed[256];
    unsigned typed_first, typed_count;
    chip_ticks_t next_byte;
} chip_serial_t;

typedef struct {
    uint32_t size[8]; /* of a stream's or a channel's transfer */
} chip_dma_t;

typedef struct {
    bool enabled, select, clock, data_out;
    chip_ticks_t ready; /* takes commands and drives gates */
    chip_ticks_t disabled_at, selected_at, risen_at;
    uint32_t in, out, answer;
    unsigned bits;
    uint32_t control[2];
    uint32_t status, latched; /* over-currents: since the last reading; that hold a leg off */
    bool limits;              /* holds a leg off until its next edge, reports nothing here */
} chip_driver_t;

typedef struct {
    unsigned keys; /* of the unlock sequence */
    chip_ticks_t busy;
    uint32_t operations;
    unsigned fixes; /* stores that are not yet what the flash makes of them */
    uint32_t fix_address[CHIP_FLASH_FIXES], fix_value[CHIP_FLASH_FIXES];
    /* STM32G431: a double word in work; those whose code is wrong. */
    uint32_t first_address, first_word, before[2];
    uint8_t broken[CHIP_FLASH_BYTES / 8];
    bool watches_reads;
    uc_hook read_hook;
    unsigned unreadable;
} chip_flash_t;

typedef struct {
    chip_ticks_t base; /* of DWT_CYCCNT and SysTick */
    chip_ticks_t tick; /* the next one */
    bool enabled[CHIP_EXCEPTIONS], pending[CHIP_EXCEPTIONS], active[CHIP_EXCEPTIONS];
    uint8_t priority[CHIP_EXCEPTIONS];
    unsigned nesting;
    unsigned stacked[CHIP_NESTING];
    uc_context *context[CHIP_NESTING];
} chip_nvic_t;

typedef struct {
    uint32_t control;
    unsigned number;
    uint32_t base[CHIP_MPU_REGIONS], attributes[CHIP_MPU_REGIONS];
} chip_mpu_t;

/* Addresses at which peripherals answer. */
typedef struct {
    chip_t *chip;
    uint32_t begin, bytes;
} chip_window_t;

struct chip {
    uc_engine *core;
    chip_window_t window[CHIP_WINDOWS_MOST];
    uint32_t word[CHIP_WORDS];
    uint16_t known[CHIP_WORDS]; /* index in CHIP_REGISTERS + 1 */
    uint32_t core_word[CHIP_CORE_BYTES / 4];
    uint8_t flash_at_power_on[CHIP_FLASH_BYTES];
    uint8_t instructions[CHIP_FLASH_BYTES / 2]; /* of the block that begins there */
    bool sets_conditions[CHIP_FLASH_BYTES / 2]; /* the block: of an IT instruction */
    chip_ticks_t now, deadline;
    uint32_t ticks_per_cycle;
    bool needs_attention;     /* an exception may have become pending */
    bool drops_conditions;    /* of an IT block that is over */
    bool may_have_conditions; /* of an IT block before the next block */
    bool reset_requested;
    chip_reset_t reset_by; /* the next reset, if one is requested */
    bool has_power;
    unsigned resets, watchdog_resets;
    chip_ticks_t crystal_ready, pll_ready;
    chip_ticks_t watchdog_end;
    chip_ticks_t stepped;     /* STM32G431: the core's clock has changed */
    chip_ticks_t break_since; /* STM32G431: TIM1's second break input is active */
    uint16_t pin_levels;      /* of the lines of EXTI, when last looked at */
    uint32_t random;

    chip_inputs_t in;
    chip_faults_t fault;
    chip_nvic_t nvic;
    chip_mpu_t mpu;
    chip_timer1_t timer1;
    chip_ticks_t timer8_zero; /* when its count was 0, if it counts */
    chip_converters_t adc;
    chip_can_t can;
    chip_serial_t serial;
    chip_dma_t dma;
    chip_flash_t flash;
    chip_driver_t driver;

    unsigned bus_faults;
    uint32_t bus_fault_at; /* instruction of the latest one */
    uint32_t missing;      /* address of the latest access without a memory */
    bool missing_code;     /* it was a fetch */

    struct chip_meter *meter; /* NULL: not metered */

    unsigned violations;
    char violation[CHIP_VIOLATIONS][CHIP_VIOLATION_BYTES];
};

/* The place of a register's word: the windows at 0x40000000, 0x48000000 and 0x50000000 in one row.
 */
static inline uint32_t chip_index(uint32_t address)
{
    switch (address >> 24) {
    case 0x48:
        return (0x80000U + (address & 0x1FFFU)) / 4U;
    case 0x50:
        return (0x82000U + (address & 0x1FFFU)) / 4U;
    default:
        return (address & 0x7FFFFU) / 4U;
    }
}

/* The register at this address. */
static inline uint32_t *chip_at(chip_t *chip, uint32_t address)
{
    return &chip->word[chip_index(address)];
}

static inline uint32_t chip_get(const chip_t *chip, uint32_t address)
{
    return chip->word[chip_index(address)];
}

static inline uint32_t chip_field(const chip_t *chip, uint32_t address, uint32_t mask)
{
    return (chip_get(chip, address) & mask) / (mask & -mask);
}

__attribute__((format(printf, 2, 3))) void chip_note(chip_t *chip, const char *format, ...);
uint32_t chip_random(chip_t *chip);

/* core.c */
bool chip_core_open(chip_t *chip);
void chip_request_reset(chip_t *chip, chip_reset_t cause);
void chip_pend(chip_t *chip, unsigned exception);

/* A peripheral's register, over the bus. */
uint32_t chip_bus_read(chip_t *chip, uint32_t address);
void chip_bus_write(chip_t *chip, uint32_t address, uint32_t value);

/* meter.c: after an exception was entered, with a block that is about to be executed, before an
 * exception is left. */
void chip_meter_enter(chip_t *chip);
void chip_meter_block(chip_t *chip, uint32_t address, uint32_t bytes, uint32_t instructions);
void chip_meter_leave(chip_t *chip);

/* exceptions.c: NVIC, SysTick, system control, cycle counter. */
void chip_nvic_reset(chip_t *chip);
uint32_t chip_core_read(chip_t *chip, uint32_t address);
void chip_core_write(chip_t *chip, uint32_t address, uint32_t value);
/* Number of the exception to be taken now; 0: none. */
unsigned chip_exception_due(chip_t *chip);
/* An access that no memory answers (B1.5.14, B3.2.15); fetch: of an instruction. */
void chip_bus_fault(chip_t *chip, uint32_t address, bool fetch);
/* Whether one is pending, masked or not. */
bool chip_exception_waits(const chip_t *chip);
void chip_exception_enter(chip_t *chip, unsigned exception);
void chip_exception_return(chip_t *chip);
chip_ticks_t chip_nvic_next(chip_t *chip);
void chip_nvic_events(chip_t *chip);

/* mpu.c */
#define CHIP_MPU_TYPE 0xE000ED90U
#define CHIP_MPU_CTRL 0xE000ED94U
#define CHIP_MPU_RNR 0xE000ED98U
#define CHIP_MPU_RBAR 0xE000ED9CU
#define CHIP_MPU_RASR 0xE000EDA0U
void chip_mpu_reset(chip_t *chip);
bool chip_mpu_write(chip_t *chip, uint32_t address, uint32_t value);

/* part.c of the chip: what it consists of. */
typedef struct {
    uint32_t begin; /* of 1 KiB of registers */
    uint32_t (*read)(chip_t *chip, uint32_t address);
    bool (*write)(chip_t *chip, uint32_t address, uint32_t value); /* false: is to be stored */
} chip_route_t;
extern const chip_route_t CHIP_ROUTES[]; /* ends with begin 0 */
void chip_part_reset(chip_t *chip);
void chip_part_watch(chip_t *chip);
chip_ticks_t chip_part_next(chip_t *chip);
/* The lines of the interrupts, by chip_line(). */
void chip_part_lines(chip_t *chip);
/* Flags of TIM1_SR whose break input is active now. */
uint32_t chip_part_break(chip_t *chip);
void chip_part_pins_written(chip_t *chip);
/* Whether the board drives this pin, and how. */
bool chip_part_level(const chip_t *chip, char port, unsigned pin, bool *level);
typedef enum { CHIP_DRIVERS_FOLLOW, CHIP_DRIVERS_OFF, CHIP_DRIVERS_HOLD_A_LEG } chip_drivers_t;
chip_drivers_t chip_part_drivers(const chip_t *chip);

/* A line that is high pends its interrupt again unless its handler runs. */
static inline void chip_line(chip_t *chip, unsigned exception, bool high)
{
    chip->nvic.pending[exception] |= high && !chip->nvic.active[exception];
}

/* clocks.c: RCC, PWR, wait states. */
void chip_clocks_reset(chip_t *chip, chip_reset_t cause, uint32_t status);
bool chip_clocks_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_noise_read(chip_t *chip, uint32_t address);
bool chip_noise_write(chip_t *chip, uint32_t address, uint32_t value);

uint32_t chip_clocks_read(chip_t *chip, uint32_t address);
bool chip_has_clock(const chip_t *chip, uint32_t address);
uint32_t chip_bus_ticks(const chip_t *chip, uint32_t prescaler_mask);
chip_ticks_t chip_clocks_next(chip_t *chip);
void chip_clocks_events(chip_t *chip);

/* flash.c */
void chip_flash_reset(chip_t *chip);
bool chip_flash_register(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_flash_read(chip_t *chip, uint32_t address);
void chip_flash_program(chip_t *chip, uint32_t address, uint32_t size, uint32_t value);

/* cells.c: what erasing and programming have alike. */
uint32_t chip_cells_word(chip_t *chip, uint32_t address);
void chip_cells_set(chip_t *chip, uint32_t address, uint32_t value);
/* Counts an operation. True if the supply fails in it. */
bool chip_cells_cut(chip_t *chip);
/* Notes an operation while the gates switch. */
void chip_cells_check_stall(chip_t *chip, const char *what);
/* How much of a change is done when the supply fails, the same for all words of an operation. */
uint32_t chip_cells_style(chip_t *chip);
uint32_t chip_cells_partly(chip_t *chip, uint32_t style, uint32_t changes);
/* After the store in hand the word is this. */
void chip_cells_fix(chip_t *chip, uint32_t address, uint32_t value);
void chip_flash_settle(chip_t *chip);

/* watchdog.c: the independent one, on its own oscillator. */
bool chip_watchdog_write(chip_t *chip, uint32_t address, uint32_t value);
void chip_watchdog_events(chip_t *chip);

/* can_bus.c: the bus of 500 kbit/s, its nodes and their arbitration. */
#define CHIP_CAN_BIT_TICKS (2U * (uint32_t)CHIP_TICKS_PER_US)
/* The next beginning or end of a frame; begins one that is due. */
chip_ticks_t chip_can_next(chip_t *chip);
void chip_can_events(chip_t *chip);
/* Whether this mailbox is on the bus now. */
bool chip_can_sends(const chip_t *chip, unsigned mailbox);
/* Notes a request of this mailbox, or its end. */
void chip_can_request(chip_t *chip, unsigned mailbox);
void chip_can_forget(chip_t *chip, unsigned mailbox);

/* driver.c: the gate driver. */
void chip_driver_reset(chip_t *chip);
void chip_driver_pins(chip_t *chip);
void chip_driver_watch(chip_t *chip);
bool chip_driver_pulls_fault(const chip_t *chip);
bool chip_driver_holds_a_leg(const chip_t *chip);
bool chip_driver_drives(const chip_t *chip);
bool chip_driver_data(const chip_t *chip);

/* pins.c: GPIO, TIM3, edges at the lines of EXTI. */
void chip_pins_watch(chip_t *chip);
bool chip_pin_is_output(const chip_t *chip, char port, unsigned pin);
uint32_t chip_pins_read(chip_t *chip, uint32_t address);
bool chip_pins_write(chip_t *chip, uint32_t address, uint32_t value);
bool chip_pin_is_analog(const chip_t *chip, char port, unsigned pin);
bool chip_pin_function(const chip_t *chip, char port, unsigned pin, unsigned function);
bool chip_pin_level(chip_t *chip, char port, unsigned pin);
typedef struct {
    char port;
    uint8_t pin, function;
} chip_pin_t;
static inline bool chip_pin_selects(const chip_t *chip, chip_pin_t pin)
{
    return chip_pin_function(chip, pin.port, pin.pin, pin.function);
}

/* timer1.c */
void chip_timer1_reset(chip_t *chip);
bool chip_timer1_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_timer1_read(chip_t *chip, uint32_t address);
chip_ticks_t chip_timer1_next(chip_t *chip);
void chip_timer1_events(chip_t *chip);
/* The counter runs and its outputs are enabled. */
bool chip_timer1_drives(const chip_t *chip);

/* A clock of the timers at the second peripheral bus. */
uint32_t chip_timer_ticks(const chip_t *chip);

/* timer8.c */
void chip_timer8_reset(chip_t *chip);
bool chip_timer8_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_timer8_read(chip_t *chip, uint32_t address);
chip_ticks_t chip_timer8_next(chip_t *chip);
void chip_timer8_events(chip_t *chip);

/* converters.c */
void chip_adc_reset(chip_t *chip);
bool chip_adc_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_adc_read(chip_t *chip, uint32_t address);
bool chip_adc_listens(const chip_t *chip);
void chip_adc_inject(chip_t *chip);
chip_ticks_t chip_adc_next(chip_t *chip);
void chip_adc_events(chip_t *chip);

/* can.c: the controller, as the bus sees it. */
void chip_can_reset(chip_t *chip);
bool chip_can_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_can_read(chip_t *chip, uint32_t address);
/* The mailbox that takes part in the next arbitration; CHIP_MAILBOXES: none. */
unsigned chip_can_offered(chip_t *chip);
chip_frame_t chip_can_mailbox(const chip_t *chip, unsigned mailbox);
/* Of two frames that begin together the one with the lower number stays. */
uint32_t chip_can_arbitration(uint32_t identifier);
/* Its frame has been acknowledged. */
void chip_can_sent(chip_t *chip, unsigned mailbox);
void chip_can_received(chip_t *chip, const chip_frame_t *frame);

/* serial.c */
void chip_serial_reset(chip_t *chip);
bool chip_serial_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_serial_read(chip_t *chip, uint32_t address);
chip_ticks_t chip_serial_next(chip_t *chip);
void chip_serial_events(chip_t *chip);

/* dma.c, of both chips and of each */
void chip_dma_move(chip_t *chip, uint32_t peripheral, uint32_t memory, bool to_memory);
/* A word from memory. */
void chip_dma_put_word(chip_t *chip, uint32_t peripheral, uint32_t memory);
/* The request of TIM8's update. */
void chip_dma_serve_timer8(chip_t *chip);
bool chip_dma_write(chip_t *chip, uint32_t address, uint32_t value);
uint32_t chip_dma_read(chip_t *chip, uint32_t address);
void chip_dma_serve(chip_t *chip);

#endif
