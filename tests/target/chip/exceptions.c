/* SPDX-License-Identifier: Apache-2.0 */
/* Exceptions of the Cortex-M4 (Arm DDI 0403, B1.5), interrupt controller (B3.4), SysTick (B3.3),
 * system control (B3.2) and cycle counter (C1.8). */
#include <string.h>

#include "blocks.h"
#include "parts.h"

enum {
    AT_DWT_CYCCNT = (int)0xE0001004,
    AT_SYST_CSR = (int)0xE000E010,
    AT_SYST_RVR = (int)0xE000E014,
    AT_SYST_CVR = (int)0xE000E018,
    AT_NVIC_ISER = (int)0xE000E100,
    AT_NVIC_ICER = (int)0xE000E180,
    AT_NVIC_ISPR = (int)0xE000E200,
    AT_NVIC_ICPR = (int)0xE000E280,
    AT_NVIC_IPR = (int)0xE000E400,
    AT_ICSR = (int)0xE000ED04,
    AT_VTOR = (int)0xE000ED08,
    AT_AIRCR = (int)0xE000ED0C,
    AT_SHPR = (int)0xE000ED18,
    AT_SHCSR = (int)0xE000ED24,
    AT_CFSR = (int)0xE000ED28,
    AT_HFSR = (int)0xE000ED2C,
    AT_BFAR = (int)0xE000ED38,
    AT_CPUID = (int)0xE000ED00,
    INTERRUPTS = CHIP_INTERRUPTS,
    LOWEST_PRIORITY = 256
};
static const uint32_t CPUID_CORTEX_M4 = 0x410FC241;
static const uint32_t SYST_ENABLE = 1, SYST_TICKINT = 2;
static const uint32_t ICSR_PENDSVSET = 1U << 28, ICSR_PENDSTSET = 1U << 26;
static const uint32_t AIRCR_KEY = 0x05FA, AIRCR_SYSRESETREQ = 4;
static const uint32_t CONTROL_FPCA = 4;
static const uint32_t SHCSR_BUSFAULTENA = 1U << 17, HFSR_FORCED = 1U << 30;
static const uint32_t CFSR_IBUSERR = 1U << 8, CFSR_PRECISERR = 1U << 9, CFSR_BFARVALID = 1U << 15;

/* The exceptions that can come, for a short look. */
static const uint8_t SOURCES[] = {EXCEPTION_NMI,    EXCEPTION_HARD_FAULT, EXCEPTION_BUS_FAULT,
                                  EXCEPTION_PENDSV, EXCEPTION_SYSTICK,    CHIP_INTERRUPT_SOURCES};
enum { SOURCE_COUNT = sizeof SOURCES };

static uint32_t *word(chip_t *chip, int address)
{
    return &chip->core_word[((uint32_t)address - (uint32_t)CHIP_CORE_BASE) / 4];
}

static int priority_of(const chip_t *chip, unsigned exception)
{
    switch (exception) {
    case EXCEPTION_NMI:
        return -2;
    case EXCEPTION_HARD_FAULT:
        return -1;
    default:
        return chip->nvic.priority[exception] & 0xF0; /* four bits on this chip */
    }
}

static int priority_now(const chip_t *chip)
{
    int priority = LOWEST_PRIORITY;
    for (unsigned i = 0; i < SOURCE_COUNT; i++) {
        if (chip->nvic.active[SOURCES[i]] && priority_of(chip, SOURCES[i]) < priority) {
            priority = priority_of(chip, SOURCES[i]);
        }
    }
    return priority;
}

void chip_nvic_reset(chip_t *chip)
{
    uc_context *kept[CHIP_NESTING];
    memcpy(kept, chip->nvic.context, sizeof kept);
    memset(&chip->nvic, 0, sizeof chip->nvic);
    memcpy(chip->nvic.context, kept, sizeof kept);
    chip->nvic.base = chip->now;
    chip->nvic.tick = CHIP_NEVER;
    for (unsigned i = 0; i < 16; i++) {
        chip->nvic.enabled[i] = true;
    }
}

