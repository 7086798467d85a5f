# SPDX-License-Identifier: Apache-2.0
"""Priorities, lost demands, starts, low bus and limits at the edges of braking.

Every kind of event (``runs``) with every drive that comes along and every rotor sensor, a Latin
hypercube of speeds, torques and battery voltages each; ``judges`` says what is right. Exit status 1
if a run is not as it should be.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from hubsim import reasons
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.sweep import drives
from matplotlib.figure import Figure
from regen_table import plotting
from studies.common import Study, markdown, percent
from studies.edges import runs
from studies.edges.judges import (
    BUS,
    FAULT,
    I_D,
    I_Q,
    JUDGES,
    MODE,
    REASON,
    WARNING,
    Finding,
    current_limit_share,
)  # fmt: skip
from studies.edges.runs import Case, drive_of

SHOWN = 1.5  # of what is accepted: what lies beyond is drawn on the edge
NOT_STARTED = "NOT_STARTED"


@dataclass(frozen=True)
class Outcome:
    """What a run did.

    Attributes
    ----------
    expected_nm, torque_nm : float
        Motor torque after the event.
    off_nm : float
        How far the torque is from what it must be.
    late_s, full_s : float
        When the torque that must go is gone, and when the one that must come is there.
    current_share, current_limit_share, bus_share : float
        Largest phase current of its limit, what is accepted of it (beyond 1.05 only what diodes
        carry where PWM cannot hold the voltage), largest bus voltage of the devices' rating.
    """

    number: int
    kind: str
    drive: str
    sensor: str
    speed_share: float
    slope_percent: float
    drive_nm: float
    brake_nm: float
    motor_share: float
    soc: float
    open_circuit_v: float
    winding_c: float
    expected_nm: float
    torque_nm: float
    off_nm: float
    off_limit_nm: float
    late_s: float
    late_limit_s: float
    full_s: float
    full_limit_s: float
    current_share: float
    current_limit_share: float
    bus_share: float
    mode: int
    reason: str
    warning: str
    first_fault: str

    @property
    def within(self) -> bool:
        """Whether the run is as it should be."""
        return (
            self.off_nm <= self.off_limit_nm
            and self.late_s <= self.late_limit_s
            and self.full_s <= self.full_limit_s
            and self.current_share <= self.current_limit_share
            and self.bus_share < 1.0
            and not self.first_fault
        )


def measure(number: int, case: Case) -> Outcome:
    """Simulate one run and judge it."""
    drive = drive_of(case.drive, case.sensor, case.kind)
    try:
        rows = runs.simulated(case)
    except HubsimError:  # the controllers do not get to the speed without a fault
        return _outcome(number, case, np.zeros((1, len(runs.SIGNALS))), Finding(), NOT_STARTED)
    fault = reasons.shown(rows[-1, FAULT])
    return _outcome(number, case, rows, JUDGES[case.kind](drive, case, rows), fault)


def _outcome(number: int, case: Case, rows: Rows, found: Finding, fault: str) -> Outcome:
    drive = drive_of(case.drive, case.sensor, case.kind)
    rating = drive.inverter.device_voltage_v or math.inf
    return Outcome(
        number=number,
        **asdict(case),
        **asdict(found),
        current_share=float(np.hypot(rows[:, I_D], rows[:, I_Q]).max())
        / drive.motor.max_phase_current_a,
        current_limit_share=current_limit_share(drive, case, rows),
        bus_share=float(rows[:, BUS].max()) / rating,
        mode=int(rows[-1, MODE]),
        reason=reasons.shown(rows[-1, REASON]),
        warning=reasons.shown(rows[-1, WARNING]),
        first_fault=fault,
    )


def summary(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what there is to say, a line for each kind and each run that misses."""
    lines = []
    for kind in dict.fromkeys(o.kind for o in outcomes):
        here = [o for o in outcomes if o.kind == kind]
        offs = ", ".join(
            f"{name} {max(o.off_nm for o in here if o.drive == name):.2f}"
            for name in dict.fromkeys(o.drive for o in here)
        )
        lines.append(
            f"{kind}: {sum(o.within for o in here)} of {len(here)} runs within; off at most "
            f"{offs} N m; gone after {1e3 * max(o.late_s for o in here):.0f} ms at most; phase "
            f"current at most {max(o.current_share for o in here):.2f} of its limit, bus "
            f"{max(o.bus_share for o in here):.2f} of the rating; "
            f"{sum(bool(o.first_fault) for o in here)} with a fault"
        )
    lines.extend(f"misses: {described(o)}" for o in outcomes if not o.within)
    return lines


