/* SPDX-License-Identifier: Apache-2.0 */
#include "hall.h"

#include <stddef.h>

#include "core/angle.h"
#include "core/q15.h"
#include "core/reciprocal.h"

/* Sensors 120 degrees apart, forward order 101, 001, 011, 010, 110, 100 (bits C B A); then the same
 * with B and C exchanged: 011, 001, 101, 100, 110, 010. */
static const uint8_t SECTOR_OF_SENSORS[16] = {
    HALL_NO_SECTOR, 1, 3, 2, 5, 0, 4, HALL_NO_SECTOR,
    HALL_NO_SECTOR, 1, 5, 0, 3, 2, 4, HALL_NO_SECTOR,
};

/* By rotor.hall_lines: bits 0 to 2 invert a line, bit 3 chooses the second half of the table. */
static inline uint8_t sector_of(const config_t *config, uint8_t sensors)
{
    return SECTOR_OF_SENSORS[((sensors & 7U) ^ (unsigned)config->rotor.hall_lines) & 15U];
}

void hall_init(hall_t *hall, const config_t *config)
{
    const hall_t fresh = {
        .standstill_periods = config->drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S,
        .reversal_periods = config->drive.pwm_frequency_Hz / HALL_REVERSAL_DIVISOR,
        .steady_sensors = HALL_NO_READING,
    };
    *hall = fresh;
}

/* ---- Sectors: geometry, timing, the angle inside ---- */

static uint32_t sector_start_q32(const config_t *config, uint8_t sector)
{
    return (uint32_t)config->rotor.edge_turn[sector] << 16;
}

static uint16_t sector_width_turn(const config_t *config, uint8_t sector)
{
    const unsigned next = sector == HALL_SECTORS - 1 ? 0U : sector + 1U;
    return (uint16_t)(config->rotor.edge_turn[next] - config->rotor.edge_turn[sector]);
}

/* From one sector to another: +1 the next one, -1 the previous one, 0 neither. */
static int32_t sector_step(uint8_t from, uint8_t to)
{
    const int32_t ahead = to >= from ? to - from : to - from + HALL_SECTORS;
    return ahead == 1 ? 1 : (ahead == HALL_SECTORS - 1 ? -1 : 0);
}

/* Of where the angle stays. */
static uint32_t centre_q32(const hall_t *hall)
{
    return hall->begin_q32 + (hall->span_q32 >> 17 << 16);
}

/* The sensors report a new sector. */
static void enter_sector(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->sector = sector;
    hall->begin_q32 = sector_start_q32(config, sector);
    hall->span_q32 = (uint32_t)sector_width_turn(config, sector) / 2U << 17 | UINT16_MAX;
    hall->periods_since_edge = 0;
}

/* Where the rotor may turn round in the sector, nothing is nearer than its middle once the angle is
 * there: the rotor may as well leave by the edge that it entered. 30 degrees of a wider sector,
 * so that its width tells such a half from every sector. */
static void end_at_middle(hall_t *hall)
{
    const uint32_t half_q32 = hall->span_q32 / 2U;
    const uint32_t narrow_q32 = half_q32 < HALL_NARROW_Q32 ? half_q32 : HALL_NARROW_Q32;
    hall->begin_q32 += hall->direction > 0 ? 0U : hall->span_q32 - narrow_q32;
    hall->span_q32 = narrow_q32;
}

static bool ends_at_middle(const hall_t *hall)
{
    return hall->span_q32 <= HALL_NARROW_Q32;
}

/* Limits the angle to the sector that the sensors report, or to its half. */
static void clamp_to_sector(hall_t *hall)
{
    if (hall->theta_q32 - hall->begin_q32 > hall->span_q32) {
        const bool ahead = hall->theta_q32 - centre_q32(hall) < UINT32_C(1) << 31;
        hall->theta_q32 = hall->begin_q32 + (ahead ? hall->span_q32 - 0x1FFFFU : 0U);
    }
}

/* The dead reckoning of a hall fault begins at the latest plausible edge. */
static void note_plausible_edge(hall_t *hall)
{
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = hall->speed_q32;
}

/* Unknown movement: speed zero, the middle of the sector. */
static void reset_movement(hall_t *hall)
{
    hall->speed_q32 = 0;
    hall->sectors_timed = 0;
    hall->timed_turn = 0;
    hall->timed_periods = 0;
    hall->direction = 0;
    if (!ends_at_middle(hall)) {
        hall->theta_q32 = centre_q32(hall);
    }
    hall->overdue_periods = hall->standstill_periods;
    hall->bounce_periods = 0;
    note_plausible_edge(hall);
}

