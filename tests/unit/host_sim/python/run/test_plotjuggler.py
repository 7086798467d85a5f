# SPDX-License-Identifier: Apache-2.0
"""The layout for PlotJuggler against the format of that program and the recordable signals."""

import itertools
import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import pytest
from hubsim.cli import commands
from hubsim.run import plotjuggler


@dataclass(frozen=True)
class Element:
    """Format of an element in PlotJuggler 3.

    Attributes with their values; children with their permitted number.
    """

    attributes: dict[str, str] = field(default_factory=dict)
    children: dict[str, tuple[int, int]] = field(default_factory=dict)


MANY = 1000
NUMBER = r"[0-9]+(\.[0-9]+)?"
# From PlotJuggler's own readers: MainWindow::loadLayoutFromFile, loadPluginState and xmlLoadState,
# TabbedPlotWidget::xmlLoadState, PlotDocker::xmlLoadState and restoreSplitter,
# PlotWidget::xmlLoadState, DataLoadCSV and DataLoadParquet::xmlLoadState. They ignore unknown
# names, so a misspelt attribute has no effect and only a check finds it.
FORMAT = {
    "root": Element(
        {},
        {
            "tabbed_widget": (1, 1),
            "use_relative_time_offset": (1, 1),
            "Plugins": (1, 1),
            "previouslyLoaded_Datafiles": (0, 1),
        },
    ),
    # The main window always exists; the program crashes for a window of another name.
    "tabbed_widget": Element(
        {"name": "Main Window", "parent": "main_window"},
        {"Tab": (1, MANY), "currentTabIndex": (1, 1)},
    ),
    "Tab": Element({"tab_name": ".+", "containers": "1"}, {"Container": (1, 1)}),
    "Container": Element({}, {"DockSplitter": (1, 1)}),
    "DockSplitter": Element(
        {"orientation": r"[|-]", "count": "[1-9][0-9]*", "sizes": f"{NUMBER}(;{NUMBER})*"},
        {"DockArea": (0, MANY), "DockSplitter": (0, MANY)},
    ),
    "DockArea": Element({"name": ".+"}, {"plot": (1, 1)}),
    "plot": Element(
        {
            "mode": "TimeSeries|XYPlot",
            "style": "Lines|LinesAndDots|Dots|Sticks|Steps|StepsInv",
            "flip_x": "true|false",
            "flip_y": "true|false",
        },
        {"limitY": (0, 1), "range": (0, 1), "curve": (1, MANY)},
    ),
    "limitY": Element(),
    "curve": Element({"name": "[a-z0-9_.]+", "color": "#[0-9a-f]{6}"}),
    "currentTabIndex": Element({"index": "[0-9]+"}),
    "use_relative_time_offset": Element({"enabled": "[01]"}),
    "Plugins": Element({}, {"plugin": (0, MANY)}),
    "previouslyLoaded_Datafiles": Element({}, {"fileInfo": (1, MANY)}),
    "fileInfo": Element({"filename": ".+", "prefix": ".*"}, {"plugin": (1, 1)}),
}
PLUGINS = {
    "DataLoad CSV": {
        "parameters": {"time_axis": "time_s", "delimiter": "0"},
        "default": {"time_axis": "time_s", "delimiter": "0"},
    },
    "DataLoad Parquet": {
        "default": {
            "prevTimestamp": "time_s",
            "radioIndexChecked": "0",
            "parseDateTime": "0",
            "dateFromat": "",
        }
    },
}  # "dateFromat" is how PlotJuggler spells it


def check(element: ET.Element) -> None:
    if element.tag == "plugin":
        states = PLUGINS[element.attrib["ID"]]
        assert {state.tag: state.attrib for state in element} == states
        return
    known = FORMAT[element.tag]
    assert set(element.attrib) == set(known.attributes), element.tag
    for name, value in element.attrib.items():
        assert re.fullmatch(known.attributes[name], value), (element.tag, name, value)
    assert {child.tag for child in element} <= set(known.children), element.tag
    for tag, (least, most) in known.children.items():
        assert least <= len(element.findall(tag)) <= most, (element.tag, tag)
    for child in element:
        check(child)


