/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The flashable image on the model of its chip, braking the paper's vehicle.
 *
 *     chip_test ELF MODE [BOARD [CONFIGURATION.bin]] [--finds TEXT]
 *
 * BOARD: the wiring, without it that of the chip's first board. CONFIGURATION: in the place of the
 * image's own. MODE:
 *
 *     stop    boots, brakes to standstill as the bench's own controller does
 *     stops   brakes to standstill by other torques, and rolls back on a slope
 *     driver  the gate driver's protection, from its settings to its report
 *
 * Exit code 0: as expected; of an image with an error planted, that TEXT finds it (rig.h).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "planted.h"
#include "rig.h"
#include "wiring.h"

static const double SPEED_M_PER_S = IMAGE_SPEED_M_PER_S;
static const double BRAKE_NM = IMAGE_BRAKE_NM;
/* Of the messages, which CAN adds to the demand and again to the brake's command. */
static const double CYCLE_S = 0.010;
static const double RUN_UP_M_PER_S2 = 5.0;
enum { PERIODS_A_SECOND = RIG_PERIODS_A_SECOND, LONGEST_STOP_s = 5 };

typedef struct {
    double distance_m, stored_j, kinetic_j;
} stop_t;

static stop_t stop(double brake_nm)
{
    bench_t *bench = &rig.bench;
    bench->params.driver.brake_demand_nm = brake_nm;
    const double kinetic_j = vehicle_kinetic_energy_j(&bench->road.vehicle, &bench->vehicle);
    for (int i = 0; i < LONGEST_STOP_s * PERIODS_A_SECOND && bench->vehicle.speed_m_per_s > 0.01;
         i++) {
        bench_period(bench);
    }
    const stop_t out = {bench->vehicle.distance_m, -bench_ledger(bench).chemical_j, kinetic_j};
    return out;
}

/* The gate driver's fault line: the six gates fall, and the mode is the fault's. */
static bool driver_fault_works(void)
{
    if (!wiring_has_fault_line()) {
        return true;
    }
    rig.bench.params.driver.brake_demand_nm = 0.0;
    rig.bench.params.driver.drive_demand_nm = IMAGE_DRIVE_NM;
    run(0.2);
    if (!expect(chip_gates(rig.chip).bridge == CHIP_BRIDGE_SWITCHES, "drives off after the stop")) {
        return false;
    }
    rig.drive.driver_fails = true;
    if (IMAGE_HAS_FAULT_LINE) {
        chip_faults(rig.chip)->gate_driver_fault = true;
        chip_run(rig.chip, CHIP_TICKS_PER_US);
        if (!expect(!chip_outputs_on(rig.chip), "the fault line takes all gates within 1 us")) {
            return false;
        }
    }
    run(0.02);
    rig.drive.driver_fails = false;
    run(0.02);
    return expect(chip_gates(rig.chip).bridge == CHIP_BRIDGE_OFF,
                  "a fault of the gate driver switches the gates off for good") &&
           expect(rig.bench.wheel[0].slow.mode == MODE_FAULT, "a fault of the driver is a fault");
}

static bool is_switching(void)
{
    return chip_gates(rig.chip).bridge == CHIP_BRIDGE_SWITCHES;
}

static bool comes_to_run(void)
{
    const bool runs = drive_off(&rig.coupling);
    return expect(rig.drive.vehicle.received.mode != MODE_BOOT, "its messages are on CAN") &&
           expect(runs, "comes to RUN");
}

static bool boots(void)
{
    boot();
    return expect(chip_resets(rig.chip) == 1, "boots without a reset") &&
           expect(says("hubfoc "), "greets on its serial line") &&
           expect(says("configuration accepted"), "boots and accepts its configuration") &&
           expect(!says("fault") && !says("FAILED"), "boots without a fault") &&
           expect(wiring_outputs_hold(rig.chip), "drives the outputs that its board needs") &&
           obeys_the_manuals() && comes_to_run() && obeys_the_manuals();
}

