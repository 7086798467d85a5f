# SPDX-License-Identifier: Apache-2.0
"""The energy table: one row for each account with its meaning, one column for each strategy."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hubsim.report import reading, words
from hubsim.report.markup import Markup, element
from hubsim.report.reading import OPTIMUM, RunLike


@dataclass(frozen=True)
class Row:
    """One account. ``energy`` names an entry of ``energy_j``.

    Other rows have a function of their own.
    """

    title: str
    meaning: str
    energy: str = ""
    style: str = ""


ROWS = (
    Row("Traction", "drawn from the battery's cells while the driver does not brake", "traction"),
    Row(
        "Braking work at the wheels",
        "what motors and hydraulic brakes take from the motion while the driver brakes",
        "braking_at_wheels",
    ),
    Row(
        "Returned to the battery",
        "into the cells while the driver brakes",
        "battery_returned",
        "battery",
    ),
    Row("Hydraulic heat", "in the friction brakes", "hydraulic", "hydraulic"),
    Row("Copper loss", "heat in the windings", "copper", "losses"),
    Row("Iron loss", "heat in the motors' iron", "iron", "losses"),
    Row("Inverter loss", "conduction, diodes and switching", "inverter", "losses"),
    Row("Battery loss", "heat in its resistances", "battery", "losses"),
)
FULL_DIGITS_KJ = 1e3  # up to here two decimals, beyond one


def decimals_of(runs: Sequence[RunLike]) -> int:
    """Return the decimals of the energies in kJ, the same in the whole table so that they align."""
    known = [abs(reading.energy_j(run, row.energy)) / 1e3 for run in runs for row in ROWS]
    largest = max((value for value in known if math.isfinite(value)), default=0.0)
    return 2 if largest < FULL_DIGITS_KJ else 1 if largest < 10.0 * FULL_DIGITS_KJ else 0


def stored_share(run: RunLike) -> float:
    """Return the share of the braking work that the battery got back.

    Worked out where the run does not say.
    """
    said = reading.as_number(run.summary.get("braking_share_stored"))
    work = reading.energy_j(run, "braking_at_wheels")
    return (
        said
        if math.isfinite(said) or not work > 0.0
        else reading.energy_j(run, "battery_returned") / work
    )


def optimum_share(run: RunLike, runs: Sequence[RunLike]) -> float:
    """Return what this run returned relative to the series optimum of the same cycle, NaN without one."""
    best = next(
        (
            reading.energy_j(other, "battery_returned")
            for other in runs
            if other.strategy == OPTIMUM
        ),
        math.nan,
    )
    return reading.energy_j(run, "battery_returned") / best if best > 0.0 else math.nan


def ideal_share(ideal: Mapping[str, Any]) -> float:
    """Return the share of the braking work that an ideal stop stores, NaN where it is not known."""
    work = _ideal_j(ideal, "braking_at_wheels")
    return _ideal_j(ideal, "battery_returned") / work if work > 0.0 else math.nan


def _ideal_j(ideal: Mapping[str, Any], name: str) -> float:
    """Return an energy of an ideal stop; its braking work is without the bearings' friction."""
    energies = ideal["energy_j"]
    if name == "braking_at_wheels":
        kinetic = reading.as_number(ideal.get("kinetic_energy_j"))
        return kinetic - reading.as_number(energies.get("friction"))
    return reading.as_number(energies.get(name))


def draw(runs: Sequence[RunLike], caption: str) -> Markup:
    """Make the table of one cycle, in a container that scrolls sideways where the screen is narrow."""
    decimals = decimals_of(runs)
    ideal = reading.ideal(runs[0]) if len(runs) == 1 else {}
    names = [element("th", reading.strategy(run).title, scope="col") for run in runs]
    names += [element("th", "Ideal stop", scope="col")] if ideal else []
    head = element(
        "thead",
        element(
            "tr",
            element("th", "Energy over the whole run", scope="col"),
            element("th", "Unit", scope="col"),
            *names,
        ),
    )
    body = [
        _row(
            row.title,
            row.meaning,
            "kJ",
            [words.fixed(reading.energy_j(run, row.energy) / 1e3, decimals) for run in runs]
            + ([words.fixed(_ideal_j(ideal, row.energy) / 1e3, decimals)] if ideal else []),
            row.style,
        )
        for row in ROWS
    ]
    rates: list[tuple[str, str, list[float]]] = [
        (
            "Share stored",
            "returned over braking work",
            [stored_share(run) for run in runs] + ([ideal_share(ideal)] if ideal else []),
        )
    ]
    if ideal:
        share = stored_share(runs[0]) / ideal_share(ideal)
        rates.append(("Share of the ideal", "share stored over that of the ideal", [share, 1.0]))
    elif len(runs) > 1:
        rates.append(
            (
                "Share of the series optimum",
                "returned over what the series strategy returns",
                [optimum_share(run, runs) for run in runs],
            )
        )
    shares = [
        _row(title, meaning, "%", [_percent(value) for value in values], "share")
        for title, meaning, values in rates
    ]
    residuals = [
        words.small_percent(reading.as_number(run.summary.get("residual_relative"))).removesuffix(
            " %"
        )
        for run in runs
    ]
    residuals += [words.UNKNOWN] if ideal else []
    shares.append(
        _row(
            "Residual",
            "sources less sinks less storage, over the energy turned over: the simulation's own error",
            "%",
            residuals,
            "quiet",
        )
    )
    table = element(
        "table",
        element("caption", caption),
        head,
        element("tbody", *body),
        element("tbody", *shares),
    )
    return element("div", table, class_="scroll", role="region", aria_label=caption, tabindex="0")


def _percent(share: float) -> str:
    return words.percent(share).removesuffix(" %")


def _row(title: str, meaning: str, unit: str, values: list[str], style: str) -> Markup:
    name = element(
        "th",
        element("span", title, class_="name"),
        element("span", meaning, class_="meaning"),
        scope="row",
    )
    cells = [element("td", value) for value in values]
    return element("tr", name, element("td", unit, class_="unit"), *cells, class_=style or None)
