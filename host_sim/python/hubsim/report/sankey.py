# SPDX-License-Identifier: Apache-2.0
"""The flow picture.

From the battery along the upper lane to the wheels, and back along the lower lane.

All widths are to one scale for all pictures drawn together. A lane's colour changes from the
battery's to the motor's with the place, whatever flows there; what leaves takes on its own colour
while it turns.
"""

from collections.abc import Sequence

from hubsim.report import lanes, markup
from hubsim.report.flows import Flow, Part, total
from hubsim.report.lanes import FADE, GAP, LABEL, LEFT, RIGHT, TIP, TURN, WIDTH, Exit, Frame, Lanes
from hubsim.report.markup import Markup, element, join, number, picture

BATTERY = 8.0  # left edge of the battery
POINT = 9.0  # longest point of what leaves
HAIR = 1.2  # what is thinner gets a dotted line beside it, so that the eye finds it
WRITTEN = 74.0  # width of a lane's label
LETTERS = 34.0  # a lane this wide can hold two lines


def draw(flow: Flow, shared: Frame, identity: str, title: str) -> Markup:
    """Draw one flow. ``identity`` is unique in the page."""
    laid = lanes.lay(flow, shared)
    fill = f"{identity}-lane"
    parts = [
        _gradient(fill, (LEFT, RIGHT), ("0.08", "stop-battery"), ("0.8", "stop-motor")),
        _battery(laid),
        _trunk(laid, fill),
    ]
    if laid.returned < 0.0:
        parts.append(_feed(laid, fill))
    parts += [*_rising_all(laid, identity), *_falling_all(laid, identity), *_labels(laid)]
    return picture(identity, title, describe(flow), WIDTH, shared.height, *parts, class_="flow")


def describe(flow: Flow) -> str:
    """Say the picture in words, for those who cannot see it."""

    def listed(parts: Sequence[Part]) -> str:
        return (
            ", ".join(f"{part.name} {markup.kilojoules(part.energy_j)}" for part in parts)
            or "nothing"
        )

    sentences = []
    if not flow.net:
        sentences.append(
            f"{markup.kilojoules(flow.drawn_j)} from the battery's cells lose on the way to the "
            f"wheels: {listed(flow.upper)}."
        )
        sentences.append(f"The road takes: {listed(flow.road)}.")
    if flow.joining:
        sentences.append(f"The vehicle gives: {listed(flow.joining)}.")
    sentences.append(f"Braking loses: {listed(flow.lower)}.")
    verb = "go back into the cells" if flow.returned_j >= 0.0 else "more are drawn from the cells"
    sentences.append(f"{markup.kilojoules(abs(flow.returned_j))} {verb}.")
    return " ".join(sentences)


def _path(*commands: str | float) -> str:
    return " ".join(
        number(command) if isinstance(command, float) else command for command in commands
    )


def _gradient(
    identity: str, ends: tuple[float, float], *stops: tuple[str, str], clear_first: bool = False
) -> Markup:
    """Change colour from one x to another."""
    made = [
        element(
            "stop",
            offset=offset,
            class_=style,
            stop_opacity="0" if clear_first and place == 0 else None,
        )
        for place, (offset, style) in enumerate(stops)
    ]
    return element(
        "linearGradient",
        *made,
        id=identity,
        gradientUnits="userSpaceOnUse",
        x1=ends[0],
        x2=ends[1],
        y1=0.0,
        y2=0.0,
    )


def _battery(laid: Lanes) -> Markup:
    back = laid.frame.back_y
    top = back - 6.0 if laid.flow.net else laid.top_y
    bottom = back + max(abs(laid.returned), 44.0 if laid.flow.net else 8.0)
    x, middle = 0.5 * (BATTERY + LEFT) - 1.0, 0.5 * (top + bottom)
    turned = f"rotate(-90 {number(x)} {number(middle)}) translate(0 3.5)"
    return join(
        element(
            "rect",
            x=BATTERY,
            y=top,
            width=LEFT - BATTERY - 2.0,
            height=bottom - top,
            rx=3.0,
            class_="battery",
        ),
        element(
            "text", "battery", x=x, y=middle, class_="on", text_anchor="middle", transform=turned
        ),
    )


