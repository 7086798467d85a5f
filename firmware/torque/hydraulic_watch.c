/* SPDX-License-Identifier: Apache-2.0 */
#include "torque/hydraulic_watch.h"

#include "core/q15.h"

enum {
    ONE_Q15 = 1 << 15,
    FILTER_LOG2 = 6,    /* 64 ms */
    MOTOR_LOG2 = 9,     /* 0.5 s, of 16 mN m */
    ACQUIRE_SHARE = 32, /* of the difference, in each step */
    ACQUIRE_LOG2 = 5,
    MOST_mNm = (1 << 23) - 1, /* largest input of the filter, and of a road with 8 fraction bits */
    MOST_GAIN_Q15 = 2 * ONE_Q15,
    SLOW_LOG2 = 8,             /* 256 ms */
    FADE_LOG2 = 13,            /* 8 s */
    MOST_STEP_mNm = 1 << 22,   /* largest input of the slow filters */
    QUIET_SHARE = 3,           /* of the tolerance, without a command */
    REPORT_SHARE = 3,          /* of the sum, where two of three agree */
    AGREES_SHARE = 4,          /* of the tolerance: smallest torque that shows a brake at work */
    GAIN_PART = 5,             /* of its torque, that a brake may make more or less */
    INERTIA_PART = 10,         /* of the known torque, that another inertia may take */
    FOLLOWED_MOST_q8 = 1 << 23 /* largest change of the road in a millisecond */
};

static void end_finding(hydraulic_watch_t *watch)
{
    watch->reason = REASON_NONE;
    watch->gain_q15 = ONE_Q15;
    watch->extra_mNm = 0;
    watch->by_report = false;
    watch->confirms_report = false;
    watch->agrees_ms = 0;
}

static void clear_sums(hydraulic_watch_t *watch)
{
    watch->missing_mNm_ms = 0;
    watch->excess_mNm_ms = 0;
    watch->report_mNm_ms = 0;
}

void hydraulic_watch_init(hydraulic_watch_t *watch)
{
    const hydraulic_watch_t fresh = {.weight_q15 = ONE_Q15};
    *watch = fresh;
    end_finding(watch);
}

int32_t hydraulic_watch_corrected_mNm(const hydraulic_watch_t *watch, int32_t modelled_mNm)
{
    return q_max(
        q_saturate64((int64_t)q15_product(modelled_mNm, watch->gain_q15) + watch->extra_mNm), 0);
}

static int32_t limited_mNm(int64_t torque_mNm)
{
    return q_clamp(q_saturate64(torque_mNm), -MOST_mNm, MOST_mNm);
}

/* Torque of an angular acceleration; mrad/s^2 g m^2 / 1000, by way of 2^10 (2 % less). */
static int32_t torque_of_mNm(const config_brake_t *brake, int32_t acceleration_mrad_s2)
{
    return q_saturate64(((int64_t)brake->hydraulic_watch_inertia_g_m2 * acceleration_mrad_s2) >>
                        10);
}

/* Air drag: what it is of the squared speed, times that; uN m s^2 mrad^2/s^2 / 10^9, by way of 2^30
 * (7 % less). */
static int32_t drag_mNm(const config_brake_t *brake, int32_t speed_mrad_s)
{
    const int64_t square = ((int64_t)speed_mrad_s * speed_mrad_s) >> 20;
    return q_saturate64((square * brake->hydraulic_watch_drag_uNm_s2) >> 10);
}

/* What the road may change in a millisecond; mrad/s^2 a radian, times the angle: / 10^9, by way of
 * 2^30 (7 % less), with 8 fraction bits. */
static int32_t road_change_q8_mNm(const config_brake_t *brake, int32_t speed_mrad_s)
{
    const int64_t per_rad =
        (int64_t)brake->hydraulic_watch_inertia_g_m2 * brake->hydraulic_watch_road_mrad_s2;
    return q_saturate64((q_saturate64(per_rad) * (int64_t)speed_mrad_s) >> 22) + 1;
}

/* While the brake answers a new command, what is missing is rather the brake's than the road's; for
 * as long at most as it has been certain before. */
static bool awaits_brake(hydraulic_watch_t *watch, bool uncertain)
{
    watch->certain_ms =
        q_clamp(watch->certain_ms + (uncertain ? -1 : 1), 0, HYDRAULIC_WATCH_AWAITS_ms);
    return uncertain && watch->certain_ms > 0;
}

