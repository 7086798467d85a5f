/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hall.h: angle and speed from three hall sensors, once per PWM period.
 *
 * Speed: the time of the latest sectors, up to one electrical turn, so that misplaced sensors
 * cancel. Angle: extrapolated between edges, corrected at each edge, always inside the sector that
 * the sensors report. At high speed the observed angle tells when in the last period an edge was
 * passed. Where a slow rotor may turn round the angle goes no further than to the middle of the
 * sector. When the next edge is overdue the speed decays and the angle returns to the middle; after
 * a quarter of a second the rotor counts as at standstill, there (within 30 degrees for evenly
 * spaced sensors: torque at least 87 % of the nominal).
 *
 * An edge that is gone in the next period was a disturbance of a line and is taken back. A reversal
 * within an eighth of the last sector's time is a bounce and changes nothing. Four readings are
 * impossible for healthy sensors (DERIVATIONS.md, Hall sensors): a skipped sector, a lasting
 * invalid state, a reversal or a stop faster than a rotor can. Each counts in faults and starts the
 * hall fault ride-through: valid is false and the angle continues by dead reckoning with the
 * plausible edges, so that the torque can be ramped down. It ends after six plausible edges in
 * sequence, or at standstill with a possible state. Edges of a rotor that counts as standing then
 * are counted in faults as well.
 */
#ifndef FOC_HALL_H
#define FOC_HALL_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"
#include "foc/state.h"

/* Geometry of six sectors, and times in which no rotor turns back or stops. The validator's
 * relation of the blend-out speed to halls and the rotor's proofs rest on them. */
enum {
    HALL_STANDSTILL_PER_S = 4,    /* no edge for 1/4 s: standstill */
    HALL_INVALID_PERIODS = 64,    /* debounce of an impossible state */
    HALL_OVERDUE_FACTOR = 2,      /* an edge is overdue after this many last sectors' times */
    HALL_BOUNCE_DIVISOR = 8,      /* of the last sector's time: a reversal sooner is a bounce */
    HALL_HIGH_SPEED_PERIODS = 32, /* sector time below which an edge corrects an eighth, below
                                     twice that a quarter */
    HALL_LEAD_LOG2 = 3,           /* of what contradicts the observed angle's lead: an eighth */
    HALL_ANGLE_GAIN_LOG2 = 2,     /* of the error of an edge with an observed angle: a quarter */
    HALL_SPEED_GAIN = 16,         /* of that error in turns Q16 to speed Q32, times 8 or 4 */
    HALL_DECAY_LOG2 = 6,          /* an overdue edge takes 1/64 of the speed a period */
    HALL_REVERSAL_DIVISOR = 67,   /* 15 ms: no rotor reverses within two sectors of less time */
    HALL_PLAUSIBLE_EDGES = 6,     /* in sequence end the ride-through */
    HALL_EDGE_WINDOW_TURN = 5461, /* 30 degrees: accepted deviation of an edge in ride-through */
    HALL_FASTEST_Q31 = (1 << 29) - 1, /* a quarter turn per period: the widest sector in one */
    HALL_SECTORS = CONFIG_HALL_EDGES,
    HALL_NO_SECTOR = 7, /* of an impossible state */
    HALL_NO_READING = 255
};

/* Less than any sector, of which the narrowest has 30 degrees (config/validate.h). */
#define HALL_NARROW_Q32 (UINT32_C(5458) << 16)

void hall_init(hall_t *hall, const config_t *config);

/* Angle of the EMF observer at this sample. It is used within the last period's movement only, so
 * that the sensors stay what decides. */
typedef struct {
    uint16_t theta_turn;
    bool known;
} hall_observed_t;

/* A period with an event: an edge, an impossible state, an overdue edge, the end of a sector. */
void hall_process_event(hall_t *hall, const config_t *config, uint8_t sensors,
                        hall_observed_t observed);

/* The same, of a reading that may be a disturbance of a line: an edge that is gone in the next
 * period was none, and all that it made is taken back. before: the state before this edge; not
 * valid without one, and at first. False: the edge contradicts the movement so far, a reversal, a
 * fault or far too early, and the next period has to confirm it; until then the rotor goes on as
 * `before` has it. */
bool hall_process_reading(hall_t *hall, hall_t *before, const config_t *config, uint8_t sensors,
                          hall_observed_t observed);

/* One period without an event: the rotor moves inside its sector, as in nearly every period. False
 * if there is an event; then nothing has changed. sensors: bit 0 A, bit 1 B, bit 2 C. */
static inline bool hall_extrapolate(hall_t *hall, uint8_t sensors)
{
    const int32_t periods = hall->periods_since_edge;
    const bool overdue = periods >= hall->overdue_periods;
    if (sensors != hall->steady_sensors || overdue) {
        return false;
    }
    const uint32_t theta_q32 = hall->theta_q32 + (uint32_t)hall->speed_q32;
    if (theta_q32 - hall->begin_q32 > hall->span_q32) {
        return false;
    }
    hall->theta_q32 = theta_q32;
    hall->periods_since_edge = periods + 1;
    return true;
}

#endif
