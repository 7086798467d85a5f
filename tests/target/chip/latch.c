/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The image of a board whose gate driver has pins only, a DRV8302: what an over-current in a switch
 * comes to, and how its latch ends.
 *
 *     chip_latch ELF MODE BOARD CONFIGURATION.bin [--finds TEXT]
 *
 *     latches  M_OC high: bridge off within a microsecond, a fault that only an acknowledgement at
 *              standstill ends
 *     limits   M_OC low, a fault of the board: the driver cuts the current and reports nothing
 *
 * Exit code 0: as expected; of an image or a board with an error, that TEXT finds it (rig.h).
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "parts.h"
#include "planted.h"
#include "rig.h"
#include "wiring.h"

/* Quickly as long as it is fast, then so that the halls' speed, that of a whole turn, is less than
 * the hand-over speed at the end: the firmware knows a rest after that at once (firmware/monitor).
 */
static const double FAST_M_PER_S = 0.5, FAST_M_PER_S2 = 5.0, SLOW_M_PER_S2 = 0.4;
static const double TURNING_S = 0.2; /* longer than an acknowledgement is pending, 50 ms */
static const double ACKNOWLEDGED_S = 0.5;
static const double REST_S = 0.6; /* the halls' speed ends up to 0.25 s after the wheel's */
enum {
    HOT_mV = 360,  /* 150 A, the most that the board carries, through 2.4 mOhm */
    SHORT_mV = 450 /* 0.403 V at OC_ADJ */
};

static bool acknowledging;

static void exchange(drive_t *drive, const slow_input_t *in)
{
    slow_input_t sent = *in;
    sent.demand.fault_reset = acknowledging;
    vehicle_can_send(&drive->vehicle, &sent);
}

static bool is_switching(void)
{
    return chip_gates(rig.chip).bridge == CHIP_BRIDGE_SWITCHES;
}

static bool is_in_fault(void)
{
    const slow_output_t *seen = &rig.drive.vehicle.received;
    return seen->mode == MODE_FAULT && seen->fault_reason == REASON_HARDWARE_BREAK &&
           !chip_outputs_on(rig.chip);
}

static bool is_latched(void)
{
    return chip_driver_pulls_fault(rig.chip);
}

/* In the PWM interrupt, 4 us after the trigger (chip_test.c, trips_at_once). */
static bool trips(void)
{
    (void)chip_run_to_sample(rig.chip, rig.drive.period * 2U);
    chip_sample(rig.chip);
    chip_run(rig.chip, 4U * CHIP_TICKS_PER_US);
    chip_faults(rig.chip)->low_side_a_mV = SHORT_mV;
    chip_run(rig.chip, CHIP_TICKS_PER_US);
    const bool off = !chip_outputs_on(rig.chip);
    run(0.02);
    return expect(off, "an over-current takes all gates within a microsecond");
}

static bool drives(void)
{
    boot();
    rig.drive.exchange = exchange;
    if (!expect(drive_off(&rig.coupling), "comes to RUN")) {
        return false;
    }
    rig.bench.params.driver.drive_demand_nm = IMAGE_DRIVE_NM;
    run(0.05);
    chip_faults(rig.chip)->low_side_a_mV = HOT_mV;
    run(0.002);
    chip_faults(rig.chip)->low_side_a_mV = 0;
    return expect(is_switching() && !is_latched(), "the board's largest current is no fault");
}

static void acknowledge(double duration_s)
{
    acknowledging = true;
    run(duration_s);
    acknowledging = false;
    run(0.02);
}

static void come_to_rest(void)
{
    bench_t *bench = &rig.bench;
    bench->params.driver.drive_demand_nm = 0.0;
    bench->speed_prescribed = true;
    while (bench->vehicle.speed_m_per_s > 0.0) {
        const double before = bench->vehicle.speed_m_per_s;
        const double a = before > FAST_M_PER_S ? FAST_M_PER_S2 : SLOW_M_PER_S2;
        bench->vehicle.speed_m_per_s = fmax(before - a / RIG_PERIODS_A_SECOND, 0.0);
        bench_period(bench);
    }
    run(REST_S);
}

static bool lasts_while_turning(void)
{
    acknowledge(TURNING_S);
    if (!expect(is_in_fault() && is_latched(),
                "no acknowledgement ends it while the wheel turns")) {
        return false;
    }
    come_to_rest();
    return expect(is_in_fault() && is_latched(), "it does not end by itself at standstill");
}

static bool ends_at_rest(void)
{
    acknowledge(ACKNOWLEDGED_S);
    return expect(!is_latched(), "an acknowledgement at standstill releases the latch") &&
           expect(rig.drive.vehicle.received.mode == IMAGE_MODE, "and it comes to RUN again");
}

/* The over-current is still there when the bridge switches again. */
static bool trips_again(void)
{
    if (!trips()) {
        return false;
    }
    acknowledge(ACKNOWLEDGED_S);
    return expect(is_in_fault() && is_latched(), "an over-current that lasts is a fault again");
}

static bool latches(void)
{
    if (!drives() || !trips()) {
        return false;
    }
    chip_faults(rig.chip)->low_side_a_mV = 0;
    const bool good = expect(is_in_fault(), "the driver's fault is a fault with its reason") &&
                      expect(is_latched(), "the driver latches") && lasts_while_turning() &&
                      ends_at_rest();
    if (!good) {
        return false;
    }
    rig.bench.speed_prescribed = false;
    rig.bench.params.driver.drive_demand_nm = IMAGE_DRIVE_NM;
    run(0.3);
    return expect(is_switching(), "the bridge switches again") && trips_again() &&
           expect(chip_resets(rig.chip) == 1, "runs without a reset") && obeys_the_manuals();
}

int main(int argc, char **argv)
{
    const char *finds = planted_text(&argc, argv);
    if (argc != 5) {
        (void)fprintf(stderr, "usage: chip_latch ELF latches|limits BOARD CONFIGURATION.bin "
                              "[--finds TEXT]\n");
        return 2;
    }
    if (!use_board(argv[3], argv[4]) || !open_rig(argv[1])) {
        (void)fprintf(stderr, "the image, its board or its configuration cannot be used\n");
        return 2;
    }
    chip_faults(rig.chip)->driver_mode_low = strcmp(argv[2], "limits") == 0;
    return rig_result(latches(), finds);
}
