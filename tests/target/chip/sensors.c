/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the image of a board makes of its divider, its thermistors and its rotor sensor's pins.
 *
 *     chip_sensors ELF BOARD CONFIGURATION.bin
 *
 * Exit code 0: as expected.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "boards.h"
#include "config/validate.h"
#include "parts.h"
#include "rig.h"
#include "wiring.h"

enum {
    POWER = 0x18C, /* WheelPower and WheelHealth of the front left wheel (hubfoc.dbc) */
    HEALTH = 0x190,
    SETTLE_ms = 300, /* three cycles of both */
    BUS_mV = 48000,
    WINDING_cC = 9000,
    SWITCH_cC = 8000,
    FULL_SCALE_mV = 61800,
    CODES = 4096,
    ENCODER_COUNTS = 4096 /* a turn */
};
/* The divider's code is 15 mV and CAN's step 100 mV. ntc.c: 3 % of B are 2 K at 100 degC. */
static const double VOLTAGE_ERROR_V = 0.12, TEMPERATURE_ERROR_K = 2.0;

typedef struct {
    double bus_v, winding_c, switch_c;
} seen_t;

/* Signed, 13 bits from here on. */
static double temperature(const uint8_t *data)
{
    const int raw = (data[0] | data[1] << 8) & 0x1FFF;
    return 0.1 * (raw >= 0x1000 ? raw - 0x2000 : raw);
}

static seen_t last_frames(void)
{
    seen_t seen = {NAN, NAN, NAN};
    chip_frame_t frame;
    for (int ms = 0; ms < SETTLE_ms; ms++) {
        chip_run(rig.chip, 1000U * CHIP_TICKS_PER_US);
        while (chip_receive(rig.chip, &frame)) {
            if (frame.identifier == POWER) {
                seen.bus_v = 0.1 * (frame.data[2] | frame.data[3] << 8);
            } else if (frame.identifier == HEALTH) {
                seen.winding_c = temperature(&frame.data[2]);
                seen.switch_c = temperature(&frame.data[4]);
            }
        }
    }
    return seen;
}

static bool measures(void)
{
    boot();
    if (!expect(says("configuration accepted"), "boots and accepts its configuration")) {
        return false;
    }
    wiring_bus_voltage(chip_inputs(rig.chip), (uint16_t)(BUS_mV * CODES / FULL_SCALE_mV));
    wiring_temperatures(chip_inputs(rig.chip), WINDING_cC, SWITCH_cC);
    const seen_t seen = last_frames();
    printf("%.1f V, winding %.1f, switches %.1f degC on CAN\n", seen.bus_v, seen.winding_c,
           seen.switch_c);
    return expect(fabs(seen.bus_v - BUS_mV / 1000.0) < VOLTAGE_ERROR_V, "reads the bus voltage") &&
           expect(fabs(seen.winding_c - WINDING_cC / 100.0) < TEMPERATURE_ERROR_K,
                  "reads the winding's thermistor") &&
           expect(fabs(seen.switch_c - SWITCH_cC / 100.0) < TEMPERATURE_ERROR_K,
                  "reads the switches' thermistor") &&
           obeys_the_manuals();
}

/* Counted by TIM3, or refused where the pins are not its own. */
static bool takes_an_encoder(void)
{
    enum { TIM3_FUNCTION = 2 };
    rig.config.rotor.sensor = CONFIG_ROTOR_ENCODER;
    rig.config.rotor.encoder_counts = ENCODER_COUNTS;
    rig.config.crc32 = config_crc32(&rig.config, (uint32_t)offsetof(config_t, crc32));
    if (!chip_write(rig.chip, IMAGE_CONFIGURATION_BEGINS, &rig.config, sizeof rig.config)) {
        return wrong("the configuration cannot be written");
    }
    boot();
    bool selected = true;
    for (int x = 0; x < 3; x++) {
        const wire_t wire = boards_chosen()->hall[x];
        selected = selected && chip_pin_function(rig.chip, wire.port, wire.pin, TIM3_FUNCTION);
    }
    printf("an encoder: %s\n", selected ? "at TIM3" : "refused");
    return boards_chosen()->encoder_at_tim3
               ? expect(selected && says("configuration accepted"), "counts an encoder")
               : expect(!selected && says("rotor.sensor is not on this board"),
                        "refuses an encoder whose pins are another timer's");
}

