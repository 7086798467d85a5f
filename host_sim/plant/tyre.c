/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/tyre.h"

#include <math.h>

static const double LUMP = 7.0 / 6.0;

double tyre_step(const tyre_params_t *params, tyre_state_t *state, const tyre_contact_t *contact,
                 double step_s)
{
    const double slip = fabs(contact->slip_m_per_s);
    const double stuck_share = exp(-sqrt(slip / params->stribeck_speed_m_per_s));
    const double friction =
        contact->friction * (params->sliding_share + (1.0 - params->sliding_share) * stuck_share);
    const double release_per_s = params->bristle_stiffness_per_m * slip / friction +
                                 LUMP / params->contact_length_m * fabs(contact->rolling_m_per_s);
    const double before_m = state->deflection_m;
    state->deflection_m =
        (before_m + step_s * contact->slip_m_per_s) / (1.0 + step_s * release_per_s);
    const double rate_m_per_s = (state->deflection_m - before_m) / step_s;
    const double mean_m = 0.5 * (before_m + state->deflection_m);
    return contact->load_n * (params->bristle_stiffness_per_m * mean_m +
                              params->bristle_damping_s_per_m * rate_m_per_s);
}

double tyre_stored_j(const tyre_params_t *params, const tyre_state_t *state, double load_n)
{
    return 0.5 * load_n * params->bristle_stiffness_per_m * state->deflection_m *
           state->deflection_m;
}
