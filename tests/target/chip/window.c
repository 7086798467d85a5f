/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The image of a board with low-side shunts, which show a current only while the low sides conduct.
 *
 *     chip_window ELF MODE BOARD CONFIGURATION.bin [--finds TEXT]
 *
 *     refused  pulses too short for the shunts: is refused
 *     fast     brakes at the largest voltage as the bench's own controller does
 *
 * Exit code 0: as expected; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "planted.h"
#include "rig.h"
#include "wiring.h"

static const double FAST_BRAKE_NM = 30.0;
static const double SETTLE_S = 0.3, MEASURED_S = 0.2;
enum { SAMPLING_ns = 15 * 1000 / 21 };

/* Half of the shortest pulse, and what the board's shunts need of it: hal/stm32f405/DERIVATIONS.md,
 * Sampling window. */
static bool refuses(void)
{
    char text[RIG_WHY_BYTES];
    const int32_t is_ns = rig.config.drive.min_pulse_ns;
    const int32_t needed_ns = (int32_t)lround(wiring_shunts().settling_s * 1e9) + SAMPLING_ns +
                              rig.config.drive.dead_time_ns / 2;
    boot();
    (void)snprintf(text, sizeof text, "drive.min_pulse_ns on this board is %d, accepted %d ..",
                   (int)is_ns, (int)needed_ns);
    const bool names_both = says(text);
    printf("half a pulse of %d ns, %d ns needed: %s\n", (int)is_ns, (int)needed_ns,
           names_both ? "both named" : "not named");
    return expect(names_both, "names the pulse and what the shunts need") &&
           expect(!says("configuration accepted"), "refuses the configuration") &&
           expect(!drive_off(&rig.coupling), "does not come to RUN") &&
           expect(chip_gates(rig.chip).bridge == CHIP_BRIDGE_OFF, "the bridge stays off") &&
           obeys_the_manuals();
}

/* Power stored by braking at that speed. */
static double braking_power_w(void)
{
    rig.bench.params.driver.brake_demand_nm = FAST_BRAKE_NM;
    run(SETTLE_S);
    const double before_j = bench_ledger(&rig.bench).chemical_j;
    run(MEASURED_S);
    return (before_j - bench_ledger(&rig.bench).chemical_j) / MEASURED_S;
}

static bool brakes_fast(void)
{
    if (!expect(drive_off_to(NULL, IMAGE_FAST_M_PER_S), "the bench's own controller drives")) {
        return false;
    }
    const double direct_w = braking_power_w();
    boot();
    if (!expect(drive_off_to(&rig.coupling, IMAGE_FAST_M_PER_S), "comes to that speed in RUN")) {
        return false;
    }
    const double power_w = braking_power_w();
    printf("braking at %g m/s: %.1f W stored; the bench's own controller: %.1f W; %u currents "
           "lost\n",
           IMAGE_FAST_M_PER_S, power_w, direct_w, rig.drive.lost_currents);
    return expect(rig.bench.wheel[0].first_fault == REASON_NONE, "brakes without a fault") &&
           expect(rig.drive.vehicle.received.mode == IMAGE_MODE, "brakes in mode RUN") &&
           expect(rig.drive.lost_currents == 0, "samples while the low sides conduct") &&
           expect(direct_w > 100.0 && fabs(power_w - direct_w) < 0.02 * direct_w,
                  "stores what there is to store") &&
           obeys_the_manuals();
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 5) {
        (void)fprintf(stderr, "usage: chip_window ELF refused|fast BOARD CONFIGURATION.bin "
                              "[--finds TEXT]\n");
        return 2;
    }
    if (!use_board(argv[3], argv[4]) || !open_rig(argv[1])) {
        (void)fprintf(stderr, "the image, its board or its configuration cannot be used\n");
        return 2;
    }
    return rig_result(strcmp(argv[2], "refused") == 0 ? refuses() : brakes_fast(), finds);
}
