/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Torque bounds and current setpoints of all shipped configurations, against the circuit of
 * reference_motor.h in double precision: random speeds up to 110 %, temperatures, bus voltages and
 * current limits. The power at the bound must be the power limit within 0.1 % of rated torque and
 * 0.1 % of the largest power, on the voltage ellipse 0.5 %.
 */
#include "random_values.h"
#include "reference_motor.h"
#include "torque/current_setpoint.h"
#include "torque/feasible_torque.h"
#include "torque/loss_maps.h"
#include "torque_model.h"
#include "unity.h"

extern const config_t CONFIG_LU2013, CONFIG_EBIKE36V, CONFIG_SCOOTER48V, CONFIG_IPM400V;

enum { STATES = 500, HALVINGS = 30 };

typedef struct {
    const config_t *config;
    reference_motor_t motor;
    int32_t speed_mrad_s, winding_cC;
    double phase_v, weakest_a;
} drive_t;

void setUp(void) {}

void tearDown(void) {}

static reference_point_t at_d(const drive_t *drive, double d_a, double airgap_nm)
{
    const reference_motor_t *m = &drive->motor;
    const double g_q = m->w_rad_s * m->l_q_h * m->iron_siemens;
    double x = 0.0;
    for (int n = 0; n < 40; n++) {
        const double flux = m->psi_wb + (m->l_d_h - m->l_q_h) * (d_a + g_q * x);
        x = airgap_nm / (1.5 * m->pole_pairs * fmax(flux, 0.25 * m->psi_wb));
    }
    return reference_point(m, d_a + g_q * x, x);
}