def _trunk(laid: Lanes, fill: str) -> Markup:
    """Draw both lanes and the half turn between them as one outline."""
    lane, back, inner = laid.frame.lane_y, laid.frame.back_y, 0.5 * GAP
    commands: list[str | float] = ["M", RIGHT, back]
    if not laid.flow.net:
        top, outer = laid.top_y, inner + laid.turned
        commands = ["M", LEFT, lane, "V", top]
        for leaving in (*laid.upper, *laid.road):
            top += leaving.width
            commands += ["H", leaving.middle - 0.5 * leaving.width - TURN, "V", top]
        commands += ["H", laid.bend_x, "A", outer, outer, "0 0 1", laid.bend_x, back + laid.turned]
    if laid.flow.joining:
        commands += ["H", RIGHT]
    bottom = back + laid.slowing
    commands += ["V", bottom]
    for leaving in laid.lower:
        if leaving.from_wheels > 0.0:
            bottom -= leaving.from_wheels
            commands += ["H", leaving.middle + 0.5 * leaving.width + TURN, "V", bottom]
    if laid.returned > 0.0:
        shoulder = LEFT + TIP
        commands += [
            "H",
            shoulder,
            "v",
            3.0,
            "L",
            LEFT,
            0.5 * (back + bottom),
            "L",
            shoulder,
            back - 3.0,
        ]
    commands += ["V", back]
    commands += (
        ["Z"]
        if laid.flow.net
        else ["H", laid.bend_x, "A", inner, inner, "0 0 0", laid.bend_x, lane, "Z"]
    )
    return element("path", d=_path(*commands), fill=f"url(#{fill})", class_="trunk")


def _feed(laid: Lanes, fill: str) -> Markup:
    """Draw what the battery has to add to the losses of braking: a lane from the left."""
    back = laid.frame.back_y
    bottom = back - laid.returned
    commands: list[str | float] = ["M", LEFT, back, "V", bottom]
    for leaving in reversed(laid.lower):
        if leaving.from_battery > 0.0:
            bottom -= leaving.from_battery
            commands += ["H", leaving.middle - 0.5 * leaving.width - TURN, "V", bottom]
    return element("path", d=_path(*commands, "V", back, "Z"), fill=f"url(#{fill})", class_="trunk")


def _rising_all(laid: Lanes, identity: str) -> list[Markup]:
    """Draw every exit of the upper lane."""
    drawn, top = [], laid.top_y
    labels_y, rows = laid.frame.labels_y, laid.frame.upper_rows
    for place, leaving in enumerate((*laid.upper, *laid.road)):
        # Alternating rows: the first, third, ... label is the one beside its stem.
        row_y = labels_y - LABEL - place % rows * LABEL
        drawn.append(_rising(leaving, top, laid.flow, f"{identity}-{place}-up", labels_y + 1.0))
        drawn += [_label(leaving, row_y + 10.0), _leader(leaving, labels_y + 1.0, top - TURN)]
        if row_y < labels_y - LABEL:
            drawn.append(_dotted(leaving.middle, row_y + LABEL - 5.0, labels_y + 1.0))
        top += leaving.width
    return drawn


