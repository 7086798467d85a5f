/*
 * Between the boxes of the fast reach: what becomes of a command.
 */
#include "foc/foc.h"
#include "proof.h"

static current_loop_tuning_t no_tuning(void)
{
    const current_loop_tuning_t out = {.w_psi_q25 = 0};
    return out;
}

/* The limiter of the current vector: any command and any field weakening in the paper's circle and the largest. What the circle
 * leaves of q beside any d is proved of circle_other(). */
void prove_reference(void)
{
    static foc_state_t state;
    const int32_t radius = nondet_bool() ? 14895 : Q15_ONE;
    state.current_circle = circle_init(radius);
    state.weakening.current_q28 = any_within(-32767 * 8192, 0);
    state.current.dead_time.reference_pu.d = any_within(-32768, 32768);
    state.current.dead_time.reference_pu.q = any_within(-32768, 32768);
    state.current.dead_time.behind_pu.d = any_within(-65536, 65536);
    state.current.dead_time.behind_pu.q = any_within(-65536, 65536);
    const foc_command_t command = {
        .number = nondet_uint16(),
        .i_reference_pu = {.d = nondet_int16(), .q = nondet_int16()},
        .tuning = no_tuning(),
    };
    foc_period_t period;
    foc_follow(&state, &command, &period);
    const dq_t reference = period.i_reference_pu;
    PROMISE(reference.d >= -radius && reference.d <= radius);
    PROMISE(command.i_reference_pu.q >= 0 ? reference.q >= 0 && reference.q <= command.i_reference_pu.q
                                          : reference.q <= 0 && reference.q >= command.i_reference_pu.q);
    PROMISE(state.followed == command.number);
    PROOF_END();
}
