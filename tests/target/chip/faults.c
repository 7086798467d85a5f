/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A fault of the chip each, or of what it is connected to, and what comes of it.
 *
 *     chip_faults ELF [--finds TEXT]
 *
 * Prints a table: when there was no torque any more, who reset the chip, what CAN and the serial
 * line show.
 *
 * Exit code 0: as expected; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "copies.h"
#include "core/reason.h"
#include "planted.h"
#include "rig.h"

enum { ROW_BYTES = 240, MEAN = RIG_PERIODS_A_SECOND / 1000 };
static const double PERIOD_S = 1.0 / RIG_PERIODS_A_SECOND;
static const double BRAKES_S = 0.2;
static const double TORQUE_NM =
    0.05 * IMAGE_SMALL_BRAKE_NM; /* less, in a millisecond's mean, is none */

typedef enum { AT_BOOT, BRAKING } instant_t;

typedef struct {
    const char *name;
    instant_t instant;
    void (*inject)(chip_faults_t *fault);
    double within_s;  /* the bridge off, or at most TORQUE_NM, from then on */
    double watched_s; /* from the fault on */
    bool resets;      /* by the watchdog */
    reason_t reason;  /* of the fault that CAN shows; REASON_NONE: no message any more */
    const char *line; /* the serial line's from the fault on; NULL: none */
} fault_case_t;

static void crystal(chip_faults_t *fault)
{
    fault->crystal_dead = true;
}

static void pll(chip_faults_t *fault)
{
    fault->pll_does_not_lock = true;
}

static void timer(chip_faults_t *fault)
{
    fault->timer_stuck = true;
}

static void converter(chip_faults_t *fault)
{
    fault->converter_stuck = true;
}

static void core(chip_faults_t *fault)
{
    fault->core_stuck = true;
}

static void can_bus(chip_faults_t *fault)
{
    fault->can_silent = true;
}

static void can_wire(chip_faults_t *fault)
{
    fault->can_mute = true;
}

/* Another node sends without a pause: its frames are more urgent than all of the wheel's, less than
 * Demand. */
static void babbling_node(chip_faults_t *fault)
{
    (void)fault;
    static chip_node_t node = {.identifier = 0x150};
    node.period = chip_can_frame_ticks(8);
    node.next = chip_now(rig.chip);
    chip_traffic(rig.chip, &node, 1);
}

static void supply(chip_faults_t *fault)
{
    fault->supply_low = true;
}

/*
 * within_s: the converters' stop ends the renewal of the compare values, and the stop timer takes
 * the gates 1.5 periods after the last one, within two of the first sample that is missing
 * (hal/inverter.h); the supervisor no longer feeds the watchdog; a core
 * that executes nothing is the same to them; where the wheel's messages do not
 * leave, the brake system takes its own path after 50 ms, and the motor leaves after that path's
 * dead time of at most 50 ms with its lag, three to four of which are 0.3 s, whether a demand still
 * comes or not; the supply detector has the highest priority and ends in the watchdog's reset, as
 * does a crystal that stops.
 *
 * After the watchdog's reset, 50 ms later at most, the fault is still there. Without a crystal the
 * program's sum takes 0.5 s.
 */
static const fault_case_t FAULTS[] = {
    {"crystal dead at the start", AT_BOOT, crystal, 0.0, 0.0, false, REASON_NONE,
     "clock fault: crystal or PLL did not start"},
    {"PLL does not lock", AT_BOOT, pll, 0.0, 0.0, false, REASON_NONE,
     "clock fault: crystal or PLL did not start"},
    {"TIM1 without its clock at the start", AT_BOOT, timer, 0.0, 0.0, false, REASON_NONE,
     "self-test failed: the PWM timer does not update at the top of its count"},
    {"converters stop", BRAKING, converter, 0.0001, 0.15, true, REASON_PROGRAM_FLOW,
     "started by watchdog"},
    {"core executes nothing", BRAKING, core, 0.0001, 0.15, true, REASON_NONE, NULL},
    {"CAN bus held dominant", BRAKING, can_bus, 0.4, 0.6, false, REASON_NONE, NULL},
    {"wire from controller to CAN cut", BRAKING, can_wire, 0.4, 0.6, false, REASON_NONE, NULL},
    {"a node babbles before all of the wheel's messages", BRAKING, babbling_node, 0.4, 0.6, false,
     REASON_NONE, NULL},
    {"supply falls", BRAKING, supply, 0.001, 0.2, true, REASON_HARDWARE_BREAK,
     "started by watchdog"},
    {"crystal stops", BRAKING, crystal, 0.001, 0.9, true, REASON_NONE,
     "clock fault: crystal or PLL did not start"},
};

