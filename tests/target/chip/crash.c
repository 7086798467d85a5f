/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The flashable image after a disturbance: an access that no memory answers, a jump to where there
 * is none. The gates must be off at once, the watchdog restarts the core, and the record is shown.
 *
 *     chip_crash ELF
 *
 * Exit code 0: as expected.
 */
#include <stdio.h>
#include <string.h>

#include "rig.h"

enum {
    NO_MEMORY = 0x60000000, /* the external memory that this chip has no pins for */
    MOST_OFFSET = 1 << 16,  /* of an access by a pointer */
    LINE_BYTES = 160,
    REGISTERS = 12,
    STACK_LEFT_BYTES = 64, /* as the firmware's own check */
    STACK_MOST_BYTES = 2560
};

/* The latest text on the serial line from `words` on. */
static const char *latest(const char *words)
{
    const char *found = NULL;
    for (const char *at = strstr(chip_text(rig.chip), words); at != NULL;
         at = strstr(at + 1, words)) {
        found = at;
    }
    return found;
}

static bool has_bus_fault(uint32_t *instruction)
{
    const unsigned before = chip_bus_faults(rig.chip, instruction);
    for (int us = 0; us < 2000 && chip_bus_faults(rig.chip, instruction) == before; us++) {
        chip_run(rig.chip, CHIP_TICKS_PER_US);
    }
    return chip_bus_faults(rig.chip, instruction) > before;
}

/* The gates are off 1 us after the fault at the latest: what a piece of the run adds. */
static bool stops_at_once(uint32_t *instruction)
{
    if (!expect(has_bus_fault(instruction), "the disturbance ends in a bus fault")) {
        return false;
    }
    chip_run(rig.chip, CHIP_TICKS_PER_US);
    return expect(!chip_outputs_on(rig.chip), "a fault of the core switches the gates off");
}

/* Until the watchdog's reset and the greeting after it: a twentieth of a second, and the line's
 * time for 300 characters; then the shell's answer. */
static bool shows(unsigned count, uint32_t instruction, uint32_t *address)
{
    const unsigned resets = chip_resets(rig.chip);
    chip_run(rig.chip, 200000U * CHIP_TICKS_PER_US);
    chip_type(rig.chip, "crash\r");
    chip_run(rig.chip, 100000U * CHIP_TICKS_PER_US);
    char line[LINE_BYTES];
    (void)snprintf(line, sizeof line, "crash %u since the supply came: bus fault at 0x%08X", count,
                   instruction);
    const char *greeting = strstr(chip_text(rig.chip), line);
    const char *answer = latest(line);
    const char *registers = latest("cfsr hfsr address:");
    if (!expect(chip_resets(rig.chip) == resets + 1, "the watchdog restarts the core once") ||
        !expect(latest("started by watchdog") != NULL, "the greeting names the watchdog") ||
        !expect(greeting != NULL, "the greeting names fault and instruction") ||
        !expect(answer != greeting && registers != NULL, "the shell shows the record")) {
        return false;
    }
    registers = strchr(registers, ':') + 1;
    for (int i = 0; i < REGISTERS; i++) {
        int read = 0;
        if (sscanf(registers, " 0x%8X%n", address, &read) != 1) {
            return wrong("twelve registers are shown");
        }
        registers += read;
    }
    return true;
}

/* Types this while the wheel is driven, and runs for so long; the answer shows this. */
static bool answers(const char *typed, double duration_s, const char *shown)
{
    const size_t before = strlen(chip_text(rig.chip));
    chip_type(rig.chip, typed);
    run(duration_s);
    return expect(strstr(&chip_text(rig.chip)[before], shown) != NULL, typed);
}

/* Shell, CAN and braking together: what the stack has never used then is what must remain. */
static bool leaves_stack(void)
{
    /* The last one by the arrow that brings the line before back. */
    if (!answers("faults S\rlimits\rcan\r", 0.6, "limit") ||
        !answers("blackbox\r", 0.5, "black box") || !answers("watch\r", 1.2, " cycles, stack ") ||
        !answers("\rinstall\r", 0.1, "send the configuration") ||
        !answers(":020000000102FB\r:00000001FF\r", 0.1, "refused: ") ||
        !answers("config mon\r", 0.6, "monitor.") ||
        !answers("help\rboot\rversion\rcrash\r", 0.6, "no crash since") ||
        !answers("status\r", 0.2, " cycles, stack ") || !answers("\033[A\r", 0.2, "demand VALID")) {
        return false;
    }
    const char *free_text = latest(" cycles, stack ");
    unsigned free_bytes = 0;
    if (!expect(free_text != NULL && sscanf(free_text, " cycles, stack %u B", &free_bytes) == 1,
                "the status names the free stack")) {
        return false;
    }
    printf("stack: %u bytes never used\n", free_bytes);
    return expect(free_bytes >= STACK_LEFT_BYTES, "the stack is long enough") &&
           expect(IMAGE_STACK_BYTES - free_bytes <= STACK_MOST_BYTES, "no more stack than 2.5 KiB");
}

