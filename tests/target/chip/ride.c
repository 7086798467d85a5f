/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the interrupts of the flashable image execute on rides of the bench's vehicle, for
 * tools/benchmark (interrupt.py).
 *
 *     chip_ride ELF RIDE OUTPUT
 *
 *     ride          1.2 s at rest, forward to the highest speed, back and as far the other way,
 *                   with demands to drive and to brake that change every 50 ms
 *     stop          drives, brakes to standstill
 *     encoder       as "ride", with an encoder in the place of the hall sensors
 *     faults        at ten moments of "ride" each of six faults, and 20 ms after it: a current
 *                   sensor that shows more than its range, none, or what it last showed; a hall
 *                   wire that is broken; a gate driver that reports a fault; a demand that no
 *                   longer comes
 *     registers     none: boots only
 *
 * OUTPUT gets a line for each handled interrupt of the converters and of the millisecond, in the
 * order of their returns: "pwm" or "millisecond", what it met, its instructions, and the blocks of
 * code that it executed, ADDRESS+BYTES in hexadecimal; a tab between these four. With "registers" a
 * line for each register of the peripherals, ADDRESS VALUE in hexadecimal.
 *
 * Exit code 0: it ran to the end, without a fault but the ride's own.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "config/validate.h"
#include "rig.h"
#include "wiring.h"

enum {
    PERIODS_A_ms = RIG_PERIODS_A_SECOND / 1000,
    RIDE_ms = 1200,
    DEMAND_ms = 50,
    LONGEST_STOP_ms = 5000,
    ENCODER_COUNTS = 4096, /* a turn */
    MOMENTS = 10,
    AFTER_FAULT_ms = 20
};

typedef struct {
    const char *name;
    void (*inject)(void);
} fault_case_t;

/* What the interrupt that comes next meets. */
typedef struct {
    FILE *out;
    const char *fault; /* NULL: none; since then */
    double drive_nm, brake_nm;
    bool was_on, edge, new_setpoint;
    uint8_t hall;
    uint32_t random;
} met_t;

static met_t met = {.random = 7};

/* ---- what is written ---- */

static void write_met(void)
{
    if (met.fault != NULL || !met.was_on) {
        (void)fputs(met.fault != NULL ? met.fault : "idle", met.out);
        return;
    }
    (void)fprintf(met.out, "%s%s%s", met.drive_nm > 0.0 ? "driving" : "braking",
                  met.edge ? ", hall edge" : "", met.new_setpoint ? ", new setpoint" : "");
}

static void handled(void *context, const chip_handled_t *now)
{
    (void)context;
    const bool pwm = chip_is_pwm_interrupt(now->exception);
    if (!pwm && now->exception != CHIP_EXCEPTION_MILLISECOND) {
        return;
    }
    (void)fputs(pwm ? "pwm\t" : "millisecond\t", met.out);
    write_met();
    (void)fprintf(met.out, "\t%u\t", now->instructions);
    for (uint32_t i = 0; i < now->count; i++) {
        (void)fprintf(met.out, "%s%x+%x", i > 0 ? " " : "", now->block[i].address,
                      now->block[i].bytes);
    }
    (void)fputc('\n', met.out);
    met.new_setpoint = !pwm;
}

/* The sampled values are those of the interrupt that follows. */
static fast_output_t period(void *context, const fast_input_t *in)
{
    (void)context;
    const fast_output_t out = rig.coupling.period(rig.coupling.context, in);
    met.edge = in->hall_state != met.hall;
    met.hall = in->hall_state;
    met.was_on = chip_outputs_on(rig.chip);
    return out;
}

static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    (void)context;
    return rig.coupling.millisecond(rig.coupling.context, in);
}

/* ---- the ride ---- */

static void demand(double drive_nm, double brake_nm)
{
    met.drive_nm = drive_nm;
    met.brake_nm = brake_nm;
    rig.bench.params.driver.drive_demand_nm = drive_nm;
    rig.bench.params.driver.brake_demand_nm = brake_nm;
}

