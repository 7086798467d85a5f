/* SPDX-License-Identifier: Apache-2.0 */
/*
 * No word of the flash while the bridge switches: a record of the journal is due, and the wheel is
 * driven for longer than the journal waits.
 *
 *     chip_bridge ELF application [--finds TEXT]
 *         the application does not try: nor does it with the bridge off while the wheel turns
 *     chip_bridge ELF port [--finds TEXT]
 *         of an image whose application does not look: the port refuses, the drive goes on, and the
 *         record is written when the bridge is off
 *
 * Exit code 0: as expected; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <stdio.h>
#include <string.h>

#include "planted.h"
#include "rig.h"

static const double TRIES_S = 1.3; /* it waits for a second */
enum { GREETING_us = 120000 };

static bool drives_with_a_record_due(void)
{
    boot();
    chip_reset_by(rig.chip, CHIP_RESET_PIN); /* is counted */
    chip_run(rig.chip, (chip_ticks_t)GREETING_us * CHIP_TICKS_PER_US);
    if (!expect(says("started by reset pin"), "a start is to be recorded") ||
        !expect(drive_off(&rig.coupling), "comes to RUN") ||
        !expect(chip_flash_operations(rig.chip) == 0, "nothing has been written yet")) {
        return false;
    }
    rig.bench.params.driver.drive_demand_nm = IMAGE_DRIVE_NM;
    run(TRIES_S);
    return expect(chip_flash_operations(rig.chip) == 0, "writes while the bridge switches") &&
           expect(chip_outputs_on(rig.chip) && rig.drive.vehicle.received.mode == IMAGE_MODE &&
                      rig.bench.wheel[0].first_fault == REASON_NONE,
                  "drives on") &&
           obeys_the_manuals();
}

/* A fault of the gate driver, while the wheel turns. */
static bool writes_with_the_bridge_off(bool wanted)
{
    rig.drive.driver_fails = true;
    run(TRIES_S);
    return expect(!chip_outputs_on(rig.chip), "the bridge is off") &&
           expect((chip_flash_operations(rig.chip) > 0) == wanted,
                  "whether it writes while the wheel turns") &&
           expect(chip_resets(rig.chip) == 2, "runs without a reset") && obeys_the_manuals();
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 3) {
        (void)fprintf(stderr, "usage: chip_bridge ELF application|port [--finds TEXT]\n");
        return 2;
    }
    const bool good = (open_rig(argv[1]) || wrong("the image cannot be loaded")) &&
                      drives_with_a_record_due() &&
                      writes_with_the_bridge_off(strcmp(argv[2], "port") == 0);
    return rig_result(good, finds);
}