/* Speed at which a vehicle that does not stop may still be seen to roll; below it nothing is
 * counted. A wheel that turns round rolls on another slope. */
static bool rolls(hydraulic_watch_t *watch, const config_t *config,
                  const hydraulic_watch_input_t *in)
{
    const int32_t slowest_mrad_s = config->brake.blend_out_end_mrad_s / 2 + 1;
    const bool fast = q_abs(in->speed_mrad_s) > slowest_mrad_s;
    const bool backwards = in->speed_mrad_s < 0;
    if (fast && backwards != watch->backwards) {
        watch->backwards = backwards;
        watch->acquired_ms = 0;
        watch->rolls = false;
    }
    return fast;
}

/* Before standstill hall sensors show the speed that the wheel had an edge ago, as if its brake had
 * failed. Where all known torques let it stand within HYDRAULIC_WATCH_ENDS_ms, what is missing is
 * found only if it still rolls most of that time later. */
static bool hides_torque(hydraulic_watch_t *watch, const config_t *config, int32_t speed_mrad_s)
{
    const int32_t against_mNm =
        -(watch->known_lp_mNm.accumulator >> FILTER_LOG2) - (watch->road_q8_mNm >> 8);
    const bool stands_soon = config->rotor.sensor == CONFIG_ROTOR_HALL &&
                             (int64_t)config->brake.hydraulic_watch_inertia_g_m2 * speed_mrad_s <
                                 (int64_t)against_mNm * HYDRAULIC_WATCH_ENDS_ms;
    watch->rolls_on_ms =
        stands_soon ? q_max(watch->rolls_on_ms - 1, 0) : HYDRAULIC_WATCH_ROLLS_ON_ms;
    return stands_soon && watch->rolls_on_ms > 0;
}

/* A wheel that slips slows down faster than a tyre can slow a vehicle. mrad/s in a millisecond
 * times um: um/s^2, with 8 fraction bits. */
static bool slips(const config_t *config, int32_t change_q8_mrad_s)
{
    const int64_t rim_um_s2_q8 = (int64_t)q_abs(change_q8_mrad_s) * config->vehicle.wheel_radius_um;
    return rim_um_s2_q8 > (int64_t)config->monitor.tyre_grip_mm_s2 * 256000;
}

/* What of the deceleration in which the road was followed is now the inertia's. */
static void weigh(hydraulic_watch_t *watch, int32_t weight_q15)
{
    const int32_t more_q8_mNm = q15_product(watch->quarter_q8_mNm, weight_q15 - watch->weight_q15);
    watch->road_q8_mNm = q_saturate64(watch->road_q8_mNm + (int64_t)more_q8_mNm * 4);
    watch->weight_q15 = weight_q15;
}

/* Steps of the motor's torque, faster than a road's slope can follow, show the inertia:
 * least squares of inertial over known torque. Not while the wheel slips, nor until the speed
 * estimate has settled after a start on a rolling wheel. */
static void learn_inertia(hydraulic_watch_t *watch, int32_t known_mNm, int32_t inertial_mNm,
                          int32_t floor_mNm)
{
    const int32_t x = q_limit(known_mNm, MOST_STEP_mNm);
    const int32_t y = q_limit(inertial_mNm, MOST_STEP_mNm);
    if (watch->pause_ms > 0) {
        filter_reset(&watch->known_slow_mNm, x, SLOW_LOG2);
        filter_reset(&watch->inertial_slow_mNm, y, SLOW_LOG2);
        return;
    }
    const int32_t step_mNm = x - filter_step(&watch->known_slow_mNm, x, SLOW_LOG2);
    const int32_t follows_mNm = y - filter_step(&watch->inertial_slow_mNm, y, SLOW_LOG2);
    if (watch->quiet_ms < HYDRAULIC_WATCH_QUIET_ms || q_abs(step_mNm) <= 2 * floor_mNm) {
        return;
    }
    watch->known_square += (int64_t)step_mNm * step_mNm - (watch->known_square >> FADE_LOG2);
    watch->known_by_inertial +=
        (int64_t)step_mNm * follows_mNm - watch->known_by_inertial / (1 << FADE_LOG2);
    /* Steps of four floors for half a second. */
    const int64_t enough = (int64_t)floor_mNm * floor_mNm << 13;
    if (watch->known_square > enough) {
        const int64_t by = watch->known_by_inertial;
        weigh(watch, by < ONE_Q15
                         ? HYDRAULIC_WATCH_HEAVIEST_Q15
                         : q_clamp(q_saturate64(watch->known_square / (by >> 15)),
                                   HYDRAULIC_WATCH_LIGHTEST_Q15, HYDRAULIC_WATCH_HEAVIEST_Q15));
    }
}

