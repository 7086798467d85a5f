# SPDX-License-Identifier: Apache-2.0
"""Where the lanes of the flow picture run and where what leaves them goes.

Lengths in user units of the SVG.

Two lanes lie above each other, the battery at their left ends, a half turn joins their right ends.
Their inner edges are straight; what leaves the upper lane is sliced off its upper edge, what leaves
the lower lane off its lower edge.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from hubsim.report.flows import Flow, Part, total

WIDTH = 400.0
LEFT, RIGHT = 26.0, 392.0  # where the lanes touch the battery, where they end
GAP = 50.0  # between the lanes
TURN = 7.0  # inner radius of what leaves
STEM = 14.0  # shortest straight piece of what leaves
FADE = 16.0  # over this length it takes on its own colour
LABEL = 30.0  # height of two lines
PITCH = 57.0  # between the middles of neighbouring labels
NARROW = 53.0  # below this distance two labels need two rows
TIP = 13.0  # length of the arrow into the battery
WIDEST_UPPER, WIDEST_ROAD, WIDEST_LOWER = 168.0, 92.0, 100.0


@dataclass(frozen=True)
class Frame:
    """What pictures that are compared have in common. ``per_j``: width of a joule."""

    per_j: float
    upper: float  # width of the widest upper lane, 0: none has one
    lower: float
    rows: int = 1  # of labels below; 2: alternating, where one row is too narrow for them
    upper_rows: int = 1  # the same above

    @property
    def labels_y(self) -> float:
        """Lower edge of the labels above the upper lane."""
        return self.upper_rows * LABEL

    @property
    def lane_y(self) -> float:
        """Inner edge of the upper lane; its label is placed relative to it."""
        if self.upper <= 0.0:
            return 34.0 - GAP
        return self.labels_y + STEM + TURN + self.upper

    @property
    def back_y(self) -> float:
        """Inner edge of the lower lane."""
        return self.lane_y + GAP

    @property
    def height(self) -> float:
        """Of the whole picture."""
        return self.back_y + self.lower + TURN + STEM + self.rows * LABEL + 6.0

    @property
    def end_y(self) -> float:
        """Points of what leaves the lower lane."""
        return self.height - self.rows * LABEL - 5.0


@dataclass(frozen=True)
class Exit:
    """A part that leaves a lane, and where.

    Middle of its stem, its width, how much of that comes from the wheels.
    """

    part: Part
    middle: float
    width: float
    from_wheels: float

    @property
    def from_battery(self) -> float:
        """Width of what the battery feeds against the direction of the lower lane."""
        return self.width - self.from_wheels


@dataclass(frozen=True)
class Lanes:
    """One flow in a frame, with everything as lengths. The half turn begins at ``bend_x``."""

    flow: Flow
    frame: Frame
    drawn: float
    wheels: float
    turned: float
    slowing: float
    returned: float
    upper: list[Exit]
    road: list[Exit]
    lower: list[Exit]
    bend_x: float

    @property
    def top_y(self) -> float:
        """Outer edge of the upper lane at the battery."""
        return self.frame.lane_y - self.drawn


def frame(flows: Sequence[Flow]) -> Frame:
    """Choose the scale at which every flow fits."""
    bounds = [
        (WIDEST_UPPER, max(flow.drawn_j for flow in flows)),
        (WIDEST_ROAD, max(total(flow.road) for flow in flows)),
        (WIDEST_LOWER, max(max(flow.slowing_j, -flow.returned_j) for flow in flows)),
    ]
    per_j = min(space / energy for space, energy in bounds if energy > 0.0)
    one_row = Frame(per_j, per_j * bounds[0][1], per_j * bounds[2][1])
    laid = [lay(flow, one_row) for flow in flows]
    return replace(
        one_row,
        rows=2 if any(_crowded(lanes.lower) for lanes in laid) else 1,
        upper_rows=2 if any(_crowded([*lanes.upper, *lanes.road]) for lanes in laid) else 1,
    )


def _crowded(leaving: Sequence[Exit]) -> bool:
    """Whether a label would overlap the next one."""
    return any(abs(after.middle - before.middle) < NARROW for before, after in pairwise(leaving))


def lay(flow: Flow, shared: Frame) -> Lanes:
    """Place a flow in a frame."""
    per_j = shared.per_j
    turned, slowing, returned = (
        flow.turned_j * per_j,
        flow.slowing_j * per_j,
        flow.returned_j * per_j,
    )
    if flow.net:
        upper, road, bend_x = [], [], RIGHT - 24.0
    else:
        first = LEFT + FADE + TURN + 10.0
        leaving = _placed([*flow.upper, *flow.road], per_j, first, RIGHT - 12.0 - first)
        upper, road = leaving[: len(flow.upper)], leaving[len(flow.upper) :]
        last = leaving[-1].middle - 0.5 * leaving[-1].width if leaving else first
        bend_x = min(max(last, 0.7 * WIDTH), RIGHT - 0.5 * GAP - turned)
    first = bend_x - FADE - TURN
    mirrored = _placed(flow.lower, per_j, WIDTH - first, first - LEFT - TIP - 16.0)
    lower = _fed(
        [Exit(one.part, WIDTH - one.middle, one.width, one.width) for one in mirrored],
        slowing if returned < 0.0 else None,
    )
    return Lanes(
        flow,
        shared,
        flow.drawn_j * per_j,
        flow.wheels_j * per_j,
        turned,
        slowing,
        returned,
        upper,
        road,
        lower,
        bend_x,
    )


def _placed(parts: Sequence[Part], per_j: float, first: float, space: float) -> list[Exit]:
    """Place stems from left to right, the first one's left edge at ``first``.

    Labels are apart where there is space.
    """
    widths = [part.energy_j * per_j for part in parts]
    if not widths:
        return []
    wanted = [max(PITCH, 0.5 * (before + width) + TURN + 2.0) for before, width in pairwise(widths)]
    distances = _pressed(wanted, space - 0.5 * (widths[0] + widths[-1]))
    middle = first + 0.5 * widths[0]
    placed = []
    for part, width, distance in zip(parts, widths, [*distances, 0.0], strict=True):
        placed.append(Exit(part, middle, width, width))
        middle += distance
    return placed


def _pressed(wanted: list[float], space: float) -> list[float]:
    """Return distances reduced to the available space.

    All by the same share, none below half a label's.
    """
    excess = sum(wanted) - space
    slack = sum(max(distance - 0.5 * PITCH, 0.0) for distance in wanted)
    if excess <= 0.0 or slack <= 0.0:
        return wanted
    share = min(excess / slack, 1.0)
    return [distance - share * max(distance - 0.5 * PITCH, 0.0) for distance in wanted]


def _fed(lower: list[Exit], slowing: float | None) -> list[Exit]:
    """Let what the wheels give feed the exits nearest to them.

    The battery feeds the rest. None: the wheels feed all.
    """
    if slowing is None:
        return lower
    found = []
    for leaving in lower:
        own = min(leaving.width, slowing)
        found.append(Exit(leaving.part, leaving.middle, leaving.width, own))
        slowing -= own
    return found
