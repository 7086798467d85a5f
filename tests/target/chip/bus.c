/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The flashable image in one wheel of the paper's vehicle, with its CAN bus at this program's
 * standard input and output: whoever is there is the vehicle.
 *
 *     chip_bus ELF                   a stop
 *     chip_bus ELF CONFIGURATION     at rest until the input ends, with this configuration
 *
 *     plan DISTANCE_m STORED_J     once, of a stop: by the bench's own controller
 *
 *     frame ID DATA                in each millisecond, both ways, hexadecimal: as on the bus
 *
 *     sensor TORQUE_mNm            what the brake's torque sensor measures, when it does
 *
 *     battery CHARGE DISCHARGE PEAK VOLTAGE     mA and mV, what the battery allows
 *
 *     step PHASE SPEED_m_per_s DISTANCE_m STORED_J     ends a millisecond; answered by "step".
 * PHASE: rest, moving, from the first message of mode RUN on, or end
 *
 * The brake acts as WheelBrake says. Exit code 0: the vehicle has stopped, or stood until the input
 * ended, and nothing that a manual forbids has been seen.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rig.h"

static const double BRAKE_NM = 90.0;
enum { LONGEST_STOP_s = 5, LINE_BYTES = 160, DIGITS = 2 };

static const char *phase = "rest";
static bool ended; /* the input */

static double stored_j(void)
{
    return phase[0] == 'r' ? 0.0 : -bench_ledger(&rig.bench).chemical_j;
}

static void print_inputs(const slow_input_t *in)
{
    if (in->hydraulic.valid && in->hydraulic.age_ms == 0) {
        printf("sensor %d\n", in->hydraulic.torque_mNm);
    }
    printf("battery %d %d %d %d\n", in->bms.charge_current_mA, in->bms.discharge_current_mA,
           in->bms.charge_peak_current_mA, in->bms.voltage_mV);
    printf("step %s %.6f %.6f %.3f\n", phase, rig.bench.vehicle.speed_m_per_s,
           rig.bench.vehicle.distance_m, stored_j());
    (void)fflush(stdout);
}

/* Digits, two a byte, or none of it. */
static bool read_data(const char *text, chip_frame_t *frame)
{
    frame->length = (uint8_t)(strlen(text) / DIGITS);
    for (unsigned i = 0; i < frame->length; i++) {
        unsigned byte;
        if (sscanf(text + (size_t)DIGITS * i, "%2x", &byte) != 1) {
            return false;
        }
        frame->data[i] = (uint8_t)byte;
    }
    return true;
}

/* Frames until "step"; at the end of the input false. */
static bool read_frames(chip_t *chip)
{
    char line[LINE_BYTES];
    while (fgets(line, sizeof line, stdin) != NULL && strcmp(line, "step\n") != 0) {
        unsigned identifier;
        char data[DIGITS * sizeof(((chip_frame_t *)NULL)->data) + 1];
        chip_frame_t frame = {.length = 0};
        if (sscanf(line, "frame %x %16s", &identifier, data) != 2 || !read_data(data, &frame)) {
            (void)fprintf(stderr, "chip_bus: not a frame: %s", line);
            exit(2);
        }
        frame.identifier = identifier;
        chip_send(chip, &frame);
    }
    return feof(stdin) == 0;
}

static void print_frame(const chip_frame_t *frame)
{
    printf("frame %x ", frame->identifier);
    for (unsigned i = 0; i < frame->length; i++) {
        printf("%02x", frame->data[i]);
    }
    printf("\n");
}

static void exchange(drive_t *drive, const slow_input_t *in)
{
    print_inputs(in);
    ended = !read_frames(drive->chip);
    if (ended && phase[0] == 'm') {
        exit(2);
    }
}

static double stop(void)
{
    rig.bench.params.driver.brake_demand_nm = BRAKE_NM;
    for (int i = 0;
         i < LONGEST_STOP_s * RIG_PERIODS_A_SECOND && rig.bench.vehicle.speed_m_per_s > 0.01; i++) {
        bench_period(&rig.bench);
    }
    return rig.bench.vehicle.distance_m;
}

static bool stopped(void)
{
    if (!drive_off(NULL)) {
        return wrong("the bench's own controller does not run");
    }
    phase = "plan";
    const double direct_m = stop();
    printf("plan %.6f %.3f\n", direct_m, stored_j());
    phase = "rest";
    boot();
    rig.drive.exchange = exchange;
    rig.drive.seen = print_frame;
    if (!expect(drive_off(&rig.coupling), "comes to RUN")) {
        return false;
    }
    phase = "moving";
    (void)stop();
    const bool good = expect(rig.bench.vehicle.speed_m_per_s <= 0.01, "the vehicle stops") &&
                      expect(chip_resets(rig.chip) == 1, "runs without a reset");
    phase = "end";
    run(0.4);
    return good;
}

static bool stood(void)
{
    boot();
    rig.drive.exchange = exchange;
    rig.drive.seen = print_frame;
    (void)drive_off_to(&rig.coupling, 0.0); /* RUN or not is the client's affair */
    while (!ended) {
        run(1e-3);
    }
    return true;
}

int main(int argc, char **argv)
{
    if (argc < 2 || argc > 3) {
        (void)fprintf(stderr, "usage: chip_bus ELF [CONFIGURATION]\n");
        return 2;
    }
    const char *configuration = argc > 2 ? argv[2] : NULL;
    const bool ready = use_board(NULL, configuration) && open_rig(argv[1]);
    const bool good = ready && (configuration == NULL ? stopped() : stood()) && obeys_the_manuals();
    if (!good) {
        (void)fprintf(stderr, "%s\n%s\n", rig.why, rig.chip == NULL ? "" : chip_text(rig.chip));
    }
    chip_close(rig.chip);
    return good ? 0 : 1;
}
