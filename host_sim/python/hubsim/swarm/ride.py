# SPDX-License-Identifier: Apache-2.0
"""One drawn run, simulated, as the judge sees it."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from regen_table.schema import Drive

from hubsim import run
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run.results import RunResult
from hubsim.scenario import Scenario
from hubsim.swarm.draw import Case

VEHICLE_SIGNALS = (
    "time_s",
    "driver.drive_nm",
    "driver.brake_nm",
    "vehicle.speed_m_per_s",
    "vehicle.distance_m",
    "vehicle.height_m",
    "battery.current_a",
    "bus.voltage_v",
    "bms.charge_a",
)
WHEEL_SIGNALS = (
    "motor_torque_nm",
    "hydraulic_torque_nm",
    "mode",
    "reason",
    "fault_reason",
    "warning_reason",
    "limit_braking_reason",
    "limit_driving_reason",
    "bridge",
    "command_nm",
    "estimate_nm",
    "hydraulic_command_nm",
    "available_nm",
    "winding_temperature_c",
    "switch_temperature_c",
    "current_d_a",
    "current_q_a",
    "direction",
)
COLLAPSED = "its voltage collapsed"  # what the engine says
PATTERNS = (*VEHICLE_SIGNALS, *(f"wheel*.{name}" for name in WHEEL_SIGNALS))


# Parameters that faults change and the judge needs: what the healthy brakes can still do, and when.
LATER = (
    "brake.torque_loss",
    "fault.hydraulic_flicker_loss",
    "fault.hydraulic_late_s",
    "fault.can_delay_s",
)


class CollapsedError(HubsimError):
    """More power is drawn from the bus than the battery can give."""


class NotStartedError(HubsimError):
    """The controllers do not get to the speed at which a run begins."""


@dataclass(frozen=True)
class Recording:
    """What a run did.

    Attributes
    ----------
    signals : mapping
        Of the vehicle by their names, of the wheels as ``wheel0.name``; shape (rows,).
    parameters : mapping
        Of the simulated world when the run began.
    most : mapping
        What the parameters of LATER are at most, whenever.
    peak_current_a : tuple of float
        Of each wheel, active short circuits apart.
    bus_peak_v : float
        Highest voltage at the bridges.
    residual_j, turned_over_j : float
        The simulation's own energy error, and the sum of all energies given.
    faults : tuple of str
        Names of the faults that the run has.
    """

    drive: Drive
    wheels: int
    signals: Mapping[str, Rows]
    parameters: Mapping[str, float]
    most: Mapping[str, float]
    peak_current_a: tuple[float, ...]
    bus_peak_v: float
    residual_j: float
    turned_over_j: float
    faults: tuple[str, ...] = ()
    duration_s: float = 0.0

    @cached_property
    def time_s(self) -> Rows:
        """Times of the rows, a millisecond apart."""
        return self.signals["time_s"]

    @cached_property
    def speed(self) -> Rows:
        """Over ground, m/s, positive forward."""
        return self.signals["vehicle.speed_m_per_s"]

    def wheel(self, k: int, name: str) -> Rows:
        """Return a signal of a wheel."""
        return self.signals[f"wheel{k}.{name}"]


def scenario_of(case: Case) -> Scenario:
    """Return the scenario of a run, checked as a file is."""
    return Scenario.model_validate(case.data)


def simulated(case: Case) -> Recording:
    """Make a run.

    Raises
    ------
    CollapsedError
        Where the simulated bus collapses: the run cannot go on.
    NotStartedError
        Where the controllers do not come as far as RUN before the run begins.
    """
    drive, scenario = case.drive, scenario_of(case)
    name = f"seed {case.seed}"
    try:
        result = run.simulate(
            name, drive, scenario, Path(), (*PATTERNS, "bus.peak_v", "wheel*.peak_current_a")
        )
    except HubsimError as error:
        collapsed = COLLAPSED in str(error)
        raise (CollapsedError if collapsed else NotStartedError)(str(error)) from error
    return recording_of(result, drive, case)


def most_of(
    parameters: Mapping[str, float], events: Mapping[str, Mapping[str, Any]]
) -> dict[str, float]:
    """Return what the parameters of LATER are at most."""
    return {
        name: max(
            [parameters[name], *(e["set"][name] for e in events.values() if name in e["set"])]
        )
        for name in LATER
    }


def pedals(time_s: Rows, case: Case) -> dict[str, Rows]:
    """Return the pedals over time: the recorded demand is the last one that was sent."""
    return {
        signal: np.interp(time_s, *np.array(case.data[trace], dtype=np.float64).T)
        for signal, trace in (
            ("driver.drive_nm", "drive_trace_nm"),
            ("driver.brake_nm", "demand_trace_nm"),
        )
        if case.data.get(trace)
    }


def recording_of(result: RunResult, drive: Drive, case: Case) -> Recording:
    """Return what the judge looks at."""
    rows = {name: np.ascontiguousarray(result.rows[:, k]) for k, name in enumerate(result.names)}
    rows |= pedals(rows["time_s"], case)
    return Recording(
        drive=drive,
        wheels=result.wheels,
        signals=rows,
        parameters=result.parameters,
        most=most_of(result.parameters, case.data["events"]),
        peak_current_a=tuple(
            float(rows[f"wheel{k}.peak_current_a"][-1]) for k in range(result.wheels)
        ),
        bus_peak_v=float(rows["bus.peak_v"][-1]),
        residual_j=result.energy_j("residual"),
        turned_over_j=result.energy_j("turned_over"),
        faults=case.faults,
        duration_s=result.duration_s,
    )