/* Braking torque that is missing, from speed and known torques filtered alike. */
static int32_t missing_mNm(hydraulic_watch_t *watch, const config_t *config,
                           const hydraulic_watch_input_t *in, int32_t floor_mNm,
                           int32_t *change_q8_mrad_s)
{
    const int32_t speed_q8 = q_saturate64((int64_t)q_abs(in->speed_mrad_s) * 256);
    const int32_t along_mNm = in->speed_mrad_s >= 0 ? in->motor_mNm : -in->motor_mNm;
    int32_t hydraulic_mNm = in->modelled_mNm; /* as it is: measured, or to be decided on */
    if (watch->confirms_report) {
        hydraulic_mNm = in->reported_mNm;
    } else if (!watch->by_report) {
        hydraulic_mNm = hydraulic_watch_corrected_mNm(watch, in->modelled_mNm);
    }
    const int32_t known_mNm = limited_mNm((int64_t)along_mNm - hydraulic_mNm);
    if (!watch->rolls) {
        watch->rolls = true;
        watch->stale = true;
        watch->speed_lp_q8_mrad_s = speed_q8;
        filter_reset(&watch->known_lp_mNm, known_mNm, FILTER_LOG2);
        watch->quiet_ms = 0;
        watch->pause_ms = q_max(watch->pause_ms, HYDRAULIC_WATCH_SETTLE_ms);
        clear_sums(watch);
    }
    const int32_t change_q8 = (speed_q8 - watch->speed_lp_q8_mrad_s) / (1 << FILTER_LOG2);
    watch->speed_lp_q8_mrad_s += change_q8;
    *change_q8_mrad_s = change_q8;
    const int32_t filtered_mNm = filter_step(&watch->known_lp_mNm, known_mNm, FILTER_LOG2);
    const int64_t inertial_q8_mNm = (int64_t)config->brake.hydraulic_watch_inertia_g_m2 * change_q8;
    const int32_t inertial_mNm = limited_mNm(inertial_q8_mNm >> 8);
    watch->inertial_mNm = inertial_mNm;
    if (watch->acquired_ms < HYDRAULIC_WATCH_ACQUIRE_ms) {
        watch->quarter_q8_mNm += (inertial_mNm * 64 - watch->quarter_q8_mNm) >> ACQUIRE_LOG2;
    }
    learn_inertia(watch, filtered_mNm, inertial_mNm, floor_mNm);
    const int32_t speed_mrad_s = watch->speed_lp_q8_mrad_s / 256;
    const int64_t air_mNm = drag_mNm(&config->brake, speed_mrad_s);
    return limited_mNm(q15_product(inertial_mNm, watch->weight_q15) + air_mNm - filtered_mNm);
}

/* The road follows what is missing. An inertia that is a quarter wrong makes a quarter of the
 * inertial torque look like a road, which is followed just so. After a standstill, where the load
 * may have changed, what of it is not followed yet is tolerated until a road has been followed that
 * holds no more than the floor of it.
 *
 * Returns that tolerance. */
static int32_t follow_road(hydraulic_watch_t *watch, int32_t floor_mNm, int32_t lacking_mNm,
                           int32_t change_q8_mNm)
{
    watch->road_q8_mNm +=
        q_clamp(q_limit(lacking_mNm, MOST_mNm) * 256, -change_q8_mNm, change_q8_mNm);
    const int32_t apart_q8_mNm = watch->inertial_mNm * 64 - watch->quarter_q8_mNm;
    const int32_t followed_q8_mNm = q_clamp(apart_q8_mNm, -change_q8_mNm, change_q8_mNm);
    watch->quarter_q8_mNm += followed_q8_mNm;
    const int32_t rest_mNm = q_abs(apart_q8_mNm - followed_q8_mNm) >> 8;
    if (!watch->stale || rest_mNm + (q_abs(watch->quarter_q8_mNm) >> 8) < floor_mNm) {
        watch->stale = false;
        return 0;
    }
    return rest_mNm;
}

