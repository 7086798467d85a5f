# SPDX-License-Identifier: Apache-2.0
"""The energy of a run as one flow that balances.

Cells, losses, wheels, road, braking work, losses, cells.

    drawn            = upper + road + turned          from the cells to the wheels
    turned + joining = lower + returned               from the wheels back to the cells

A flow never holds a negative part: what would be one comes in instead of going out (``joining``).
Only ``returned_j`` has a sign: negative when braking costs energy from the battery.
"""

import math
from dataclasses import dataclass

from hubsim.report import reading
from hubsim.report.reading import RunLike

NEGLIGIBLE = 2e-5  # of the largest energy: what is less is left out, 3 J of an urban cycle
SHOWN = 1e-4  # of the braking work: a difference of two runs that is told
UNUSUAL = 1e-3  # the same for what hardly ever leaves a lane and would only take space


@dataclass(frozen=True)
class Part:
    """An energy with a name.

    ``kind`` chooses its colour: loss, hydraulic, road or motion. It is left out below ``least``,
    relative to the largest.
    """

    name: str
    energy_j: float
    kind: str
    least: float = NEGLIGIBLE


@dataclass(frozen=True)
class Flow:
    """One run.

    ``work_j`` is the braking work at the wheels. ``split``: losses are known apart for driving and
    braking; without it all are in ``upper``. ``net``: the cells gave nothing for driving, so there
    is no upper lane and ``lower`` has everything.
    """

    drawn_j: float
    upper: tuple[Part, ...]
    road: tuple[Part, ...]
    joining: tuple[Part, ...]
    turned_j: float
    lower: tuple[Part, ...]
    returned_j: float
    work_j: float
    split: bool
    net: bool

    @property
    def wheels_j(self) -> float:
        """Work at the wheels while driving, J."""
        return self.drawn_j - total(self.upper)

    @property
    def slowing_j(self) -> float:
        """What the lower lane has at its beginning, J."""
        return self.turned_j + total(self.joining)


def total(parts: tuple[Part, ...] | list[Part]) -> float:
    """Return the sum of parts in J."""
    return math.fsum(part.energy_j for part in parts)


def differences_j(flow: Flow, other: Flow) -> dict[str, float]:
    """Return what becomes of the braking work differently in two runs, by the part's name, J.

    Only what differs by a hundredth of a per cent of the work or more, the largest first.
    """
    names = dict.fromkeys(part.name for part in (*flow.lower, *other.lower))
    found = {name: _of(flow, name) - _of(other, name) for name in names}
    least = SHOWN * max(flow.work_j, other.work_j)
    kept = {name: joule for name, joule in found.items() if abs(joule) >= least}
    return dict(sorted(kept.items(), key=lambda entry: -abs(entry[1])))


def _of(flow: Flow, name: str) -> float:
    return math.fsum(part.energy_j for part in flow.lower if part.name == name)


def flow_of(run: RunLike) -> Flow | None:
    """Return the flow of a run, None when its main energies are not known or nothing flows."""
    drawn, work, returned, hydraulic = (
        reading.energy_j(run, name)
        for name in ("traction", "braking_at_wheels", "battery_returned", "hydraulic")
    )
    if not all(map(math.isfinite, (drawn, work, returned, hydraulic))):
        return None
    driving, braking = (
        reading.phase_j(run, "while_driving_j"),
        reading.phase_j(run, "while_braking_j"),
    )
    if driving is None or braking is None:
        return _whole(run, drawn, returned, hydraulic, work)
    lower = [
        Part("hydraulic", _known(braking, "hydraulic", hydraulic), "hydraulic"),
        Part("bearings", _known(braking, "bearing"), "loss", UNUSUAL),
        Part("iron", braking["iron"], "loss"),
        Part("copper", braking["copper"], "loss"),
        Part("inverter", braking["inverter"], "loss"),
    ]
    # What polarisation keeps or gives is the battery's; by difference, so that every lane balances.
    lower.append(Part("battery", work - total(lower) - returned, "loss"))
    upper = [
        Part("inverter", driving["inverter"], "loss"),
        Part("copper", driving["copper"], "loss"),
        Part("iron", driving["iron"], "loss"),
        Part("bearings", _known(driving, "bearing"), "loss", UNUSUAL),
        Part("hydraulic", _known(driving, "hydraulic"), "hydraulic", UNUSUAL),
    ]
    road = _road(run)
    if road is None:
        upper.insert(0, Part("battery", driving["battery"], "loss"))
        road = [Part("road", drawn - total(upper) - work, "road")]
    else:
        upper.insert(0, Part("battery", drawn - total(upper) - total(road) - work, "loss"))
    return _balanced(drawn, upper, road, lower, returned, work, split=True)