def described(o: Outcome) -> str:
    """Return one run in words."""
    return (
        f"run {o.number}, {o.kind}, {o.drive}, {o.sensor}, {o.speed_share:.0%} of the largest "
        f"speed, {o.open_circuit_v:.1f} V, drive {o.drive_nm:.1f}, brake {o.brake_nm:.1f} N m, "
        f"winding {o.winding_c:.0f} degC: expected {o.expected_nm:.2f}, torque {o.torque_nm:.2f}, "
        f"off {o.off_nm:.2f} of {o.off_limit_nm:.2f} N m, late {o.late_s:.3f} of "
        f"{o.late_limit_s:.3f} s, full {o.full_s:.3f} of {o.full_limit_s:.3f} s, current "
        f"{o.current_share:.2f} of {o.current_limit_share:.2f}, "
        f"{o.first_fault or o.warning or o.reason or 'no limit'}"
    )


def tables(outcomes: Sequence[Outcome]) -> dict[str, str]:
    """Return the table of the page: a line for each kind of event."""
    rows = []
    for kind in dict.fromkeys(o.kind for o in outcomes):
        here = [o for o in outcomes if o.kind == kind]
        rows.append(
            (
                f"`{kind}`",
                f"{sum(o.within for o in here)} of {len(here)}",
                f"{max(o.off_nm for o in here):.2f}",
                percent(max(used_share(o, False) for o in here)),
                f"{1e3 * max(o.late_s for o in here):.0f}",
                percent(max(used_share(o, True) for o in here)),
                f"{max(o.current_share for o in here):.2f}",
                f"{max(o.bus_share for o in here):.2f}",
            )
        )
    columns = (
        "kind",
        "within",
        "off at most, N m",
        "of the accepted",
        "gone after, ms",
        "of the accepted time",
        "phase current",
        "bus",
    )
    return {"kinds": markdown(columns, rows)}


def figure(outcomes: Sequence[Outcome]) -> Figure:
    """Draw what is used of each kind's tolerance over speed, a panel for each drive."""
    names = list(dict.fromkeys(o.drive for o in outcomes))
    made, panels = plotting.figure(
        "Share of what is accepted over speed", 2, (len(names) + 1) // 2, 10.0, 7.0
    )
    groups = (("unasked or missing torque", False), ("time", True))
    for name, axes in zip(names, panels, strict=False):
        here = [o for o in outcomes if o.drive == name]
        for (text, in_time), colour in zip(groups, (plotting.BLUE, plotting.ORANGE), strict=True):
            used = [used_share(o, in_time) for o in here]
            axes.plot([o.speed_share for o in here], used, ".", color=colour, label=text)
        axes.axhline(1.0, color="gray", linewidth=0.8)
        axes.set(title=name, xlabel="share of the largest speed", ylabel="of the accepted")
        axes.set_ylim(0.0, SHOWN)
    plotting.legend_below(made, panels[0], 2)
    return made


def used_share(o: Outcome, in_time: bool) -> float:
    """Return what a run uses of its tolerance in torque or in time, at most SHOWN."""
    pairs = (
        ((o.late_s, o.late_limit_s), (o.full_s, o.full_limit_s))
        if in_time
        else ((o.off_nm, o.off_limit_nm),)
    )
    return min(max(max(a, 0.0) / b if b > 0.0 else 0.0 for a, b in pairs), SHOWN)


STUDY = Study(
    name="edges",
    text=__doc__,
    outcome=Outcome,
    cases=lambda options: runs.draw(drives.DRIVES, options.count, options.seed),
    measure=measure,
    summary=summary,
    figure=figure,
    tables=tables,
    holds=lambda outcomes: all(o.within for o in outcomes),
    count=720,
)
main = STUDY.main
