/* SPDX-License-Identifier: Apache-2.0 */
/* The road under a wheel of 10.3 kg m2, in double precision: slope torque and both brakes move it,
 * and road_step() sees speed and brakes. */
#include "torque/road.h"

#include <math.h>
#include <string.h>

#include "paper_vehicle.h"
#include "random_values.h"
#include "unity.h"

static const double INERTIA_KG_M2 = 0.25 * 0.25 * 165.0, PER_MS = 1e-3;
enum { SETTLED_ms = 640, END_mrad_s = 838 };

static config_t config;
static road_state_t state;
static double speed_rad_s, slope_nm;     /* slope_nm: brakes a wheel that turns forward */
static int32_t motor_mNm, hydraulic_mNm; /* signed; magnitude */
static int32_t road_mNm;

void setUp(void)
{
    config = paper_vehicle();
    config.vehicle.mass_g = 660000;
    config.vehicle.wheel_radius_um = 250000;
    config.battery.driven_wheels = 4;
    config.brake.blend_out_end_mrad_s = END_mrad_s;
    road_init(&state, &config);
    speed_rad_s = 40.0;
    slope_nm = 0.0;
    motor_mNm = hydraulic_mNm = 0;
    road_mNm = 0;
}

void tearDown(void) {}

static void roll(int duration_ms)
{
    for (int n = 0; n < duration_ms; n++) {
        const double brakes_nm = copysign(hydraulic_mNm * 1e-3, speed_rad_s);
        speed_rad_s += (motor_mNm * 1e-3 - brakes_nm - slope_nm) / INERTIA_KG_M2 * PER_MS;
        road_mNm = road_step(&state, &config, (int32_t)lround(speed_rad_s * 1e3), motor_mNm,
                             hydraulic_mNm, true);
    }
}

void test_the_inertia_is_that_of_the_share_of_the_mass_at_the_radius(void)
{
    TEST_ASSERT_EQUAL_INT32(10312, state.inertia_g_m2); /* 165 kg (0.25 m)^2 = 10.3125 */
    config.vehicle.mass_g = 100000000;
    config.vehicle.wheel_radius_um = 2000000;
    config.battery.driven_wheels = 1;
    road_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(400000000, state.inertia_g_m2);
    config.vehicle.mass_g = 1000;
    config.vehicle.wheel_radius_um = 100000;
    road_init(&state, &config);
    TEST_ASSERT_EQUAL_INT32(10, state.inertia_g_m2);
}

/* Whatever the brakes and the direction. A speed of whole mrad/s is known to 1 mrad/s in 64 ms, of
 * this inertia 0.16 N m, and the low-pass stops 63/256 mrad/s short of a constant slope's. */
void test_a_slope_is_seen_beside_any_brakes(void)
{
    const double slopes_nm[] = {0.0, 12.0, 40.0};
    for (int k = 0; k < 24; k++) {
        setUp();
        const double direction = k % 2 == 0 ? 1.0 : -1.0;
        speed_rad_s *= direction;
        slope_nm = direction * slopes_nm[k / 2 % 3];
        motor_mNm = (k / 6 % 2 == 0 ? 0 : -20000) * (int)direction;
        hydraulic_mNm = k / 12 == 0 ? 0 : 15000;
        roll(SETTLED_ms);
        TEST_ASSERT_INT32_WITHIN(300, (int32_t)lround(slopes_nm[k / 2 % 3] * 1e3), road_mNm);
    }
}

/* All terms pass the same filter, so a brake that comes or goes is no slope. */
void test_a_step_of_the_brakes_is_no_slope(void)
{
    slope_nm = 10.0;
    roll(SETTLED_ms);
    for (int k = 0; k < 4; k++) {
        motor_mNm = k % 2 == 0 ? -30000 : 0;
        hydraulic_mNm = k / 2 == 0 ? 25000 : 0;
        for (int n = 0; n < 100; n++) {
            roll(1);
            TEST_ASSERT_INT32_WITHIN(1500, 10000, road_mNm); /* 55 N m, a millisecond apart */
        }
    }
}

void test_a_road_that_pushes_brakes_with_zero(void)
{
    slope_nm = -20.0;
    roll(SETTLED_ms);
    TEST_ASSERT_EQUAL_INT32(0, road_mNm);
    TEST_ASSERT_INT32_WITHIN(300, 20000, state.torque_mNm);
}

