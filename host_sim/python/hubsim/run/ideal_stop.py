# SPDX-License-Identifier: Apache-2.0
"""The ideal stop beside a simulated one: same demand, strategy and limits, and no delay."""

from collections.abc import Collection, Mapping
from typing import Any

from regen_table import STOP_LIMITS, limited_stop
from regen_table.errors import ConfigurationError
from regen_table.limited_stop import LimitedStop
from regen_table.schema import Drive

from hubsim.scenario import Scenario

AT_WORK_SHARE = 0.001  # of the energy, which a limit leaves to the hydraulic brake


def ideal_of(drive: Drive, scenario: Scenario) -> dict[str, Any]:
    """Return the ideal stop that a run is to be compared with, as JSON holds it.

    The same braking demand, initial speed, winding temperature and state of charge under the same
    strategy and the limits of the drive's file (STOP_LIMITS), without air drag, rolling resistance
    and delay, the battery at rest before the stop. ``limits_cost_j``: what each limit costs, the
    energy that the stop would store more without this one alone. Empty where the scenario is no
    stop at constant demand, or the motor does not turn that fast.
    """
    constant = scenario.demand_trace_nm is None and not scenario.follows and not scenario.events
    forwards = scenario.initial_speed_kmh > 0.0 and scenario.stop_at_standstill
    if not (constant and forwards and scenario.demand_nm > 0.0 and scenario.slope_percent == 0.0):
        return {}

    def inside(limits: Collection[str]) -> LimitedStop:
        return limited_stop.stop(
            drive,
            drive.brake.strategy,
            scenario.demand_nm,
            scenario.initial_speed_kmh,
            scenario.winding_temperature_c,
            scenario.initial_soc,
            limits,
        )

    try:
        found = inside(STOP_LIMITS)
        least_j = AT_WORK_SHARE * found.kinetic_energy_j
        returned_j = found.energy_j.battery_returned
        cost_j = {
            name: inside(set(STOP_LIMITS) - {name}).energy_j.battery_returned - returned_j
            for name in STOP_LIMITS
            if found.hydraulic_by_reason_j.get(name, 0.0) > least_j
        }
    except ConfigurationError:
        return {}
    return found.as_dict() | {
        "limits": list(found.limits),
        "limits_cost_j": {name: joule for name, joule in cost_j.items() if joule > least_j},
    }


def ideal_share(stop: Mapping[str, Any]) -> float | None:
    """Return the share of the braking work that an ideal stop stores, None without a stop.

    Braking work as in a run: what motors and hydraulic brakes take from the motion, so without the
    bearings' friction.
    """
    energies = stop.get("energy_j")
    if not isinstance(energies, Mapping):
        return None
    work = float(stop["kinetic_energy_j"]) - float(energies["friction"])
    return float(energies["battery_returned"]) / work if work > 0.0 else None


def stored_share(drive: Drive, scenario: Scenario) -> float:
    """Return the share of the kinetic energy that the ideal stop stores; NaN without one."""
    return float(ideal_of(drive, scenario).get("stored_share_of_kinetic", float("nan")))
