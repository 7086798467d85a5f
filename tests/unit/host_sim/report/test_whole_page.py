# SPDX-License-Identifier: Apache-2.0
"""The page with everything in it.

Self-contained, valid pictures, one target for every reference.
"""

import re
import xml.etree.ElementTree as ET
from collections import Counter

from hubsim.report import Extras, page

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.ideal_extras import best_map, curves
from tests.unit.host_sim.report.ideal_vehicle import STRATEGIES, drive, three

DRAWABLE = {
    "svg",
    "g",
    "defs",
    "clipPath",
    "linearGradient",
    "stop",
    "path",
    "rect",
    "line",
    "circle",
    "text",
    "tspan",
    "title",
    "desc",
}


def whole() -> str:
    runs = [*three(), *[drive(strategy, cycle="udds") for strategy in STRATEGIES]]
    return page.document(runs, Extras({"lu2013": best_map()}, curves()))


def test_the_page_contains_every_given_part() -> None:
    headings = [heading.words() for heading in documents.read(whole()).all("h2")]
    for wanted in (
        "Energy flow",
        "Where the motor brakes",
        "Over time",
        "Stops: how much of the kinetic energy comes back",
    ):
        assert any(wanted in heading for heading in headings), wanted
    words = documents.read(whole()).words()
    for wanted in (
        "Total torque error, N·m",
        "Jerk, m/s³",
        "Motor current, A",
        "What limited the torque",
    ):
        assert wanted in words, wanted


def test_without_map_and_stops_their_parts_are_omitted() -> None:
    words = documents.read(page.document(three())).words()
    assert "Where the motor brakes" not in words
    assert "Stops:" not in words


def test_ids_are_unique_and_every_reference_has_a_target() -> None:
    text = whole()
    identities = Counter(
        node.attributes["id"] for node in documents.read(text).all() if "id" in node.attributes
    )
    assert max(identities.values()) == 1
    references = set(re.findall(r"url\(#([^)]+)\)", text)) | set(
        re.findall(r'href="#([^"]+)"', text)
    )
    assert references <= set(identities)


def test_pictures_are_well_formed_svg() -> None:
    pictures = re.findall(r"<svg.*?</svg>", whole(), flags=re.DOTALL)
    assert len(pictures) == 6 + 6 + 6 + 6 + 1  # bars, flows, points and traces of six runs, stops
    for text in pictures:
        root = ET.fromstring(text)
        assert {node.tag for node in root.iter()} <= DRAWABLE
        left, top, width, height = map(float, root.attrib["viewBox"].split())
        assert (left, top) == (0.0, 0.0)
        assert width > 0.0 and height > 0.0
        for node in root.iter("path"):
            assert re.fullmatch(r"[-\d. MLHVvhAZ]*", node.attrib["d"]), node.attrib["d"][:80]
        for node in root.iter():
            for key in ("x", "y", "x1", "x2", "y1", "y2", "cx", "cy", "width", "height"):
                assert "nan" not in node.attrib.get(key, "") and "inf" not in node.attrib.get(
                    key, ""
                )


def test_the_page_is_self_contained() -> None:
    text = re.sub(r"^ *//.*$", "", whole(), flags=re.MULTILINE)
    assert not re.search(r"https?:|url\((?!#)|@import|src=|//[a-z]", text)