/* Not below half the end of the blend-out, 420 mrad/s, nor while something is not trusted. */
void test_the_road_stays_what_it_was_while_it_is_not_seen(void)
{
    slope_nm = 10.0;
    roll(SETTLED_ms);
    const int32_t before_mNm = road_mNm;
    const int32_t slow_mrad_s = END_mrad_s / 2 + 1;
    for (int n = 0; n < 3; n++) {
        const int32_t seen_mNm = road_step(&state, &config,
                                           n == 0   ? 40000
                                           : n == 1 ? slow_mrad_s
                                                    : -slow_mrad_s,
                                           -50000, 0, n > 0);
        TEST_ASSERT_EQUAL_INT32(before_mNm, seen_mNm);
        TEST_ASSERT_FALSE(state.rolls);
    }
    (void)road_step(&state, &config, slow_mrad_s + 1, 0, 0, true);
    TEST_ASSERT_TRUE(state.rolls);
}

/* A wheel that is seen again, or turns round, has another speed and other torques: neither is a
 * change of speed. */
void test_a_wheel_that_is_seen_again_or_turns_round_begins_anew(void)
{
    slope_nm = 10.0;
    roll(SETTLED_ms);
    const int32_t before_mNm = road_mNm;
    (void)road_step(&state, &config, 40000, 0, 0, false);
    TEST_ASSERT_EQUAL_INT32(before_mNm, road_step(&state, &config, 90000, 10000, 3000, true));
    TEST_ASSERT_EQUAL_INT32(before_mNm, road_step(&state, &config, -5000, -10000, 2000, true));
    TEST_ASSERT_EQUAL_INT32(before_mNm, road_step(&state, &config, 5000, 10000, 4000, true));
}

typedef struct {
    double sector_rad, shown_rad_s, angle_rad, now_s, edge_s, before_s;
} halls_t;

/* Mean speed over the last sector, at its end. Returns by how much that sector took longer. */
static double roll_by_halls(halls_t *halls, double decel_rad_s2)
{
    double growth = 1.0;
    for (int part = 0; part < 50; part++) {
        speed_rad_s -= decel_rad_s2 * PER_MS / 50.0;
        halls->angle_rad += speed_rad_s * PER_MS / 50.0;
        halls->now_s += PER_MS / 50.0;
        if (halls->angle_rad >= halls->sector_rad) {
            halls->angle_rad -= halls->sector_rad;
            const double edge_s = halls->now_s - halls->angle_rad / speed_rad_s;
            const double sector_s = edge_s - halls->edge_s;
            halls->shown_rad_s = halls->sector_rad / sector_s;
            growth = halls->before_s > 0.0 ? sector_s / halls->before_s : 1.0;
            halls->edge_s = edge_s;
            halls->before_s = sector_s;
        }
    }
    return growth;
}

/* Within 1 N m: edges fall between the steps. In a stop, where a sector takes longer than the
 * filter as well. The change from one mean to the next is that of half of both sectors' time: less
 * than that of the last sector's time by half of what this has grown. */
void test_a_slope_is_seen_by_slow_hall_sensors(void)
{
    const double sectors_rad[] = {0.02, 0.05, 0.1, 0.2}, brake_nm = 35.0;
    for (int k = 0; k < 4; k++) {
        setUp();
        slope_nm = 30.0;
        motor_mNm = -(int32_t)lround(brake_nm * 1e3);
        speed_rad_s = 12.0;
        halls_t halls = {.sector_rad = sectors_rad[k], .shown_rad_s = speed_rad_s};
        double growth = 1.0;
        for (int n = 0; speed_rad_s > 1.5; n++) {
            growth = fmax(roll_by_halls(&halls, (brake_nm + slope_nm) / INERTIA_KG_M2), growth);
            road_mNm = road_step(&state, &config, (int32_t)lround(halls.shown_rad_s * 1e3),
                                 motor_mNm, 0, true);
            const double least_nm = (brake_nm + slope_nm) * (1.0 + 1.0 / growth) / 2.0 - brake_nm;
            if (n > SETTLED_ms) {
                TEST_ASSERT_GREATER_OR_EQUAL_INT32((int32_t)lround(least_nm * 1e3) - 1000,
                                                   road_mNm);
                TEST_ASSERT_LESS_OR_EQUAL_INT32((int32_t)lround(slope_nm * 1e3) + 1000, road_mNm);
            }
        }
        TEST_ASSERT_TRUE(growth < 1.4);
    }
}

void test_any_values_give_a_magnitude(void)
{
    random_t random = random_seeded(41);
    for (int n = 0; n < 200000; n++) {
        road_mNm = road_step(&state, &config, random_wild(&random), random_wild(&random),
                             random_wild(&random), random_chance(&random, 0.9));
        TEST_ASSERT_GREATER_OR_EQUAL_INT32(0, road_mNm);
        TEST_ASSERT_LESS_THAN_INT32(1 << 23, road_mNm);
    }
}
