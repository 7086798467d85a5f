/* SPDX-License-Identifier: Apache-2.0 */
#include "rig.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "config/validate.h"
#include "core/reason.h"
#include "planted.h"
#include "unity.h"
#include "wiring.h"

static const double SPEED_M_PER_S = IMAGE_SPEED_M_PER_S;
/* 0.6 s: the CRC of the program takes 0.5 s on the internal oscillator. */
enum { READY_PERIODS = 12000 };

rig_t rig;

/* The fixture's checks are Unity's. */
void setUp(void) {}

void tearDown(void) {}

bool wrong(const char *text)
{
    if (rig.why[0] == '\0') {
        (void)snprintf(rig.why, sizeof rig.why, "%s", text);
    }
    return false;
}

bool expect(bool good, const char *text)
{
    return good ? true : wrong(text);
}

/* The first thing that is wrong, the fault that the controller has named, what the model has noted,
 * a line of the program's own. */
static bool is_found(const char *finds)
{
    char fault[RIG_WHY_BYTES];
    (void)snprintf(fault, sizeof fault, "fault: %s", reason_text(rig.bench.wheel[0].first_fault));
    printf("%s\n", fault);
    bool found = planted_is(rig.why, finds) || planted_is(fault, finds);
    for (unsigned i = 0; rig.chip != NULL && i < CHIP_VIOLATIONS; i++) {
        const char *noted = chip_violation_text(rig.chip, i);
        if (noted != NULL) {
            printf("noted: %s\n", noted);
            found = found || planted_is(noted, finds);
        }
    }
    if (rig.chip != NULL && chip_text(rig.chip)[0] == '\0') {
        chip_run(rig.chip, CHIP_TICKS_PER_SECOND); /* on its internal oscillator it takes longer */
    }
    const char *line = rig.chip == NULL ? NULL : chip_text(rig.chip);
    while (line != NULL && *line != '\0') {
        found = found || planted_is(line, finds);
        line = strchr(line, '\n');
        line = line == NULL ? NULL : line + 1;
    }
    return found;
}

int rig_result(bool good, const char *finds)
{
    bool right = good;
    printf("%s\n", good ? "as it must be" : rig.why);
    if (finds != NULL) {
        right = !good && is_found(finds);
        printf("%s\n", good ? "NOT FOUND" : right ? "found" : "FAILS FOR ANOTHER REASON");
    }
    if (!right && rig.chip != NULL) {
        printf("%s\n", chip_text(rig.chip));
    }
    chip_close(rig.chip);
    return right ? 0 : 1;
}

bool obeys_the_manuals(void)
{
    const char *violation = chip_violation_text(rig.chip, 0);
    return violation == NULL ? true : wrong(violation);
}

bool says(const char *text)
{
    return strstr(chip_text(rig.chip), text) != NULL;
}

static config_t configuration;
static bool has_configuration;

bool use_board(const char *board, const char *path)
{
    if (board != NULL && !wiring_choose(board)) {
        return wrong("there is no such board");
    }
    if (path == NULL) {
        return true;
    }
    FILE *file = fopen(path, "rb");
    has_configuration = file != NULL && fread(&configuration, 1, sizeof configuration, file) ==
                                            sizeof configuration;
    if (file != NULL) {
        (void)fclose(file);
    }
    return has_configuration ? true : wrong("the configuration cannot be read");
}

void use_vesc_status(int32_t controller_id)
{
    configuration = image_config();
    configuration.can.vesc_status = controller_id;
    configuration.crc32 = config_crc32(&configuration, (uint32_t)offsetof(config_t, crc32));
    has_configuration = true;
}

bool open_rig(const char *elf)
{
    chip_close(rig.chip);
    memset(&rig, 0, sizeof rig);
    rig.elf = elf;
    rig.config = has_configuration ? configuration : image_config();
    rig.chip = chip_open(elf);
    return rig.chip != NULL &&
           (!has_configuration ||
            chip_write(rig.chip, IMAGE_CONFIGURATION_BEGINS, &configuration, sizeof configuration));
}

void boot(void)
{
    drive_begin(&rig.drive, rig.chip, &rig.config);
    rig.coupling = drive_coupling(&rig.drive);
}

bool drive_off(const wheel_coupling_t *coupling)
{
    return drive_off_to(coupling, SPEED_M_PER_S);
}

bool drive_off_to(const wheel_coupling_t *coupling, double speed_m_per_s)
{
    bench_params_t params = image_vehicle();
    params.run.initial_speed_m_per_s = speed_m_per_s;
    params.sensors.current_full_scale_a = 1e-3 * rig.config.drive.current_full_scale_mA;
    params.sensors.voltage_full_scale_v = 1e-3 * rig.config.drive.voltage_full_scale_mV;
    const driver_trace_t none = {.points = 0};
    bench_init(&rig.bench, &params, &rig.config, &none);
    rig.bench.wheel[0].coupling = coupling;
    rig.bench.speed_prescribed = true;
    rig.bench.vehicle.speed_m_per_s = 0.0;
    for (int i = 0; i < READY_PERIODS && rig.bench.wheel[0].slow.mode != IMAGE_MODE; i++) {
        bench_period(&rig.bench);
    }
    return rig.bench.wheel[0].slow.mode == IMAGE_MODE && bench_start(&rig.bench) == BENCH_READY;
}

void run(double duration_s)
{
    const int64_t periods = llround(duration_s * RIG_PERIODS_A_SECOND);
    for (int64_t i = 0; i < periods; i++) {
        bench_period(&rig.bench);
    }
}