def _known(entries: dict[str, float], name: str, otherwise: float = 0.0) -> float:
    value = entries.get(name, math.nan)
    return value if math.isfinite(value) else otherwise


def _road(run: RunLike) -> list[Part] | None:
    """Return what motion cost and kept, if all of it is known; negative where it gave."""
    drag, rolling, climbed, kinetic = (
        reading.energy_j(run, name) for name in ("drag", "rolling", "climbed", "stored_kinetic")
    )
    if not all(map(math.isfinite, (drag, rolling, kinetic))):
        return None
    return [
        Part("air", drag, "road"),
        Part("rolling", rolling, "road"),
        Part("height", climbed if math.isfinite(climbed) else 0.0, "motion"),
        Part("speed", kinetic, "motion"),
    ]


def _whole(
    run: RunLike, drawn: float, returned: float, hydraulic: float, work: float
) -> Flow | None:
    """Return the flow of a run whose losses are not split into driving and braking.

    All losses are drawn on the way to the wheels.
    """
    losses = [
        Part(name, reading.energy_j(run, name), "loss")
        for name in ("battery", "inverter", "copper", "iron")
    ]
    upper = [part for part in losses if math.isfinite(part.energy_j)]
    drawn, returned = drawn + max(-returned, 0.0), max(returned, 0.0)
    lower = [Part("hydraulic", hydraulic, "hydraulic")]
    road = [Part("road", drawn - total(upper) - hydraulic - returned, "road")]
    return _balanced(drawn, upper, road, lower, returned, work, split=False)


def _balanced(
    drawn: float,
    upper: list[Part],
    road: list[Part],
    lower: list[Part],
    returned: float,
    work: float,
    *,
    split: bool,
) -> Flow | None:
    """Turn negative parts round, and let the lower lane carry what the upper one cannot."""
    every = [*upper, *road, *lower]
    largest = max(abs(drawn), abs(returned), *(abs(part.energy_j) for part in every))
    least = NEGLIGIBLE * largest
    joining = [
        Part(_source(part), -part.energy_j, "motion")
        for part in every
        if part.energy_j < -UNUSUAL * largest
    ]
    upper, road, lower = (
        [part for part in parts if part.energy_j > part.least * largest]
        for parts in (upper, road, lower)
    )
    net = drawn - total(upper) <= least
    if net:
        lower, upper, returned, drawn = _merged([*road, *lower, *upper]), [], returned - drawn, 0.0
        road = []
    wheels = drawn - total(upper)
    taken: list[Part] = []
    later: list[Part] = []
    for part in road:
        space = max(wheels - total(taken), 0.0)
        taken += [Part(part.name, min(part.energy_j, space), part.kind)] if space > least else []
        later += (
            [Part(part.name, part.energy_j - space, part.kind)]
            if part.energy_j - space > least
            else []
        )
    lower = [*later, *lower]
    turned = max(wheels - total(taken), 0.0)
    if max(drawn, turned + total(joining), abs(returned)) <= 0.0:
        return None
    return Flow(
        drawn,
        tuple(upper),
        tuple(taken),
        tuple(joining),
        turned,
        tuple(lower),
        returned,
        work,
        split,
        net,
    )


def _source(part: Part) -> str:
    """Name a part that gives instead of taking."""
    return {
        "road": "motion",
        "speed": "motion",
        "height": "descent",
        "battery": "polarisation",
    }.get(part.name, part.name)


def _merged(parts: list[Part]) -> list[Part]:
    """Add parts of the same name."""
    names = dict.fromkeys((part.name, part.kind) for part in parts)
    return [
        Part(name, total([part for part in parts if (part.name, part.kind) == (name, kind)]), kind)
        for name, kind in names
    ]
