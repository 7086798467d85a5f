#include "foc/hall.h"

#include "core/angle.h"
#include "core/q15.h"
#include "core/reciprocal.h"

enum { SECTORS = CONFIG_HALL_EDGES, NO_SECTOR = 7 };

/* Sensors 120 degrees apart, forward order 101, 001, 011, 010, 110, 100 (bits C B A). */
static const uint8_t SECTOR_OF_SENSORS[8] = {NO_SECTOR, 1, 3, 2, 5, 0, 4, NO_SECTOR};

static uint8_t next_sector(uint8_t sector)
{
    return sector == SECTORS - 1 ? 0 : (uint8_t)(sector + 1U);
}

static uint8_t previous_sector(uint8_t sector)
{
    return sector == 0 ? SECTORS - 1 : (uint8_t)(sector - 1U);
}

static uint16_t sector_start(const config_t *config, uint8_t sector)
{
    return (uint16_t)config->rotor.edge_turn[sector];
}

static uint16_t sector_width(const config_t *config, uint8_t sector)
{
    return (uint16_t)(sector_start(config, next_sector(sector)) - sector_start(config, sector));
}

static void enter_sector(hall_t *hall, const config_t *config, uint8_t sector)
{
    const uint16_t half = (uint16_t)(sector_width(config, sector) / 2U);
    hall->sector = sector;
    hall->half_width_turn = (int16_t)half;
    hall->middle_turn = (uint16_t)(sector_start(config, sector) + half);
    hall->begin_turn = sector_start(config, sector);
    hall->span_turn = (uint16_t)(2U * half);
    hall->periods_since_edge = 0;
}

static void settle(hall_t *hall)
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

void hall_init(hall_t *hall, const config_t *config)
{
    const hall_t zero = {0};
    *hall = zero;
    hall->standstill_periods = config->drive.pwm_frequency_Hz / HALL_STANDSTILL_PER_S;
    hall->turn_round_periods = config->drive.pwm_frequency_Hz / HALL_TURN_ROUND_DIVISOR;
    hall->steady_sensors = HALL_NEVER;
}