/* Beyond the stop, too: the halls' speed ends up to a quarter of a second after the wheel's. */
static bool keeps_its_mode(void)
{
    run(0.3);
    return expect(chip_resets(rig.chip) == 1, "runs without a reset") &&
           expect(rig.bench.wheel[0].first_fault == REASON_NONE, "stops without a fault") &&
           expect(rig.drive.vehicle.received.mode == IMAGE_MODE, "stops in mode RUN") &&
           obeys_the_manuals();
}

/* CAN makes demand and brake command older by a cycle each: the stop is longer by at most that at
 * full speed, and the battery misses at most the power of two cycles, T w. */
static bool stops_as(const stop_t *direct)
{
    const stop_t seen = stop(BRAKE_NM);
    printf("stop: %.3f m, %.1f J of %.1f stored; the bench's own controller: %.3f m, %.1f J\n",
           seen.distance_m, seen.stored_j, seen.kinetic_j, direct->distance_m, direct->stored_j);
    return expect(fabs(seen.distance_m - direct->distance_m) <
                      2.0 * CYCLE_S * SPEED_M_PER_S + 0.002 * direct->distance_m,
                  "stops in the distance that it needs") &&
           expect(fabs(seen.stored_j - direct->stored_j) <
                      BRAKE_NM * IMAGE_SPEED_RAD_S * 2.0 * CYCLE_S + 0.002 * seen.kinetic_j,
                  "stores what there is to store") &&
           keeps_its_mode();
}

static bool passes(const char *elf)
{
    if (!open_rig(elf)) {
        return wrong("the image cannot be loaded");
    }
    if (!expect(drive_off(NULL), "the bench's own controller comes to RUN")) {
        return false;
    }
    const stop_t direct = stop(BRAKE_NM);
    return boots() && stops_as(&direct) && driver_fault_works() && obeys_the_manuals();
}

/* ---- other stops ---- */

static void bring_to_speed(void)
{
    bench_t *bench = &rig.bench;
    bench->params.driver.brake_demand_nm = 0.0;
    bench->params.road.slope = 0.0;
    bench_refresh(bench);
    bench->speed_prescribed = true;
    for (double speed = bench->vehicle.speed_m_per_s; speed < SPEED_M_PER_S;
         speed += RUN_UP_M_PER_S2 / PERIODS_A_SECOND) {
        bench->vehicle.speed_m_per_s = speed;
        bench_period(bench);
    }
    bench->speed_prescribed = false;
}

static bool stops_by(double brake_nm, double slope)
{
    bring_to_speed();
    rig.bench.params.road.slope = slope;
    bench_refresh(&rig.bench);
    (void)stop(brake_nm);
    const bool good = keeps_its_mode();
    const double after = rig.bench.vehicle.speed_m_per_s;
    printf("stop by %g N m, slope %g: %s, %.2f m/s 0.3 s later\n", brake_nm, slope,
           good ? "no fault" : "a fault", after);
    return good && expect(slope > 0.0 ? after < -0.1 : fabs(after) < 0.01,
                          "stands, or rolls back on the slope");
}

static bool stops_by_each(const char *elf)
{
    static const double OTHER_NM[] = IMAGE_OTHER_BRAKES_NM;
    if (!open_rig(elf) || !boots()) {
        return wrong("the image does not boot");
    }
    bool good = true;
    for (unsigned i = 0; i < sizeof OTHER_NM / sizeof OTHER_NM[0]; i++) {
        good = good && stops_by(OTHER_NM[i], 0.0);
    }
    return good && stops_by(IMAGE_SMALL_BRAKE_NM, IMAGE_SLOPE);
}

/* ---- the gate driver ---- */

enum {
    HOT_mV = 384,  /* 160 A through 2.4 mOhm: what the board carries at most, hot */
    SHORT_mV = 450 /* a switch that is out of saturation has volts; the next threshold is 454 */
};

