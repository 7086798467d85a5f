# SPDX-License-Identifier: Apache-2.0
"""The criteria of a scenario with their values, limits and results, a column for each run."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from hubsim.report import reading, words
from hubsim.report.markup import Markup, element, join
from hubsim.report.reading import RunLike


def draw(runs: Sequence[RunLike], caption: str) -> Markup:
    """Make the table of criteria; nothing where the scenario has none."""
    found = [{str(one["name"]): one for one in reading.criteria(run)} for run in runs]
    names = list(dict.fromkeys(name for run in found for name in run))
    if not names:
        return Markup("")
    heads = [element("th", reading.strategy(run).title, scope="col") for run in runs]
    head = element(
        "tr",
        element("th", "Criterion", scope="col"),
        element("th", "Unit", scope="col"),
        element("th", "Accepted", scope="col"),
        *heads,
    )
    body = [_row(name, [run.get(name) for run in found]) for name in names]
    table = element(
        "table",
        element("caption", f"{caption}: {_count(found)}"),
        element("thead", head),
        element("tbody", *body),
    )
    return element(
        "div", table, class_="scroll criteria", role="region", aria_label=caption, tabindex="0"
    )


def _count(found: Sequence[Mapping[str, Mapping[str, Any]]]) -> str:
    every = [one for run in found for one in run.values()]
    met = sum(one.get("passed") is True for one in every)
    return f"{met} of {len(every)} criteria met"


def _row(name: str, results: Sequence[Mapping[str, Any] | None]) -> Markup:
    known = [one for one in results if one is not None]
    text = next((str(one["text"]) for one in known if one.get("text")), "")
    title = name.replace("_", " ")
    heading = element(
        "th",
        element("span", title[0].upper() + title[1:], class_="name"),
        element("span", text, class_="meaning"),
        scope="row",
    )
    unit = next((str(one["unit"]) for one in known if one.get("unit")), "")
    limits = list(dict.fromkeys(_limits(one) for one in known))
    shared = limits[0] if len(limits) == 1 else ""
    cells = [_cell(one, "" if shared else _limits(one or {})) for one in results]
    return element(
        "tr",
        heading,
        element("td", words.unit(unit), class_="unit"),
        element("td", shared, class_="limits"),
        *cells,
    )


def _cell(one: Mapping[str, Any] | None, limits: str) -> Markup:
    if one is None:
        return element("td", words.UNKNOWN)
    passed = one.get("passed") is True
    value = reading.as_number(one.get("value"))
    shown = words.figure(value) if math.isfinite(value) else words.UNKNOWN
    remark = str(one.get("remark") or "")
    parts = [
        element("span", shown, class_="figure"),
        element("span", "met" if passed else "not met", class_="met" if passed else "missed"),
    ]
    if limits:
        parts.append(element("span", limits, class_="meaning"))
    if remark:
        parts.append(element("span", remark, class_="meaning"))
    return element("td", join(*parts))


def _limits(one: Mapping[str, Any]) -> str:
    """Write the accepted range."""
    low, high = (reading.as_number(one.get(key)) for key in ("at_least", "at_most"))
    if math.isfinite(low) and math.isfinite(high):
        return f"{words.figure(low)} to {words.figure(high)}"
    if math.isfinite(low):
        return f"at least {words.figure(low)}"
    return f"at most {words.figure(high)}" if math.isfinite(high) else ""
