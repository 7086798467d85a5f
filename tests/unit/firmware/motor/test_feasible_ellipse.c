/* SPDX-License-Identifier: Apache-2.0 */
/* Current setpoints on the voltage ellipse, against the circuit in double precision. */
#include "motor/current_setpoint.h"
#include "reference_drive.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

/* Magnets that assist a reluctance motor: the hyperbola of its torque bends most. */
static config_t six_times_salient(void)
{
    config_t config = CONFIG_IPM400V;
    config.motor.q_inductance_nH = 6 * config.motor.d_inductance_nH;
    return config;
}

/* Between the bounds of voltage and current the setpoint makes the torque, and where the map's i_d
 * needs more voltage than there is, all of the voltage is in use. Where the hyperbola bends most,
 * up to 3.1 % more: the reserve of the fast loop, sqrt(1 + 1/16). */
void test_setpoints_on_the_voltage_ellipse_make_the_torque_with_the_voltage_there_is(void)
{
    const config_t salient = six_times_salient();
    const config_t *const configs[] = {&CONFIG_LU2013, &CONFIG_IPM400V, &salient};
    for (int c = 0; c < 3; c++) {
        random_t random = random_seeded((uint64_t)(30 + c));
        int on_ellipse = 0;
        for (int n = 0; n < 4 * STATES; n++) {
            int32_t phase_mV = 0;
            drive_t drive = any_drive(configs[c], &random, &phase_mV);
            const motor_model_t model = model_at(configs[c], drive.speed_mrad_s, drive.winding_cC);
            const feasible_set_t set = feasible_set_at(&model, phase_mV);
            drive.weakest_a = 1e-3 * model_current_mA(&model, set.weakest_d_b);
            const double sign = random_chance(&random, 0.5) ? 1.0 : -1.0;
            feasible_side_t side = feasible_side_at(&set, sign > 0.0 ? SIDE_DRIVING : SIDE_BRAKING,
                                                    configs[c]->motor.max_torque_mNm);
            feasible_circle_t circle = {.known = false};
            const feasible_bounds_t ends = feasible_by_voltage_and_current(&side, &circle);
            const int32_t bound_mNm =
                q_min(q_min(ends.voltage_mNm, ends.current_mNm), configs[c]->motor.max_torque_mNm);
            const int32_t torque_mNm = (int32_t)(sign * random_fraction(&random) * bound_mNm);
            const current_setpoint_t i = current_setpoint_step(&set, torque_mNm, 0);
            const double airgap_nm = 1e-3 * torque_mNm + friction_nm(&drive);
            const reference_point_t wanted = at_torque(&drive, airgap_nm);
            if (volts(&drive, wanted) > 1.0001 * drive.phase_v ||
                hypot(wanted.i_d_a, wanted.i_q_a) > 1e-3 * configs[c]->motor.max_phase_current_mA) {
                continue; /* near no load the ellipse may leave torques out, beside its ends */
            }
            const reference_point_t at = of_terminal(&drive, 1e-3 * i.i_d_mA, 1e-3 * i.i_q_mA);
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * configs[c]->motor.max_torque_mNm, 1e3 * airgap_nm,
                                      1e3 * at.torque_nm);
            const double most_v = (configs[c] == &salient ? 1.031 : 1.004) * drive.phase_v;
            TEST_ASSERT_TRUE(volts(&drive, at) <= most_v);
            TEST_ASSERT_TRUE(i.feasible);
            const double map_a = 1e-3 * map_d_mA(configs[c], drive.speed_mrad_s, drive.winding_cC,
                                                 (int32_t)lround(1e3 * airgap_nm));
            if (volts(&drive, at_d(&drive, map_a, airgap_nm)) > 1.005 * drive.phase_v) {
                on_ellipse++;
                TEST_ASSERT_TRUE(volts(&drive, at) >= 0.998 * drive.phase_v);
            }
        }
        TEST_ASSERT_GREATER_THAN_INT(STATES / 4, on_ellipse);
    }
}