/* Adds the time of a fully crossed sector. The sums cover at most one turn: the sixth sector before
 * this one was the same sector. */
static void time_sector(hall_t *hall, const config_t *config, uint8_t sector, int32_t periods)
{
    if (hall->sectors_timed < HALL_SECTORS) {
        hall->sectors_timed++;
        hall->timed_turn += sector_width_turn(config, sector);
    } else {
        hall->timed_periods -= hall->sector_periods[sector];
    }
    hall->timed_periods += (uint32_t)periods;
    hall->sector_periods[sector] = (uint16_t)periods;
}

/* Speed over the sectors timed so far, at most a quarter turn per period. Six sectors of up to a
 * quarter of a second may exceed the reciprocal's 16 bits; then both are divided by 4. */
static int32_t measured_speed_q32(const hall_t *hall)
{
    uint32_t turn_q31 = hall->timed_turn << 15; /* at most one turn */
    uint32_t periods = hall->timed_periods;
    if (periods > UINT16_MAX) {
        turn_q31 /= 4U;
        periods /= 4U;
    }
    const uint32_t speed_q31 = reciprocal_scale(turn_q31, (uint16_t)periods);
    const int32_t magnitude_q31 =
        speed_q31 < HALL_FASTEST_Q31 ? (int32_t)speed_q31 : HALL_FASTEST_Q31;
    return hall->direction * 2 * magnitude_q31;
}

/* An overdue edge: the speed decays; after a quarter of a second the rotor is at standstill. */
static void decay_overdue_speed(hall_t *hall)
{
    if (hall->periods_since_edge > hall->standstill_periods) {
        reset_movement(hall);
    } else if (hall->periods_since_edge > hall->overdue_periods) {
        hall->speed_q32 -= hall->speed_q32 / (1 << HALL_DECAY_LOG2);
    }
}

/* ---- Hall fault ride-through ---- */

/* Dead reckoning from the last plausible edge with the speed there: what looked like a slower rotor
 * since then may have been a dead sensor, which stretches sectors to twice their time. */
