# SPDX-License-Identifier: Apache-2.0
"""The record of a controller's first fault on the page."""

import base64

from hubsim.report import page
from hubsim.report.reading import Extras, FaultRecord

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.ideal_vehicle import three

PICTURE = b'<svg xmlns="http://www.w3.org/2000/svg"/>'


def test_each_record_has_a_section_with_its_lines_and_its_picture() -> None:
    records = [
        FaultRecord("a.txt", "OVERCURRENT", ["one & two", "<three>"], PICTURE),
        FaultRecord("b.txt", "OVERVOLTAGE", [], PICTURE + b" "),
    ]
    tree = documents.read(page.document(three(), Extras(records=records)))
    sections = [node for node in tree.all("section") if node.attributes["id"].startswith("record-")]
    assert [node.attributes["id"] for node in sections] == ["record-0", "record-1"]
    headings = [node.all("h2")[0].words() for node in sections]
    assert headings == ["Black box: OVERCURRENT", "Black box: OVERVOLTAGE"]
    assert [item.words() for item in sections[0].all("li")] == ["one & two", "<three>"]
    for node, record in zip(sections, records, strict=True):
        assert record.name in node.words()
        (picture,) = node.all("img")
        kind, _, coded = picture.attributes["src"].partition(",")
        assert kind == "data:image/svg+xml;base64"
        assert base64.b64decode(coded) == record.picture
        assert picture.attributes["alt"]


def test_without_records_the_page_has_no_such_section() -> None:
    assert "Black box" not in page.document(three())