def curves(text: str) -> list[str]:
    return [curve.attrib["name"] for curve in ET.fromstring(text).iter("curve")]


@pytest.mark.parametrize("recording", [None, "run.csv"])
def test_every_element_and_attribute_is_one_of_plotjuggler(recording: str | None) -> None:
    text = plotjuggler.layout(commands.signal_names(), recording)
    assert text.startswith("<?xml version='1.0' encoding='UTF-8'?>\n<root>")
    root = ET.fromstring(text)
    assert root.tag == "root"
    check(root)
    tabs = root.findall("tabbed_widget/Tab")
    current = root.find("tabbed_widget/currentTabIndex")
    assert current is not None
    assert int(current.attrib["index"]) < len(tabs)
    for splitter in root.iter(
        "DockSplitter"
    ):  # PlotJuggler reads "count" sizes and fills "count" areas
        assert (
            int(splitter.attrib["count"])
            == len(splitter)
            == splitter.attrib["sizes"].count(";") + 1
        )
        assert sum(map(float, splitter.attrib["sizes"].split(";"))) == pytest.approx(1.0, abs=1e-5)


def test_a_misspelt_attribute_is_detected() -> None:
    text = plotjuggler.layout(commands.signal_names())
    for right, wrong in (
        ("prevTimestamp", "time_axis"),
        ("flip_x", "flipx"),
        ("<limitY", "<limits"),
        ("Main Window", "main"),
        ("#0072b2", "blue"),
    ):
        with pytest.raises((AssertionError, KeyError)):
            check(ET.fromstring(text.replace(right, wrong)))


def test_the_layout_contains_only_existing_signals() -> None:
    known = commands.signal_names()
    text = plotjuggler.layout(known)
    root = ET.fromstring(text)
    assert set(curves(text)) <= set(known)
    assert [tab.attrib["tab_name"] for tab in root.iter("Tab")] == [
        "vehicle",
        "torques",
        *(f"wheel {k}" for k in range(4)),
    ]
    for plot in root.iter("plot"):
        found = [curve.attrib for curve in plot.iter("curve")]
        assert len({curve["name"] for curve in found}) == len(found)
        assert all(a["color"] != b["color"] for a, b in itertools.pairwise(found))


def test_a_layout_refers_to_its_recording() -> None:
    assert list(ET.fromstring(plotjuggler.layout(["time_s", "wheel0.mode"])).iter("fileInfo")) == []
    root = ET.fromstring(plotjuggler.layout(["time_s", "wheel0.mode"], "../data/run.csv"))
    (loaded,) = root.iter("fileInfo")
    assert loaded.attrib["filename"] == "../data/run.csv"
    assert loaded[0].attrib["ID"] == "DataLoad CSV"


def test_every_important_signal_is_in_the_layout() -> None:
    shown = curves(plotjuggler.layout(commands.signal_names()))
    for signal in (
        "driver.reference_m_per_s",
        "vehicle.speed_m_per_s",
        "battery.current_a",
        "bus.voltage_v",
        "wheel3.hydraulic_torque_nm",
        "wheel0.current_q_a",
        "wheel1.dc_w",
        "wheel2.winding_temperature_c",
        "wheel0.reason",
        "wheel0.mode",
    ):
        assert signal in shown


def test_a_layout_omits_signals_that_were_not_recorded() -> None:
    assert curves(
        plotjuggler.layout(["time_s", "vehicle.speed_m_per_s", "wheel10.mode", "wheel2.mode"])
    ) == ["vehicle.speed_m_per_s", "wheel2.mode", "wheel10.mode"]


def test_the_layout_in_the_package_is_up_to_date() -> None:
    assert plotjuggler.PATH.read_text(encoding="utf-8") == plotjuggler.layout(
        commands.signal_names()
    )
