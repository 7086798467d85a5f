# SPDX-License-Identifier: Apache-2.0
import json

from hubsim.report import markup
from hubsim.report.markup import Markup, element

from tests.unit.host_sim.report import documents

HOSTILE = "</script><b a='1' c=\"2\">&amp;"


def test_text_and_attributes_are_parsed_back_unchanged() -> None:
    node = documents.read(element("p", HOSTILE, title=HOSTILE, data_x="1")).all("p")[0]
    assert node.words() == HOSTILE
    assert node.attributes == {"title": HOSTILE, "data-x": "1"}


def test_nested_elements_are_escaped_once() -> None:
    assert element("p", element("b", "<")) == "<p><b>&lt;</b></p>"
    assert isinstance(markup.join("<", Markup("<br>")), Markup)
    assert markup.join("<", Markup("<br>")) == "&lt;<br>"


def test_none_is_omitted_and_void_elements_have_no_end_tag() -> None:
    assert element("br", class_=None) == "<br>"


def test_coordinates_have_no_trailing_zeros_and_no_negative_zero() -> None:
    assert [markup.number(value) for value in (1.0, 0.125, 2.5, -0.001, 100.0, -3.456)] == [
        "1",
        "0.12",
        "2.5",
        "0",
        "100",
        "-3.46",
    ]


def test_embedded_data_cannot_close_the_script_element() -> None:
    value = {"text": HOSTILE, "numbers": [1.5, None]}
    script = documents.read(markup.data(value)).all("script")[0]
    assert not script.children
    assert json.loads(script.text) == value
