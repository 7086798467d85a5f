# SPDX-License-Identifier: Apache-2.0
"""The page: a section for each cycle with a column for each strategy, all in one file."""

import math
from collections.abc import Sequence
from pathlib import Path

from hubsim.report import (
    fault_record,
    flows,
    lanes,
    markup,
    operating_map,
    reading,
    sankey,
    stop_curves,
    tables,
    traces,
)
from hubsim.report.markup import Markup, data, element, join
from hubsim.report.reading import Extras, RunLike

_HERE = Path(__file__).parent
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"

HOW_TO_READ = (
    (
        "The braking work at the wheels is what brakes and motors take from the motion; the flow "
        "picture shows what becomes of it."
    ),
    (
        "Between strategies that drive alike, the better one has the thicker arrow back into the "
        "battery. The way out to the "
        "wheels is the same for all."
    ),
    (
        "A motor that brakes harder than its best torque returns less, because copper loss grows"
        " with the square of the current. The series strategy stops at that torque."
    ),
    (
        "In the torque panel the filled areas are stacked: motor and hydraulic brake together make "
        "the demand."
    ),
    (
        "The strips show when a limit made the torque smaller than the demand, with the reason that"
        " the controller reports."
    ),
    (
        "The residual compares sources, sinks and storage over the whole run. It is an error of the"
        " simulation, not of the vehicle."
    ),
)


IDEAL = (
    "The ideal stop has the same demand, initial speed, winding temperature and state of charge,"
    " and the limits of the drive: steady state of the motor at every speed, no delay, no air drag"
    " and no rolling resistance, the battery at rest before the stop."
)


_OWN_PAGE = join(
    Markup("The same page of your own motor: copy "),
    element("code", "tools/motors/lu2013.toml"),
    Markup(", put in its numbers, then "),
    element("code", "hubsim sim --config mine.toml"),
    Markup("; of one run: "),
    element("code", "hubsim run stop --config mine.toml --json stop.json --csv stop.csv"),
    Markup(" and "),
    element("code", "hubsim report stop.json -o page.html"),
    Markup("."),
)


def document(runs: Sequence[RunLike], extras: Extras | None = None) -> str:
    """Return the whole page."""
    extras = extras or Extras()
    cycles = reading.by_cycle(runs)
    vehicles = ", ".join(dict.fromkeys(run.vehicle for run in runs))
    title = f"Energy of {vehicles} in {', '.join(reading.cycle(name) for name in cycles)}"
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        Markup(f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'),
        element("link", rel="icon", href="data:,"),
        *[
            element("meta", name=f"hubfoc-{key}", content=value)
            for key, value in _common(runs).items()
        ],
        element("title", title),
        element("style", Markup(_asset("palette.css") + _asset("page.css"))),
    )
    sections = [
        _cycle(name, group, place, extras) for place, (name, group) in enumerate(cycles.items())
    ]
    records = [fault_record.section(kept, place) for place, kept in enumerate(extras.records)]
    body = element(
        "body",
        _header(runs, vehicles, list(cycles)),
        element("main", *sections, _stops(extras), *records),
        # On paper, after signals alone, the footer shares their upright sheet.
        _footer(extras.command, runs, upright=not extras.stops),
        element("script", Markup(_asset("readout.js"))),
    )
    return f'<!DOCTYPE html>\n<html lang="en">{head}\n{body}</html>\n'


def _asset(name: str) -> str:
    return "\n" + (_HERE / name).read_text(encoding="utf-8")


def _header(runs: Sequence[RunLike], vehicles: str, cycles: list[str]) -> Markup:
    counted = {
        1: "One braking strategy",
        2: "Two braking strategies",
        3: "Three braking strategies",
    }
    strategies = len({run.strategy for run in runs})
    how_many = counted.get(strategies, f"{strategies} braking strategies")
    driven = " and ".join(reading.cycle(name) for name in cycles)
    links = [
        element("li", element("a", reading.cycle(name), href=f"#cycle-{place}"))
        for place, name in enumerate(cycles)
    ]
    return element(
        "header",
        element("p", f"Vehicle {vehicles} · hubfoc, simulated", class_="kicker"),
        element("h1", "Where the braking energy goes"),
        element(
            "p",
            f"{how_many} on {driven}: a complete controller, the same code as on the "
            "microcontroller, works in every driven "
            "wheel of the simulated vehicle, and every joule is accounted for.",
            class_="lead",
        ),
        element("nav", element("ul", *links), aria_label="Cycles") if len(cycles) > 1 else "",
    )


