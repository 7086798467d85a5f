/* SPDX-License-Identifier: Apache-2.0 */
#include "hall.h"

#include "core/angle.h"
#include "core/q15.h"
#include "core/reciprocal.h"

/* Sensors 120 degrees apart, forward order 101, 001, 011, 010, 110, 100 (bits C B A). */
static const uint8_t SECTOR_OF_SENSORS[8] = {HALL_NO_SECTOR, 1, 3, 2, 5, 0, 4, HALL_NO_SECTOR};

void hall_init(hall_t *hall, const config_t *config)
{
    const hall_t zero = {0};
    *hall = zero;
    hall->standstill_periods = config->drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S;
    hall->reversal_periods = config->drive.pwm_frequency_Hz / HALL_REVERSAL_DIVISOR;
    hall->steady_sensors = HALL_NO_READING;
}

/* ---- Sectors: geometry, timing, the angle inside ---- */

static uint8_t next_sector(uint8_t sector)
{
    return sector == HALL_SECTORS - 1 ? 0 : (uint8_t)(sector + 1U);
}

static uint8_t previous_sector(uint8_t sector)
{
    return sector == 0 ? HALL_SECTORS - 1 : (uint8_t)(sector - 1U);
}

static uint16_t sector_start(const config_t *config, uint8_t sector)
{
    return (uint16_t)config->rotor.edge_turn[sector];
}

static uint16_t sector_width(const config_t *config, uint8_t sector)
{
    return (uint16_t)(sector_start(config, next_sector(sector)) - sector_start(config, sector));
}

/* The sensors report a new sector. */
static void enter_sector(hall_t *hall, const config_t *config, uint8_t sector)
{
    const uint16_t half = (uint16_t)(sector_width(config, sector) / 2U);
    hall->sector = sector;
    hall->half_width_turn = (int16_t)half;
    hall->middle_turn = (uint16_t)(sector_start(config, sector) + half);
    hall->begin_q32 = (uint32_t)sector_start(config, sector) << 16;
    hall->span_q32 = (uint32_t)half << 17 | UINT16_MAX;
    hall->periods_since_edge = 0;
}

/* Unknown movement: speed zero, the middle of the sector. */
static void reset_movement(hall_t *hall)
{
    hall->speed_q32 = 0;
    hall->sectors_timed = 0;
    hall->timed_turn = 0;
    hall->timed_periods = 0;
    hall->direction = 0;
    hall->theta_q32 = (uint32_t)hall->middle_turn << 16;
    hall->overdue_periods = hall->standstill_periods;
    hall->bounce_periods = 0;
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = 0;
}

/* Adds the time of a fully crossed sector. The sums cover at most one turn: the sixth sector before
 * this one was the same sector. */
static void time_sector(hall_t *hall, uint8_t sector, uint16_t width_turn, uint16_t periods)
{
    if (hall->sectors_timed < HALL_SECTORS) {
        hall->sectors_timed++;
        hall->timed_turn += width_turn;
    } else {
        hall->timed_periods -= hall->sector_periods[sector];
    }
    hall->timed_periods += periods;
    hall->sector_periods[sector] = periods;
}

/* Speed over the sectors timed so far. */
static int32_t measured_speed_q32(const hall_t *hall)
{
    const uint32_t turn = hall->timed_turn;
    const uint32_t periods = hall->timed_periods;
    /* turn <= 65 536. Six sectors of up to a quarter of a second may exceed the reciprocal's 16
     * bits; then both are divided by 4. */
    const bool slow = periods > UINT16_MAX;
    const uint32_t divisor = slow ? periods / 4U : periods;
    const uint32_t dividend_q15 = slow ? turn << 13 : turn << 15;
    const uint32_t speed_q31 =
        reciprocal_scale(dividend_q15, (uint16_t)q_min((int32_t)divisor, UINT16_MAX));
    const int32_t speed_q32 = q_min((int32_t)(speed_q31 & INT32_MAX), INT32_MAX / 2) * 2;
    return hall->direction > 0 ? speed_q32 : -speed_q32;
}

/* Limits the angle to the sector that the sensors report. */
static void clamp_to_sector(hall_t *hall)
{
    const int32_t beyond = angle_difference((uint16_t)(hall->theta_q32 >> 16), hall->middle_turn);
    if (beyond > hall->half_width_turn) {
        hall->theta_q32 = (uint32_t)(uint16_t)(hall->middle_turn + hall->half_width_turn - 1) << 16;
    } else if (beyond < -hall->half_width_turn) {
        hall->theta_q32 = (uint32_t)(uint16_t)(hall->middle_turn - hall->half_width_turn) << 16;
    }
}

/* An overdue edge: the speed decays; after a quarter of a second the rotor is at standstill. */
static void decay_overdue_speed(hall_t *hall)
{
    if (hall->periods_since_edge > hall->overdue_periods) {
        hall->speed_q32 -= hall->speed_q32 / (1 << HALL_DECAY_LOG2);
        if (hall->speed_q32 == 0) {
            hall->theta_q32 = (uint32_t)hall->middle_turn << 16;
        }
        if (hall->periods_since_edge > hall->standstill_periods) {
            reset_movement(hall);
        }
    }
}