def _rising(leaving: Exit, top: float, flow: Flow, fade: str, end: float) -> Markup:
    """Draw a fading straight piece, a quarter turn up and a stem with a point."""
    low, high = leaving.middle - 0.5 * leaving.width, leaving.middle + 0.5 * leaving.width
    start, point, outer = low - TURN, min(0.4 * leaving.width, POINT), TURN + leaving.width
    outline = _path(
        "M", start - FADE, top, "H", start, "A", TURN, TURN, "0 0 0", low, top - TURN, "V",
        end + point, "L", leaving.middle, end, "L", high, end + point, "V", top - TURN, "A", outer,
        outer, "0 0 1", start, top + leaving.width, "H", start - FADE, "Z",
    )  # fmt: skip
    when = "while driving" if flow.split else "over the whole run"
    return join(
        _fading(fade, start - FADE, start, leaving.part.kind),
        element(
            "path",
            _tooltip(leaving.part, flow, when, flow.drawn_j, "of what was drawn"),
            d=outline,
            fill=f"url(#{fade})",
            class_="exit",
        ),
    )


def _falling_all(laid: Lanes, identity: str) -> list[Markup]:
    """Draw every exit of the lower lane, each from the side or sides it is fed from."""
    end = laid.frame.end_y
    drawn = []
    bottom = laid.frame.back_y + laid.slowing
    for place, leaving in enumerate(laid.lower):
        drawn.append(_leader(leaving, bottom + TURN, end))
        if leaving.from_wheels > 0.0:
            high = leaving.middle + 0.5 * leaving.width
            drawn.append(
                _falling(
                    leaving,
                    laid.flow,
                    (high, high - leaving.from_wheels),
                    bottom,
                    end,
                    f"{identity}-{place}-down",
                )
            )
            bottom -= leaving.from_wheels
    bottom = laid.frame.back_y - laid.returned
    for place, leaving in enumerate(reversed(laid.lower)):
        if leaving.from_battery > 0.0:
            low = leaving.middle - 0.5 * leaving.width
            drawn.append(
                _falling(
                    leaving,
                    laid.flow,
                    (low, low + leaving.from_battery),
                    bottom,
                    end,
                    f"{identity}-{place}-feed",
                )
            )
            bottom -= leaving.from_battery
    for place, leaving in enumerate(laid.lower):
        lower_row = place % laid.frame.rows * LABEL
        if lower_row > 0.0:
            drawn.append(_dotted(leaving.middle, end + 3.0, end + lower_row + 1.0))
        drawn.append(_label(leaving, end + 12.0 + lower_row))
    return drawn


def _falling(
    leaving: Exit, flow: Flow, sides: tuple[float, float], bottom: float, end: float, fade: str
) -> Markup:
    """Draw a quarter turn down.

    ``sides``: near and far edge of the stem, as seen from where the flow comes from.
    """
    near, far = sides
    sign = 1.0 if near > far else -1.0
    width = abs(near - far)
    start, outer, point = near + sign * TURN, TURN + width, min(0.4 * width, POINT)
    one, other = ("0", "1") if sign > 0.0 else ("1", "0")
    outline = _path(
        "M", start + sign * FADE, bottom, "H", start, "A", TURN, TURN, f"0 0 {one}", near,
        bottom + TURN, "V", end - point, "L", 0.5 * (near + far), end, "L", far, end - point, "V",
        bottom + TURN, "A", outer, outer, f"0 0 {other}", start, bottom - width, "H",
        start + sign * FADE, "Z",
    )  # fmt: skip
    when = "while braking" if flow.split and not flow.net else "over the whole run"
    return join(
        _fading(fade, start + sign * FADE, start, leaving.part.kind),
        element(
            "path",
            _tooltip(leaving.part, flow, when, flow.work_j, "of the braking work"),
            d=outline,
            fill=f"url(#{fade})",
            class_="exit",
        ),
    )


def _fading(identity: str, clear: float, full: float, kind: str) -> Markup:
    """Let a colour come up between two places, from whichever side."""
    return _gradient(
        identity, (clear, full), ("0", f"stop-{kind}"), ("1", f"stop-{kind}"), clear_first=True
    )