def _cycle(name: str, runs: list[RunLike], place: int, extras: Extras) -> Markup:
    called = reading.cycle(name)
    identity = f"c{place}"
    heading = called[0].upper() + called[1:] if called else "Run"
    return element(
        "section",
        element("h2", f"{heading}: how much of the braking work comes back"),
        *(_single if len(runs) == 1 else _compared)(runs, identity, called, extras),
        id=f"cycle-{place}",
        data_cycle=name,
    )


def _compared(runs: list[RunLike], identity: str, called: str, extras: Extras) -> list[Markup]:
    """Show several runs, a column for each."""
    return [
        element("div", *[_card(run) for run in runs], class_="columns"),
        _flows(runs, identity, called),
        tables.energies(runs, f"Energies of the whole vehicle, {called}"),
        _points(runs, identity, called, extras),
        tables.braking_quality(runs, f"How well it brakes, {called}"),
        tables.criteria(runs, f"What the scenario asks for, {called}"),
        _traces(runs, identity, called),
    ]


def _single(runs: list[RunLike], identity: str, called: str, extras: Extras) -> list[Markup]:
    """Show one run over the whole width: pictures beside each other, signals in three columns."""
    pictures = (_flows(runs, identity, called), _points(runs, identity, called, extras))
    ideal = reading.ideal(runs[0])
    note = element("p", IDEAL + tables.limits_cost(ideal), class_="soft") if ideal else Markup("")
    brakes = tables.braking_quality(runs, f"How well it brakes, {called}")
    asked = tables.criteria(runs, f"What the scenario asks for, {called}")
    return [
        element("div", element("div", _card(runs[0])), brakes, class_="beside"),
        element("div", *filter(None, pictures), class_="beside pictures"),
        tables.energies(runs, f"Energies of the whole vehicle, {called}"),
        note,
        asked,
        _groups(runs, identity, called),
    ]


def _card(run: RunLike) -> Markup:
    """Put the result in one number, and the braking work in a bar."""
    called = reading.strategy(run)
    share = tables.stored_share(run)
    known = math.isfinite(share)
    number = markup.percent(share).removesuffix(" %") if known else ""
    meaning = (
        " % of the braking work stored" if known else "share of the braking work stored: not known"
    )
    parts: list[Markup] = [
        element("h3", called.title),
        element("p", number, element("small", meaning), class_="share"),
        _bar(run),
        element("p", called.sentence) if called.sentence else Markup(""),
    ]
    return element("article", *parts, class_=f"card {stop_curves.accent(run.strategy)}")


def _bar(run: RunLike) -> Markup:
    """Show what became of the braking work, to scale; left of zero what the battery had to add."""
    work, returned = (
        reading.energy_j(run, "braking_at_wheels"),
        reading.energy_j(run, "battery_returned"),
    )
    braking = reading.phase_j(run, "while_braking_j") or {}
    hydraulic = braking.get("hydraulic", reading.energy_j(run, "hydraulic"))
    if not (math.isfinite(returned) and math.isfinite(hydraulic) and work > 0.0):
        return Markup("")
    shares = (
        ("battery", "returned", returned / work),
        ("losses", "motor, inverter and battery losses", (work - returned - hydraulic) / work),
        ("hydraulic", "hydraulic heat", hydraulic / work),
    )
    bars = []
    low = right = -sum(min(share, 0.0) for _, _, share in shares)
    left = 0.0
    for style, _, share in shares:
        width = abs(share)
        bars.append(
            element(
                "rect",
                x=100.0 * (right if share >= 0.0 else left),
                y=0.0,
                width=100.0 * width,
                height=10.0,
                class_=f"share-{style}",
            )
        )
        right, left = (right + width, left) if share >= 0.0 else (right, left + width)
    listed = [
        element("li", element("span", f"{name} {markup.percent(share)}"), class_=style)
        for style, name, share in shares
    ]
    view = f"0 0 {100.0 * max(right, low + 1.0):.2f} 10"
    drawn = element(
        "svg",
        *bars,
        viewBox=view,
        preserveAspectRatio="none",
        aria_hidden="true",
        focusable="false",
    )
    return join(drawn, element("ul", *listed))


