# SPDX-License-Identifier: Apache-2.0
"""The tables of a page: energies, criteria, braking quality; a column for each run."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hubsim.report import markup, quality, reading
from hubsim.report.markup import Markup, element, join
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
    summary_share = reading.as_number(run.summary.get("braking_share_stored"))
    work = reading.energy_j(run, "braking_at_wheels")
    return (
        summary_share
        if math.isfinite(summary_share) or not work > 0.0
        else reading.energy_j(run, "battery_returned") / work
    )


def optimum_share(run: RunLike, runs: Sequence[RunLike]) -> float:
    """Return what a run returned relative to the series optimum of its cycle, or NaN."""
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


def limits_cost(ideal: Mapping[str, Any]) -> str:
    """Return what each limit of the drive costs an ideal stop, as a sentence; empty without one."""
    costs = ideal.get("limits_cost_j")
    if not isinstance(costs, Mapping) or not costs:
        return ""
    listed = ", ".join(f"{name} {reading.as_number(j) / 1e3:.2f} kJ" for name, j in costs.items())
    return f" It would store more without one of these limits: {listed}."


def _ideal_j(ideal: Mapping[str, Any], name: str) -> float:
    """Return an energy of an ideal stop; its braking work is without the bearings' friction."""
    energies = ideal["energy_j"]
    if name == "braking_at_wheels":
        kinetic = reading.as_number(ideal.get("kinetic_energy_j"))
        return kinetic - reading.as_number(energies.get("friction"))
    return reading.as_number(energies.get(name))