bool chip_exception_waits(const chip_t *chip)
{
    for (unsigned i = 0; i < SOURCE_COUNT; i++) {
        if (chip->nvic.pending[SOURCES[i]] && chip->nvic.enabled[SOURCES[i]]) {
            return true;
        }
    }
    return false;
}

unsigned chip_exception_due(chip_t *chip)
{
    chip_part_lines(chip);
    unsigned due = 0;
    int before = priority_now(chip);
    for (unsigned i = 0; i < SOURCE_COUNT; i++) {
        const unsigned each = SOURCES[i];
        if (chip->nvic.pending[each] && chip->nvic.enabled[each] &&
            priority_of(chip, each) < before) {
            due = each;
            before = priority_of(chip, each);
        }
    }
    if (due == 0 || before < 0 || due == EXCEPTION_BUS_FAULT) {
        return due;
    }
    /* In the middle of an IT block the emulator keeps the conditions, which a handler would
     * inherit: the block after it is soon enough. */
    uint32_t flags;
    uint32_t masked;
    uint32_t base;
    (void)uc_reg_read(chip->core, UC_ARM_REG_CPSR, &flags);
    (void)uc_reg_read(chip->core, UC_ARM_REG_PRIMASK, &masked);
    (void)uc_reg_read(chip->core, UC_ARM_REG_BASEPRI, &base);
    if ((flags & BLOCKS_IT_BITS) != 0) {
        return 0;
    }
    return (masked & 1U) != 0 || (base != 0 && (uint32_t)before >= base) ? 0 : due;
}

void chip_bus_fault(chip_t *chip, uint32_t address, bool fetch)
{
    uint32_t masked;
    (void)uc_reg_read(chip->core, UC_ARM_REG_PC, &chip->bus_fault_at);
    (void)uc_reg_read(chip->core, UC_ARM_REG_PRIMASK, &masked);
    chip->bus_faults++;
    *word(chip, AT_CFSR) |= fetch ? CFSR_IBUSERR : CFSR_PRECISERR | CFSR_BFARVALID;
    if (!fetch) {
        *word(chip, AT_BFAR) = address;
    }
    const bool may_enter = (*word(chip, AT_SHCSR) & SHCSR_BUSFAULTENA) != 0 && masked == 0 &&
                           priority_of(chip, EXCEPTION_BUS_FAULT) < priority_now(chip);
    *word(chip, AT_HFSR) |= may_enter ? 0U : HFSR_FORCED;
    chip_pend(chip, may_enter ? EXCEPTION_BUS_FAULT : EXCEPTION_HARD_FAULT);
}

/* B1.5.6: eight words, and eighteen more if the floating-point unit has been used. */
static void push_frame(chip_t *chip, bool with_floats)
{
    static const int REGISTERS[7] = {UC_ARM_REG_R0,  UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3,
                                     UC_ARM_REG_R12, UC_ARM_REG_LR, UC_ARM_REG_PC};
    uint32_t frame[26] = {0};
    for (int i = 0; i < 7; i++) {
        (void)uc_reg_read(chip->core, REGISTERS[i], &frame[i]);
    }
    (void)uc_reg_read(chip->core, UC_ARM_REG_XPSR, &frame[7]);
    if (with_floats) {
        for (int i = 0; i < 16; i++) {
            (void)uc_reg_read(chip->core, UC_ARM_REG_S0 + i, &frame[8 + i]);
        }
        (void)uc_reg_read(chip->core, UC_ARM_REG_FPSCR, &frame[24]);
    }
    uint32_t stack;
    (void)uc_reg_read(chip->core, UC_ARM_REG_SP, &stack);
    const uint32_t size = with_floats ? 104 : 32;
    frame[7] |= (stack & 4U) != 0 ? 1U << 9 : 0U;
    stack = (stack - size) & ~7U;
    if (uc_mem_write(chip->core, stack, frame, size) != UC_ERR_OK) {
        chip_note(chip, "the stack of an exception at 0x%08X is outside of the memory", stack);
    }
    (void)uc_reg_write(chip->core, UC_ARM_REG_SP, &stack);
}

