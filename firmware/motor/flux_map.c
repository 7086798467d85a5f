/* SPDX-License-Identifier: Apache-2.0 */
#include "motor/flux_map.h"

#include "core/q15.h"
#include "core/scaled.h"
#include "flux_constants.h"

enum {
    ONE_LOG2 = 13, /* fraction bits of a position, in steps, and of a value, in entries */
    ONE = 1 << ONE_LOG2,
    HALF = ONE / 2,
    LARGEST_RISE_cK = 100000,
    Q16_PER_1E8_q32 = 2814750 /* 2^16 / 10^8 */
};

/* Two neighbouring points of an axis, and the share of the second; beyond the ends up to half a
 * step outside 0 .. ONE. */
typedef struct {
    int32_t index, share;
} place_t;

static place_t place_of(int32_t at, int32_t points)
{
    const int32_t index = q_clamp(at >> ONE_LOG2, 0, points - 2);
    const place_t out = {.index = index, .share = at - index * ONE};
    return out;
}

/* Position of a current on an axis, in steps from the first point; half a step beyond the ends. */
static int32_t position(int32_t from_first_mA, int32_t step_mA, int32_t points)
{
    const uint32_t per_mA_q32 = UINT32_MAX / (uint32_t)q_divisor(step_mA);
    /* To nearest, so that the points are exact. */
    const int64_t half_q32 = INT64_C(1) << (31 - ONE_LOG2);
    const int64_t at = ((int64_t)from_first_mA * per_mA_q32 + half_q32) >> (32 - ONE_LOG2);
    return q_clamp(q_saturate64(at), -HALF, (points - 1) * ONE + HALF);
}

static int32_t between(int32_t low, int32_t high, int32_t share)
{
    return low + (int32_t)(((int64_t)(high - low) * share) >> ONE_LOG2);
}

/* A flux at a place, in entries with ONE_LOG2 fraction bits. */
static int32_t flux_at(const config_flux_map_t *map, const int16_t *psi_lsb, place_t d, place_t q)
{
    const int16_t *row = &psi_lsb[d.index * map->q_points + q.index];
    const int16_t *next = row + map->q_points;
    return between(between(row[0] * ONE, row[1] * ONE, q.share),
                   between(next[0] * ONE, next[1] * ONE, q.share), d.share);
}

/* Saturated so that its sign may be changed. */
static int32_t symmetric(int64_t x)
{
    return q_limit(q_saturate64(x), INT32_MAX);
}

static int32_t flux_nWb(const config_flux_map_t *map, int32_t flux)
{
    return symmetric(((int64_t)flux * (int32_t)(UINT32_C(1) << map->lsb_log2)) >> ONE_LOG2);
}

/* Places half a step on either side of a position, which is moved inwards where the axis ends. */
typedef struct {
    place_t below, above;
} around_t;

static around_t around(int32_t at, int32_t points)
{
    const int32_t middle = q_clamp(at, HALF, (points - 1) * ONE - HALF);
    const around_t out = {.below = place_of(middle - HALF, points),
                          .above = place_of(middle + HALF, points)};
    return out;
}

/* A change of flux over a step, in nH. */
static int32_t inductance_nH(const config_flux_map_t *map, int32_t change, int32_t step_mA)
{
    const uint32_t per_entry = (UINT32_C(1000) << 21) / (uint32_t)q_divisor(step_mA);
    return symmetric(((int64_t)change * per_entry) >> (ONE_LOG2 + 21 - map->lsb_log2));
}

bool flux_map_present(const config_t *config)
{
    return config->flux_map.d_points > 0;
}

flux_map_point_t flux_map_at(const config_t *config, int32_t i_d_mA, int32_t i_q_mA)
{
    const config_flux_map_t *map = &config->flux_map;
    if (!flux_map_present(config)) {
        return flux_map_of_constants(&config->motor, i_d_mA, i_q_mA);
    }
    const int32_t first_mA = -map->d_negative_points * map->d_step_mA;
    const int32_t from_first_mA = q_subtract(i_d_mA, first_mA);
    const int32_t at_d = position(from_first_mA, map->d_step_mA, map->d_points);
    const int32_t at_q = position(q_abs(i_q_mA), map->q_step_mA, map->q_points);
    const int32_t sign = i_q_mA < 0 ? -1 : 1;
    const place_t d = place_of(at_d, map->d_points);
    const place_t q = place_of(at_q, map->q_points);
    const around_t by_d = around(at_d, map->d_points);
    const around_t by_q = around(at_q, map->q_points);
    const flux_map_point_t out = {
        .d_nWb = flux_nWb(map, flux_at(map, map->psi_d_lsb, d, q)),
        .q_nWb = sign * flux_nWb(map, flux_at(map, map->psi_q_lsb, d, q)),
        .d_nH = inductance_nH(map,
                              flux_at(map, map->psi_d_lsb, by_d.above, q) -
                                  flux_at(map, map->psi_d_lsb, by_d.below, q),
                              map->d_step_mA),
        .q_nH = inductance_nH(map,
                              flux_at(map, map->psi_q_lsb, d, by_q.above) -
                                  flux_at(map, map->psi_q_lsb, d, by_q.below),
                              map->q_step_mA),
        .cross_nH = sign * inductance_nH(map,
                                         flux_at(map, map->psi_d_lsb, d, by_q.above) -
                                             flux_at(map, map->psi_d_lsb, d, by_q.below),
                                         map->q_step_mA),
    };
    return out;
}

/* Of the magnets at a winding temperature, in entries with ONE_LOG2 fraction bits; at least a tenth
 * of what the map has without current. */
static int32_t magnets(const config_t *config, int32_t winding_temperature_cC)
{
    const config_motor_t *motor = &config->motor;
    const config_flux_map_t *map = &config->flux_map;
    const int32_t rise_cK =
        q_clamp(q_subtract(winding_temperature_cC, motor->reference_temperature_cC),
                -LARGEST_RISE_cK, LARGEST_RISE_cK);
    const int32_t share_1e8 = motor->flux_coefficient_ppm_K * rise_cK;
    const int32_t share_q16 = (int32_t)(((int64_t)share_1e8 * Q16_PER_1E8_q32) >> 32);
    const int32_t row = map->d_negative_points * map->q_points;
    const int32_t at_reference = map->psi_d_lsb[row] * ONE;
    const int64_t change = ((int64_t)at_reference * share_q16) >> 16;
    return q_max(at_reference / 10, q_saturate64(at_reference + change));
}

int32_t flux_map_shift_mA(const config_t *config, int32_t winding_temperature_cC)
{
    const config_flux_map_t *map = &config->flux_map;
    if (!flux_map_present(config)) {
        return 0;
    }
    const int32_t wanted = magnets(config, winding_temperature_cC);
    const int16_t *psi_lsb = map->psi_d_lsb; /* at i_q = 0 */
    int32_t index = 0;
    while (index < map->d_points - 2 && psi_lsb[map->q_points] * ONE < wanted) {
        psi_lsb += map->q_points;
        index++;
    }
    const int32_t low = psi_lsb[0] * ONE;
    const int32_t rise = psi_lsb[map->q_points] * ONE - low;
    const int32_t share =
        q_clamp(scaled_ratio(wanted - low, q_max(rise, 1)), -SCALED_ONE / 2, SCALED_ONE / 2 * 3);
    return (index - map->d_negative_points) * map->d_step_mA +
           scaled_multiply(share, map->d_step_mA);
}
