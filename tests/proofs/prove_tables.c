/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The slow loop's tables: with any grid that the validator accepts every read lies inside the part
 * of the table that is in use, and every interpolation is between values that core/grid.h takes:
 * entries within the validator's bounds, or what was interpolated between them. Its
 * functions are replaced by their specification: a position is any on its axis, and an interpolated
 * value is any between its two ends.
 */
#include "config/config.h"
#include "core/grid.h"
#include "proof.h"

static const int16_t *table;
static int32_t used;
static int32_t largest; /* magnitude of what a table can say: the largest entry, the widest LSB */
static bool values;     /* also checks the values of local variables */

static void check_read(const int16_t *at)
{
    PROVE(__CPROVER_same_object(at, table));
    const int32_t beyond_bytes =
        (int32_t)(__CPROVER_POINTER_OFFSET(at) - __CPROVER_POINTER_OFFSET(table));
    PROVE(beyond_bytes >= 0 && beyond_bytes < used * (int32_t)sizeof(int16_t));
}

/* Entries are within +-largest, and so is what lies between two such values. These take the checker
 * most of its time. */
static int32_t any_interpolation(int32_t a, int32_t b)
{
    if (values) {
        PROVE(a >= -largest && a <= largest && b >= -largest && b <= largest);
    }
    return any_within(-largest, largest);
}

static int32_t any_weighted(const int16_t *a, const int16_t *b, const int16_t *c, const int16_t *d)
{
    check_read(a);
    check_read(b);
    check_read(c);
    check_read(d);
    return any_within(-largest, largest);
}

static grid_position_t any_position(int32_t x, int32_t points, int32_t step_log2)
{
    (void)x;
    PROVE(points >= 2 && step_log2 >= 0 && step_log2 <= 20);
    const grid_position_t out = {.index = any_within(0, points - 2),
                                 .fraction_q20 = any_within(0, GRID_WHOLE_Q20)};
    return out;
}

#define grid_locate any_position
#define grid_interpolate(a, b, fraction_q20) any_interpolation(a, b)
#define grid_weighted(weights, a, b, c, d) any_weighted(&(a), &(b), &(c), &(d))
#include "loss_maps.c"
#undef grid_weighted
#undef grid_interpolate
#undef grid_locate

#define LOWEST(name, count, lowest, highest, unit, text) lowest
#define HIGHEST(name, count, lowest, highest, unit, text) highest
enum {
    LARGEST_ENTRY = CONFIG_CURRENT_MAP_ARRAY(HIGHEST),
    CURRENT_LSB_LOG2 = 6,
    TORQUE_LSB_LOG2 = 10,
};
_Static_assert(CONFIG_CURRENT_MAP_ARRAY(LOWEST) == -LARGEST_ENTRY &&
                   CONFIG_REGEN_MAP_ARRAY(LOWEST) == -LARGEST_ENTRY &&
                   CONFIG_REGEN_MAP_ARRAY(HIGHEST) == LARGEST_ENTRY,
               "the entries' bounds are symmetrical");
_Static_assert(LARGEST_ENTRY << TORQUE_LSB_LOG2 < 1 << 30, "grid_interpolate() takes the values");

static void check_current_map(int32_t layers)
{
    config_t config;
    config_current_map_t *map = &config.current_map;
    map->torque_points = any_within(3, 65);
    map->torque_step_log2 = any_within(0, 20);
    map->speed_points = any_within(2, 65);
    map->speed_step_log2 = any_within(6, 20);
    map->temperature_points = layers;
    map->temperature_step_log2 = any_within(6, 15);
    map->temperature_origin_cC = any_within(-10000, 20000);
    ASSUME(map->torque_points % 2 == 1);
    map->lsb_log2 = any_within(0, CURRENT_LSB_LOG2);
    table = map->current_d_lsb;
    largest = LARGEST_ENTRY << CURRENT_LSB_LOG2;
    used = map->torque_points * map->speed_points * map->temperature_points;
    ASSUME(used <= CONFIG_CURRENT_MAP_POINTS_MAX);
    values = layers == 2; /* these take every path */
    const loss_maps_row_t row = loss_maps_row_at(&config, nondet_int32(), nondet_int32());
    (void)loss_maps_row_d_mA(&row, nondet_int32());
}

/* As many as the validator accepts; a product of three unknowns would take the checker a minute. */
void prove_current_map_of_one_layer(void)
{
    check_current_map(1);
    PROOF_END();
}

void prove_current_map_of_two_layers(void)
{
    check_current_map(2);
    PROOF_END();
}

void prove_current_map_of_three_layers(void)
{
    check_current_map(3);
    PROOF_END();
}

void prove_current_map_of_four_layers(void)
{
    check_current_map(4);
    PROOF_END();
}

void prove_current_map_of_five_layers(void)
{
    check_current_map(5);
    PROOF_END();
}

void prove_regen_map(void)
{
    config_t config;
    config_regen_map_t *map = &config.regen_map;
    map->speed_points = any_within(2, 65);
    map->speed_step_log2 = any_within(6, 20);
    map->temperature_points = any_within(2, 17);
    map->temperature_step_log2 = any_within(6, 15);
    map->temperature_origin_cC = any_within(-10000, 20000);
    map->lsb_log2 = any_within(0, TORQUE_LSB_LOG2);
    table = map->torque_lsb;
    largest = LARGEST_ENTRY << TORQUE_LSB_LOG2;
    used = map->speed_points * map->temperature_points;
    ASSUME(used <= CONFIG_REGEN_POINTS_MAX);
    PROVE(loss_maps_torque_mNm(&config, nondet_int32(), nondet_int32()) >= 0);
    PROOF_END();
}
