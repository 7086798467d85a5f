/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Whether the voltage suffices for a point with any currents: the sum of squares does not overflow,
 * so that the comparison is the one written, in whole numbers.
 */
#include "feasible_ellipse.h"
#include "motor/motor_model.h"
#include "proof.h"

/* The contracts of motor_model_u_d_b() and motor_model_u_q_b(): any voltage of a point. */
static int32_t u_d_b, u_q_b;

#define motor_model_u_d_b(model, at) ((void)(model), (void)(at), u_d_b)
#define motor_model_u_q_b(model, at) ((void)(model), (void)(at), u_q_b)

/* The contract that prove_feasible_square() proves; equal numbers have equal squares. */
enum { MOST_OF_A_POINT_b = 5 << 26, FAR_b = 1 << 26 };

int64_t __CPROVER_uninterpreted_square(int32_t x);

static int64_t square_by_contract(int32_t x)
{
    const int64_t out = __CPROVER_uninterpreted_square(x);
    PROVE(x >= -MOST_OF_A_POINT_b && x <= MOST_OF_A_POINT_b);
    ASSUME(out >= 0 && out <= INT64_C(1) << 57);
    ASSUME((x > -FAR_b && x < FAR_b) || out >= INT64_C(1) << 52);
    return out;
}

void prove_feasible_square(void)
{
    const int32_t x = any_within(-MOST_OF_A_POINT_b, MOST_OF_A_POINT_b);
    const int64_t out = square(x);
    PROVE(out >= 0 && out <= INT64_C(1) << 57);
    PROVE((x > -FAR_b && x < FAR_b) || out >= INT64_C(1) << 52);
    PROOF_END();
}
#define square square_by_contract
#include "feasible_torque.c"

/* Of a voltage clamped to 26 bits (feasible_set_at()). */
enum { MOST_VOLTAGE_b = 1 << 25 };

static motor_model_t model;
static const motor_point_t ANY_POINT;

static void any_voltages(void)
{
    u_d_b = any_within(-(1 << 28), 1 << 28);
    u_q_b = any_within(-(1 << 28), (1 << 28) + (1 << 26));
}

static feasible_set_t any_set(void)
{
    const feasible_set_t out = {.model = &model, .voltage_squared = nondet_int64()};
    ASSUME(out.voltage_squared >= 0 &&
           out.voltage_squared <= (int64_t)MOST_VOLTAGE_b * MOST_VOLTAGE_b);
    return out;
}

/* No overflow, and more voltage suffices for all that less suffices for. */
void prove_feasible_holds(void)
{
    const feasible_set_t set = any_set();
    const feasible_set_t higher = any_set();
    any_voltages();
    ASSUME(set.voltage_squared <= higher.voltage_squared);
    const bool holds = feasible_holds(&set, ANY_POINT);
    PROVE(!holds || feasible_holds(&higher, ANY_POINT));
    PROOF_END();
}

/* Far outside the ellipse no sum wraps round to a small one. */
void prove_feasible_holds_not_far_outside(void)
{
    const feasible_set_t set = any_set();
    any_voltages();
    ASSUME(u_d_b <= -FAR_b || u_d_b >= FAR_b || u_q_b <= -FAR_b || u_q_b >= FAR_b);
    PROVE(!feasible_holds(&set, ANY_POINT));
    PROOF_END();
}
