/* SPDX-License-Identifier: Apache-2.0 */
/*
 * steps.h: the steps of a controller as they were recorded, and run again.
 *
 * Both steps are pure, so a configuration and everything that they were given since a boot, in its
 * order, are a controller's complete inputs: run again they give the same outputs bit for bit.
 *
 * Plain declarations only, in the engine's library and by the rules of bench/engine.h, whose
 * handle hubsim_t is.
 */
#ifndef APPLICATION_STEPS_H
#define APPLICATION_STEPS_H

#include <stdint.h>

#include "bench/engine.h"

enum {
    HUBSIM_STEP_BOOT = 0, /* values: at HUBSIM_BOOT_... */
    HUBSIM_STEP_FAST = 1, /* values: raw inputs of the step, then its outputs (controller_api.h) */
    HUBSIM_STEP_SLOW = 2  /* likewise */
};

enum { HUBSIM_STEP_VALUES = 56 };

/* What the controller knew from before a boot. */
enum {
    HUBSIM_BOOT_KEPT_cC = 0,        /* the warmest of windings and switches */
    HUBSIM_BOOT_HOLD_DIRECTION = 1, /* in which the wheel was held */
    HUBSIM_BOOT_HOLD_LEAVES = 2,    /* it had just driven off */
    HUBSIM_BOOT_VALUES = 3
};

typedef struct {
    int16_t kind;
    int16_t reports; /* 1: what this fast step reports to the slow loop was taken */
    int32_t values[HUBSIM_STEP_VALUES];
} hubsim_step_t;

/* After hubsim_application and before hubsim_start: the steps of every wheel are recorded; and at
 * any time: no more are. */
int hubsim_record(hubsim_t *sim);
int hubsim_record_end(hubsim_t *sim);

/* At most `capacity` steps of one wheel that were not read yet, their number returned, negative:
 * there was no memory for some; and config_t of the latest boot. They take memory until read. */
int hubsim_steps_read(hubsim_t *sim, int wheel, hubsim_step_t *steps, int capacity);
int hubsim_steps_config(hubsim_t *sim, int wheel, void *image, uint32_t size_bytes);

/* A controller that runs recorded steps again. NULL when there is no memory. */
typedef struct hubsim_replay hubsim_replay_t;
hubsim_replay_t *hubsim_replay_new(void);
void hubsim_replay_delete(hubsim_replay_t *replay);

/* The configuration from the next boot on; negative: the firmware's validator refuses it. */
int hubsim_replay_config(hubsim_replay_t *replay, const void *image, uint32_t size_bytes);

/* Runs `count` steps with the inputs in them and puts what the steps return now in the place of
 * their outputs. Steps before a boot are refused, as are unknown kinds: negative, nothing run
 * from there on. */
int hubsim_replay_steps(hubsim_replay_t *replay, hubsim_step_t *steps, int count);

#endif
