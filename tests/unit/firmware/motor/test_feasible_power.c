/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Torque bounds by battery power of all shipped configurations, against the circuit in double
 * precision, the loss of the bridge included. The power at the bound must be the power limit
 * within 0.1 % of rated torque and 0.15 % of the largest power, on the voltage ellipse
 * 0.5 %, and anywhere where i_d changes fast with the torque.
 */
#include "paper_vehicle.h"
#include "reference_drive.h"
#include "unity.h"

/* As the fold-back gives it: the management would permit any power more. */
enum { ANY_ANGLE_b = INT32_MAX };

static const double VERTEX_SHARE = 1.5e-3, ELLIPSE_SHARE = 5e-3; /* of the largest power */

void setUp(void) {}

void tearDown(void) {}

static double drawn_w(const drive_t *drive, double shaft_nm)
{
    const reference_point_t at = at_torque(drive, shaft_nm + friction_nm(drive));
    return at.power_w + reference_bridge_w(drive->config, at);
}

/* The tighter bound of voltage and phase current: beyond it no bound by power applies. */
static int32_t by_currents_mNm(feasible_side_t *side)
{
    feasible_circle_t circle = {.known = false};
    const feasible_bounds_t ends = feasible_by_voltage_and_current(side, &circle);
    return q_min(ends.voltage_mNm, ends.current_mNm);
}

/* The power crosses its limit between a slightly smaller and a slightly larger torque. */
static void assert_bound(const drive_t *drive, double shaft_nm, double sign, double limit_w,
                         double share)
{
    const double step_nm = 1e-6 * drive->config->motor.rated_torque_mNm;
    /* On the ellipse the corrections of i_d leave 0.5 %, at the vertex the bridge 0.15 %. */
    const bool far = drive->phase_v < volts(drive, at_map(drive, shaft_nm + friction_nm(drive)));
    const double power_w = (far ? ELLIPSE_SHARE : share) * 1e-3 * drive->config->motor.max_power_mW;
    const double inside_w = sign * drawn_w(drive, shaft_nm - sign * step_nm);
    const double beyond_w = sign * drawn_w(drive, shaft_nm + sign * step_nm);
    TEST_ASSERT_TRUE(inside_w <= sign * limit_w + power_w);
    TEST_ASSERT_TRUE(beyond_w >= sign * limit_w - power_w);
}

static void compare(const config_t *config, uint64_t seed, double share)
{
    random_t random = random_seeded(seed);
    const config_battery_t *battery = &config->battery;
    int driving = 0;
    int braking = 0;
    for (int n = 0; n < STATES; n++) {
        drive_t drive = {
            .config = config,
            .speed_mrad_s = random_between(&random, 1000, config->motor.max_speed_mrad_s / 10 * 11),
            .winding_cC = random_between(&random, -2000, 14000),
        };
        const int32_t bus_mV =
            random_between(&random, battery->min_voltage_mV, battery->max_voltage_mV);
        const int32_t phase_mV = (int32_t)(0.55 * bus_mV);
        drive.motor = reference_motor(config, drive.speed_mrad_s, drive.winding_cC);
        drive.phase_v = 1e-3 * phase_mV;
        const motor_model_t model = model_at(config, drive.speed_mrad_s, drive.winding_cC);
        const feasible_set_t set = feasible_set_at(&model, phase_mV);
        drive.weakest_a = 1e-3 * model_current_mA(&model, set.weakest_d_b);
        const int32_t cap_mNm = config->motor.max_torque_mNm;

        const int32_t drawn_mA = random_between(&random, 0, battery->max_discharge_current_mA);
        feasible_side_t drives = feasible_side_at(&set, SIDE_DRIVING, cap_mNm);
        feasible_side_t brakes = feasible_side_at(&set, SIDE_BRAKING, cap_mNm);
        const int32_t drives_mNm = q_min(by_currents_mNm(&drives), cap_mNm);
        const int32_t brakes_mNm = q_min(by_currents_mNm(&brakes), cap_mNm);
        const int32_t by_drawn_mNm =
            feasible_by_drawn_mNm(&drives, feasible_power_b(&model, drawn_mA, bus_mV));
        /* Above the largest speed nothing drives. */
        if (drive.speed_mrad_s < config->motor.max_speed_mrad_s && by_drawn_mNm > 0 &&
            by_drawn_mNm < drives_mNm) {
            driving++;
            assert_bound(&drive, 1e-3 * by_drawn_mNm, 1.0, 1e-6 * drawn_mA * bus_mV, share);
        }
        const int32_t returned_mA = random_between(&random, 0, battery->max_charge_current_mA);
        const feasible_returned_t returned = {
            .power_b = feasible_power_b(&model, returned_mA, bus_mV),
            .margin_b = ANY_ANGLE_b, /* power reserve for the angle error: test_torque_limits.c */
        };
        const int32_t by_returned_mNm = feasible_by_returned_mNm(&brakes, returned);
        if (by_returned_mNm < brakes_mNm) {
            braking++;
            assert_bound(&drive, -1e-3 * by_returned_mNm, -1.0, -1e-6 * returned_mA * bus_mV,
                         share);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(STATES / 10, driving);
    TEST_ASSERT_GREATER_THAN_INT(STATES / 10, braking);
}

void test_bounds_by_battery_power_of_every_configuration_match_the_circuit(void)
{
    compare(&CONFIG_LU2013, 1, VERTEX_SHARE);
    compare(&CONFIG_EBIKE36V, 2, VERTEX_SHARE);
    compare(&CONFIG_SCOOTER48V, 3, VERTEX_SHARE);
    compare(&CONFIG_IPM400V, 4, VERTEX_SHARE);
}

/* i_d of least current follows the torque most where magnets only assist reluctance. */
void test_bounds_by_battery_power_of_a_reluctance_motor_match_the_circuit(void)
{
    config_t reluctance = salient_vehicle();
    reluctance.motor.q_inductance_nH = 6 * reluctance.motor.d_inductance_nH;
    reluctance.motor.flux_linkage_nWb = 30000000;
    reluctance.motor.max_power_mW = 8000000; /* what the battery gives */
    fill_with_best_angle(&reluctance);
    compare(&reluctance, 5, ELLIPSE_SHARE);
}
