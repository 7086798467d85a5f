/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Bounds by battery power where i_d follows the torque, along the map and along the voltage
 * ellipse: the corrections of i_d step by step in double precision. A unit of power is 2^16 of the
 * binary scale.
 */
#include "plain_motor.h"
#include "random_values.h"
#include "unity.h"

enum { POWER_LOG2 = 16, ROUNDS = 4000 };

/* A 32nd of the phase current limit, 2^22: from where on i_d is corrected again. */
static const double FAR = 4.0 / 32.0;
static const double STEEPEST = 2.0;

typedef struct {
    double a, b, b_d, c, c_d, c_dd;              /* power of x and i_d */
    double fall;                                 /* of the map's i_d, up to a torque of one */
    double reactance, emf, per_d, volts, lowest; /* |u|^2 = (X x)^2 + (E + D d)^2 */
    double limit, cap;
} drive_t;

static plain_motor_t motor;

void setUp(void)
{
    plain_motor_init(&motor);
}

void tearDown(void) {}

static void apply(const drive_t *drive)
{
    motor.set.power = (feasible_power_t){
        .a = plain_ratio(drive->a),
        .b = plain_units(drive->b),
        .b_d = plain_ratio(drive->b_d),
        .c = (int32_t)lround(ldexp(drive->c, POWER_LOG2)),
        .c_d = plain_units(drive->c_d),
        .c_dd = plain_ratio(drive->c_dd),
    };
    motor.map_lsb[0] = plain_entry(&motor, PLAIN_UNIT_LOG2, -drive->fall);
    motor.map_lsb[1] = 0;
    motor.map_lsb[2] = motor.map_lsb[0];
    motor.model.reactance_q_b = plain_ratio(drive->reactance);
    motor.model.voltage_q_b = plain_units(drive->emf);
    motor.model.voltage_q_per_d = plain_ratio(drive->per_d);
    motor.set.voltage_squared = (int64_t)ldexp(drive->volts * drive->volts, 2 * PLAIN_UNIT_LOG2);
    motor.set.weakest_d_b = plain_units(drive->lowest);
}

/* The reference: i_d along a straight line over x, and the power along it. */
typedef struct {
    double offset, slope, a, b, c;
} line_t;

static line_t line_at(const drive_t *d, double i_d, double x, double slope)
{
    const double offset = i_d - slope * x;
    const line_t out = {
        .offset = offset,
        .slope = slope,
        .a = d->a + d->b_d * slope + d->c_dd * slope * slope,
        .b = d->b + d->b_d * offset + d->c_d * slope + 2.0 * d->c_dd * slope * offset,
        .c = d->c + d->c_d * offset + d->c_dd * offset * offset,
    };
    return out;
}

static double power(const line_t *p, double x)
{
    return p->a * x * x + p->b * x + p->c;
}

/* i_d of the map, or of the ellipse down to the lowest one; whether that is far from before. */
static bool corrected(const drive_t *d, double x, double *i_d, bool straight, line_t *p)
{
    const double before = *i_d;
    bool on_ellipse = false;
    *i_d = -d->fall * fmin(fabs(x), 1.0);
    if (plain_is_above(hypot(d->reactance * x, d->emf + d->per_d * *i_d), d->volts)) {
        const double left = d->volts * d->volts - d->reactance * d->reactance * x * x;
        const double highest = *i_d;
        const double lowest = fmin(d->lowest, highest);
        *i_d = fmin(fmax((sqrt(fmax(left, 0.0)) - d->emf) / d->per_d, lowest), highest);
        on_ellipse = *i_d > lowest;
        plain_unclear =
            plain_unclear || (on_ellipse && (fabs(left) < 0.05 || *i_d - lowest < 0.01));
    }
    const bool far = plain_is_above(fabs(*i_d - before), FAR);
    const double u_q = fmax(d->emf + d->per_d * *i_d, 1e-9); /* zero where no x is on the ellipse */
    const double steep = -d->reactance * d->reactance * x / (u_q * d->per_d);
    const double slope = fmin(fmax(steep, -STEEPEST), STEEPEST);
    *p = line_at(d, *i_d, x, far && straight && on_ellipse ? slope : 0.0);
    return far;
}

static double near_root(const line_t *p, double left, double sign)
{
    const double sum = p->b + sqrt(fmax(p->b * p->b + 4.0 * p->a * left, 0.0));
    plain_unclear = plain_unclear || p->b * p->b + 4.0 * p->a * left < 0.05 || sum < 0.1;
    return left * sign > 0.0 ? 2.0 * left / sum : 0.0;
}

static double far_root(const line_t *p, double left)
{
    plain_unclear = plain_unclear || p->b * p->b + 4.0 * p->a * left < 0.05;
    return -(p->b + sqrt(fmax(p->b * p->b + 4.0 * p->a * left, 0.0))) / (2.0 * p->a);
}