void chip_exception_enter(chip_t *chip, unsigned exception)
{
    chip_nvic_t *nvic = &chip->nvic;
    if (nvic->nesting == CHIP_NESTING) {
        chip_note(chip, "exceptions nested %u deep", nvic->nesting);
        chip_request_reset(chip, CHIP_RESET_PROGRAM);
        return;
    }
    uint32_t control;
    uint32_t current;
    (void)uc_reg_read(chip->core, UC_ARM_REG_CONTROL, &control);
    (void)uc_reg_read(chip->core, UC_ARM_REG_IPSR, &current);
    const bool with_floats = (control & CONTROL_FPCA) != 0;
    (void)uc_context_save(chip->core, nvic->context[nvic->nesting]);
    nvic->stacked[nvic->nesting] = exception;
    nvic->nesting++;
    chip_meter_enter(chip);
    push_frame(chip, with_floats);
    control &= ~CONTROL_FPCA;
    (void)uc_reg_write(chip->core, UC_ARM_REG_CONTROL, &control);
    const uint32_t link =
        (current != 0 ? 0xFFFFFFF1U : 0xFFFFFFF9U) & ~(with_floats ? 1U << 4 : 0U);
    const uint32_t number = exception;
    uint32_t vector = 0;
    if (uc_mem_read(chip->core, *word(chip, AT_VTOR) + 4U * exception, &vector, 4) != UC_ERR_OK ||
        (*word(chip, AT_VTOR) & 0x1FFU) != 0) {
        chip_note(chip, "no vector table at 0x%08X", *word(chip, AT_VTOR));
    }
    (void)uc_reg_write(chip->core, UC_ARM_REG_LR, &link);
    (void)uc_reg_write(chip->core, UC_ARM_REG_IPSR, &number);
    (void)uc_reg_write(chip->core, UC_ARM_REG_PC, &vector);
    nvic->pending[exception] = false;
    nvic->active[exception] = true;
    /* 12 cycles of stacking. */
    chip->now += 12ULL * chip->ticks_per_cycle;
}

/* What the handler has changed in the frame counts; the rest is as it was. */
void chip_exception_return(chip_t *chip)
{
    chip_nvic_t *nvic = &chip->nvic;
    if (nvic->nesting == 0) {
        chip_note(chip, "return from an exception that there is not");
        chip_request_reset(chip, CHIP_RESET_PROGRAM);
        return;
    }
    uint32_t stack;
    uint32_t frame[8];
    (void)uc_reg_read(chip->core, UC_ARM_REG_SP, &stack);
    const bool read = uc_mem_read(chip->core, stack, frame, sizeof frame) == UC_ERR_OK;
    chip_meter_leave(chip);
    nvic->nesting--;
    nvic->active[nvic->stacked[nvic->nesting]] = false;
    uint32_t masked;
    (void)uc_reg_read(chip->core, UC_ARM_REG_PRIMASK, &masked);
    (void)uc_context_restore(chip->core, nvic->context[nvic->nesting]);
    (void)uc_reg_write(chip->core, UC_ARM_REG_PRIMASK, &masked);
    static const int REGISTERS[6] = {UC_ARM_REG_R0, UC_ARM_REG_R1,  UC_ARM_REG_R2,
                                     UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR};
    for (int i = 0; i < 6 && read; i++) {
        (void)uc_reg_write(chip->core, REGISTERS[i], &frame[i]);
    }
    if (read) {
        const uint32_t at = frame[6] | 1U;
        (void)uc_reg_write(chip->core, UC_ARM_REG_PC, &at);
    } else {
        chip_note(chip, "the stack at 0x%08X is outside of the memory", stack);
    }
    chip->needs_attention = true;
    chip->now += 10ULL * chip->ticks_per_cycle;
}

/* ---- registers ---- */

static chip_ticks_t systick_period(chip_t *chip)
{
    return (*word(chip, AT_SYST_RVR) + 1ULL) * chip->ticks_per_cycle;
}

