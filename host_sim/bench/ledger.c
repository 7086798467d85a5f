/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/ledger.h"

void ledger_add_change(ledger_t *to, const ledger_t *now, const ledger_t *before)
{
#define ADD_CHANGE(name, text) to->name += now->name - before->name;
    LEDGER_LIST(ADD_CHANGE)
#undef ADD_CHANGE
}

double ledger_residual_j(const ledger_t *l)
{
    const double heat_j = l->copper_j + l->iron_j + l->conduction_j + l->diode_j + l->switching_j +
                          l->bearing_j + l->hydraulic_j + l->battery_j + l->cable_j + l->tyre_j;
    const double gained_j =
        l->climbed_j + l->kinetic_j + l->magnetic_j + l->polarisation_j + l->bus_j;
    return l->chemical_j - heat_j - l->drag_j - l->rolling_j - gained_j;
}
