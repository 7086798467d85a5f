/* SPDX-License-Identifier: Apache-2.0 */
/* Energy accounts: residual, and sum of changes. */
#include "bench/ledger.h"

#include <string.h>

#include "unity.h"

enum { ENTRIES = sizeof(ledger_t) / sizeof(double) };

void setUp(void) {}

void tearDown(void) {}

/* Every entry is a different power of two, so a sum identifies its entries. */
static ledger_t distinct(void)
{
    double values[ENTRIES];
    for (int k = 0; k < ENTRIES; k++) {
        values[k] = (double)(1 << k);
    }
    ledger_t out;
    memcpy(&out, values, sizeof(out));
    return out;
}

void test_the_residual_is_drawn_energy_minus_sinks_and_stored_energy(void)
{
    ledger_t l = distinct();
    const double sinks_j = l.copper_j + l.iron_j + l.conduction_j + l.diode_j + l.switching_j +
                           l.bearing_j + l.hydraulic_j + l.battery_j + l.drag_j + l.rolling_j +
                           l.climbed_j + l.kinetic_j + l.magnetic_j + l.polarisation_j + l.cable_j +
                           l.bus_j + l.tyre_j;
    TEST_ASSERT_EQUAL_DOUBLE(l.chemical_j - sinks_j, ledger_residual_j(&l));
    l.chemical_j = sinks_j;
    TEST_ASSERT_EQUAL_DOUBLE(0.0, ledger_residual_j(&l));
}

void test_intermediate_work_does_not_enter_the_balance(void)
{
    ledger_t l = distinct();
    const double before_j = ledger_residual_j(&l);
    l.shaft_j += 1e6;
    l.turned_over_j += 1e6;
    l.residual_j += 1e6;
    TEST_ASSERT_EQUAL_DOUBLE(before_j, ledger_residual_j(&l));
}

void test_a_change_is_added_entry_by_entry(void)
{
    const ledger_t now = distinct();
    ledger_t before;
    memset(&before, 0, sizeof(before));
    ledger_t sum = distinct();
    ledger_add_change(&sum, &now, &before);
    ledger_add_change(&sum, &before, &before);
    double values[ENTRIES];
    memcpy(values, &sum, sizeof(values));
    for (int k = 0; k < ENTRIES; k++) {
        TEST_ASSERT_EQUAL_DOUBLE(2.0 * (double)(1 << k), values[k]);
    }
}