static void name(hydraulic_watch_t *watch, reason_t reason)
{
    watch->reason = reason;
    watch->found_ms = 0;
    watch->quiet_ms = 0;
    clear_sums(watch);
}

/* With another expected torque, to which the filters settle. */
static void find(hydraulic_watch_t *watch, reason_t reason)
{
    name(watch, reason);
    watch->pause_ms = q_max(watch->pause_ms, HYDRAULIC_WATCH_SETTLE_ms);
}

/* Less torque than expected: the end of an excess, or a weak brake. */
static void found_missing(hydraulic_watch_t *watch, int32_t modelled_mNm, int32_t by_mNm)
{
    if (watch->reason == REASON_HYDRAULIC_STRONG || watch->reason == REASON_HYDRAULIC_STUCK) {
        end_finding(watch);
        clear_sums(watch);
        return;
    }
    const int64_t loss_q15 = ((int64_t)by_mNm << 15) / q_max(modelled_mNm, 1);
    watch->gain_q15 = q_clamp(q_saturate64(watch->gain_q15 - loss_q15), 0, ONE_Q15);
    const bool known = hydraulic_watch_is_short(watch);
    const int32_t since_ms = watch->found_ms;
    find(watch, known ? watch->reason : REASON_HYDRAULIC_WEAK);
    watch->found_ms = known ? since_ms : 0;
}

/* More torque than expected: a brake that was only late, the end of its weakness, or an excess. */
static void found_excess(hydraulic_watch_t *watch, int32_t modelled_mNm, int32_t by_mNm,
                         bool commanded)
{
    if (hydraulic_watch_is_short(watch)) {
        const bool late = watch->found_ms < HYDRAULIC_WATCH_LATE_ms;
        end_finding(watch);
        find(watch, late ? REASON_HYDRAULIC_LATE : REASON_NONE);
        return;
    }
    if (commanded) {
        const int64_t more_q15 = ((int64_t)by_mNm << 15) / q_max(modelled_mNm, 1);
        watch->gain_q15 = q_min(q_saturate64(watch->gain_q15 + more_q15), MOST_GAIN_Q15);
    } else {
        watch->extra_mNm = q_saturate64((int64_t)watch->extra_mNm + by_mNm);
    }
    const bool stuck = watch->reason == REASON_HYDRAULIC_STUCK || !commanded;
    find(watch, stuck ? REASON_HYDRAULIC_STUCK : REASON_HYDRAULIC_STRONG);
}

/* The end of a finding by reports. */
static void end_by_report(hydraulic_watch_t *watch, bool agrees)
{
    const bool late =
        agrees && hydraulic_watch_is_short(watch) && watch->found_ms < HYDRAULIC_WATCH_LATE_ms;
    end_finding(watch);
    find(watch, late ? REASON_HYDRAULIC_LATE : REASON_NONE);
}

/* Reports that contradict the commands: the deceleration shows half of the difference or more if
 * the brake is wrong, less if its sensor is. */
static void decide_report(hydraulic_watch_t *watch, const hydraulic_watch_input_t *in,
                          int32_t lacking_mNm, int32_t enough_mNm_ms)
{
    const int32_t differs_mNm = in->modelled_mNm - in->reported_mNm;
    const int32_t towards_mNm = differs_mNm >= 0 ? lacking_mNm : -lacking_mNm;
    const int32_t end_mNm_ms = enough_mNm_ms / REPORT_SHARE;
    watch->report_mNm_ms =
        q_limit(q_saturate64((int64_t)watch->report_mNm_ms + towards_mNm - q_abs(differs_mNm) / 2),
                end_mNm_ms);
    if (watch->report_mNm_ms >= end_mNm_ms) {
        watch->confirms_report = true;
    } else if (watch->report_mNm_ms <= -end_mNm_ms && (watch->by_report || in->outside_ms != 0)) {
        end_by_report(watch, false);
        watch->refutes_report = true;
    }
}

/* Reports show a brake that makes what is commanded, for as long as they need to be used. Without
 * enough of a command they show nothing. */
