/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The i_d of a torque on the voltage ellipse of a motor whose magnets only assist its reluctance:
 * tangents of the torque's hyperbola one by one in double precision (DERIVATIONS.md, Feasible
 * torque). Two at least; up to five while |u| is beyond U and the reserve of the fast loop.
 */
#include "plain_drive.h"
#include "unity.h"

enum { ROUNDS = 10000, LEAST = 2, MOST_TANGENTS = 5 };

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
    motor.constants.current_most_b = 1 << 25; /* 32 units: no circle */
    motor.constants.torque_factor_q24 = 1 << 28;
    motor.constants.torque_inverse_q24 = 1 << 20;
}

void tearDown(void) {}

static double flux(const plain_drive_t *d, double i_d)
{
    return d->psi + d->saliency * i_d;
}

static double volts(const plain_drive_t *d, plain_point_t at)
{
    return hypot(drive_u_d(d, at), drive_u_q(d, at));
}

/* Along i_d with x at constant torque to |u| = U, or to the least |u|. A slope ends at four. */
static double to_ellipse(const plain_drive_t *d, plain_point_t at)
{
    const double x_per_d = drive_clamped(-d->saliency * at.x / flux(d, at.d), -4.0, 4.0);
    const double u_d = drive_u_d(d, at);
    const double u_q = drive_u_q(d, at);
    const double s_d = d->r - d->x_q * x_per_d;
    const double s_q = d->x_d + d->r * x_per_d;
    const double half = s_d * u_d + s_q * u_q;
    const double squared = s_d * s_d + s_q * s_q;
    const double under_root = half * half - squared * (u_d * u_d + u_q * u_q - d->u * d->u);
    plain_unclear = plain_unclear || fabs(under_root) < 0.03 || squared < 0.03 || squared > 31.0;
    return (sqrt(fmax(under_root, 0.0)) - half) / squared;
}

/* The number of tangents that it took. */
static int weakened(const plain_drive_t *d, double airgap, plain_point_t *at)
{
    const double highest = at->d;
    const double lowest = fmin(d->lowest, highest);
    int tangents = 0;
    while (tangents < MOST_TANGENTS) {
        if (tangents >= LEAST && !plain_is_above(volts(d, *at), sqrt(17.0 / 16.0) * d->u)) {
            break;
        }
        at->d = drive_clamped(at->d + to_ellipse(d, *at), lowest, highest);
        plain_unclear = plain_unclear || flux(d, at->d) < 0.3 * d->psi;
        at->x = airgap / flux(d, at->d);
        tangents++;
    }
    return tangents;
}

static plain_drive_t any(random_t *random)
{
    plain_drive_t out = {
        .psi = random_real(random, 0.3, 1.0),
        .saliency = -random_real(random, 0.2, 1.5),
        .r = random_real(random, 0.0, 0.1),
        .x_d = random_real(random, 0.1, 0.8),
        .u = random_real(random, 0.5, 3.0),
        .lowest = random_real(random, -8.0, -0.5),
    };
    out.x_q = out.x_d * random_real(random, 1.5, 6.0);
    out.emf = out.psi * random_real(random, 0.5, 3.0);
    return out;
}

void test_the_i_d_of_a_torque_on_the_ellipse_takes_two_to_five_tangents_of_its_hyperbola(void)
{
    random_t random = random_seeded(44);
    int took[MOST_TANGENTS + 1] = {0};
    for (int n = 0; n < ROUNDS; n++) {
        const plain_drive_t d = any(&random);
        drive_apply(&d, &motor);
        const double map = plain_entry_value(random_real(&random, -1.0, 0.0));
        for (int k = 0; k < 3; k++) {
            motor.map_lsb[k] = plain_entry(&motor, PLAIN_UNIT_LOG2, map);
        }
        const double airgap = random_real(&random, -4.0, 4.0);
        plain_point_t wanted = {.d = map, .x = airgap / flux(&d, map)};
        plain_unclear = false;
        if (!plain_is_above(volts(&d, wanted), d.u)) {
            continue;
        }
        const int tangents = weakened(&d, airgap, &wanted);
        if (plain_unclear || fabs(wanted.x) > 15.0) {
            continue;
        }
        took[tangents]++;
        const motor_point_t found = feasible_point(&motor.set, plain_units(airgap));
        TEST_ASSERT_DOUBLE_WITHIN(6e-3, wanted.d, plain_value(found.d_b));
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, wanted.x, plain_value(found.x_b));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 20, took[2]);
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 50, took[3]);
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 500, took[4]);
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 20, took[5]); /* most of them with too little voltage */
}
