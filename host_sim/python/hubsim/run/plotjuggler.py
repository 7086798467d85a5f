# SPDX-License-Identifier: Apache-2.0
"""A PlotJuggler layout from a list of signals: which curves belong together, and in which colours.

PlotJuggler 3 (``plotjuggler --layout FILE.xml``, or Layout, Load) shows a page for the vehicle, one
for the torques and one for each wheel; curves of signals that were not recorded are left out, and
so are empty plots. A layout that was written with a CSV recording names it, and PlotJuggler loads
it without a question.
"""

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

# The layout for everything that the paper's vehicle can record: 'hubsim list --layout' prints it, a
# test keeps it up to date.
PATH = Path(__file__).resolve().parent / "plotjuggler.xml"

# A tab is a name and its plots from top to bottom; a plot is the patterns of its curves. "{k}"
# stands for a wheel.
_VEHICLE = (
    ("driver.reference_m_per_s", "vehicle.speed_m_per_s", "vehicle.wheel_speed*"),
    ("driver.drive_nm", "driver.brake_nm"),
    ("battery.current_a", "bus.current_a"),
    ("battery.voltage_v", "bus.voltage_v"),
)
_TORQUES = (
    ("wheel*.motor_torque_nm",),
    ("wheel*.hydraulic_torque_nm",),
    ("wheel*.available_nm",),
    ("wheel*.reason", "wheel*.available_reason", "wheel*.fault_reason"),
)
_WHEEL = (
    (
        "wheel{k}.motor_torque_nm",
        "wheel{k}.command_nm",
        "wheel{k}.estimate_nm",
        "wheel{k}.hydraulic_torque_nm",
    ),
    (
        "wheel{k}.current_d_a",
        "wheel{k}.current_q_a",
        "wheel{k}.current_d_estimate_a",
        "wheel{k}.current_q_estimate_a",
    ),
    (
        "wheel{k}.dc_w",
        "wheel{k}.shaft_w",
        "wheel{k}.copper_w",
        "wheel{k}.iron_w",
        "wheel{k}.inverter_w",
    ),
    ("wheel{k}.winding_temperature_c", "wheel{k}.switch_temperature_c"),
    ("wheel{k}.slip", "wheel{k}.reason", "wheel{k}.mode"),
)
# Okabe and Ito's colours, distinguishable with most kinds of colour blindness.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999")


# What PlotJuggler's readers of files keep in a layout. CSV: now "parameters", "default" in older
# ones; comma is delimiter 0. Parquet: the column of time, and that it is neither the rows' number
# nor a date (the misspelt name is PlotJuggler's).
_CSV = (
    "DataLoad CSV",
    (
        ("parameters", {"time_axis": "time_s", "delimiter": "0"}),
        ("default", {"time_axis": "time_s", "delimiter": "0"}),
    ),
)
_PARQUET = (
    "DataLoad Parquet", (("default", {
        "prevTimestamp": "time_s", "radioIndexChecked": "0", "parseDateTime": "0", "dateFromat": "",
    }),)
)  # fmt: skip


def layout(signals: Sequence[str], recording: str | None = None) -> str:
    """Return the layout for recorded signals as an XML document.

    Parameters
    ----------
    recording : str, optional
        A CSV file that PlotJuggler loads with the layout, seen from the layout's directory.
    """
    root = ET.Element("root")
    window = ET.SubElement(root, "tabbed_widget", {"name": "Main Window", "parent": "main_window"})
    for name, plots in _tabs(signals):
        curves = [found for patterns in plots if (found := _matching(signals, patterns))]
        if curves:
            _add_tab(window, name, curves)
    ET.SubElement(window, "currentTabIndex", index="0")
    ET.SubElement(root, "use_relative_time_offset", enabled="0")
    plugins = ET.SubElement(root, "Plugins")
    for plugin in (_CSV, _PARQUET):
        _add_plugin(plugins, *plugin)
    if recording is not None:
        loaded = ET.SubElement(
            ET.SubElement(root, "previouslyLoaded_Datafiles"),
            "fileInfo",
            filename=recording,
            prefix="",
        )
        _add_plugin(loaded, *_CSV)
    ET.indent(root, " ")
    return ET.tostring(root, encoding="unicode", xml_declaration=False).join(
        ("<?xml version='1.0' encoding='UTF-8'?>\n", "\n")
    )


def _tabs(signals: Sequence[str]) -> Iterable[tuple[str, Sequence[Sequence[str]]]]:
    yield "vehicle", _VEHICLE
    yield "torques", _TORQUES
    wheels = {
        name.partition(".")[0].removeprefix("wheel") for name in signals if name.startswith("wheel")
    }
    for k in sorted(wheels, key=int):
        yield f"wheel {k}", [[pattern.replace("{k}", k) for pattern in plot] for plot in _WHEEL]


def _matching(signals: Sequence[str], patterns: Sequence[str]) -> list[str]:
    return [name for pattern in patterns for name in signals if fnmatchcase(name, pattern)]


def _add_plugin(
    parent: ET.Element, name: str, states: Sequence[tuple[str, dict[str, str]]]
) -> None:
    plugin = ET.SubElement(parent, "plugin", ID=name)
    for element, attributes in states:
        ET.SubElement(plugin, element, attributes)


def _add_tab(window: ET.Element, name: str, plots: Sequence[Sequence[str]]) -> None:
    tab = ET.SubElement(window, "Tab", tab_name=name, containers="1")
    share = f"{1.0 / len(plots):.6f}"
    container = ET.SubElement(tab, "Container")
    splitter = ET.SubElement(
        container,
        "DockSplitter",
        orientation="-",
        count=str(len(plots)),
        sizes=";".join([share] * len(plots)),
    )
    for curves in plots:
        area = ET.SubElement(splitter, "DockArea", name="...")
        plot = ET.SubElement(
            area, "plot", mode="TimeSeries", style="Lines", flip_x="false", flip_y="false"
        )
        ET.SubElement(plot, "limitY")
        for n, curve in enumerate(curves):
            ET.SubElement(plot, "curve", name=curve, color=_COLOURS[n % len(_COLOURS)])