static bool agrees(hydraulic_watch_t *watch, const config_brake_t *brake,
                   const hydraulic_watch_input_t *in)
{
    const int32_t largest_mNm = q_saturate64((int64_t)in->commanded_mNm + in->uncertain_mNm);
    const int32_t least_mNm = q15_product(largest_mNm, ONE_Q15 - brake->hydraulic_gain_band_q15);
    const bool now =
        in->reported_mNm >= least_mNm && least_mNm > brake->hydraulic_tolerance_mNm / AGREES_SHARE;
    watch->agrees_ms = now ? watch->agrees_ms + 1 : 0;
    return watch->agrees_ms > brake->hydraulic_timeout_ms;
}

/* Reports show a brake to be wrong. The deceleration is to decide, so the road waits. */
static bool is_undecided(const hydraulic_watch_t *watch, const config_brake_t *brake,
                         const hydraulic_watch_input_t *in)
{
    const bool differs =
        q_abs(in->modelled_mNm - in->reported_mNm) > brake->hydraulic_tolerance_mNm / AGREES_SHARE;
    return !watch->confirms_report && (in->outside_ms != 0 || (watch->by_report && differs));
}

/* A brake that its reports show to be wrong, as long as they do. A short one, for which the motor
 * makes up, gets smaller commands by that: these end nothing. */
static void follow_report(hydraulic_watch_t *watch, const config_brake_t *brake,
                          const hydraulic_watch_input_t *in, int32_t floor_mNm)
{
    /* > 0 beyond, < 0 short of its command */
    const int32_t difference = in->contradicts_mNm != 0 ? in->contradicts_mNm : in->outside_ms;
    const bool is_short = hydraulic_watch_is_short(watch);
    if (!in->reported) {
        end_by_report(watch, false);
    } else if (difference == 0) {
        if (!is_short || agrees(watch, brake, in)) {
            end_by_report(watch, true);
        }
    } else if (difference < 0) {
        watch->agrees_ms = 0;
        watch->gain_q15 = in->reported_mNm > in->commanded_mNm / 4 ? ONE_Q15 / 2 : 0;
        if (!is_short) {
            name(watch, REASON_HYDRAULIC_WEAK);
        }
    } else if (watch->reason != REASON_HYDRAULIC_STRONG &&
               watch->reason != REASON_HYDRAULIC_STUCK) {
        name(watch,
             in->commanded_mNm > floor_mNm ? REASON_HYDRAULIC_STRONG : REASON_HYDRAULIC_STUCK);
    }
}

/* An error by a part of a torque looks like a road: what of it the road has had no time to follow.
 * |torque| < 2^24. */
static int32_t unfollowed_mNm(int32_t *followed_q4_mNm, int32_t torque_mNm, int32_t change_q8_mNm,
                              int32_t part)
{
    const int32_t apart_q4_mNm = torque_mNm * 16 - *followed_q4_mNm;
    const int32_t most_q8_mNm = q_min(change_q8_mNm, FOLLOWED_MOST_q8);
    const int32_t follows_q4_mNm = q_limit(apart_q4_mNm, most_q8_mNm * part / 16);
    *followed_q4_mNm += follows_q4_mNm;
    return q_abs(apart_q4_mNm - follows_q4_mNm) / (16 * part);
}

/* Of the gain of a healthy brake and of an inertia that is not learned, after a change of the road
 * by up to that much. */
static int32_t parts_unfollowed_mNm(hydraulic_watch_t *watch, int32_t hydraulic_mNm,
                                    int32_t known_mNm, int32_t change_q8_mNm)
{
    return unfollowed_mNm(&watch->hydraulic_q4_mNm, hydraulic_mNm, change_q8_mNm, GAIN_PART) +
           unfollowed_mNm(&watch->known_q4_mNm, known_mNm, change_q8_mNm, INERTIA_PART);
}

/* Of a ramp, a brake twice as late as configured misses two thirds of what lies between that and
 * one twice as early. */
static int32_t late_mNm(int32_t uncertain_mNm)
{
    return uncertain_mNm - uncertain_mNm / 4;
}

/* What is found without reports: a sixteenth more, since less is tolerated. */
static int32_t end_of_sum_mNm_ms(int32_t enough_mNm_ms)
{
    return q_min(enough_mNm_ms, INT32_MAX / 2) / 16 * 17;
}