typedef enum { DRIVING, DRAWING, RETURNING } bound_t;

/* Three corrections, a further one only after a large change. */
static double reference(const drive_t *d, bound_t bound)
{
    double x = bound == DRIVING ? d->cap : -d->cap;
    double i_d = 0.0;
    line_t p = line_at(d, i_d, x, 0.0);
    const double rest = bound == RETURNING ? -d->limit : d->limit;
    if (bound == RETURNING) {
        const bool rising = !plain_is_above(0.0, 2.0 * p.a * x + p.b);
        if (rising && !plain_is_above(rest, power(&p, x))) {
            return INFINITY;
        }
    } else if (!plain_is_above(power(&p, x), rest)) {
        return INFINITY;
    }
    for (int corrections = 0;; corrections++) {
        const double left = rest - p.c;
        if (bound == DRAWING) {
            x = far_root(&p, left);
        } else {
            x = near_root(&p, left, bound == DRIVING ? 1.0 : -1.0);
        }
        i_d = p.offset + p.slope * x;
        if (corrections == 3) {
            break;
        }
        x = bound == RETURNING ? fmax(x, -d->cap) : x;
        if (!corrected(d, x, &i_d, bound != DRAWING, &p)) {
            corrections = 2;
        }
    }
    plain_unclear =
        plain_unclear || (bound == RETURNING && p.b * p.b < 4.0 * p.a * (p.c - rest) + 0.05);
    return fabs(x);
}

static int32_t bound_mNm(const drive_t *drive, bound_t bound)
{
    const int32_t power_b = (int32_t)lround(ldexp(drive->limit, POWER_LOG2));
    const feasible_side_t side =
        plain_side(&motor, bound == DRIVING ? SIDE_DRIVING : SIDE_BRAKING, plain_units(drive->cap));
    const feasible_returned_t returned = {.power_b = power_b, .margin_b = 0};
    return bound == RETURNING ? feasible_by_returned_mNm(&side, returned)
                              : feasible_by_drawn_mNm(&side, power_b);
}

static drive_t any(random_t *random, bound_t bound, double most_fall)
{
    const drive_t out = {
        .a = random_real(random, 0.1, 0.4),
        .b = random_real(random, 0.5, 2.0),
        .b_d = random_real(random, -0.3, 0.3),
        .c = random_real(random, -0.05, 0.1),
        .c_d = random_real(random, -0.2, 0.2),
        .c_dd = random_real(random, 0.0, 0.2),
        .fall = random_chance(random, 0.5) ? 0.0
                                           : plain_entry_value(random_real(random, 0.0, most_fall)),
        .reactance = random_real(random, 0.1, 0.7),
        .emf = random_real(random, 0.5, 1.5),
        .per_d = random_real(random, 0.3, 1.0),
        .volts = random_chance(random, 0.3) ? 50.0 : random_real(random, 0.8, 1.4),
        .lowest = random_real(random, -2.0, -0.1),
        .limit = random_real(random, 0.0, 1.5),
        .cap = random_real(random, 0.3, bound == DRAWING ? 16.0 : 3.0),
    };
    return out;
}

static void compare(bound_t bound, uint64_t seed, double most_fall)
{
    random_t random = random_seeded(seed);
    int bounded = 0;
    for (int n = 0; n < ROUNDS; n++) {
        const drive_t drive = any(&random, bound, most_fall);
        apply(&drive);
        plain_unclear = false;
        const double wanted = reference(&drive, bound);
        if (plain_unclear || (wanted > 20.0 && wanted < INFINITY)) {
            continue;
        }
        const int32_t found_mNm = bound_mNm(&drive, bound);
        if (wanted > 1e6) {
            TEST_ASSERT_EQUAL_INT32(FEASIBLE_UNBOUNDED, found_mNm);
            continue;
        }
        bounded++;
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * fmax(wanted, 1.0), wanted, plain_value(found_mNm));
    }
    TEST_ASSERT_GREATER_THAN_INT(ROUNDS / 10, bounded);
}

void test_drawing_brake_bounds_follow_i_d_along_map_and_ellipse_in_three_corrections(void)
{
    compare(DRAWING, 2, 0.8);
}

void test_returning_bounds_follow_i_d_along_map_and_ellipse_in_three_corrections(void)
{
    compare(RETURNING, 3, 0.8);
}

/* A map so steep that the corrections do not come to rest in three. */
void test_three_corrections_are_all_on_a_map_that_falls_seven_times_as_fast_as_the_torque(void)
{
    compare(DRIVING, 4, 7.0);
    compare(RETURNING, 5, 7.0);
}
