/* SPDX-License-Identifier: Apache-2.0 */
#include "rig.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

static const double SPEED_M_PER_S = IMAGE_SPEED_M_PER_S;
enum { READY_PERIODS = 8000 };

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

bool obeys_the_manuals(void)
{
    const char *violation = chip_violation_text(rig.chip, 0);
    return violation == NULL ? true : wrong(violation);
}

bool says(const char *text)
{
    return strstr(chip_text(rig.chip), text) != NULL;
}

bool open_rig(const char *elf)
{
    chip_close(rig.chip);
    memset(&rig, 0, sizeof rig);
    rig.elf = elf;
    rig.config = image_config();
    rig.chip = chip_open(elf);
    return rig.chip != NULL;
}

void boot(void)
{
    drive_begin(&rig.drive, rig.chip, &rig.config);
    rig.coupling = drive_coupling(&rig.drive);
}

bool drive_off(const wheel_coupling_t *coupling)
{
    bench_params_t params = image_vehicle();
    params.run.initial_speed_m_per_s = SPEED_M_PER_S;
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