def energies(runs: Sequence[RunLike], caption: str) -> Markup:
    """Make the table of one cycle; it scrolls sideways on a narrow screen."""
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
            [markup.fixed(reading.energy_j(run, row.energy) / 1e3, decimals) for run in runs]
            + ([markup.fixed(_ideal_j(ideal, row.energy) / 1e3, decimals)] if ideal else []),
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
        markup.small_percent(reading.as_number(run.summary.get("residual_relative"))).removesuffix(
            " %"
        )
        for run in runs
    ]
    residuals += [markup.UNKNOWN] if ideal else []
    shares.append(
        _row(
            "Residual",
            "sources less sinks less storage, over the energy turned over: the simulation's own "
            "error",
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
    return markup.percent(share).removesuffix(" %")


def _row(title: str, meaning: str, unit: str, values: list[str], style: str) -> Markup:
    name = element(
        "th",
        element("span", title, class_="name"),
        element("span", meaning, class_="meaning"),
        scope="row",
    )
    cells = [element("td", value) for value in values]
    return element("tr", name, element("td", unit, class_="unit"), *cells, class_=style or None)


# What a criterion without words of its own is called, and what evaluation.py writes of reasons.
_NAMED = {"no_fault": "no controller finds a fault", "says_why": "the controllers say why"}
_SEEN = "seen: "


def criteria(runs: Sequence[RunLike], caption: str) -> Markup:
    """Make the table of criteria; nothing where the scenario has none."""
    found = [{str(one["name"]): one for one in reading.criteria(run)} for run in runs]
    names = list(dict.fromkeys(name for run in found for name in run))
    if not names:
        return Markup("")
    heads = [element("th", reading.strategy(run).title, scope="col") for run in runs]
    head = element("tr", element("th", "What it must show", scope="col"), *heads)
    body = [_criterion(name, [run.get(name) for run in found]) for name in names]
    table = element(
        "table",
        element("caption", f"{caption}: {_counted(found)}"),
        element("thead", head),
        element("tbody", *body),
    )
    return element(
        "div", table, class_="scroll criteria", role="region", aria_label=caption, tabindex="0"
    )


def _counted(found: Sequence[Mapping[str, Mapping[str, Any]]]) -> str:
    every = [one for run in found for one in run.values() if one.get("applies", True)]
    met = sum(one.get("passed") is True for one in every)
    return f"{met} of {len(every)} criteria met"


def _criterion(name: str, results: Sequence[Mapping[str, Any] | None]) -> Markup:
    """Make a row: the criterion in words, what is accepted, and a result for each run."""
    known = [one for one in results if one is not None]
    text = next((str(one["text"]) for one in known if one.get("text")), "")
    called = text or _NAMED.get(name) or name.replace("_", " ")
    limits = list(dict.fromkeys(_limits(one) for one in known))
    shared = limits[0] if len(limits) == 1 else ""
    heading = element(
        "th",
        element("span", called[0].upper() + called[1:], class_="name"),
        element("span", shared, class_="meaning") if shared else "",
        scope="row",
    )
    return element(
        "tr", heading, *[_cell(one, "" if shared else _limits(one or {})) for one in results]
    )


def _cell(one: Mapping[str, Any] | None, limits: str) -> Markup:
    if one is None:
        return element("td", markup.UNKNOWN)
    remark = str(one.get("remark") or "")
    if not one.get("applies", True):
        return element("td", element("span", remark, class_="meaning"))
    passed = one.get("passed") is True
    parts = [
        element("span", "met" if passed else "not met", class_="met" if passed else "missed"),
        element("span", _value(one), class_="figure") if not _of_reasons(one) else Markup(""),
    ]
    if limits:
        parts.append(element("span", limits, class_="meaning"))
    if remark and not (passed and _of_reasons(one)):
        parts.append(element("span", remark, class_="meaning"))
    return element("td", join(*filter(None, parts)))


def _of_reasons(one: Mapping[str, Any]) -> bool:
    """Return whether a criterion counts reasons, which say more in words."""
    return _SEEN in str(one.get("remark") or "")


def _value(one: Mapping[str, Any]) -> str:
    value = reading.as_number(one.get("value"))
    return f"{markup.figure(value)}{_unit(one)}" if math.isfinite(value) else markup.UNKNOWN


def _unit(one: Mapping[str, Any]) -> str:
    unit = markup.unit(str(one.get("unit") or ""))
    return f" {unit}" if unit else ""


def _limits(one: Mapping[str, Any]) -> str:
    """Write the accepted range with its unit."""
    low, high = (reading.as_number(one.get(key)) for key in ("at_least", "at_most"))
    if _of_reasons(one):
        return ""
    if math.isfinite(low) and math.isfinite(high):
        return f"{markup.figure(low)} to {markup.figure(high)}{_unit(one)}"
    if math.isfinite(low):
        return f"at least {markup.figure(low)}{_unit(one)}"
    return f"at most {markup.figure(high)}{_unit(one)}" if math.isfinite(high) else ""


def braking_quality(runs: Sequence[RunLike], caption: str) -> Markup:
    """Make the table of braking quality; nothing where nothing is known of it."""
    errors = [quality.while_braking(run, quality.torque_error_nm(run)) for run in runs]
    every_jerk = [quality.jerk_m_per_s3(run) for run in runs]
    jerks = [quality.while_braking(run, jerk) for run, jerk in zip(runs, every_jerk, strict=True)]
    stops = [quality.at_the_stop(run, jerk) for run, jerk in zip(runs, every_jerk, strict=True)]
    if all(values is None for values in (*errors, *jerks)):
        return Markup("")
    rows = (
        (
            "Total torque error",
            "motor and hydraulic brake together less the demand, root mean square",
            "N·m",
            errors,
            quality.root_mean_square,
        ),
        (
            "Largest total torque error",
            "for a moment, where demand or hand-over change",
            "N·m",
            errors,
            quality.largest,
        ),
        (
            "Jerk",
            "change of deceleration in a second, root mean square",
            "m/s³",
            jerks,
            quality.root_mean_square,
        ),
        ("Largest jerk under way", "for a moment, above 0.3 m/s", "m/s³", jerks, quality.largest),
        (
            "Largest jerk at the stop",
            "from sample to sample, the last 0.3 m/s and the standstill",
            "m/s³",
            stops,
            quality.largest,
        ),
        (
            "Jolt at the stop",
            "deceleration that ends at once with the motion: rolling, and brakes not eased",
            "m/s²",
            [quality.left_at_the_stop_m_per_s2(run) for run in runs],
            quality.largest,
        ),
    )
    body = []
    for title, meaning, unit, found, figure in rows:
        name = element(
            "th",
            element("span", title, class_="name"),
            element("span", meaning, class_="meaning"),
            scope="row",
        )
        cells = [
            element(
                "td",
                markup.significant(value)
                if math.isfinite(value := figure(values))
                else markup.UNKNOWN,
            )
            for values in found
        ]
        body.append(element("tr", name, element("td", unit, class_="unit"), *cells))
    names = [element("th", reading.strategy(run).title, scope="col") for run in runs]
    head = element(
        "tr",
        element("th", "While the driver brakes", scope="col"),
        element("th", "Unit", scope="col"),
        *names,
    )
    table = element(
        "table", element("caption", caption), element("thead", head), element("tbody", *body)
    )
    return element("div", table, class_="scroll", role="region", aria_label=caption, tabindex="0")