static double volts(const drive_t *drive, reference_point_t p)
{
    const reference_motor_t *m = &drive->motor;
    const double w = m->w_rad_s;
    /* torque current from the terminal current */
    const double g = w * m->iron_siemens;
    const double x =
        (p.i_q_a - g * (m->l_d_h * p.i_d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    const double i_dt = p.i_d_a + g * m->l_q_h * x;
    return hypot(m->resistance_ohm * p.i_d_a - w * m->l_q_h * x,
                 m->resistance_ohm * p.i_q_a + w * (m->l_d_h * i_dt + m->psi_wb));
}

static reference_point_t at_map(const drive_t *drive, double airgap_nm)
{
    const double map_a =
        1e-3 * loss_maps_d_current_mA(drive->config, drive->speed_mrad_s, drive->winding_cC,
                                      (int32_t)lround(1e3 * airgap_nm));
    return at_d(drive, map_a, airgap_nm);
}

/* With the map's i_d, or the i_d on the voltage limit, down to the largest field weakening. */
static reference_point_t at_torque(const drive_t *drive, double airgap_nm)
{
    const double map_a =
        1e-3 * loss_maps_d_current_mA(drive->config, drive->speed_mrad_s, drive->winding_cC,
                                      (int32_t)lround(1e3 * airgap_nm));
    double high_a = map_a;
    double low_a = fmin(map_a, drive->weakest_a);
    if (volts(drive, at_d(drive, map_a, airgap_nm)) <= drive->phase_v) {
        return at_d(drive, map_a, airgap_nm);
    }
    for (int n = 0; n < HALVINGS; n++) {
        const double middle_a = 0.5 * (low_a + high_a);
        if (volts(drive, at_d(drive, middle_a, airgap_nm)) <= drive->phase_v) {
            low_a = middle_a;
        } else {
            high_a = middle_a;
        }
    }
    return at_d(drive, low_a, airgap_nm);
}

static double friction_nm(const drive_t *drive)
{
    const config_motor_t *motor = &drive->config->motor;
    const double speed_rad_s = 1e-3 * drive->speed_mrad_s;
    return 1e-3 * motor->friction_torque_mNm * fmin(1.0, speed_rad_s / 0.5) +
           1e-6 * motor->viscous_friction_uNm_s * speed_rad_s;
}

static double drawn_w(const drive_t *drive, double shaft_nm)
{
    return at_torque(drive, shaft_nm + friction_nm(drive)).power_w;
}

/* The tighter bound of voltage and phase current: beyond it no bound by power applies. */
static int32_t by_currents_mNm(const feasible_side_t *side)
{
    return q_min(side->voltage_mNm, feasible_by_current_mNm(side));
}

/* The power crosses its limit between a slightly smaller and a slightly larger torque. */
static void assert_bound(const drive_t *drive, double shaft_nm, double sign, double limit_w)
{
    const double step_nm = 1e-6 * drive->config->motor.rated_torque_mNm;
    /* On the ellipse the corrections of i_d leave 0.5 %. */
    const bool far = drive->phase_v < volts(drive, at_map(drive, shaft_nm + friction_nm(drive)));
    const double power_w = (far ? 5e-6 : 1e-6) * drive->config->motor.max_power_mW;
    const double inside_w = sign * drawn_w(drive, shaft_nm - sign * step_nm);
    const double beyond_w = sign * drawn_w(drive, shaft_nm + sign * step_nm);
    TEST_ASSERT_TRUE(inside_w <= sign * limit_w + power_w);
    TEST_ASSERT_TRUE(beyond_w >= sign * limit_w - power_w);
}

static void compare(const config_t *config, uint64_t seed)
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
        const feasible_side_t drives = feasible_side_at(&set, SIDE_DRIVING, cap_mNm);
        const feasible_side_t brakes = feasible_side_at(&set, SIDE_BRAKING, cap_mNm);
        const int32_t by_drawn_mNm =
            feasible_by_drawn_mNm(&drives, feasible_power_b(&model, drawn_mA, bus_mV));
        /* Above the largest speed nothing drives. */
        if (drive.speed_mrad_s < config->motor.max_speed_mrad_s && by_drawn_mNm > 0 &&
            by_drawn_mNm < q_min(by_currents_mNm(&drives), cap_mNm)) {
            driving++;
            assert_bound(&drive, 1e-3 * by_drawn_mNm, 1.0, 1e-6 * drawn_mA * bus_mV);
        }
        if (config->rotor.sensor == CONFIG_ROTOR_HALL) {
            continue; /* power reserve for the angle error: test_torque_limits.c */
        }
        const int32_t returned_mA = random_between(&random, 0, battery->max_charge_current_mA);
        const int32_t by_returned_mNm =
            feasible_by_returned_mNm(&brakes, feasible_power_b(&model, returned_mA, bus_mV));
        if (by_returned_mNm < q_min(by_currents_mNm(&brakes), cap_mNm)) {
            braking++;
            assert_bound(&drive, -1e-3 * by_returned_mNm, -1.0, -1e-6 * returned_mA * bus_mV);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(STATES / 10, driving);
    TEST_ASSERT_TRUE(config->rotor.sensor == CONFIG_ROTOR_HALL || braking > STATES / 10);
}

void test_bounds_by_battery_power_of_every_configuration_match_the_circuit(void)
{
    compare(&CONFIG_LU2013, 1);
    compare(&CONFIG_EBIKE36V, 2);
    compare(&CONFIG_SCOOTER48V, 3);
    compare(&CONFIG_IPM400V, 4);
}

void test_charge_bounds_with_an_angle_sensor_match_the_circuit(void)
{
    const config_t *const configs[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V};
    for (int c = 0; c < 3; c++) {
        config_t config = *configs[c];
        config.rotor.sensor = CONFIG_ROTOR_ANGLE;
        compare(&config, (uint64_t)(10 + c));
    }
}

/* A point of terminal currents of the circuit. */
static reference_point_t of_terminal(const drive_t *drive, double d_a, double q_a)
{
    const reference_motor_t *m = &drive->motor;
    const double g = m->w_rad_s * m->iron_siemens;
    const double x = (q_a - g * (m->l_d_h * d_a + m->psi_wb)) / (1.0 + g * g * m->l_d_h * m->l_q_h);
    return reference_point(m, d_a + g * m->l_q_h * x, x);
}

static drive_t any_drive(const config_t *config, random_t *random, int32_t *phase_mV)
{
    const config_battery_t *battery = &config->battery;
    drive_t drive = {
        .config = config,
        .speed_mrad_s = random_between(random, 1000, config->motor.max_speed_mrad_s / 10 * 11),
        .winding_cC = random_between(random, -2000, 14000),
    };
    *phase_mV =
        (int32_t)(0.55 * random_between(random, battery->min_voltage_mV, battery->max_voltage_mV));
    drive.phase_v = 1e-3 * *phase_mV;
    drive.motor = reference_motor(config, drive.speed_mrad_s, drive.winding_cC);
    return drive;
}

/* On the circle with 0.4 % in reserve: maximum torque per ampere by golden section, and where the
 * voltage does not suffice there, by bisection down to where it does or field weakening ends. */
static double by_current_nm(const drive_t *drive, double sign)
{
    const double most_a = 1e-3 * drive->config->motor.max_phase_current_mA * (1.0 - 1.0 / 256.0);
    const reference_motor_t *m = &drive->motor;
    const double saliency_h = m->l_d_h - m->l_q_h;
    double low_a = -most_a;
    double high_a = most_a;
    for (int n = 0; n < 80; n++) {
        const double a = low_a + 0.382 * (high_a - low_a);
        const double b = low_a + 0.618 * (high_a - low_a);
        const double at_a = (m->psi_wb + saliency_h * a) * sqrt(most_a * most_a - a * a);
        const double at_b = (m->psi_wb + saliency_h * b) * sqrt(most_a * most_a - b * b);
        if (at_a > at_b) {
            high_a = b;
        } else {
            low_a = a;
        }
    }
    double inside_a = fmin(fmax(drive->weakest_a, -most_a), low_a);
    double d_a = low_a;
    for (int n = 0; n < HALVINGS; n++) {
        const double q_a = sign * sqrt(fmax(most_a * most_a - d_a * d_a, 0.0));
        if (volts(drive, of_terminal(drive, d_a, q_a)) <= drive->phase_v) {
            if (n == 0) {
                break;
            }
            inside_a = d_a;
        } else {
            low_a = d_a;
        }
        d_a = 0.5 * (inside_a + low_a);
    }
    const double q_a = sign * sqrt(fmax(most_a * most_a - d_a * d_a, 0.0));
    if (volts(drive, of_terminal(drive, d_a, q_a)) > 1.001 * drive->phase_v) {
        return -1.0; /* nowhere on the circle: bridge_choice.h opens the bridge */
    }
    return fmax(sign * (of_terminal(drive, d_a, q_a).torque_nm - friction_nm(drive)), 0.0);
}

void test_phase_current_bounds_of_every_configuration_match_a_bisection_on_the_circuit(void)
{
    const config_t *const configs[] = {&CONFIG_LU2013, &CONFIG_EBIKE36V, &CONFIG_SCOOTER48V,
                                       &CONFIG_IPM400V};
    for (int c = 0; c < 4; c++) {
        random_t random = random_seeded((uint64_t)(20 + c));
        int bounded = 0;
        for (int n = 0; n < STATES; n++) {
            int32_t phase_mV = 0;
            drive_t drive = any_drive(configs[c], &random, &phase_mV);
            const motor_model_t model = model_at(configs[c], drive.speed_mrad_s, drive.winding_cC);
            const feasible_set_t set = feasible_set_at(&model, phase_mV);
            drive.weakest_a = 1e-3 * model_current_mA(&model, set.weakest_d_b);
            const int32_t most_mNm = configs[c]->motor.max_torque_mNm;
            const int32_t cap_mNm = n % 2 == 0 ? most_mNm : 3 * most_mNm;
            for (int sign = -1; sign <= 1; sign += 2) {
                const feasible_side_t side =
                    feasible_side_at(&set, sign > 0 ? SIDE_DRIVING : SIDE_BRAKING, cap_mNm);
                const int32_t found_mNm = feasible_by_current_mNm(&side);
                const double wanted_mNm = 1e3 * by_current_nm(&drive, sign);
                if (wanted_mNm < 0.0) {
                    continue;
                }
                if (found_mNm == FEASIBLE_UNBOUNDED) {
                    TEST_ASSERT_TRUE(wanted_mNm >= 0.998 * cap_mNm);
                } else {
                    bounded++;
                    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * most_mNm, wanted_mNm, found_mNm);
                }
            }
        }
        TEST_ASSERT_GREATER_THAN_INT(STATES / 2, bounded);
    }
}

/* Between the bounds of voltage and current the setpoint makes the torque, and where the map's i_d
 * needs more voltage than there is, all of the voltage is in use. */
void test_setpoints_on_the_voltage_ellipse_make_the_torque_with_the_voltage_there_is(void)
{
    const config_t *const configs[] = {&CONFIG_LU2013, &CONFIG_IPM400V};
    for (int c = 0; c < 2; c++) {
        random_t random = random_seeded((uint64_t)(30 + c));
        int on_ellipse = 0;
        for (int n = 0; n < 4 * STATES; n++) {
            int32_t phase_mV = 0;
            drive_t drive = any_drive(configs[c], &random, &phase_mV);
            const motor_model_t model = model_at(configs[c], drive.speed_mrad_s, drive.winding_cC);
            const feasible_set_t set = feasible_set_at(&model, phase_mV);
            drive.weakest_a = 1e-3 * model_current_mA(&model, set.weakest_d_b);
            const double sign = random_chance(&random, 0.5) ? 1.0 : -1.0;
            const feasible_side_t side = feasible_side_at(
                &set, sign > 0.0 ? SIDE_DRIVING : SIDE_BRAKING, configs[c]->motor.max_torque_mNm);
            const int32_t bound_mNm = q_min(q_min(side.voltage_mNm, feasible_by_current_mNm(&side)),
                                            configs[c]->motor.max_torque_mNm);
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
            TEST_ASSERT_TRUE(volts(&drive, at) <= 1.004 * drive.phase_v);
            const double map_a =
                1e-3 * loss_maps_d_current_mA(configs[c], drive.speed_mrad_s, drive.winding_cC,
                                              (int32_t)lround(1e3 * airgap_nm));
            if (volts(&drive, at_d(&drive, map_a, airgap_nm)) > 1.005 * drive.phase_v) {
                on_ellipse++;
                TEST_ASSERT_TRUE(volts(&drive, at) >= 0.998 * drive.phase_v);
            }
        }
        TEST_ASSERT_GREATER_THAN_INT(STATES / 4, on_ellipse);
    }
}
