/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the image of a board makes of a winding sensor of the configured kind, of its open and
 * shorted line, and of a sensor of another kind in its place; likewise of the switches' sensor.
 *
 *     chip_thermometers ELF BOARD ntc|pt1000|kty84|table|none CONFIGURATION.bin
 *
 * Exit code 0: as expected.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "boards.h"
#include "core/reason.h"
#include "rig.h"
#include "wiring.h"

enum {
    HEALTH = 0x190,   /* WheelHealth of the front left wheel (hubfoc.dbc) */
    SHOWN_ms = 400,   /* sensor_fault_time, and three cycles */
    HEALED_ms = 2400, /* one that comes again heals after two seconds */
    CODES = 4096,
    CODE_SHORTED = 0,
    CODE_OPEN = CODES - 1,
    TEMPERATURES = 3,
    KINDS = 5
};
static const double DIVIDER_Ohm = 10e3; /* to the supply, the sensor to ground */
static const double TEMPERATURE_ERROR_K = 2.5;
static const double AMBIENT_C = 25.0;

/* R of 10 kOhm at 25 degC, B = 3380 K. */
static double ntc_Ohm(double celsius)
{
    return 10e3 * exp(3380.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15));
}

/* IEC 60751, above 0 degC. */
static double pt1000_Ohm(double celsius)
{
    return 1000.0 * (1.0 + 3.9083e-3 * celsius - 5.775e-7 * celsius * celsius);
}

/* About 1 kOhm at 100 degC, within 3 Ohm of the data sheet's table from 0 to 150 degC. */
static double kty84_Ohm(double celsius)
{
    const double above = celsius - 100.0;
    return 1000.0 * (1.0 + 6.12e-3 * above + 1.1e-5 * above * above);
}

/* The points of the configuration, chip_boards.cmake: only at them is it asked. */
static double table_Ohm(double celsius)
{
    return celsius < 50.0 ? 10e3 : celsius < 100.0 ? 2488.0 : 389.0;
}

typedef struct {
    const char *name;
    double (*ohm)(double celsius);
    double lowest_Ohm, highest_Ohm; /* that a whole sensor has */
    double celsius[TEMPERATURES];
} kind_t;

/* -40 to 196 degC; -50 to 250; -40 to 300; the points. */
static const kind_t KIND[KINDS] = {
    {"ntc", ntc_Ohm, 150.0, 250e3, {25.0, 90.0, 130.0}},
    {"pt1000", pt1000_Ohm, 803.0, 1941.0, {25.0, 90.0, 140.0}},
    {"kty84", kty84_Ohm, 359.0, 2624.0, {25.0, 90.0, 140.0}},
    {"table", table_Ohm, 200.0, 97e3, {25.0, 60.0, 120.0}},
    {"none", NULL, 0.0, 0.0, {0.0, 0.0, 0.0}},
};

static uint16_t code_of(double ohm)
{
    return (uint16_t)lround(CODES * ohm / (ohm + DIVIDER_Ohm));
}

typedef struct {
    double winding_c;
    unsigned warning;
} seen_t;

static bool is_named(seen_t seen)
{
    return seen.warning == (unsigned)REASON_WINDING_SENSOR;
}

/* What WheelHealth says once a sensor has shown this code for long enough. */
static seen_t with_code_at(uint8_t channel, uint16_t code, int after_ms)
{
    static seen_t seen;
    chip_frame_t frame;
    chip_inputs(rig.chip)->analog_code[channel] = code;
    for (int ms = 0; ms < after_ms; ms++) {
        chip_run(rig.chip, 1000U * CHIP_TICKS_PER_US);
        while (chip_receive(rig.chip, &frame)) {
            if (frame.identifier == HEALTH) {
                const int raw = (frame.data[2] | frame.data[3] << 8) & 0x1FFF;
                seen.winding_c = 0.1 * (raw >= 0x1000 ? raw - 0x2000 : raw);
                seen.warning = frame.data[7];
            }
        }
    }
    printf("channel %u, code %u: winding %.1f degC, warning %u\n", (unsigned)channel,
           (unsigned)code, seen.winding_c, seen.warning);
    return seen;
}