static void start_ride_through(hall_t *hall)
{
    hall->faults++;
    hall->valid = false;
    hall->plausible_edges = 0;
    hall->invalid_periods = 0;
    hall->speed_q32 = hall->edge_speed_q32;
    hall->direction = (int8_t)(hall->speed_q32 > 0 ? 1 : (hall->speed_q32 < 0 ? -1 : 0));
    hall->theta_q32 =
        hall->edge_theta_q32 + (uint32_t)hall->edge_speed_q32 * (uint32_t)hall->periods_since_edge;
    hall->overdue_periods =
        q_min(hall->overdue_periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
}

/* Ride-through: a neighbouring sector in the direction of rotation. From the second such edge on
 * both ends of the sector just left are known; its time alone counts, and because that is known to
 * one period only, with a weight of 1/4. */
static void follow_plausible_edge(hall_t *hall, const config_t *config, uint8_t sector)
{
    const uint8_t left = hall->sector;
    const uint32_t edge_q32 = sector_start_q32(config, hall->direction > 0 ? sector : left);
    hall->plausible_edges++;
    if (hall->plausible_edges > 1) {
        hall->sectors_timed = 1;
        hall->timed_turn = sector_width_turn(config, left);
        hall->timed_periods = (uint32_t)hall->periods_since_edge;
        hall->sector_periods[left] = (uint16_t)hall->periods_since_edge;
        hall->bounce_periods = hall->periods_since_edge / HALL_BOUNCE_DIVISOR;
        hall->overdue_periods =
            q_min(hall->periods_since_edge * HALL_OVERDUE_FACTOR * HALL_OVERDUE_FACTOR,
                  hall->standstill_periods);
        hall->speed_q32 = (int32_t)((INT64_C(3) * hall->speed_q32 + measured_speed_q32(hall)) / 4);
    }
    const int32_t error_turn =
        angle_difference((uint16_t)(edge_q32 >> 16), (uint16_t)(hall->theta_q32 >> 16));
    if (q_abs(error_turn) < HALL_EDGE_WINDOW_TURN || hall->plausible_edges > 1) {
        hall->theta_q32 += (uint32_t)(error_turn * 32768);
    }
}

/* True when the sensors are valid again. */
static bool ride_through_step(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    if (sector == HALL_NO_SECTOR) {
        hall->plausible_edges = 0;
    } else if (sector != hall->sector) {
        const int32_t step = sector_step(hall->sector, sector);
        const bool neighbour = step != 0;
        if (neighbour && step != hall->direction &&
            hall->periods_since_edge <= hall->bounce_periods) {
            return false; /* a bounce */
        }
        if (neighbour && step == hall->direction) {
            follow_plausible_edge(hall, config, sector);
        } else {
            hall->plausible_edges = 0;
            hall->direction = (int8_t)(hall->direction == 0 ? step : hall->direction);
        }
        if (hall->speed_q32 == 0) {
            hall->faults++; /* a rotor that stands has no edges */
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
    hall->valid = true;
    clamp_to_sector(hall);
    hall->overdue_periods /= HALL_OVERDUE_FACTOR;
    note_plausible_edge(hall);
}

/* ---- Plausible sensors ---- */

/* Weight of an edge's correction of the speed: 2^-result. At high speed an edge is seen up to a
 * period late, which is several degrees, and would add noise to the angle and to the back-EMF
 * feed-forward; at low speed the last turn is old and a period short (DERIVATIONS.md, Hall
 * sensors). */
static unsigned smoothing_log2(const hall_t *hall, int32_t sector_periods)
{
    if (hall->sectors_timed < HALL_SECTORS || sector_periods >= 2 * HALL_HIGH_SPEED_PERIODS) {
        return 0;
    }
    return sector_periods < HALL_HIGH_SPEED_PERIODS ? 3 : 2;
}

/* How far the rotor is past an edge seen at this sample, by the observed angle: at most the
 * movement of one period. What contradicts that corrects the observed angle's lead. */
static int32_t passed_turn(hall_t *hall, uint32_t edge_q32, hall_observed_t observed)
{
    const int32_t moved_turn = hall->speed_q32 / 65536;
    const uint16_t without_lead_turn =
        (uint16_t)(observed.theta_turn - (hall->observer_lead_q32 >> 16));
    const int32_t seen_turn = angle_difference(without_lead_turn, (uint16_t)(edge_q32 >> 16));
    const int32_t passed = q_clamp(seen_turn, q_min(moved_turn, 0), q_max(moved_turn, 0));
    hall->observer_lead_q32 += (uint32_t)((seen_turn - passed) * (65536 >> HALL_LEAD_LOG2));
    return passed;
}

/* Once a turn: the speed stays inside what a period more or less makes of the last turn's time. */
static void check_speed(hall_t *hall)
{
    const int32_t measured_q32 = measured_speed_q32(hall);
    const int32_t measured_q16 = measured_q32 / 65536;
    const int32_t period_q32 = measured_q16 * measured_q16;
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    hall->speed_q32 =
        q_clamp(hall->speed_q32, measured_q32 - period_q32, measured_q32 + period_q32);
}

/* High speed and an observed angle: a critically damped tracking loop over the edges. */
static void follow_observed_edge(hall_t *hall, uint32_t edge_q32, hall_observed_t observed,
                                 unsigned log2)
{
    if (hall->sector == 0) {
        check_speed(hall);
        return;
    }
    const uint32_t theta_q32 = hall->theta_q32 + (uint32_t)hall->speed_q32;
    const uint32_t now_turn = (edge_q32 >> 16) + (uint32_t)passed_turn(hall, edge_q32, observed);
    const int32_t error_turn = angle_difference((uint16_t)now_turn, (uint16_t)(theta_q32 >> 16));
    hall->theta_q32 = theta_q32 + ((uint32_t)error_turn << (16 - HALL_ANGLE_GAIN_LOG2));
    hall->speed_q32 =
        q_limit(hall->speed_q32 + error_turn * (HALL_SPEED_GAIN << log2), 2 * HALL_FASTEST_Q31);
}

/* Without one the edge lay on average half a period before this sample. At low speed half of the
 * angle's error, the whole of the speed's. */
static void follow_unobserved_edge(hall_t *hall, uint32_t edge_q32, unsigned log2)
{
    const int32_t speed_q32 =
        hall->speed_q32 + ((measured_speed_q32(hall) - hall->speed_q32) >> log2);
    hall->speed_q32 = speed_q32;
    const uint32_t now_q32 = edge_q32 + (uint32_t)(speed_q32 / 2);
    if (hall->sectors_timed < HALL_SECTORS) {
        hall->theta_q32 = now_q32;
    } else {
        /* This period's movement, before the comparison. */
        const uint32_t theta_q32 = hall->theta_q32 + (uint32_t)speed_q32;
        const int32_t error_turn =
            angle_difference((uint16_t)(now_q32 >> 16), (uint16_t)(theta_q32 >> 16));
        hall->theta_q32 = theta_q32 + ((uint32_t)error_turn << (log2 > 0 ? 16U - log2 : 15U));
        clamp_to_sector(hall);
    }
}

/* Whether a slow rotor may turn round in the sector that begins: the one that it left took 8/7 of
 * the time of the one before, or 143 ms, or more. With a constant deceleration it takes 1.3
 * times as long (DERIVATIONS.md, Hall sensors). Before overdue_periods are this sector's. */
static bool may_turn_round(const hall_t *hall, int32_t periods)
{
    return periods >= 2 * hall->reversal_periods && 7 * periods > 4 * hall->overdue_periods;
}

/* An edge in the direction of the last one: a sector was crossed from end to end. */
static void follow_edge(hall_t *hall, const config_t *config, uint8_t sector,
                        hall_observed_t observed)
{
    const uint8_t left = hall->sector;
    const int32_t periods = hall->periods_since_edge;
    enter_sector(hall, config, sector);
    const uint32_t edge_q32 =
        hall->direction > 0 ? hall->begin_q32 : sector_start_q32(config, left);
    time_sector(hall, config, left, periods);
    hall->bounce_periods = (int32_t)((uint32_t)periods / HALL_BOUNCE_DIVISOR);
    const unsigned log2 = smoothing_log2(hall, periods);
    if (log2 > 0 && observed.known) {
        follow_observed_edge(hall, edge_q32, observed, log2);
        clamp_to_sector(hall);
    } else {
        if (may_turn_round(hall, periods)) {
            end_at_middle(hall);
        }
        follow_unobserved_edge(hall, edge_q32, log2);
    }
    hall->overdue_periods = q_min(periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
    note_plausible_edge(hall);
}

/* The first edge after a standstill, or a reversal. A reversal may also be a dead sensor: where the
 * rotor was not slow the angle stays at the edge until one more sector's time has passed, which
 * halves the error in that case. A ride-through that starts later continues as if the rotor had
 * not reversed. */
static void process_reversal(hall_t *hall, const config_t *config, uint8_t sector, int32_t step)
{
    const bool moved = hall->sectors_timed > 0;
    const int32_t overdue_periods = hall->overdue_periods;
    const int32_t speed_q32 = hall->speed_q32;
    const uint32_t edge_q32 = sector_start_q32(config, step > 0 ? sector : hall->sector);
    enter_sector(hall, config, sector);
    reset_movement(hall);
    hall->direction = (int8_t)step;
    if (moved) {
        if (overdue_periods < 2 * HALL_OVERDUE_FACTOR * hall->reversal_periods) {
            hall->theta_q32 = edge_q32;
        }
        hall->overdue_periods = overdue_periods;
        hall->edge_theta_q32 = edge_q32;
        hall->edge_speed_q32 = speed_q32;
    }
}

/* Where an edge is overdue the rotor may come back: from then on nothing is nearer than the middle
 * of the sector. */
static void return_to_middle(hall_t *hall)
{
    if (!ends_at_middle(hall)) {
        const uint32_t away_q32 = centre_q32(hall) - hall->theta_q32;
        const uint32_t sign = 0U - (away_q32 >> 31);
        hall->theta_q32 += ((away_q32 ^ sign) >> HALL_DECAY_LOG2) ^ sign;
    }
}

/* A period inside the same sector. */
static void extrapolate(hall_t *hall)
{
    if (hall->periods_since_edge > hall->overdue_periods) {
        return_to_middle(hall);
        decay_overdue_speed(hall);
    } else {
        hall->theta_q32 += (uint32_t)hall->speed_q32;
        clamp_to_sector(hall);
    }
}

/* Back into the sector left so soon after the last edge: no rotor can reverse so fast. */
static bool impossible_reversal(const hall_t *hall, int32_t step)
{
    return step == -hall->direction && hall->sectors_timed > 0 &&
           hall->overdue_periods < hall->reversal_periods &&
           hall->periods_since_edge <= hall->overdue_periods;
}

/* No edge although dead reckoning is half a sector past it: no rotor can decelerate so fast. */
static bool impossible_stop(const hall_t *hall)
{
    const int32_t predicted_turn = q_abs(hall->edge_speed_q32 / 65536) * hall->periods_since_edge;
    return hall->sectors_timed > 0 && hall->overdue_periods < hall->reversal_periods / 2 &&
           predicted_turn > (int32_t)(hall->span_q32 >> 16) * 3 / 2;
}

static void process_same_sector(hall_t *hall)
{
    if (impossible_stop(hall)) {
        start_ride_through(hall);
    } else {
        extrapolate(hall);
    }
}

static void process_impossible_state(hall_t *hall)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    hall->invalid_periods++;
    if (hall->invalid_periods >= HALL_INVALID_PERIODS) {
        start_ride_through(hall);
    }
}

/* An edge, the bounce of the last one, an impossible reversal, or a skipped sector. */
static void process_other_sector(hall_t *hall, const config_t *config, uint8_t sector,
                                 hall_observed_t observed)
{
    const int32_t step = sector_step(hall->sector, sector);
    if (step != 0 && step == hall->direction) {
        follow_edge(hall, config, sector, observed);
    } else if (step != 0 && hall->periods_since_edge <= hall->bounce_periods) {
        extrapolate(hall);
    } else if (step == 0 || impossible_reversal(hall, step)) {
        start_ride_through(hall);
        enter_sector(hall, config, sector);
    } else {
        process_reversal(hall, config, sector, step);
    }
}

static void process_plausible(hall_t *hall, const config_t *config, uint8_t sector,
                              hall_observed_t observed)
{
    if (sector == HALL_NO_SECTOR) {
        process_impossible_state(hall);
        return;
    }
    hall->invalid_periods = 0;
    if (sector == hall->sector) {
        process_same_sector(hall);
    } else {
        process_other_sector(hall, config, sector, observed);
    }
}

static void start(hall_t *hall, const config_t *config, uint8_t sector)
{
    if (sector != HALL_NO_SECTOR) {
        hall->started = true;
        hall->valid = true;
        enter_sector(hall, config, sector);
        reset_movement(hall);
    }
}

void hall_process_event(hall_t *hall, const config_t *config, uint8_t sensors,
                        hall_observed_t observed)
{
    const uint8_t sector = sector_of(config, sensors);
    hall->periods_since_edge = q_min(hall->periods_since_edge + 1, UINT16_MAX);
    if (hall->valid) {
        process_plausible(hall, config, sector, observed);
    } else if (!hall->started) {
        start(hall, config, sector);
    } else if (ride_through_step(hall, config, sector)) {
        end_ride_through(hall);
    }
    /* A bounce, an impossible state and a ride-through are processed in every period. */
    hall->steady_sensors =
        hall->valid && sector == hall->sector ? sensors : (uint8_t)HALL_NO_READING;
}

/* ---- Disturbed lines ---- */

/* A reading that lasted one period: now the sensors report the sector before it, or a neighbour of
 * that, into which the rotor has gone meanwhile. */
static bool was_disturbance(const hall_t *hall, const hall_t *before, uint8_t sector)
{
    return sector != hall->sector && sector != HALL_NO_SECTOR &&
           (sector == before->sector || sector_step(before->sector, sector) != 0);
}

_Static_assert(offsetof(hall_t, sector_periods) == sizeof((hall_t *)NULL)->movement,
               "movement has as many words as the members beside it");

/* All but the constants and what only an impossible state counts. */
static void copy_movement(hall_t *to, const hall_t *from)
{
    to->movement = from->movement;
    /* Of the sector that an edge leaves: the only one that it times. */
    to->sector_periods[from->sector] = from->sector_periods[from->sector];
}

/* The rotor has gone on in the period of the disturbance. */
static void take_back(hall_t *hall, const hall_t *before)
{
    copy_movement(hall, before);
    hall->invalid_periods = 0;
    hall->periods_since_edge = q_min(hall->periods_since_edge + 1, UINT16_MAX);
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    clamp_to_sector(hall);
}

/* Where the rotor was expected: in the direction of the last edge, and after three quarters of its
 * sector's time. */
static bool expected_edge(const hall_t *hall, const hall_t *before)
{
    return hall->valid && hall->direction == before->direction &&
           8 * before->periods_since_edge >= 3 * before->overdue_periods;
}

bool hall_process_reading(hall_t *hall, hall_t *before, const config_t *config, uint8_t sensors,
                          hall_observed_t observed)
{
    const uint8_t sector = sector_of(config, sensors);
    if (before->valid && hall->periods_since_edge == 0 && was_disturbance(hall, before, sector)) {
        take_back(hall, before);
    }
    const bool edge = hall->valid && sector != HALL_NO_SECTOR && sector != hall->sector;
    if (edge) {
        copy_movement(before, hall);
    } else {
        before->valid = false;
    }
    hall_process_event(hall, config, sensors, observed);
    const bool confirmed = !edge || expected_edge(hall, before);
    if (!confirmed) {
        hall->steady_sensors = HALL_NO_READING;
    }
    return confirmed;
}