/* ---- Hall fault ride-through ---- */

/* Dead reckoning from the last plausible edge with the speed there: what looked like a slower rotor
 * since then may have been a dead sensor. */
static void start_ride_through(hall_t *hall)
{
    hall->faults++;
    hall->ride_through = true;
    hall->plausible_edges = 0;
    hall->speed_q32 = hall->edge_speed_q32;
    hall->direction = (int8_t)(hall->speed_q32 > 0 ? 1 : (hall->speed_q32 < 0 ? -1 : 0));
    hall->theta_q32 =
        hall->edge_theta_q32 + (uint32_t)hall->edge_speed_q32 * (uint32_t)hall->periods_since_edge;
    /* A dead sensor stretches sectors to twice their time. */
    hall->overdue_periods =
        q_min(hall->overdue_periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
}

/* Ride-through: a neighbouring sector in the direction of rotation. */
static void follow_plausible_edge(hall_t *hall, const config_t *config, uint8_t sector)
{
    const uint8_t left = hall->sector;
    const uint16_t edge_turn = sector_start(config, hall->direction > 0 ? sector : left);
    hall->plausible_edges++;
    if (hall->plausible_edges > 1) {
        /* Both ends of the sector just left were plausible edges: its time alone counts. */
        hall->sectors_timed = 0;
        hall->timed_turn = 0;
        hall->timed_periods = 0;
        time_sector(hall, left, sector_width(config, left), (uint16_t)hall->periods_since_edge);
        hall->bounce_periods = hall->periods_since_edge / HALL_BOUNCE_DIVISOR;
        hall->overdue_periods =
            q_min(hall->periods_since_edge * HALL_OVERDUE_FACTOR * HALL_OVERDUE_FACTOR,
                  hall->standstill_periods);
        /* The time of one sector is known to one period only: weight 1/4. */
        hall->speed_q32 =
            q_saturate64((INT64_C(3) * hall->speed_q32 + measured_speed_q32(hall)) / 4);
    }
    const int32_t error_turn = angle_difference(edge_turn, (uint16_t)(hall->theta_q32 >> 16));
    if (q_abs(error_turn) < HALL_EDGE_WINDOW_TURN || hall->plausible_edges > 1) {
        hall->theta_q32 += (uint32_t)(error_turn * 32768);
    }
}

static bool ride_through_step(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    if (sector == HALL_NO_SECTOR) {
        hall->plausible_edges = 0;
    } else if (sector != hall->sector) {
        const int32_t step = sector == next_sector(hall->sector)
                                 ? 1
                                 : (sector == previous_sector(hall->sector) ? -1 : 0);
        if (step != 0 && step != hall->direction &&
            hall->periods_since_edge <= hall->bounce_periods) {
            return false; /* a bounce */
        }
        if (step != 0 && step == hall->direction) {
            follow_plausible_edge(hall, config, sector);
        } else {
            hall->plausible_edges = 0;
            if (hall->direction == 0) {
                hall->direction = (int8_t)step;
            }
        }
        enter_sector(hall, config, sector);
    }
    const bool standstill = hall->periods_since_edge > hall->standstill_periods;
    /* An impossible state cannot give an edge, so a missing one is no sign of deceleration. */
    if (sector != HALL_NO_SECTOR || standstill) {
        decay_overdue_speed(hall);
    }
    return sector != HALL_NO_SECTOR &&
           (standstill || hall->plausible_edges >= HALL_PLAUSIBLE_EDGES);
}

static void end_ride_through(hall_t *hall)
{
    hall->ride_through = false;
    clamp_to_sector(hall);
    hall->overdue_periods /= HALL_OVERDUE_FACTOR;
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = hall->speed_q32;
}

/* ---- Plausible sensors ---- */

/* Weight of an edge's correction of angle and speed: 2^-result. At high speed an edge is seen up to
 * a period late, which is several degrees, and would add noise to the angle and to the back-EMF
 * feed-forward; at low speed the last turn is old and a period short (README, Hall sensors). */
static unsigned smoothing_log2(const hall_t *hall, int32_t sector_periods)
{
    if (hall->sectors_timed < HALL_SECTORS || sector_periods >= 2 * HALL_HIGH_SPEED_PERIODS) {
        return 0;
    }
    return sector_periods < HALL_HIGH_SPEED_PERIODS ? 3 : 2;
}

/* The first edge after a standstill, or a reversal. A reversal may also be a dead sensor: until one
 * more sector's time has passed the angle stays at the edge, which halves the error in that case.
 */
static void process_reversal(hall_t *hall, int8_t direction, uint16_t edge_turn)
{
    const bool moved = hall->sectors_timed > 0;
    const int32_t overdue_periods = hall->overdue_periods;
    const int32_t speed_q32 = hall->speed_q32;
    reset_movement(hall);
    hall->direction = direction;
    if (moved) {
        hall->theta_q32 = (uint32_t)edge_turn << 16;
        hall->overdue_periods = overdue_periods;
        /* A ride-through that starts later continues as if the rotor had not reversed. */
        hall->edge_theta_q32 = hall->theta_q32;
        hall->edge_speed_q32 = speed_q32;
    }
}

static void process_edge(hall_t *hall, const config_t *config, uint8_t sector, int8_t direction)
{
    const uint8_t left = hall->sector;
    const int32_t crossing_periods = hall->periods_since_edge;
    const uint16_t edge_turn = sector_start(config, direction > 0 ? sector : left);
    const bool fully_crossed = direction == hall->direction;
    hall->direction = direction;
    enter_sector(hall, config, sector);
    if (!fully_crossed) {
        process_reversal(hall, direction, edge_turn);
        return;
    }
    time_sector(hall, left, sector_width(config, left), (uint16_t)crossing_periods);
    hall->overdue_periods = q_min(crossing_periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
    hall->bounce_periods = crossing_periods / HALL_BOUNCE_DIVISOR;
    const unsigned edges_log2 = smoothing_log2(hall, crossing_periods);
    const int64_t error_q32 = (int64_t)measured_speed_q32(hall) - hall->speed_q32;
    hall->speed_q32 = q_saturate64(hall->speed_q32 + (error_q32 >> edges_log2));
    /* The edge lay on average half a period before this sample. */
    const uint32_t now_q32 = ((uint32_t)edge_turn << 16) + (uint32_t)(hall->speed_q32 / 2);
    if (hall->sectors_timed < HALL_SECTORS) {
        hall->theta_q32 = now_q32;
    } else {
        /* This period's movement, before the comparison. */
        hall->theta_q32 += (uint32_t)hall->speed_q32;
        const int32_t error_turn =
            angle_difference((uint16_t)(now_q32 >> 16), (uint16_t)(hall->theta_q32 >> 16));
        hall->theta_q32 += (uint32_t)(error_turn * (edges_log2 > 0 ? 65536 >> edges_log2 : 32768));
        clamp_to_sector(hall);
    }
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = hall->speed_q32;
}

/* A period inside the same sector. */
static void extrapolate(hall_t *hall)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    clamp_to_sector(hall);
    decay_overdue_speed(hall);
}

/* A neighbouring sector: an edge, the bounce of the last one, or an impossible reversal. */
static void process_neighbour(hall_t *hall, const config_t *config, uint8_t sector,
                              int8_t direction)
{
    const bool back = direction == -hall->direction;
    const bool too_fast = hall->sectors_timed > 0 &&
                          hall->overdue_periods < hall->reversal_periods &&
                          hall->periods_since_edge <= hall->overdue_periods;
    if (direction != hall->direction && hall->periods_since_edge <= hall->bounce_periods) {
        extrapolate(hall);
    } else if (back && too_fast) {
        start_ride_through(hall);
        enter_sector(hall, config, sector);
    } else {
        process_edge(hall, config, sector, direction);
    }
}

/* No edge although dead reckoning is half a sector past it: no rotor can decelerate so fast. */
static bool impossible_stop(const hall_t *hall)
{
    const int32_t predicted_turn = q_abs(hall->edge_speed_q32 / 65536) * hall->periods_since_edge;
    return hall->sectors_timed > 0 && hall->overdue_periods < hall->reversal_periods / 2 &&
           predicted_turn > (int32_t)(hall->span_q32 >> 16) * 3 / 2;
}

static void process_plausible(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->invalid_periods =
        sector == HALL_NO_SECTOR ? q_min(hall->invalid_periods + 1, UINT16_MAX) : 0;
    if (sector == HALL_NO_SECTOR) {
        hall->theta_q32 += (uint32_t)hall->speed_q32;
        if (hall->invalid_periods >= HALL_INVALID_PERIODS) {
            start_ride_through(hall);
        }
    } else if (sector == hall->sector) {
        if (impossible_stop(hall)) {
            start_ride_through(hall);
        } else {
            extrapolate(hall);
        }
    } else if (sector == next_sector(hall->sector)) {
        process_neighbour(hall, config, sector, 1);
    } else if (sector == previous_sector(hall->sector)) {
        process_neighbour(hall, config, sector, -1);
    } else {
        start_ride_through(hall);
        enter_sector(hall, config, sector);
    }
}

void hall_process_event(hall_t *hall, const config_t *config, uint8_t sensors)
{
    const uint8_t sector = SECTOR_OF_SENSORS[sensors & 7U];
    hall->periods_since_edge = q_min(hall->periods_since_edge + 1, UINT16_MAX);
    if (!hall->started) {
        if (sector != HALL_NO_SECTOR) {
            hall->started = true;
            enter_sector(hall, config, sector);
            reset_movement(hall);
        }
    } else if (!hall->ride_through) {
        process_plausible(hall, config, sector);
    } else if (ride_through_step(hall, config, sector)) {
        end_ride_through(hall);
    }
    hall->valid = hall->started && !hall->ride_through;
    /* A bounce, an impossible state and a ride-through are processed in every period. */
    hall->steady_sensors =
        hall->valid && sector == hall->sector ? sensors : (uint8_t)HALL_NO_READING;
}