enum { FAULTS_COUNT = sizeof FAULTS / sizeof FAULTS[0] };

/* With a clock and a good configuration the vehicle is told why the wheel does not start. */
static bool tells_at_boot(const fault_case_t *fault)
{
    return fault->instant == AT_BOOT && fault->inject == timer;
}

/* What was seen from a fault on. */
typedef struct {
    double noisy_s; /* when there was torque last */
    double frame_s; /* when the last message came */
    double now_s;
    size_t from; /* of the serial line's text */
    double impulse_nms[MEAN];
    unsigned periods;
} seen_t;
static seen_t seen;

static void see_frame(const chip_frame_t *frame)
{
    (void)frame;
    seen.frame_s = seen.now_s;
}

static bool is_off(void)
{
    return chip_gates(rig.chip).bridge == CHIP_BRIDGE_OFF;
}

/* Once a period: after MEAN of them, whether there is no torque. */
static bool is_quiet(void)
{
    const double after_nms = rig.bench.wheel[0].totals.torque_impulse_nms;
    double *const before_nms = &seen.impulse_nms[seen.periods++ % MEAN];
    const double mean_nm = (after_nms - *before_nms) / (MEAN * PERIOD_S);
    *before_nms = after_nms;
    return is_off() || fabs(mean_nm) < TORQUE_NM;
}

static bool shows(const char *line)
{
    return line == NULL || strstr(&chip_text(rig.chip)[seen.from], line) != NULL;
}

static bool at_boot(const fault_case_t *fault)
{
    fault->inject(chip_faults(rig.chip));
    boot();
    rig.drive.seen = see_frame;
    seen.frame_s = -1.0;
    const bool runs = drive_off(&rig.coupling);
    return expect(!runs && is_off(), "the bridge stays off") &&
           expect(shows(fault->line), "the serial line says why") &&
           expect(says("hubfoc ") && says(" on stm32") && says("self-test RAM: good") &&
                      says("self-test firmware CRC: good"),
                  "it greets, and its self-tests are good") &&
           expect((seen.frame_s >= 0.0) == tells_at_boot(fault),
                  tells_at_boot(fault) ? "it says that it waits for the self-test"
                                       : "it sends no message") &&
           expect(chip_resets(rig.chip) == 1, "boots without a reset");
}

static bool can_shows(const fault_case_t *fault)
{
    const slow_output_t *received = &rig.drive.vehicle.received;
    if (fault->reason == REASON_NONE) {
        return expect(seen.frame_s <= fault->within_s, "its messages end with the fault");
    }
    return expect(received->mode == MODE_FAULT && received->fault_reason == fault->reason,
                  "its messages name the fault");
}

/* What all faults that come while it brakes begin with. */
static bool comes_to_brake(const char *elf)
{
    if (!open_rig(elf)) {
        return wrong("the image cannot be loaded");
    }
    boot();
    if (!expect(drive_off(&rig.coupling), "comes to RUN")) {
        return false;
    }
    rig.bench.params.driver.brake_demand_nm = IMAGE_SMALL_BRAKE_NM;
    run(BRAKES_S);
    bool brakes = false;
    for (int i = 0; i < 2 * MEAN; i++) {
        run(PERIOD_S);
        brakes = !is_quiet();
    }
    rig.drive.seen = see_frame;
    seen.from = strlen(chip_text(rig.chip));
    return expect(brakes, "brakes") && obeys_the_manuals();
}

