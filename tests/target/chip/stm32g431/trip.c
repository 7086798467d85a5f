/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The flashable image and an over-current in a switch, on the model of the STM32G431: the chip's
 * own comparators take the gates: thresholds, time, report, comparators that do not answer, and
 * amplifiers with another output without current.
 *
 *     chip_trip_g431 ELF [--finds TEXT]
 *
 * Exit code 0: as expected; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <stdio.h>
#include <string.h>

#include "core/reason.h"
#include "planted.h"
#include "rig.h"

enum {
    MOST_mA = 40000, /* the board's largest current */
    TRIP_mA = 53000, /* its threshold is 50 A; DAC and comparator 1 % and a code of 0.5 A each */
    SPIKE_ns = 250,  /* of an edge: shorter than the filter */
    SPIKE_mA = 200000,
    BIAS_MOST_mV = 27 /* 16 times 128.6 mV less 15 times this: half of the reference */
};

static bool is_switching(void)
{
    return chip_gates(rig.chip).bridge == CHIP_BRIDGE_SWITCHES;
}

static bool drives(void)
{
    boot();
    if (!expect(says("configuration accepted") && drive_off(&rig.coupling), "comes to drive") ||
        !obeys_the_manuals()) {
        return false;
    }
    rig.bench.params.driver.drive_demand_nm = IMAGE_DRIVE_NM;
    run(0.05);
    return expect(is_switching(), "the bridge switches");
}

/* The current is in the shunt only while this runs, away from the samples, so that the firmware
 * does not see it; the plant does not know of it. */
static bool stays_on_with(int32_t current_mA, chip_ticks_t duration)
{
    (void)chip_run_to_sample(rig.chip, rig.drive.period * 2U);
    chip_sample(rig.chip);
    chip_run(rig.chip, 10U * CHIP_TICKS_PER_US);
    chip_faults(rig.chip)->low_side_a_mA = current_mA;
    chip_faults(rig.chip)->low_side_a_ends = chip_now(rig.chip) + duration;
    chip_run(rig.chip, duration + CHIP_TICKS_PER_US);
    chip_faults(rig.chip)->low_side_a_mA = 0;
    chip_faults(rig.chip)->low_side_a_ends = 0;
    return chip_outputs_on(rig.chip);
}

/* In the middle of the PWM interrupt, which begins 4 us after the trigger: the program could not
 * answer before its end. */
static bool trips_at_once(void)
{
    (void)chip_run_to_sample(rig.chip, rig.drive.period * 2U);
    chip_sample(rig.chip);
    chip_run(rig.chip, 5U * CHIP_TICKS_PER_US);
    if (!expect(chip_in_interrupt(rig.chip), "the PWM interrupt runs 5 us after the trigger")) {
        return false;
    }
    chip_faults(rig.chip)->low_side_a_mA = TRIP_mA;
    const chip_ticks_t begin = chip_now(rig.chip);
    while (chip_outputs_on(rig.chip) && chip_now(rig.chip) - begin < 2U * CHIP_TICKS_PER_US) {
        chip_run(rig.chip, CHIP_TICKS_PER_US / 20U);
    }
    const uint64_t taken_ns = (chip_now(rig.chip) - begin) * 1000U / CHIP_TICKS_PER_US;
    printf("gates off %u ns after the over-current\n", (unsigned)taken_ns);
    chip_faults(rig.chip)->low_side_a_mA = 0;
    return expect(!chip_outputs_on(rig.chip) && taken_ns <= 1000U,
                  "an over-current takes all gates within a microsecond");
}

static bool protects(void)
{
    if (!drives() ||
        !expect(stays_on_with(MOST_mA, 10U * CHIP_TICKS_PER_US),
                "the board's largest current is no fault") ||
        !expect(stays_on_with(SPIKE_mA, SPIKE_ns * CHIP_TICKS_PER_US / 1000U),
                "an edge is no fault") ||
        !trips_at_once()) {
        return false;
    }
    run(0.02);
    return expect(rig.bench.wheel[0].slow.mode == MODE_FAULT && !chip_outputs_on(rig.chip),
                  "an over-current is a fault, and lasts") &&
           expect(rig.bench.wheel[0].first_fault == REASON_HARDWARE_BREAK,
                  "the over-current is the power stage's") &&
           expect(chip_resets(rig.chip) == 1, "runs without a reset") && obeys_the_manuals();
}

static bool refuses_dead_comparators(void)
{
    chip_faults(rig.chip)->comparators_dead = true;
    boot();
    return expect(says("the over-current comparators do not answer"), "names dead comparators") &&
           expect(!drive_off(&rig.coupling) && !chip_outputs_on(rig.chip),
                  "stays off with dead comparators");
}

/* The others above start with the largest output that the board's amplifiers may have without
 * current; this is the smallest. */
static bool starts_with_a_bias(void)
{
    chip_faults(rig.chip)->amplifier_bias_mV = BIAS_MOST_mV;
    boot();
    return expect(drive_off(&rig.coupling), "comes to drive with a bias at its amplifiers") &&
           obeys_the_manuals();
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_trip_g431 ELF [--finds TEXT]\n");
        return 2;
    }
    const bool good = (open_rig(argv[1]) || wrong("the image cannot be loaded")) && protects() &&
                      open_rig(argv[1]) && refuses_dead_comparators() && open_rig(argv[1]) &&
                      starts_with_a_bias();
    return rig_result(good, finds);
}