/* The same of the winding's sensor. At the start its code is that of an NTC (drive_begin()). */
static seen_t with_code(uint16_t code, bool whole)
{
    static seen_t seen = {NAN, (unsigned)REASON_WINDING_SENSOR};
    const int after_ms = whole && is_named(seen) ? HEALED_ms : SHOWN_ms;
    seen = with_code_at(boards_chosen()->winding_channel, code, after_ms);
    return seen;
}

static bool measures(const kind_t *kind)
{
    bool good = true;
    for (int k = 0; k < TEMPERATURES && kind->ohm != NULL; k++) {
        const seen_t seen = with_code(code_of(kind->ohm(kind->celsius[k])), true);
        good = good && expect(!is_named(seen), "a whole sensor is no finding") &&
               expect(fabs(seen.winding_c - kind->celsius[k]) < TEMPERATURE_ERROR_K,
                      "reads the sensor of the configured kind");
    }
    return good;
}

/* Without a sensor no code is a finding. */
static bool names_broken_lines(const kind_t *kind)
{
    static const uint16_t ENDS[2] = {CODE_SHORTED, CODE_OPEN};
    bool good = true;
    for (int end = 0; end < 2; end++) {
        good = good && expect(is_named(with_code(ENDS[end], false)) == (kind->ohm != NULL),
                              "an open or a shorted line is named, of a sensor that is fitted");
    }
    return good;
}

/* The switches' NTC is the board's, whatever the winding has. */
static bool names_broken_lines_of_the_switches(void)
{
    const uint8_t channel = boards_chosen()->switch_channel;
    const uint16_t whole = chip_inputs(rig.chip)->analog_code[channel];
    bool good = true;
    for (int end = 0; end < 2; end++) {
        const seen_t seen = with_code_at(channel, end == 0 ? CODE_SHORTED : CODE_OPEN, SHOWN_ms);
        good = good && expect(seen.warning == (unsigned)REASON_SWITCH_SENSOR,
                              "an open or a shorted line of the switches' sensor is named");
    }
    return good && expect(with_code_at(channel, whole, HEALED_ms).warning == 0U,
                          "the switches' sensor heals");
}

/* Named where its resistance at 25 degC is none of the configured kind's, and only there. */
static bool names_other_kinds(const kind_t *kind)
{
    bool good = true;
    for (int k = 0; k < KINDS && kind->ohm != NULL; k++) {
        if (KIND[k].ohm != NULL && &KIND[k] != kind) {
            const double ohm = KIND[k].ohm(AMBIENT_C);
            const bool known = ohm < kind->lowest_Ohm || ohm > kind->highest_Ohm;
            good = good && expect(is_named(with_code(code_of(ohm), !known)) == known,
                                  "a sensor of another kind is named where it can be known");
        }
    }
    return good;
}

static bool try_kind(const char *elf, const kind_t *kind)
{
    if (!open_rig(elf)) {
        return wrong("the chip cannot be opened");
    }
    boot();
    return expect(says("configuration accepted"), "boots and accepts its configuration") &&
           measures(kind) && names_broken_lines_of_the_switches() && names_broken_lines(kind) &&
           names_other_kinds(kind) && obeys_the_manuals();
}

int main(int argc, char **argv)
{
    const kind_t *kind = NULL;
    for (int k = 0; k < KINDS && argc == 5; k++) {
        kind = strcmp(argv[3], KIND[k].name) == 0 ? &KIND[k] : kind;
    }
    if (kind == NULL) {
        (void)fprintf(stderr, "usage: chip_thermometers ELF BOARD KIND CONFIGURATION.bin\n");
        return 2;
    }
    return rig_result(use_board(argv[2], argv[4]) && try_kind(argv[1], kind), NULL);
}