static bool while_braking(const fault_case_t *fault)
{
    fault->inject(chip_faults(rig.chip));
    while (seen.now_s < fault->watched_s) {
        run(PERIOD_S);
        seen.now_s += PERIOD_S;
        seen.noisy_s = is_quiet() ? seen.noisy_s : seen.now_s;
    }
    return expect(seen.noisy_s <= fault->within_s, "the torque goes in time and stays away") &&
           expect((chip_watchdog_resets(rig.chip) > 0) == fault->resets, "resets as it must") &&
           can_shows(fault) && expect(shows(fault->line), "the serial line says why");
}

/* ---- the table ---- */

static const char HEADING[] =
    "| fault, " IMAGE_CHIP " | no torque after | reset | CAN | serial line |\n";

static void format_row(const fault_case_t *fault, char row[ROW_BYTES])
{
    char time[ROW_BYTES] = "bridge never on";
    char can[ROW_BYTES] = "no message";
    char line[ROW_BYTES] = "";
    if (fault->instant == BRAKING) {
        /* The bridge follows at the end of its period. */
        (void)snprintf(time, sizeof time, "%.2f ms", 1000.0 * (seen.noisy_s + PERIOD_S));
    }
    if (tells_at_boot(fault)) {
        (void)snprintf(can, sizeof can, "BOOT: waits for the self-test");
    }
    if (fault->reason != REASON_NONE) {
        (void)snprintf(can, sizeof can, "FAULT: %s", reason_text(fault->reason));
    }
    if (fault->line != NULL) {
        (void)snprintf(line, sizeof line, "`%s`", fault->line);
    }
    (void)snprintf(row, ROW_BYTES, "| %s | %s | %s | %s | %s |\n", fault->name, time,
                   fault->resets ? "watchdog" : "none", can, line);
}

static bool answers(const fault_case_t *fault)
{
    char row[ROW_BYTES];
    const bool good = fault->instant == AT_BOOT ? at_boot(fault) : while_braking(fault);
    format_row(fault, row);
    printf("%s", row);
    return good;
}

static bool at_each_boot(const char *elf)
{
    bool good = true;
    for (unsigned i = 0; i < FAULTS_COUNT && good; i++) {
        if (FAULTS[i].instant == AT_BOOT) {
            good = open_rig(elf) ? answers(&FAULTS[i]) : wrong("the image cannot be loaded");
        }
    }
    return good;
}

/* In a copy of the braking chip, one after the other in the order of the table. */
typedef enum { ANSWERED, FOUND, MISSED } copy_end_t;
static const char *copy_finds;
static const fault_case_t *copy_fault;
static int copy_code;

static int copy_work(uint32_t number)
{
    (void)number;
    if (answers(copy_fault)) {
        return ANSWERED;
    }
    return rig_result(false, copy_finds) == 0 ? FOUND : MISSED;
}

static void copy_ended(uint32_t number, int code)
{
    (void)number;
    copy_code = code;
}

static int while_braking_each(const char *finds)
{
    copy_finds = finds;
    copy_code = ANSWERED;
    for (unsigned i = 0; i < FAULTS_COUNT && copy_code == ANSWERED; i++) {
        if (FAULTS[i].instant == BRAKING) {
            copy_fault = &FAULTS[i];
            copies_run(1, copy_work, copy_ended);
        }
    }
    return copy_code;
}

/* It drives nevertheless: the supply detector acts at 2.8 V. */
static bool reports_the_brown_out_level(const char *elf)
{
    bool reported[2] = {true, false};
    for (int off = 0; off <= 1; off++) {
        if (!open_rig(elf)) {
            return wrong("the image cannot be loaded");
        }
        chip_faults(rig.chip)->brown_out_off = off != 0;
        boot();
        reported[off] = says("brown-out level is below 3");
    }
    return expect(!reported[0] && reported[1], "a low brown-out level is reported, and no other");
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_faults ELF [--finds TEXT]\n");
        return 2;
    }
    bool good = !IMAGE_REPORTS_BROWN_OUT || reports_the_brown_out_level(argv[1]);
    printf("%s|---|---|---|---|---|\n", HEADING);
    good = good && at_each_boot(argv[1]) && comes_to_brake(argv[1]);
    const int code = good ? while_braking_each(finds) : MISSED;
    return good && code != ANSWERED ? (code == FOUND ? 0 : 1) : rig_result(good, finds);
}