/* The share of the largest torque, -1 .. 1, of the next 50 ms; below 0: to brake. */
static void next_demand(void)
{
    met.random = met.random * 1664525U + 1013904223U; /* Numerical Recipes */
    const double share = ((int32_t)(met.random >> 23) - 256) / 256.0;
    const double most_nm = 1e-3 * rig.config.motor.max_torque_mNm;
    demand(fmax(share, 0.0) * most_nm, fmax(-share, 0.0) * 2.0 * most_nm);
}

/* Rest, forward to the highest speed, back, and as far the other way. */
static double speed_share(double part)
{
    if (part < 0.05) {
        return 0.0;
    }
    if (part < 0.35) {
        return (part - 0.05) / 0.3;
    }
    if (part < 0.45) {
        return 1.0;
    }
    return part < 0.95 ? 1.0 - 2.0 * (part - 0.45) / 0.5 : -1.0;
}

static void set_speed(int period_of_ride)
{
    const double most_m_per_s =
        1e-3 * rig.config.motor.max_speed_mrad_s * rig.bench.params.vehicle.wheel_radius_m;
    const double part = (double)period_of_ride / (RIDE_ms * PERIODS_A_ms);
    rig.bench.vehicle.speed_m_per_s = most_m_per_s * speed_share(part);
}

/* LIMP, too: a quick reversal makes the halls' angle uncertain for a moment. */
static bool is_running(void)
{
    const operating_mode_t mode = rig.bench.wheel[0].slow.mode;
    return (mode == MODE_RUN || mode == MODE_LIMP) && chip_outputs_on(rig.chip);
}

static bool stops(void)
{
    rig.bench.vehicle.speed_m_per_s = IMAGE_SPEED_M_PER_S;
    demand(IMAGE_DRIVE_NM, 0.0);
    run(0.2);
    demand(0.0, IMAGE_BRAKE_NM);
    for (int ms = 0; ms < LONGEST_STOP_ms && rig.bench.vehicle.speed_m_per_s > 0.01; ms++) {
        run(0.001);
    }
    run(0.3);
    return expect(fabs(rig.bench.vehicle.speed_m_per_s) < 0.01, "comes to a stop");
}

static void use_encoder(bench_params_t *params)
{
    config_t *config = &rig.config;
    config->rotor.sensor = CONFIG_ROTOR_ENCODER;
    config->rotor.encoder_counts = ENCODER_COUNTS;
    params->encoder.counts = ENCODER_COUNTS;
    params->encoder.index_deg = 360.0 / 65536.0 * config->rotor.encoder_index_turn;
    params->encoder.index_width_counts = 1.0;
    config->crc32 = config_crc32(config, (uint32_t)offsetof(config_t, crc32));
}

/* From power-on to a controller that runs. metered: from its boot on. */
static bool starts(const char *elf, bool encoder, bool metered)
{
    if (!open_rig(elf)) {
        return wrong("the image cannot be loaded");
    }
    bench_params_t params = image_vehicle();
    if (encoder) {
        use_encoder(&params);
        if (!chip_write(rig.chip, IMAGE_CONFIGURATION_BEGINS, &rig.config, sizeof rig.config)) {
            return wrong("the configuration cannot be written");
        }
    }
    boot();
    static const wheel_coupling_t METERED = {.period = period, .millisecond = millisecond};
    const driver_trace_t none = {.points = 0};
    bench_init(&rig.bench, &params, &rig.config, &none);
    rig.bench.wheel[0].coupling = &METERED;
    return expect(chip_meter(rig.chip, metered ? handled : NULL, NULL), "has a meter") &&
           expect(bench_start(&rig.bench) == BENCH_READY, "comes to RUN");
}

/* ---- faults ---- */

static void show_a(double stuck, double frozen, double shown)
{
    fault_params_t *fault = &rig.bench.params.fault;
    fault->current_sensors = 1.0;
    fault->current_stuck = stuck;
    fault->current_frozen = frozen;
    fault->current_shown = shown;
}

static void over_current(void)
{
    show_a(1.0, 0.0, 1.0);
}

static void lost_current(void)
{
    show_a(1.0, 0.0, 0.0);
}

static void frozen_current(void)
{
    show_a(0.0, 1.0, 0.0);
}

