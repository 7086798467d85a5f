# SPDX-License-Identifier: Apache-2.0
"""Every colour of text is told from every ground that it stands on: WCAG 2.1, 4.5 to 1."""

import re

import pytest
from hubsim.report import page

STYLE = page._asset("palette.css") + page._asset("page.css")
GROUNDS = ("paper", "sheet", "shade")
# Grounds and colours of areas, lines and marks beside text; all others are colours of text.
NO_TEXT = {*GROUNDS, "rule", "hydraulic", "loss", "road", "motion", "on"}
LEAST = 4.5


def colours() -> dict[str, dict[str, str]]:
    """Return the colours of the light and the dark page by name."""
    light, dark = (
        dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})", block))
        for block in re.findall(r":root \{(.*?)\}", STYLE, flags=re.DOTALL)[:2]
    )
    return {"light": light, "dark": light | dark}


def luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    linear = [x / 12.92 if x <= 0.03928 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_black_and_white_are_twenty_one_to_one() -> None:
    assert contrast("#ffffff", "#000000") == pytest.approx(21.0)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_is_told_from_its_ground(theme: str) -> None:
    known = colours()[theme]
    found = {
        (name, ground): contrast(known[name], known[ground])
        for name in known.keys() - NO_TEXT
        for ground in GROUNDS
    }
    assert {pair: ratio for pair, ratio in found.items() if ratio < LEAST} == {}
    # Labels inside the flow picture's lanes.
    assert all(contrast(known["on"], known[lane]) >= LEAST for lane in ("battery", "motor"))


def test_colours_of_areas_alone_are_no_colours_of_text() -> None:
    """A rule that sets ``color`` to one of them is of a curve or an area; its text has its own."""
    for name in ("hydraulic", "loss", "road"):
        users = re.findall(rf"([^{{}}]*)\{{ color: var\(--{name}\); \}}", STYLE)
        selectors = [one.strip() for user in users for one in user.rpartition("}")[2].split(",")]
        assert set(selectors) <= {".hydraulic", ".target", ".field"}, selectors
    assert ".key.hydraulic, .readout .hydraulic { color: var(--hydraulic-text); }" in STYLE
    assert "tr.hydraulic { color: var(--hydraulic-text); }" in STYLE