static bool survives_a_bad_pointer(void)
{
    uint32_t instruction;
    uint32_t address = 0;
    if (!leaves_stack()) {
        return false;
    }
    if (!expect(chip_gates(rig.chip).bridge == CHIP_BRIDGE_SWITCHES, "the bridge switches")) {
        return false;
    }
    /* In the PWM interrupt, as chip_test.c and trip.c find it: the background might count with
     * them. */
    (void)chip_run_to_sample(rig.chip, rig.drive.period * 2U);
    chip_sample(rig.chip);
    chip_run(rig.chip, 5U * CHIP_TICKS_PER_US);
    if (!expect(chip_in_interrupt(rig.chip), "the PWM interrupt runs 5 us after the top")) {
        return false;
    }
    chip_spoil_registers(rig.chip, NO_MEMORY);
    return stops_at_once(&instruction) && shows(1, instruction, &address) &&
           expect(instruction - IMAGE_BEGINS < IMAGE_BYTES, "the instruction is the image's") &&
           expect(address - (uint32_t)NO_MEMORY < MOST_OFFSET, "the record has the address");
}

static bool survives_a_bad_jump(void)
{
    uint32_t instruction;
    uint32_t address = 0;
    chip_derail(rig.chip, NO_MEMORY);
    return stops_at_once(&instruction) && shows(2, instruction, &address) &&
           expect(instruction == (uint32_t)NO_MEMORY, "the record has the jump's target") &&
           expect(address == UINT32_MAX, "a fetch has no address of data");
}

static bool holds_its_supply(void)
{
    return !IMAGE_HOLDS_SUPPLY || chip_drives_high(rig.chip, 'C', 5);
}

static bool enters_the_bootloader(void)
{
    const unsigned resets = chip_resets(rig.chip);
    chip_type(rig.chip, "bootloader\r");
    chip_run(rig.chip, 100000U * CHIP_TICKS_PER_US);
    if (!expect(chip_in_bootloader(rig.chip) && chip_resets(rig.chip) == resets + 1,
                "the shell restarts the chip in its bootloader") ||
        !expect(holds_its_supply() && !chip_outputs_on(rig.chip),
                "the supply stays on and the bridge off in the bootloader")) {
        return false;
    }
    const size_t before = strlen(chip_text(rig.chip));
    chip_reset_by(rig.chip, CHIP_RESET_PIN);
    chip_run(rig.chip, 100000U * CHIP_TICKS_PER_US);
    return expect(strstr(chip_text(rig.chip) + before, "configuration accepted") != NULL,
                  "the next reset starts the program");
}

static bool refuses_the_bootloader(void)
{
    chip_type(rig.chip, "bootloader\r");
    run(0.05);
    return expect(latest("refused: only with the wheel known to be at rest") != NULL &&
                      chip_resets(rig.chip) == 1,
                  "no bootloader while the wheel turns");
}

static bool forgets_with_the_supply(void)
{
    const size_t before = strlen(chip_text(rig.chip));
    chip_power_cycle(rig.chip);
    chip_run(rig.chip, 100000U * CHIP_TICKS_PER_US);
    chip_type(rig.chip, "crash\r");
    chip_run(rig.chip, 50000U * CHIP_TICKS_PER_US);
    const char *text = chip_text(rig.chip) + before;
    return expect(strstr(text, "no crash since the supply came") != NULL &&
                      strstr(text, "bus fault") == NULL,
                  "nothing is shown after the supply was gone") &&
           expect(strstr(text, "started by supply") != NULL &&
                      strstr(text, "started by watchdog") == NULL,
                  "the greeting names the supply");
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_crash ELF\n");
        return 2;
    }
    bool good = open_rig(argv[1]) || wrong("the image cannot be loaded");
    if (good) {
        boot();
        good = expect(drive_off(&rig.coupling), "comes to RUN");
        rig.bench.params.driver.drive_demand_nm = IMAGE_DRIVE_NM;
        good = good && refuses_the_bootloader() && survives_a_bad_pointer() &&
               survives_a_bad_jump() && forgets_with_the_supply() && enters_the_bootloader();
    }
    printf("%s\n", good ? "as it must be" : rig.why);
    if (!good && rig.chip != NULL) {
        printf("%s\n", chip_text(rig.chip));
    }
    chip_close(rig.chip);
    return good ? 0 : 1;
}
