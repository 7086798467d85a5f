/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The flashable image after a reset of each kind: the greeting names its cause, the black box
 * counts it, and the journal keeps the count when the supply is gone.
 *
 *     chip_starts ELF [--finds TEXT]
 *
 * Exit code 0: as expected; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <stdio.h>
#include <string.h>

#include "planted.h"
#include "rig.h"

enum { GREETING_ms = 120, RECORD_ms = 1100, ANSWER_ms = 150, LINE_BYTES = 80 };

/* NULL: this chip has no such reset, or no flag of its own for it. */
static const char *const NAMES[CHIP_RESETS] = {
    [CHIP_RESET_BROWN_OUT] = IMAGE_BROWN_OUT_HAS_A_FLAG ? "low supply" : NULL,
    [CHIP_RESET_WATCHDOG] = "watchdog",
    [CHIP_RESET_WINDOW_WATCHDOG] = "window watchdog",
    [CHIP_RESET_LOW_POWER] = "low-power mode",
    [CHIP_RESET_PROGRAM] = "program",
    [CHIP_RESET_OPTION_BYTES] = IMAGE_OPTION_BYTES_RESET ? "option bytes" : NULL,
    [CHIP_RESET_PIN] = "reset pin",
};

static void run_ms(unsigned duration_ms)
{
    chip_run(rig.chip, (chip_ticks_t)duration_ms * 1000U * CHIP_TICKS_PER_US);
}

/* What the line shows within this time. */
static const char *shown(const char *typed, unsigned duration_ms)
{
    const char *text = chip_text(rig.chip) + strlen(chip_text(rig.chip));
    chip_type(rig.chip, typed);
    run_ms(duration_ms);
    return text;
}

static bool names(const char *greeting, const char *cause)
{
    char line[LINE_BYTES];
    (void)snprintf(line, sizeof line, "started by %s\r", cause);
    return expect(strstr(greeting, line) != NULL, line);
}

static bool names_each(void)
{
    bool good = true;
    for (int cause = CHIP_RESET_BROWN_OUT; cause < CHIP_RESETS && good; cause++) {
        if (NAMES[cause] != NULL) {
            chip_reset_by(rig.chip, (chip_reset_t)cause);
            good = names(shown("", GREETING_ms), NAMES[cause]);
        }
    }
    return good;
}

/* Times since the supply came, and since production once each. */
static bool counts_each(const char *text, unsigned times)
{
    bool good = true;
    for (int cause = CHIP_RESET_BROWN_OUT; cause < CHIP_RESETS && good; cause++) {
        if (NAMES[cause] != NULL) {
            char line[LINE_BYTES];
            (void)snprintf(line, sizeof line, "%u times started by %s, since production 1\r", times,
                           NAMES[cause]);
            good = expect(strstr(text, line) != NULL, line);
        }
    }
    return good && expect(strstr(text, "started by supply") == NULL, "the supply is not counted");
}

static bool passes(const char *elf)
{
    if (!open_rig(elf)) {
        return wrong("the image cannot be loaded");
    }
    boot();
    if (!names(chip_text(rig.chip), "supply") || !names_each()) {
        return false;
    }
    run_ms(RECORD_ms); /* the journal is written at rest, once a second */
    if (!counts_each(shown("blackbox\r", ANSWER_ms), 1)) {
        return false;
    }
    chip_power_cycle(rig.chip);
    return names(shown("", GREETING_ms), "supply") &&
           counts_each(shown("blackbox\r", ANSWER_ms), 0) && obeys_the_manuals();
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 2) {
        (void)fprintf(stderr, "usage: chip_starts ELF [--finds TEXT]\n");
        return 2;
    }
    return rig_result(passes(argv[1]), finds);
}
