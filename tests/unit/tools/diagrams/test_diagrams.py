# SPDX-License-Identifier: Apache-2.0
"""The diagrams of firmware/README.md: current, legible, and shown there."""

import xml.etree.ElementTree as ET
from itertools import combinations

import pytest
from diagrams.__main__ import DIAGRAMS, FOLDER, PLOTS

FIRMWARE = FOLDER.parents[1] / "firmware"


@pytest.mark.parametrize("name", DIAGRAMS)
def test_the_stored_picture_is_up_to_date(name: str) -> None:
    """And a well-formed document with a title."""
    text = DIAGRAMS[name]().svg()
    assert (FOLDER / name).read_text(encoding="utf-8") == text
    root = ET.fromstring(text)
    assert root.find("{http://www.w3.org/2000/svg}title") is not None


@pytest.mark.parametrize("name", DIAGRAMS)
def test_text_fits_its_box_and_boxes_do_not_overlap(name: str) -> None:
    """By the width of an average character."""
    sheet = DIAGRAMS[name]()
    assert len(sheet.boxes) > 6
    for box in sheet.boxes:
        assert box.fits(), box
        assert box.x >= 0 and box.x + box.width <= sheet.width, box
        assert box.y >= 0 and box.y + box.height <= sheet.height, box
    for one, two in combinations(sheet.boxes, 2):
        assert (
            one.x + one.width <= two.x
            or two.x + two.width <= one.x
            or one.y + one.height <= two.y
            or two.y + two.height <= one.y
        ), (one, two)


@pytest.mark.parametrize("name", DIAGRAMS)
def test_the_readme_contains_the_picture(name: str) -> None:
    """By its path from firmware/."""
    readme = FIRMWARE / "README.md"
    assert f"](../tools/diagrams/{name})" in readme.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", PLOTS)
def test_a_plot_is_up_to_date_and_shown_by_its_module(name: str) -> None:
    module, draw = PLOTS[name]
    assert (FOLDER / name).read_text(encoding="utf-8") == draw().svg()
    readme = (FIRMWARE / module / "README.md").read_text(encoding="utf-8")
    assert f"](../../tools/diagrams/{name})" in readme


def test_messages_and_modules_of_the_picture_exist() -> None:
    """A renamed message or module must be renamed in the picture as well."""
    text = DIAGRAMS["signal_flow.svg"]().svg()
    firmware = FIRMWARE
    header = (firmware / "core/include/core/fast_messages.h").read_text(encoding="utf-8")
    for message in ("fast_setpoint_t", "fast_report_t"):
        assert message in text and f"}} {message};" in header
    for module in ("torque/", "foc/", "controller/"):
        assert module in text and (firmware / module).is_dir()
