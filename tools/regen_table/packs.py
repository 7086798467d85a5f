# SPDX-License-Identifier: Apache-2.0
"""What a trace of power does to the battery.

Its RC branch settled at every instant, or as the state that it is.

A settled branch is the steady state, R_s + R_t in series, right where the power changes slowly
against R_t C_t. A stop is over long before that: a branch at rest takes next to no loss at first,
so a settled one understates what a stop returns.

Neither moves the optimum. Let w = -u_c be the branch's overvoltage while charging and q the
charging current, so that C_t dw/dt = q - w/R_t and q grows with the returned power p and falls with
w. If one trace returns at least as much power at every instant as another, dw/dt is at least as
large at equal w, so w never falls below the other's (the comparison theorem for one equation of
first order). The charge is the integral of q = C_t w(end) + integral of w/R_t, hence at least the
other's too: for a given speed trace the torque of least power at every instant stores most,
whatever the branch does.
"""

from dataclasses import dataclass

import numpy as np

from regen_table import BATTERIES, DYNAMIC, SETTLED, models
from regen_table.models import Array
from regen_table.schema import Drive

__all__ = ["BATTERIES", "DYNAMIC", "SETTLED", "Flow", "dynamic", "flow"]


@dataclass(frozen=True)
class Flow:
    """Energies of a trace in J, positive out of the cells.

    chemical = terminal + heat + what is left in C_t at the end.

    What is left in C_t becomes heat in R_t afterwards.
    """

    chemical_j: float
    heat_j: float
    left_in_branch_j: float


def flow(
    drive: Drive, battery: str, power_w: Array, seconds: Array, soc: float | None = None
) -> Flow:
    """Carry a trace of mean powers (W at the terminals, shape (steps,)) over as many seconds each.

    One of BATTERIES.
    """
    open_circuit_v, pack = models.open_circuit_voltage_v(drive, soc), drive.battery
    if battery == SETTLED:
        steady = models.battery_steady(
            open_circuit_v, pack.series_resistance_ohm + pack.polarisation_resistance_ohm, power_w
        )
        return Flow(
            float(np.sum(steady.chemical_power_w * seconds)),
            float(np.sum(steady.loss_w * seconds)),
            0.0,
        )
    branch = (pack.polarisation_resistance_ohm, pack.polarisation_capacitance_f)
    return dynamic(open_circuit_v, pack.series_resistance_ohm, branch, power_w, seconds)


def dynamic(
    open_circuit_v: float,
    series_ohm: float,
    branch: tuple[float, float],
    power_w: Array,
    seconds: Array,
) -> Flow:
    """Carry a trace through a pack whose RC branch (R_t in ohm, C_t in F) begins at rest.

    The current is constant within a step and gives the requested energy of the step. With
    x = h / (R_t C_t) and g = (1 - exp(-x)) / x the branch's mean voltage is then exactly g u_c + (1
    - g) R_t i, which makes the step a steady state behind u_oc - g u_c and R_s + (1 - g) R_t. It
    balances to rounding for any step: a long one is the settled branch.
    """
    resistance, capacitance = branch
    share = (
        np.asarray(seconds) / (resistance * capacitance)
        if resistance > 0.0
        else np.full(np.shape(seconds), np.inf)
    )
    decays, means = (
        np.exp(-share),
        np.divide(-np.expm1(-share), share, out=np.ones_like(share), where=share > 0.0),
    )
    voltage = chemical = heat = 0.0
    for power, step, decay, mean in zip(power_w, seconds, decays, means, strict=True):
        internal_ohm = series_ohm + (1.0 - mean) * resistance
        current = float(
            models.battery_steady(open_circuit_v - mean * voltage, internal_ohm, power).current_a
        )
        chemical += open_circuit_v * current * step
        heat += (
            (series_ohm * current + mean * voltage + (1.0 - mean) * resistance * current)
            * current
            * step
        )
        voltage = decay * voltage + (1.0 - decay) * resistance * current
    left = 0.5 * capacitance * voltage * voltage
    return Flow(float(chemical), float(heat - left), float(left))