/* A sector was crossed from end to end. A full turn of them is kept: the sixth before this one was the same sector. */
static void time_sector(hall_t *hall, uint8_t sector, uint16_t width_turn, uint16_t periods)
{
    if (hall->sectors_timed < SECTORS) {
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
    /* turn <= 65 536. Six sectors of up to a quarter of a second may exceed the reciprocal's 16 bits: quarter both then. */
    const bool slow = periods > UINT16_MAX;
    const uint32_t divisor = slow ? periods / 4U : periods;
    const uint32_t dividend_q15 = slow ? turn << 13 : turn << 15;
    const uint32_t speed_q31 = reciprocal_scale(dividend_q15, (uint16_t)q_min((int32_t)divisor, UINT16_MAX));
    const int32_t speed_q32 = q_min((int32_t)(speed_q31 & INT32_MAX), INT32_MAX / 2) * 2;
    return hall->direction > 0 ? speed_q32 : -speed_q32;
}

/* The angle inside the sector that the sensors report. */
static void hold_inside(hall_t *hall)
{
    const int32_t beyond = angle_difference((uint16_t)(hall->theta_q32 >> 16), hall->middle_turn);
    if (beyond > hall->half_width_turn) {
        hall->theta_q32 = (uint32_t)(uint16_t)(hall->middle_turn + hall->half_width_turn - 1) << 16;
    } else if (beyond < -hall->half_width_turn) {
        hall->theta_q32 = (uint32_t)(uint16_t)(hall->middle_turn - hall->half_width_turn) << 16;
    }
}

/* How far an edge moves angle and speed, as a power of two: 8 or 4 of them halve a quick rotor's error, one that of a
 * slow one. An edge is seen up to a period late, which at high speed is degrees, and a turn's time known to a period:
 * taken at their word they would shake the angle and the EMF that is fed forward. At low speed a period is nothing
 * and the last turn long ago. */
static unsigned smoothing_log2(const hall_t *hall, int32_t sector_periods)
{
    if (hall->sectors_timed < SECTORS || sector_periods >= 2 * HALL_QUICK_PERIODS) {
        return 0;
    }
    return sector_periods < HALL_QUICK_PERIODS ? 3 : 2;
}

/* The first edge after a standstill, or one that comes back. Of the latter nobody knows yet whether the rotor turned round
 * or a sensor died: until a sector's time more has passed the angle stays at the edge, which is wrong by half of what the
 * middle of the sector would be if it was the sensor. */
static void turn_round(hall_t *hall, int8_t direction, uint16_t edge_turn)
{
    const bool moved = hall->sectors_timed > 0;
    const int32_t overdue_periods = hall->overdue_periods;
    const int32_t speed_q32 = hall->speed_q32;
    settle(hall);
    hall->direction = direction;
    if (moved) {
        hall->theta_q32 = (uint32_t)edge_turn << 16;
        hall->overdue_periods = overdue_periods;
        hall->edge_theta_q32 = hall->theta_q32; /* should it turn out to be a doubt: as if nothing had turned round */
        hall->edge_speed_q32 = speed_q32;
    }
}

static void cross_edge(hall_t *hall, const config_t *config, uint8_t sector, int8_t direction)
{
    const uint8_t left = hall->sector;
    const int32_t took_periods = hall->periods_since_edge;
    const uint16_t edge_turn = sector_start(config, direction > 0 ? sector : left);
    const bool crossed = direction == hall->direction; /* the sector just left was crossed from end to end */
    hall->direction = direction;
    enter_sector(hall, config, sector);
    if (!crossed) {
        turn_round(hall, direction, edge_turn);
        return;
    }
    time_sector(hall, left, sector_width(config, left), (uint16_t)took_periods);
    hall->overdue_periods = q_min(took_periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
    hall->bounce_periods = took_periods / HALL_BOUNCE_DIVISOR;
    const unsigned edges_log2 = smoothing_log2(hall, took_periods);
    const int64_t wrong_q32 = (int64_t)measured_speed_q32(hall) - hall->speed_q32;
    hall->speed_q32 = q_saturate64(hall->speed_q32 + (wrong_q32 >> edges_log2));
    /* The edge lay on average half a period before this sample. */
    const uint32_t now_q32 = ((uint32_t)edge_turn << 16) + (uint32_t)(hall->speed_q32 / 2);
    if (hall->sectors_timed < SECTORS) {
        hall->theta_q32 = now_q32;
    } else {
        hall->theta_q32 += (uint32_t)hall->speed_q32; /* this period's movement, before the comparison */
        const int32_t wrong_turn = angle_difference((uint16_t)(now_q32 >> 16), (uint16_t)(hall->theta_q32 >> 16));
        hall->theta_q32 += (uint32_t)(wrong_turn * (edges_log2 > 0 ? 65536 >> edges_log2 : 32768));
        hold_inside(hall);
    }
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = hall->speed_q32;
}

/* When the next edge is overdue the speed dies away, and in the end the rotor counts as standing. */
static void wait_for_edge(hall_t *hall)
{
    if (hall->periods_since_edge > hall->overdue_periods) {
        hall->speed_q32 -= hall->speed_q32 / (1 << HALL_DECAY_LOG2);
        if (hall->speed_q32 == 0) {
            hall->theta_q32 = (uint32_t)hall->middle_turn << 16;
        }
        if (hall->periods_since_edge > hall->standstill_periods) {
            settle(hall);
        }
    }
}

/* One more period inside the same sector. */
static void extrapolate(hall_t *hall)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    hold_inside(hall);
    wait_for_edge(hall);
}

/* The sensors contradict themselves. Whatever was held back since the last edge in order was perhaps no slower rotor but a
 * dead sensor: the angle goes on from there as if that edge had been the last thing heard. */
static void begin_doubt(hall_t *hall)
{
    hall->lost_edges++;
    hall->doubt = true;
    hall->edges_in_order = 0;
    hall->speed_q32 = hall->edge_speed_q32;
    hall->direction = (int8_t)(hall->speed_q32 > 0 ? 1 : (hall->speed_q32 < 0 ? -1 : 0));
    hall->theta_q32 = hall->edge_theta_q32 + (uint32_t)hall->edge_speed_q32 * (uint32_t)hall->periods_since_edge;
    /* A dead sensor stretches sectors to twice their time. */
    hall->overdue_periods = q_min(hall->overdue_periods * HALL_OVERDUE_FACTOR, hall->standstill_periods);
}

/* A neighbouring sector in the direction of the rotation, while in doubt. */
static void follow_edge_in_doubt(hall_t *hall, const config_t *config, uint8_t sector)
{
    const uint8_t left = hall->sector;
    const uint16_t edge_turn = sector_start(config, hall->direction > 0 ? sector : left);
    hall->edges_in_order++;
    if (hall->edges_in_order > 1) {
        hall->sectors_timed = 0; /* both ends of the sector just left were edges in order: its time alone counts */
        hall->timed_turn = 0;
        hall->timed_periods = 0;
        time_sector(hall, left, sector_width(config, left), (uint16_t)hall->periods_since_edge);
        hall->bounce_periods = hall->periods_since_edge / HALL_BOUNCE_DIVISOR;
        hall->overdue_periods =
            q_min(hall->periods_since_edge * HALL_OVERDUE_FACTOR * HALL_OVERDUE_FACTOR, hall->standstill_periods);
        /* One sector is known to a period of its time only, so it counts for a quarter. */
        hall->speed_q32 = q_saturate64((INT64_C(3) * hall->speed_q32 + measured_speed_q32(hall)) / 4);
    }
    const int32_t wrong_turn = angle_difference(edge_turn, (uint16_t)(hall->theta_q32 >> 16));
    if (q_abs(wrong_turn) < HALL_NEAR_EDGE_TURN || hall->edges_in_order > 1) {
        hall->theta_q32 += (uint32_t)(wrong_turn * 32768);
    }
}

/* A period in doubt: dead reckoning, corrected by the edges that fit. True when the doubt is over. */
static bool reckon(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->theta_q32 += (uint32_t)hall->speed_q32;
    if (sector == NO_SECTOR) {
        hall->edges_in_order = 0;
    } else if (sector != hall->sector) {
        const int32_t step =
            sector == next_sector(hall->sector) ? 1 : (sector == previous_sector(hall->sector) ? -1 : 0);
        if (step != 0 && step != hall->direction && hall->periods_since_edge <= hall->bounce_periods) {
            return false; /* a bounce */
        }
        if (step != 0 && step == hall->direction) {
            follow_edge_in_doubt(hall, config, sector);
        } else {
            hall->edges_in_order = 0;
            if (hall->direction == 0) {
                hall->direction = (int8_t)step;
            }
        }
        enter_sector(hall, config, sector);
    }
    const bool standing = hall->periods_since_edge > hall->standstill_periods;
    /* No edge can come out of an impossible state: that none does says nothing. */
    if (sector != NO_SECTOR || standing) {
        wait_for_edge(hall);
    }
    return sector != NO_SECTOR && (standing || hall->edges_in_order >= HALL_TRUSTED_EDGES);
}

static void end_doubt(hall_t *hall)
{
    hall->doubt = false;
    hold_inside(hall);
    hall->overdue_periods /= HALL_OVERDUE_FACTOR;
    hall->edge_theta_q32 = hall->theta_q32;
    hall->edge_speed_q32 = hall->speed_q32;
}

/* The sensors say a neighbouring sector: an edge, the bounce of the last one, or a reversal that cannot be. */
static void step_to(hall_t *hall, const config_t *config, uint8_t sector, int8_t direction)
{
    const bool back = direction == -hall->direction;
    const bool too_quick = hall->sectors_timed > 0 && hall->overdue_periods < hall->turn_round_periods &&
                           hall->periods_since_edge <= hall->overdue_periods;
    if (direction != hall->direction && hall->periods_since_edge <= hall->bounce_periods) {
        extrapolate(hall);
    } else if (back && too_quick) {
        begin_doubt(hall);
        enter_sector(hall, config, sector);
    } else {
        cross_edge(hall, config, sector, direction);
    }
}

/* Half a sector beyond its end by dead reckoning, and no edge: no rotor can have slowed down so much since the last one. */
static bool stopped_too_quickly(const hall_t *hall)
{
    const int32_t gone_turn = q_abs(hall->edge_speed_q32 / 65536) * hall->periods_since_edge;
    return hall->sectors_timed > 0 && hall->overdue_periods < hall->turn_round_periods / 2 &&
           gone_turn > hall->span_turn * 3 / 2;
}

static void look_in_order(hall_t *hall, const config_t *config, uint8_t sector)
{
    hall->invalid_periods = sector == NO_SECTOR ? q_min(hall->invalid_periods + 1, UINT16_MAX) : 0;
    if (sector == NO_SECTOR) {
        hall->theta_q32 += (uint32_t)hall->speed_q32;
        if (hall->invalid_periods >= HALL_INVALID_PERIODS) {
            begin_doubt(hall);
        }
    } else if (sector == hall->sector) {
        if (stopped_too_quickly(hall)) {
            begin_doubt(hall);
        } else {
            extrapolate(hall);
        }
    } else if (sector == next_sector(hall->sector)) {
        step_to(hall, config, sector, 1);
    } else if (sector == previous_sector(hall->sector)) {
        step_to(hall, config, sector, -1);
    } else {
        begin_doubt(hall);
        enter_sector(hall, config, sector);
    }
}

void hall_look(hall_t *hall, const config_t *config, uint8_t sensors)
{
    const uint8_t sector = SECTOR_OF_SENSORS[sensors & 7U];
    hall->periods_since_edge = q_min(hall->periods_since_edge + 1, UINT16_MAX);
    if (!hall->started) {
        if (sector != NO_SECTOR) {
            hall->started = true;
            enter_sector(hall, config, sector);
            settle(hall);
        }
    } else if (!hall->doubt) {
        look_in_order(hall, config, sector);
    } else if (reckon(hall, config, sector)) {
        end_doubt(hall);
    }
    hall->valid = hall->started && !hall->doubt;
    /* A bounce, an impossible state and a doubt are looked at again in every period. */
    hall->steady_sensors = hall->valid && sector == hall->sector ? sensors : (uint8_t)HALL_NEVER;
}