/* Sum of what exceeds the tolerance, from zero up to the end. */
static int32_t summed_mNm_ms(int32_t sum_mNm_ms, int32_t beyond_mNm, int32_t end_mNm_ms)
{
    return q_clamp(q_saturate64((int64_t)sum_mNm_ms + beyond_mNm), 0, end_mNm_ms);
}

static void age(hydraulic_watch_t *watch)
{
    watch->found_ms = q_min(watch->found_ms + 1, INT16_MAX);
    if (watch->reason == REASON_HYDRAULIC_WEAK && watch->gain_q15 < ONE_Q15 / 4 &&
        watch->found_ms >= HYDRAULIC_WATCH_DEAD_ms) {
        watch->reason = REASON_HYDRAULIC_DEAD;
    }
}

/* Until the road is known: true while it is not. */
static bool acquires_road(hydraulic_watch_t *watch, const config_brake_t *brake,
                          const hydraulic_watch_input_t *in, int32_t floor_mNm, int32_t lacking_mNm)
{
    const bool quiet = in->modelled_mNm + in->uncertain_mNm <= floor_mNm;
    watch->quiet_ms = quiet && watch->reason == REASON_NONE
                          ? q_min(watch->quiet_ms + 1, HYDRAULIC_WATCH_QUIET_ms)
                          : 0;
    if (watch->provisional && quiet) {
        watch->provisional = false;
        watch->acquired_ms = 0;
    }
    if (watch->acquired_ms >= HYDRAULIC_WATCH_ACQUIRE_ms) {
        return false;
    }
    if (in->uncertain_mNm <= floor_mNm && watch->pause_ms == 0 &&
        q_abs(in->speed_mrad_s) > brake->blend_out_start_mrad_s) {
        watch->provisional = !quiet;
        watch->acquired_ms++;
        watch->road_q8_mNm += lacking_mNm * (256 / ACQUIRE_SHARE);
    }
    return true;
}

/* Sums of what is missing and what is too much beyond the tolerance. deviation_mNm: that the road
 * has not followed, after a change of it by up to change_q8. */
static void sum_up(hydraulic_watch_t *watch, const config_brake_t *brake,
                   const hydraulic_watch_input_t *in, int32_t floor_mNm, int32_t lacking_mNm,
                   int32_t deviation_mNm, int32_t change_q8, int32_t end_mNm_ms)
{
    /* What the motor makes for longer has become part of `road`. */
    const int32_t motor_mNm =
        filter_step(&watch->motor_lp_mNm, q_limit(in->motor_mNm, MOST_mNm) / 16, MOTOR_LOG2) * 16;
    const int32_t share_q15 = brake->hydraulic_watch_share_q15;
    const int32_t expected_mNm =
        q_min(hydraulic_watch_corrected_mNm(watch, in->modelled_mNm), MOST_mNm);
    const int32_t motor_part_mNm = q15_product(q_abs(in->motor_mNm - motor_mNm), share_q15);
    const int32_t shares_mNm = q15_product(expected_mNm, share_q15) + motor_part_mNm / 2;
    const int32_t parts_mNm = parts_unfollowed_mNm(
        watch, expected_mNm, watch->known_lp_mNm.accumulator >> FILTER_LOG2, change_q8);
    const int32_t tolerated_mNm = floor_mNm + deviation_mNm + late_mNm(in->uncertain_mNm) +
                                  (in->reported ? shares_mNm : q_min(shares_mNm, parts_mNm));
    const bool commanded = in->modelled_mNm > floor_mNm;
    /* Without a command an excess may be a hill, sand, another load, a brake not commanded here. */
    const int32_t excess_mNm = commanded ? -lacking_mNm - tolerated_mNm
                                         : -lacking_mNm - deviation_mNm - QUIET_SHARE * floor_mNm -
                                               QUIET_SHARE * motor_part_mNm;
    watch->missing_mNm_ms =
        commanded || watch->extra_mNm > 0
            ? summed_mNm_ms(watch->missing_mNm_ms, lacking_mNm - tolerated_mNm, end_mNm_ms)
            : 0;
    watch->excess_mNm_ms =
        watch->provisional ? 0 : summed_mNm_ms(watch->excess_mNm_ms, excess_mNm, end_mNm_ms);
}

