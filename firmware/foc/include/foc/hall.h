/* SPDX-License-Identifier: Apache-2.0 */
/*
 * hall.h: angle and speed from three hall sensors, once per PWM period.
 *
 * The speed comes from the time the last sectors took, up to one electrical turn of them, so that
 * misplaced sensors cancel; a quick rotor's is smoothed over some edges more. Between edges the
 * angle is extrapolated, at each edge a half to an eighth of the disagreement is corrected, and it
 * never leaves the sector the sensors report. When the next edge is overdue the speed dies away;
 * without an edge for a quarter of a second the rotor counts as standing and the middle of the
 * sector is used (an error of at most 30 degrees electrical for evenly placed sensors: torque at
 * least 87 % of the nominal).
 *
 * An edge that comes back before an eighth of the last sector's time is a bounce and changes
 * nothing.
 *
 * Four things a healthy set of sensors never does: it skips a sector; it shows a state that sensors
 * 120 degrees apart cannot have (000, 111) for 64 periods; it turns round within two sectors' time
 * when these take less than 15 ms (an electrical acceleration above 60 degrees / (7.5 ms)^2 = 18
 * 600 rad/s^2, twice what 40 Nm and 23 pole pairs do to a wheel of 0.1 kg m^2 in the air); it loses
 * a third of its speed within a sector when two take less than 7.5 ms (25 000 rad/s^2, twice a
 * wheel that locks). Each counts in lost_edges and ends the validity. From the last edge in order
 * the angle runs on with the speed it had there, and from then on only edges are followed that come
 * within 30 degrees of where they are expected, or after another one in order: with one dead sensor
 * two a turn, both of them true; with none at all it is dead reckoning for a quarter of a second.
 * So there is an angle to let the torque go with, in a ramp. The angle is valid again after six
 * edges in order, a turn in which every sensor has come and gone (a dead one leaves no more than
 * two in order), or at a standstill with a state that can be.
 */
#ifndef FOC_HALL_H
#define FOC_HALL_H

#include <stdbool.h>
#include <stdint.h>

#include "config/config.h"

enum {
    HALL_STANDSTILL_PER_S = 4, /* no edge for 1/4 s counts as standstill */
    HALL_INVALID_PERIODS = 64, /* an impossible state must last this long to be believed */
    HALL_OVERDUE_FACTOR = 2,   /* an edge is overdue after this many times the last sector's time */
    HALL_BOUNCE_DIVISOR =
        8, /* of the last sector's time: a reversal sooner than this is a bounce */
    HALL_QUICK_PERIODS =
        32, /* a sector that takes less: an edge corrects an eighth, below twice that a quarter */
    HALL_DECAY_LOG2 = 6, /* an overdue edge takes 1/64 of the speed a period */
    HALL_TURN_ROUND_DIVISOR =
        67, /* two sectors quicker than 1/67 s: no rotor turns round in their time */
    HALL_TRUSTED_EDGES = 6,     /* in order end a doubt */
    HALL_NEAR_EDGE_TURN = 5461, /* 30 degrees: as far from its place an edge is believed in doubt */
    HALL_NEVER = 255            /* no reading */
};

typedef struct {
    uint32_t theta_q32;   /* turns */
    int32_t speed_q32;    /* turns per period, forward positive */
    uint16_t middle_turn; /* of the present sector */
    int16_t half_width_turn;
    uint16_t begin_turn, span_turn; /* the angles that lie inside: begin .. begin + span */
    int32_t periods_since_edge;     /* counts to 65 535 */
    int32_t overdue_periods;        /* periods_since_edge beyond which the speed decays, at most
                                       standstill_periods */
    int32_t bounce_periods; /* periods_since_edge up to which a reversal is a bounce; 0 while the
                               speed is unknown */
    int32_t standstill_periods; /* a quarter of a second */
    int32_t turn_round_periods; /* 15 ms */
    int32_t invalid_periods;
    uint16_t sector_periods[CONFIG_HALL_EDGES]; /* the latest full crossing of each sector */
    uint32_t timed_turn, timed_periods; /* angle and time of the sectors that were timed in this
                                           movement, six at most */
    uint32_t edge_theta_q32;            /* at the last edge in order, and the speed from there on */
    int32_t edge_speed_q32;
    uint16_t lost_edges;    /* what a healthy set of sensors does not do, wrapping */
    uint8_t sector;         /* 0 .. 5 */
    uint8_t steady_sensors; /* the reading that means nothing new; HALL_NEVER while every reading
                               must be looked at */
    uint8_t sectors_timed;  /* 0 .. 6: how many of sector_periods belong to this movement */
    int8_t direction;       /* of the last edge: +1, -1; 0 unknown */
    uint8_t edges_in_order; /* since the last doubt arose */
    bool doubt;             /* a sensor is dead or was disturbed */
    bool started;
    bool valid;
} hall_t;

void hall_init(hall_t *hall, const config_t *config);

/* A period in which something happens: an edge, an impossible reading, an edge that is overdue, the
 * end of a sector. */
void hall_look(hall_t *hall, const config_t *config, uint8_t sensors);

/* sensors: bit 0 A, bit 1 B, bit 2 C. Updates theta_q32, speed_q32 and valid. Nearly always the
 * rotor just moves on inside the same sector: then theta_q32 and periods_since_edge are all that
 * changes. Was there more? */
static inline bool hall_step(hall_t *hall, const config_t *config, uint8_t sensors)
{
    if (sensors == hall->steady_sensors && hall->periods_since_edge < hall->overdue_periods) {
        const uint32_t theta_q32 = hall->theta_q32 + (uint32_t)hall->speed_q32;
        const uint16_t inside_turn = (uint16_t)((theta_q32 >> 16) - hall->begin_turn);
        if (inside_turn <= hall->span_turn) {
            hall->periods_since_edge++;
            hall->theta_q32 = theta_q32;
            return false;
        }
    }
    hall_look(hall, config, sensors);
    return true;
}

#endif