def _flows(runs: list[RunLike], identity: str, called: str) -> Markup:
    found = [flows.flow_of(run) for run in runs]
    known = [flow for flow in found if flow is not None]
    if not known:
        return element(
            "p", "The energies that the flow picture needs are not known.", class_="soft"
        )
    shared = lanes.frame(known)
    figures = []
    for place, (run, flow) in enumerate(zip(runs, found, strict=True)):
        title = reading.strategy(run).title
        drawn = (
            sankey.draw(flow, shared, f"{identity}f{place}", f"Energy flow, {title}, {called}")
            if flow is not None
            else element("p", "not known", class_="soft")
        )
        apart = _difference(place, runs, found)
        figures.append(element("figure", element("figcaption", element("h3", title)), drawn, apart))
    sentences = [
        "Along the upper lane energy goes from the battery to the wheels, along the lower lane it "
        "comes back. Widths are to one scale."
    ]
    if any(flow.net for flow in known):
        sentences.append(
            "Where there is no upper lane, the battery gave nothing for driving: the vehicle's "
            "own motion is the source."
        )
    if any(flow.split for flow in known):
        sentences.append(
            "Losses are booked by what the driver does at that moment; the battery's part "
            "includes what its polarisation keeps."
        )
    if not all(flow.split for flow in known):
        where = " where no work at the wheels is named" if any(flow.split for flow in known) else ""
        sentences.append(f"Losses are those of the whole run, driving and braking together{where}.")
    return _block("Energy flow", " ".join(sentences), figures)


def _difference(place: int, runs: list[RunLike], found: Sequence[flows.Flow | None]) -> Markup:
    """Say where a run's braking work goes other than in the run that returns the most."""
    own = found[place]
    others = {k: flow.returned_j for k, flow in enumerate(found) if flow is not None}
    if own is None or len(others) < 2:
        return Markup("")
    best = max(others, key=lambda k: others[k])
    against = found[best]
    if best == place or against is None:
        return element("p", "Returns the most of them.", class_="soft difference")
    parts = [
        f"{name} {markup.kilojoules(abs(joule))} {'more' if joule > 0.0 else 'less'}"
        for name, joule in flows.differences_j(own, against).items()
    ]
    lost = markup.kilojoules(against.returned_j - own.returned_j)
    text = f"Returns {lost} less than {reading.strategy(runs[best]).title}"
    return element(
        "p", f"{text}: {', '.join(parts)}." if parts else f"{text}.", class_="soft difference"
    )


def _points(runs: list[RunLike], identity: str, called: str, extras: Extras) -> Markup:
    best = extras.maps.get(runs[0].vehicle)
    if best is None:
        return Markup("")
    chart = operating_map.layout(runs, best)
    figures = []
    for place, run in enumerate(runs):
        title = reading.strategy(run).title
        drawn = operating_map.draw(
            run,
            best,
            chart,
            f"{identity}p{place}",
            f"Operating points while braking, {title}, {called}",
        )
        figures.append(
            element(
                "figure",
                element("figcaption", element("h3", title)),
                drawn,
                class_=stop_curves.accent(run.strategy),
            )
        )
    warm = markup.significant(best.temperature_c)
    note = (
        "Every dot is a moment in which the driver brakes. Below the solid line more torque would "
        "return more energy, above it less; "
        "beyond the broken line braking takes energy out of the battery. Walking speed has half of "
        f"the axis, because that is where they part. Lines hold for a winding at {warm} °C."
    )
    return _block("Where the motor brakes", note, figures)