/* With the road known: follows it, and decides what the brake or its reports lack. */
static void judge(hydraulic_watch_t *watch, const config_t *config,
                  const hydraulic_watch_input_t *in, int32_t floor_mNm, int32_t lacking_mNm)
{
    const config_brake_t *brake = &config->brake;
    const bool commanded = in->modelled_mNm > floor_mNm;
    const bool hidden = hides_torque(watch, config, q_abs(in->speed_mrad_s));
    const bool undecided = is_undecided(watch, brake, in);
    const int32_t change_q8 = awaits_brake(watch, in->uncertain_mNm > floor_mNm) || undecided
                                  ? 0
                                  : road_change_q8_mNm(brake, q_abs(in->speed_mrad_s));
    const int32_t deviation_mNm = follow_road(watch, floor_mNm, lacking_mNm, change_q8);
    if (watch->confirms_report) {
        follow_report(watch, brake, in, floor_mNm);
        return;
    }
    const int32_t enough_mNm_ms = q_saturate64((int64_t)brake->hydraulic_watch_inertia_g_m2 *
                                               brake->hydraulic_watch_speed_mrad_s);
    if (watch->by_report || q_abs(in->outside_ms) > brake->hydraulic_timeout_ms) {
        follow_report(watch, brake, in, floor_mNm);
        watch->by_report = hydraulic_watch_is_short(watch) ||
                           watch->reason == REASON_HYDRAULIC_STRONG ||
                           watch->reason == REASON_HYDRAULIC_STUCK;
        if (undecided && !hidden) {
            decide_report(watch, in, lacking_mNm, enough_mNm_ms);
        }
        return;
    }
    const int32_t end_mNm_ms = end_of_sum_mNm_ms(enough_mNm_ms);
    sum_up(watch, brake, in, floor_mNm, lacking_mNm, deviation_mNm, change_q8, end_mNm_ms);
    if (in->reported && !hidden && (undecided || in->contradicts_mNm != 0)) {
        decide_report(watch, in, lacking_mNm, enough_mNm_ms);
    } else if (in->reported && watch->reason == REASON_NONE) {
        clear_sums(watch); /* reports agree with the commands: it is the road */
    } else {
        watch->report_mNm_ms = 0;
    }
    if (watch->missing_mNm_ms >= end_mNm_ms && !hidden) {
        found_missing(watch, in->modelled_mNm, lacking_mNm);
    } else if (watch->excess_mNm_ms >= end_mNm_ms) {
        found_excess(watch, in->modelled_mNm, -lacking_mNm, commanded);
    }
}

void hydraulic_watch_step(hydraulic_watch_t *watch, const config_t *config,
                          const hydraulic_watch_input_t *in)
{
    const config_brake_t *brake = &config->brake;
    if (in->acknowledged) {
        end_finding(watch);
        clear_sums(watch);
    }
    age(watch);
    watch->refutes_report = false;
    watch->pause_ms = in->trusted ? q_max(watch->pause_ms - 1, 0) : HYDRAULIC_WATCH_PAUSE_ms;
    if (brake->hydraulic_watch_inertia_g_m2 == 0 || !rolls(watch, config, in) || !in->trusted) {
        watch->rolls = false;
        return;
    }
    int32_t change_q8_mrad_s = 0;
    const int32_t floor_mNm = torque_of_mNm(brake, brake->hydraulic_watch_floor_mrad_s2);
    const int32_t road_mNm = missing_mNm(watch, config, in, floor_mNm, &change_q8_mrad_s);
    watch->road_mNm = road_mNm;
    if (slips(config, change_q8_mrad_s)) {
        if (!hydraulic_watch_is_short(watch) && watch->found_ms < HYDRAULIC_WATCH_PAUSE_ms) {
            end_finding(watch); /* it was the slip that looked like an excess */
        }
        watch->pause_ms = HYDRAULIC_WATCH_PAUSE_ms;
    }
    const int32_t lacking_mNm = road_mNm - (watch->road_q8_mNm >> 8);
    if (acquires_road(watch, brake, in, floor_mNm, lacking_mNm)) {
        return;
    }
    if (watch->pause_ms > 0) {
        clear_sums(watch);
        return;
    }
    judge(watch, config, in, floor_mNm, lacking_mNm);
}
