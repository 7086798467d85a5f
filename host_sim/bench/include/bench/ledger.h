/* SPDX-License-Identifier: Apache-2.0 */
/*
 * ledger.h: energy accounts of a run.
 *
 *     chemical = heat + tyre + drag + rolling + climbed + gained + residual
 *
 *     heat     copper, iron, conduction, diode, switching, bearing, hydraulic, battery, cable
 *
 *     gained   kinetic, magnetic, polarisation, bus
 *
 * Sums over all wheels since the start of the run; "gained" may be negative. The residual is the
 * integration error of the simulation. shaft_j is the work of the motors on the wheels, bearing
 * losses deducted, and not part of the balance. turned_over_j is the sum of all energies given by
 * cells, moving mass and height: the reference of the residual.
 */
#ifndef BENCH_LEDGER_H
#define BENCH_LEDGER_H

/* X(name, "meaning") */
#define LEDGER_LIST(X)                                                                             \
    X(chemical_j, "net energy drawn from the battery's cells")                                     \
    X(shaft_j, "work of the motors at the wheels, positive driving")                               \
    X(copper_j, "heat in the windings")                                                            \
    X(iron_j, "heat in the iron")                                                                  \
    X(conduction_j, "heat in the inverters: resistances of switches and diodes")                   \
    X(diode_j, "heat in the inverters: forward voltage of the diodes")                             \
    X(switching_j, "heat in the inverters: switching")                                             \
    X(bearing_j, "heat in bearings and seals")                                                     \
    X(hydraulic_j, "heat in the hydraulic brakes")                                                 \
    X(battery_j, "heat in the battery")                                                            \
    X(drag_j, "work against the air")                                                              \
    X(rolling_j, "work against rolling resistance")                                                \
    X(climbed_j, "potential energy gained")                                                        \
    X(kinetic_j, "kinetic energy gained")                                                          \
    X(magnetic_j, "energy gained by the motors' magnetic fields")                                  \
    X(polarisation_j, "energy gained by the battery's polarisation")                               \
    X(tyre_j, "heat of slipping tyres and energy of their deflection")                             \
    X(cable_j, "heat in the cable between battery and bus")                                        \
    X(bus_j, "energy gained by the bus capacitors")                                                \
    X(turned_over_j, "sum of all energies given by cells, moving mass and height")                 \
    X(residual_j, "integration error of the simulation")

#define LEDGER_MEMBER(name, text) double name;
typedef struct {
    LEDGER_LIST(LEDGER_MEMBER)
} ledger_t;
#undef LEDGER_MEMBER

/* Entry by entry: to += now - before. */
void ledger_add_change(ledger_t *to, const ledger_t *now, const ledger_t *before);

/* What the balance of all other entries leaves over. */
double ledger_residual_j(const ledger_t *ledger);

#endif