def _stops(extras: Extras) -> Markup:
    if not extras.stops:
        return Markup("")
    note = element(
        "p",
        "Stops from 40 km/h at constant demand, without air drag and rolling resistance. ",
        stop_curves.legend(),
        " What lies between them are the blend-out at low speed, which keeps the last metre's "
        "energy, and the moment in which only "
        "the motor brakes because the hydraulic brake is still coming. With a battery that has "
        "settled at every speed the ideal would be "
        f"up to {markup.fixed(100.0 * stop_curves.unsettled(extras.stops), 1)} points lower.",
        class_="soft",
    )
    figure = element("figure", stop_curves.draw(extras.stops, "stops"), class_="wide")
    heading = element("h2", "Stops: how much of the kinetic energy comes back")
    return element(
        "section",
        heading,
        note,
        element("div", figure, stop_curves.table(extras.stops), class_="beside"),
        id="stops",
    )


def _traces(runs: list[RunLike], identity: str, called: str) -> Markup:
    shared = traces.layout(runs)
    if shared is None:
        return element("p", "No signals were recorded.", class_="soft")
    figures = []
    for place, run in enumerate(runs):
        title = reading.strategy(run).title
        values = traces.readout(run, shared)
        figures.append(
            element(
                "figure",
                element("figcaption", element("h3", title)),
                traces.draw(
                    run, shared, f"{identity}t{place}", f"Signals over time, {title}, {called}"
                ),
                data(values) if values is not None else "",
                class_="trace",
            )
        )
    note = _over_time(runs, "Scales are the same in every column. ")
    return _block("Over time", note, figures, "block tall")


def _groups(runs: list[RunLike], identity: str, called: str) -> Markup:
    """Show the signals of one run in three pictures beside each other."""
    titles = ("Motion and torque", "Currents and voltages", "Temperatures and limits")
    figures = []
    for group, title in enumerate(titles):
        shared = traces.layout(runs, group)
        if shared is not None:
            values = traces.readout(runs[0], shared)
            drawn = traces.draw(runs[0], shared, f"{identity}t{group}", f"{title}, {called}")
            figures.append(
                element(
                    "figure",
                    element("figcaption", element("h3", title)),
                    drawn,
                    data(values) if values is not None else "",
                    class_="trace",
                )
            )
    if not figures:
        return element("p", "No signals were recorded.", class_="soft")
    return _block("Over time", _over_time(runs, ""), figures, "block tall groups")


def _over_time(runs: list[RunLike], scales: str) -> str:
    wheels = (
        "The wheels differ: one curve for each."
        if reading.wheels_differ(runs)
        else "Torques and currents are those of one wheel; the others do the same."
    )
    return f"The driver brakes where the ground is shaded. {scales}{wheels}"


def _block(title: str, note: str, figures: list[Markup], kind: str = "block") -> Markup:
    """Put figures side by side under a heading, on paper never apart from it."""
    return element(
        "div",
        element("h2", title),
        element("p", note, class_="soft"),
        element("div", *figures, class_="columns"),
        class_=kind,
    )


def _common(runs: Sequence[RunLike]) -> dict[str, str]:
    """Return the origins of all runs as one: where they differ, every value once."""
    origins = [reading.origin(run) for run in runs]
    keys = dict.fromkeys(key for origin in origins for key in origin)
    return {
        key: ", ".join(dict.fromkeys(origin[key] for origin in origins if key in origin))
        for key in keys
    }


def _origin(runs: Sequence[RunLike]) -> Markup:
    """Say which program, configuration and seed the page comes from."""
    found = _common(runs)
    if not found:
        return Markup("")
    titles = {
        "version": "hubfoc",
        "commit": "commit",
        "configuration": "configuration",
        "configuration_crc32": "CRC-32",
        "scenario": "scenario",
        "seed": "seed",
        "date": "date",
    }
    sentences = [
        element("li", f"{title} ", element("code", found[key]))
        for key, title in titles.items()
        if key in found
    ]
    return element("ul", *sentences, class_="origin", aria_label="Origin")


def _footer(command: str, runs: Sequence[RunLike], *, upright: bool) -> Markup:
    return element(
        "footer",
        element("h2", "How to read this page"),
        element("ul", *[element("li", point) for point in HOW_TO_READ], class_="how"),
        element("p", "Made by ", element("code", command), ". ", _OWN_PAGE, class_="soft"),
        _origin(runs),
        class_="upright" if upright else None,
    )