def _tooltip(part: Part, flow: Flow, when: str, whole_j: float, of: str) -> Markup:
    share = (
        f", {markup.percent(part.energy_j / whole_j)} {of}"
        if whole_j > 0.0 and flow.split and not flow.net
        else ""
    )
    return element("title", f"{part.name} {when}: {markup.kilojoules(part.energy_j)}{share}")


def _leader(leaving: Exit, label_y: float, lane_y: float) -> Markup:
    """Draw a dotted line where the stem itself is hardly to be seen."""
    if leaving.width >= HAIR:
        return Markup("")
    return _dotted(leaving.middle, label_y, lane_y)


def _dotted(x: float, y1: float, y2: float) -> Markup:
    return element("line", x1=x, x2=x, y1=y1, y2=y2, class_="leader")


def _lines(
    x: float, y: float, first: str, second: str, anchor: str, step: float, class_: str | None = None
) -> Markup:
    """Write a name and below it what it is worth."""
    name, value = (
        element("tspan", first, x=x),
        element("tspan", second, x=x, dy=step, class_="value"),
    )
    return element("text", name, value, x=x, y=y, text_anchor=anchor, class_=class_)


def _label(leaving: Exit, y: float) -> Markup:
    return _lines(
        leaving.middle,
        y,
        leaving.part.name,
        markup.kilojoules(leaving.part.energy_j),
        "middle",
        12.0,
    )


def _end_of_wheels(laid: Lanes) -> float:
    """Return where the label of the work at the wheels ends: before what the road takes.

    Before the last part of it where the label of the cells leaves no space before the first.
    """
    free = [
        leaving.middle - 0.5 * leaving.width - TURN - FADE
        for leaving in (*laid.road[:1], *laid.road[-1:])
    ]
    least = LEFT + 10.0 + 2.0 * WRITTEN
    return next((x for x in free if x >= least), free[-1]) if free else laid.bend_x


def _labels(laid: Lanes) -> list[Markup]:
    """Name the lanes.

    Inside both ends of the upper one, in the gap above both ends of the lower one.
    """
    flow, lane = laid.flow, laid.frame.lane_y
    gap_y = laid.frame.back_y - 0.5 * GAP - 3.0
    drawn = []
    if laid.drawn >= LETTERS:
        y = lane - 0.5 * min(laid.drawn, max(laid.wheels, LETTERS)) - 3.0
        drawn.append(
            _lines(
                LEFT + 10.0,
                y,
                "from the cells",
                markup.kilojoules(flow.drawn_j),
                "start",
                14.0,
                "on",
            )
        )
    if flow.split and laid.wheels >= LETTERS:
        nearest = _end_of_wheels(laid)
        y = lane - 0.5 * laid.wheels - 3.0
        drawn.append(
            _lines(
                nearest - 4.0,
                y,
                "at the wheels",
                markup.kilojoules(flow.wheels_j),
                "end",
                14.0,
                "on",
            )
        )
    if flow.joining:
        names = " and ".join(dict.fromkeys(part.name for part in flow.joining))
        y = gap_y if flow.net else laid.frame.end_y + 12.0
        drawn.append(
            _lines(
                RIGHT,
                y,
                f"from {names}",
                markup.kilojoules(total(flow.joining)),
                "end",
                14.0 if flow.net else 12.0,
            )
        )
    if flow.split and not flow.net:
        drawn.append(
            _lines(
                laid.bend_x - 2.0,
                gap_y,
                "braking work",
                markup.kilojoules(flow.work_j),
                "end",
                14.0,
            )
        )
    share = (
        f" = {markup.percent(flow.returned_j / flow.work_j)}"
        if flow.work_j > 0.0 and not flow.net
        else ""
    )
    first = "back into the cells" if flow.returned_j >= 0.0 else "taken from the cells"
    drawn.append(
        _lines(
            LEFT + 10.0,
            gap_y,
            first,
            f"{markup.kilojoules(abs(flow.returned_j))}{share}",
            "start",
            14.0,
        )
    )
    return drawn
