/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What controller_slow_step() needs of its caller (PRE): that temperatures of a board, the report
 * of the fast loop and an accepted configuration meet it.
 */
#include "config/fields.h"
#include "core/angle.h"
#include "field_weakening.h"
#include "hal/analog.h"
#include "invariants.h"
#include "transforms.h"
#include "vectors.h"

/* Only names the fields of a relation that does not hold. */
static config_field_t any_field(uint32_t offset_bytes)
{
    (void)offset_bytes;
    config_field_t out;
    return out;
}

#define config_field_at any_field
#include "report.c"
#include "validate.c"

config_t proof_config;

/* Of the ports: the codes of the converter, 4096 less a code where the thermistor hangs on the
 * supply. */
void prove_board_temperatures(void)
{
    static int16_t point_cC[CONFIG_CURVE_POINTS];
    for (int k = 0; k < CONFIG_CURVE_POINTS; k++) {
        point_cC[k] = (int16_t)any_within(-32767, 32767);
    }
    const analog_curve_t curve = {point_cC, any_within(0, 4031), any_within(0, 4031)};
    const int32_t result_cC = analog_curve_cC(&curve, any_within(-65535, 65535));
    PROVE(is_within(result_cC, -100000, 100000));
    PROOF_END();
}

/* i_pu is what transforms_park() gives, in foc.c; the field-weakening current
 * what prove_field_weakening() leaves. */
void prove_reported_currents(void)
{
    static foc_state_t state;
    const ab16_t i = {.v = q_pair(any_within(-32768, 32767), any_within(-32768, 32767))};
    state.period.i_pu = transforms_park(i, any_rotation());
    state.weakening.current_q28 = any_within(-32767 * 8192, 0);
    fast_report_t report;
    foc_report_copy(&state, &report);
    PROVE(is_within(report.i_d_weakening_pu, -32768, 0));
    PROVE(is_within(dq_of(report.i_pu).d, -32768, 32767));
    PROVE(is_within(dq_of(report.i_pu).q, -32768, 32767));
    PROOF_END();
}

/* Every pair of ORDERS that the validator compares: relations_hold() refuses others. */
void prove_accepted_relations(void)
{
    any_configuration();
    config_result_t refusal;
    for (uint32_t k = 0; k < sizeof ORDERS / sizeof ORDERS[0]; k++) {
        ASSUME(order_holds(&proof_config, &ORDERS[k], &refusal));
    }
    PROVE(battery_relations_hold(&proof_config));
    PROVE(derating_relations_hold(&proof_config));
    PROOF_END();
}
