/* SPDX-License-Identifier: Apache-2.0 */
/* rig.h: the flashable image on the model of its chip in one wheel of the paper's vehicle, and what
 * is expected of it. */
#ifndef CHIP_RIG_H
#define CHIP_RIG_H

#include "bench/bench.h"
#include "drive.h"
#include "image.h"

enum { RIG_PERIODS_A_SECOND = 20000, RIG_WHY_BYTES = 160 };

typedef struct {
    const char *elf;
    chip_t *chip;
    drive_t drive;
    wheel_coupling_t coupling;
    config_t config;
    bench_t bench;
    char why[RIG_WHY_BYTES]; /* the first thing that is wrong; empty: nothing */
} rig_t;

extern rig_t rig;

/* Exit code of a test: 0 if `good`; with an error planted if it is not, and `finds` (planted.h) is
 * the beginning of the first thing that is wrong, of something that the model has noted, of a line
 * of the serial line, or of "fault: " and the fault that the controller has named. Says so, and
 * closes the chip. */
int rig_result(bool good, const char *finds);

/* Notes the first thing that is wrong; false, and for expect() whether it is good. */
bool wrong(const char *text);
bool expect(bool good, const char *text);

bool obeys_the_manuals(void);

/* The serial line has shown this text. */
bool says(const char *text);

/* The board, and the configuration that is written into the chip beside its image; NULL: the first
 * board, the image's own. False and a reason: one of them cannot be used. */
bool use_board(const char *board, const char *configuration);

/* The image's own configuration with this can.vesc_status. */
void use_vesc_status(int32_t controller_id);

/* A chip as it leaves the programmer, before its first instruction. */
bool open_rig(const char *elf);
void boot(void);

/* At rest until the controller runs, or long enough for it: calibration takes 0.1 s. Then brought
 * to speed. coupling NULL: the bench's own controller. */
bool drive_off(const wheel_coupling_t *coupling);
bool drive_off_to(const wheel_coupling_t *coupling, double speed_m_per_s);

void run(double duration_s);

#endif