/* In the middle of the PWM interrupt, which begins 2.6 us after the trigger and takes 3 us at
 * least: the driver's fault has to interrupt it. */
static bool trips_at_once(void)
{
    (void)chip_run_to_sample(rig.chip, rig.drive.period * 2U);
    chip_sample(rig.chip);
    chip_run(rig.chip, 4U * CHIP_TICKS_PER_US);
    if (!expect(chip_in_interrupt(rig.chip), "the PWM interrupt runs 4 us after the top")) {
        return false;
    }
    chip_faults(rig.chip)->low_side_a_mV = SHORT_mV;
    chip_run(rig.chip, CHIP_TICKS_PER_US);
    const bool off = !chip_outputs_on(rig.chip);
    chip_faults(rig.chip)->low_side_a_mV = 0;
    return off;
}

static bool driver_protects(void)
{
    if (!boots()) {
        return false;
    }
    rig.bench.params.driver.drive_demand_nm = IMAGE_DRIVE_NM;
    run(0.05);
    if (!expect(is_switching(), "the bridge switches")) {
        return false;
    }
    chip_faults(rig.chip)->low_side_a_mV = HOT_mV;
    run(0.002);
    chip_faults(rig.chip)->low_side_a_mV = 0;
    if (!expect(is_switching(), "the board's largest current through hot switches is no fault")) {
        return false;
    }
    if (!expect(trips_at_once(), "a short circuit takes all gates within a microsecond")) {
        return false;
    }
    run(0.02);
    chip_type(rig.chip, "status\roff\r");
    run(0.1);
    if (!expect(says("refused: only with the wheel known to be at rest"), "answers the shell") ||
        !expect(wiring_outputs_hold(rig.chip), "keeps its supply while the wheel turns")) {
        return false;
    }
    return expect(rig.bench.wheel[0].slow.mode == MODE_FAULT && !chip_outputs_on(rig.chip),
                  "a short circuit is a fault") &&
           expect(says("gate driver: over-current low a;") ||
                      says("gate driver: over-current low a\r"),
                  "the status names the switch") &&
           expect(chip_resets(rig.chip) == 1, "runs without a reset") && obeys_the_manuals();
}

/* With the bridge off the supply may be let go. */
static bool refuses_a_silent_driver(void)
{
    chip_faults(rig.chip)->driver_silent = true;
    boot();
    if (!expect(wiring_outputs_hold(rig.chip), "keeps its supply on, and the filters")) {
        return false;
    }
    chip_type(rig.chip, "off\r");
    chip_run(rig.chip, 100000U * CHIP_TICKS_PER_US);
    if (!expect(says("the supply is let go") && chip_drives_low(rig.chip, 'C', 5),
                "lets its supply go at rest")) {
        return false;
    }
    return expect(says("the gate driver does not hold its settings"), "names a silent driver") &&
           expect(!drive_off(&rig.coupling) && !chip_outputs_on(rig.chip),
                  "stays off with a silent driver");
}

static bool driver_passes(const char *elf)
{
    return (open_rig(elf) || wrong("the image cannot be loaded")) && driver_protects() &&
           open_rig(elf) && refuses_a_silent_driver();
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc < 3 || argc > 5) {
        (void)fprintf(stderr, "usage: chip_test ELF stop|stops|driver [BOARD [CONFIGURATION.bin]] "
                              "[--finds TEXT]\n");
        return 2;
    }
    if (!use_board(argc > 3 ? argv[3] : NULL, argc > 4 ? argv[4] : NULL)) {
        (void)fprintf(stderr, "%s\n", rig.why);
        return 2;
    }
    const char *mode = argv[2];
    const bool good = strcmp(mode, "stops") == 0    ? stops_by_each(argv[1])
                      : strcmp(mode, "driver") == 0 ? driver_passes(argv[1])
                                                    : passes(argv[1]);
    return rig_result(good, finds);
}
