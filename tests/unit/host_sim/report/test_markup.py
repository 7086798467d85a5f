# SPDX-License-Identifier: Apache-2.0
import json

from hubsim.report import markup
from hubsim.report.markup import Markup, element

from tests.unit.host_sim.report import documents

HOSTILE = "</script><b a='1' c=\"2\">&amp;"


def test_text_and_attributes_come_back_as_they_were() -> None:
    node = documents.read(element("p", HOSTILE, title=HOSTILE, data_x="1")).all("p")[0]
    assert node.words() == HOSTILE
    assert node.attributes == {"title": HOSTILE, "data-x": "1"}


def test_an_element_inside_another_is_not_escaped_again() -> None:
    assert element("p", element("b", "<")) == "<p><b>&lt;</b></p>"
    assert isinstance(markup.join("<", Markup("<br>")), Markup)
    assert markup.join("<", Markup("<br>")) == "&lt;<br>"


def test_what_is_none_is_left_out_and_void_elements_are_not_closed() -> None:
    assert element("br", class_=None) == "<br>"


def test_coordinates_have_no_superfluous_digit_and_no_negative_zero() -> None:
    assert [markup.number(value) for value in (1.0, 0.125, 2.5, -0.001, 100.0, -3.456)] == [
        "1",
        "0.12",
        "2.5",
        "0",
        "100",
        "-3.46",
    ]


def test_data_for_a_script_cannot_end_it() -> None:
    value = {"text": HOSTILE, "numbers": [1.5, None]}
    script = documents.read(markup.data(value)).all("script")[0]
    assert not script.children
    assert json.loads(script.text) == value