static void lost_hall(void)
{
    rig.bench.params.sensors.hall_stuck_high = 1.0;
}

static void gate_driver(void)
{
    rig.drive.driver_fails = true;
}

static void silence(void)
{
    rig.bench.params.driver.silent = 1.0;
}

static const fault_case_t FAULTS[] = {
    {"over-current", over_current},     {"lost current", lost_current},
    {"frozen current", frozen_current}, {"lost hall", lost_hall},
    {"gate driver", gate_driver},       {"lost demand", silence},
};

/* In a copy of everything. */
static bool meets(const fault_case_t *fault)
{
    (void)fflush(met.out);
    const pid_t child = fork();
    if (child == 0) {
        met.fault = fault->name;
        fault->inject();
        bench_refresh(&rig.bench);
        const bool metered = chip_meter(rig.chip, handled, NULL);
        run(AFTER_FAULT_ms / 1000.0);
        _exit(metered && fclose(met.out) == 0 ? 0 : 1);
    }
    int status = 1;
    return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

static bool meets_faults(void)
{
    bool good = true;
    for (unsigned i = 0; i < sizeof FAULTS / sizeof FAULTS[0]; i++) {
        good = good && meets(&FAULTS[i]);
    }
    return good || wrong("a copy with a fault cannot be run");
}

/* The vehicle's speed is given from outside, so that the torque acts on currents and voltages
 * alone. */
static bool rides_until_the_end(bool with_faults)
{
    const int periods = RIDE_ms * PERIODS_A_ms;
    bool good = true;
    for (int i = 0; i < periods && good; i++) {
        if (i % (DEMAND_ms * PERIODS_A_ms) == 0) {
            next_demand();
        }
        set_speed(i);
        bench_period(&rig.bench);
        if (i % PERIODS_A_ms == 0 && i > DEMAND_ms * PERIODS_A_ms) {
            good = expect(is_running(), "the bridge is on during the ride");
        }
        if (with_faults && good && (i + 1) % (periods / MOMENTS) == 0) {
            good = meets_faults();
        }
    }
    return good;
}

static bool writes_registers(const char *elf)
{
    if (!open_rig(elf)) {
        return wrong("the image cannot be loaded");
    }
    boot();
    for (unsigned i = 0; i < CHIP_REGISTER_COUNT; i++) {
        uint32_t value = 0;
        if (chip_register(rig.chip, CHIP_REGISTERS[i].address, &value)) {
            (void)fprintf(met.out, "%x %x\n", CHIP_REGISTERS[i].address, value);
        }
    }
    return true;
}

static bool rides(const char *elf, const char *ride)
{
    if (strcmp(ride, "registers") == 0) {
        return writes_registers(elf);
    }
    const bool faults = strcmp(ride, "faults") == 0;
    /* With faults only the copies are metered. */
    if (!starts(elf, strcmp(ride, "encoder") == 0, !faults)) {
        return false;
    }
    return (strcmp(ride, "stop") == 0 ? stops() : rides_until_the_end(faults)) &&
           expect(rig.bench.wheel[0].first_fault == REASON_NONE, "runs without a fault") &&
           obeys_the_manuals();
}

static bool is_known(const char *ride)
{
    static const char *const RIDES[] = {"ride", "stop", "encoder", "faults", "registers"};
    bool known = false;
    for (unsigned i = 0; i < sizeof RIDES / sizeof RIDES[0]; i++) {
        known = known || strcmp(RIDES[i], ride) == 0;
    }
    return known;
}

int main(int argc, char **argv)
{
    if (argc != 4 || !is_known(argv[2])) {
        (void)fprintf(stderr, "usage: chip_ride ELF ride|stop|encoder|faults|registers OUTPUT\n");
        return 2;
    }
    met.out = fopen(argv[3], "w");
    if (met.out == NULL) {
        (void)fprintf(stderr, "%s: cannot be written\n", argv[3]);
        return 2;
    }
    bool good = rides(argv[1], argv[2]);
    good = fclose(met.out) == 0 && good;
    printf("%s: %s\n", argv[2], good ? "to the end" : rig.why);
    chip_close(rig.chip);
    return good ? 0 : 1;
}