/* ---- halls 60 degrees apart, one sample of a line wrong in two of eight periods ---- */

enum { SIXTY_DEGREES = 10, SPIKES_EVERY = 8 };

/* The inputs are pulled up: a line that is cut is high. */
static bool line_is_cut;

static fast_output_t disturbed_period(void *context, const fast_input_t *in)
{
    static unsigned periods;
    (void)context;
    if (line_is_cut) {
        fast_input_t cut = *in;
        cut.hall_state |= 1U;
        return rig.coupling.period(rig.coupling.context, &cut);
    }
    periods++;
    if (periods % SPIKES_EVERY < 2) {
        const wire_t line = boards_chosen()->hall[periods / SPIKES_EVERY % 3];
        chip_inputs(rig.chip)->spike[line.port - 'A'] = (uint16_t)(1U << line.pin);
    }
    return rig.coupling.period(rig.coupling.context, in);
}

static slow_output_t millisecond(void *context, const slow_input_t *in)
{
    (void)context;
    return rig.coupling.millisecond(rig.coupling.context, in);
}

static bool drives_by_disturbed_halls(void)
{
    static const wheel_coupling_t DISTURBED = {.period = disturbed_period,
                                               .millisecond = millisecond};
    rig.config.rotor.sensor = CONFIG_ROTOR_HALL;
    rig.config.rotor.hall_lines = SIXTY_DEGREES;
    rig.config.crc32 = config_crc32(&rig.config, (uint32_t)offsetof(config_t, crc32));
    if (!chip_write(rig.chip, IMAGE_CONFIGURATION_BEGINS, &rig.config, sizeof rig.config)) {
        return wrong("the configuration cannot be written");
    }
    boot();
    bench_params_t params = image_vehicle();
    params.sensors.hall_lines = SIXTY_DEGREES;
    const driver_trace_t none = {.points = 0};
    bench_init(&rig.bench, &params, &rig.config, &none);
    rig.bench.wheel[0].coupling = &DISTURBED;
    if (!expect(bench_start(&rig.bench) == BENCH_READY, "comes to RUN by halls 60 degrees apart")) {
        return false;
    }
    rig.bench.speed_prescribed = true;
    rig.bench.vehicle.speed_m_per_s = 5.0;
    run(0.4);
    const wheel_t *wheel = &rig.bench.wheel[0];
    printf("halls: mode %d, warning %d\n", (int)wheel->slow.mode, (int)wheel->slow.warning_reason);
    if (!expect(wheel->slow.mode == MODE_RUN && wheel->first_fault == REASON_NONE &&
                    wheel->slow.warning_reason == REASON_NONE,
                "one wrong sample of a hall line has no effect")) {
        return false;
    }
    line_is_cut = true;
    run(0.1);
    printf("a line cut: mode %d, warning %d\n", (int)wheel->slow.mode,
           (int)wheel->slow.warning_reason);
    return expect(wheel->slow.warning_reason == REASON_ROTOR_UNCERTAIN &&
                      wheel->first_fault == REASON_NONE,
                  "a hall line that is cut is named, and the observer takes over");
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        (void)fprintf(stderr, "usage: chip_sensors ELF BOARD CONFIGURATION.bin\n");
        return 2;
    }
    const bool good = use_board(argv[2], argv[3]) && open_rig(argv[1]) && measures() &&
                      open_rig(argv[1]) && takes_an_encoder() && open_rig(argv[1]) &&
                      drives_by_disturbed_halls();
    printf("%s\n", good ? "as it must be" : rig.why);
    if (!good && rig.chip != NULL) {
        printf("%s\n", chip_text(rig.chip));
    }
    chip_close(rig.chip);
    return good ? 0 : 1;
}