uint32_t chip_core_read(chip_t *chip, uint32_t address)
{
    switch ((int)address) {
    case AT_CPUID:
        return CPUID_CORTEX_M4;
    case (int)CHIP_MPU_TYPE:
        return CHIP_MPU_REGIONS << 8;
    case AT_DWT_CYCCNT:
        return (uint32_t)((chip->now - chip->nvic.base) / chip->ticks_per_cycle);
    case AT_SYST_CVR:
        return chip->nvic.tick == CHIP_NEVER
                   ? 0
                   : (uint32_t)((chip->nvic.tick - chip->now) / chip->ticks_per_cycle);
    case AT_ICSR:
        return (chip->nvic.pending[EXCEPTION_PENDSV] ? ICSR_PENDSVSET : 0) |
               (chip->nvic.pending[EXCEPTION_SYSTICK] ? ICSR_PENDSTSET : 0);
    default:
        return *word(chip, (int)address);
    }
}

static void write_interrupt_bits(chip_t *chip, uint32_t address, uint32_t value)
{
    const uint32_t kind = address & 0xFFFFFF80U;
    const uint32_t first = 32U * ((address & 0x7FU) / 4U);
    for (uint32_t bit = 0; bit < 32 && first + bit < INTERRUPTS; bit++) {
        const uint32_t exception = 16U + first + bit;
        if ((value >> bit & 1U) == 0) {
            continue;
        }
        if (kind == (uint32_t)AT_NVIC_ISER) {
            chip->nvic.enabled[exception] = true;
        } else if (kind == (uint32_t)AT_NVIC_ICER) {
            chip->nvic.enabled[exception] = false;
        } else {
            chip->nvic.pending[exception] = kind == (uint32_t)AT_NVIC_ISPR;
        }
    }
}

static void write_control(chip_t *chip, uint32_t address, uint32_t value)
{
    switch ((int)address) {
    case AT_SYST_CSR:
        chip->nvic.tick =
            (value & SYST_ENABLE) != 0 ? chip->now + systick_period(chip) : CHIP_NEVER;
        break;
    case AT_ICSR:
        chip->nvic.pending[EXCEPTION_PENDSV] |= (value & ICSR_PENDSVSET) != 0;
        chip->nvic.pending[EXCEPTION_SYSTICK] |= (value & ICSR_PENDSTSET) != 0;
        break;
    case AT_AIRCR:
        if (value >> 16 == AIRCR_KEY && (value & AIRCR_SYSRESETREQ) != 0) {
            chip_request_reset(chip, CHIP_RESET_PROGRAM);
        }
        break;
    case AT_DWT_CYCCNT:
        chip->nvic.base = chip->now - (chip_ticks_t)value * chip->ticks_per_cycle;
        break;
    default:
        break;
    }
}

void chip_core_write(chip_t *chip, uint32_t address, uint32_t value)
{
    if (address >= (uint32_t)AT_NVIC_ISER && address < (uint32_t)AT_NVIC_ICPR + 0x80U) {
        write_interrupt_bits(chip, address, value);
    } else if (address >= (uint32_t)AT_NVIC_IPR && address < (uint32_t)AT_NVIC_IPR + INTERRUPTS) {
        for (uint32_t i = 0; i < 4; i++) {
            chip->nvic.priority[16U + address - (uint32_t)AT_NVIC_IPR + i] =
                (uint8_t)(value >> 8U * i);
        }
    } else if (address >= (uint32_t)AT_SHPR && address < (uint32_t)AT_SHPR + 12U) {
        for (uint32_t i = 0; i < 4; i++) {
            chip->nvic.priority[4U + address - (uint32_t)AT_SHPR + i] = (uint8_t)(value >> 8U * i);
        }
    } else if (!chip_mpu_write(chip, address, value)) {
        write_control(chip, address, value);
    }
}

chip_ticks_t chip_nvic_next(chip_t *chip)
{
    return chip->nvic.tick;
}

void chip_nvic_events(chip_t *chip)
{
    if (chip->now < chip->nvic.tick) {
        return;
    }
    chip->nvic.tick += systick_period(chip);
    if ((*word(chip, AT_SYST_CSR) & SYST_TICKINT) != 0) {
        chip_pend(chip, EXCEPTION_SYSTICK);
    }
}

bool chip_is_pwm_interrupt(unsigned exception)
{
    return exception == INTERRUPT_ADC;
}

bool chip_in_interrupt(const chip_t *chip)
{
    return chip->nvic.active[INTERRUPT_ADC];
}
