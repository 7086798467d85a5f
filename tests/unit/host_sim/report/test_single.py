# SPDX-License-Identifier: Apache-2.0
"""The page of one run: its criteria, the ideal stop beside it, one curve for each wheel."""

import copy
from typing import Any

import numpy as np
import pytest
from hubsim.report import lanes, markup, page, panels, reading, traces
from hubsim.report.flows import differences_j, flow_of

from tests.unit.host_sim.report.documents import Node, read
from tests.unit.host_sim.report.ideal_vehicle import Run, drive, three

IDEAL = {
    "kinetic_energy_j": 40000.0,
    "energy_j": {
        "battery_returned": 30000.0, "hydraulic": 500.0, "copper": 5000.0, "iron": 2000.0,
        "inverter": 1000.0, "battery": 400.0, "polarisation": 100.0, "friction": 1000.0,
    },
}  # fmt: skip
CRITERIA: list[dict[str, Any]] = [
    {"name": "as_short", "passed": True, "value": 54.69684, "at_least": None, "at_most": 67.2,
     "unit": "m", "text": "as short as the demand", "remark": ""},
    {"name": "slows", "passed": False, "value": 1.25, "at_least": 1.5, "at_most": 1.75,
     "unit": "m/s2", "text": "", "remark": "too late"},
    {"name": "settles", "passed": False, "value": None, "at_least": None, "at_most": 0.3,
     "unit": "s", "text": "", "remark": "never settles"},
]  # fmt: skip


def table(document: Node, caption: str) -> dict[str, list[str]]:
    """Texts of a table's numbers by the name of their row."""
    (found,) = [t for t in document.all("table") if caption in t.all("caption")[0].words()]
    rows = found.all("tbody")
    return {
        row.all("span", "name")[0].words(): [cell.words() for cell in row.all("td")]
        for body in rows
        for row in body.all("tr")
    }


def test_criteria_are_shown_with_value_limit_and_result() -> None:
    run = drive()
    run.summary["criteria"] = CRITERIA
    document = read(page.document([run]))
    found = table(document, "1 of 3 criteria met")
    # In words where the scenario has some, with what is accepted under them.
    assert [text.split() for text in found["As short as the demand"]] == [["met", "54.7", "m"]]
    assert found["Slows"][0].split() == ["not", "met", "1.25", "m/s²", "too", "late"]
    assert found["Settles"][0].split() == ["not", "met", "–", "never", "settles"]
    meanings = [node.words() for node in document.all("span", "meaning")]
    assert {"at most 67.2 m", "1.5 to 1.75 m/s²", "at most 0.3 s"} <= set(meanings)
    assert len(document.all("span", "met")) == 1
    assert len(document.all("span", "missed")) == 2


def test_criteria_of_several_runs_are_shown_in_columns_with_their_own_limits() -> None:
    runs = three()
    for place, run in enumerate(runs):
        run.summary["criteria"] = [CRITERIA[0] | {"at_most": 60.0 + place, "value": 50.0 + place}]
    found = table(read(page.document(runs)), "3 of 3 criteria met")["As short as the demand"]
    assert [cell.split() for cell in found] == [
        ["met", str(50 + k), "m", "at", "most", str(60 + k), "m"] for k in range(3)
    ]


def test_a_criterion_of_reasons_is_told_in_words_and_one_that_does_not_apply_is_not_counted() -> (
    None
):
    run = drive()
    run.summary["criteria"] = [
        {"name": "no_fault", "passed": True, "value": 0.0, "at_least": None, "at_most": 0.0,
         "unit": "", "text": "", "remark": "seen: NONE"},
        {"name": "says_why", "passed": False, "value": 1.0, "at_least": None, "at_most": 0.0,
         "unit": "", "text": "", "remark": "missing: ABS; seen: NONE"},
        {"name": "taken_over", "passed": True, "value": None, "at_least": None, "at_most": None,
         "unit": "N m", "text": "", "remark": "does not apply: needs a brake", "applies": False},
    ]  # fmt: skip
    found = table(read(page.document([run])), "1 of 2 criteria met")
    assert found["No controller finds a fault"] == ["met"]
    assert found["The controllers say why"][0].split()[:3] == ["not", "met", "missing:"]
    assert found["Taken over"] == ["does not apply: needs a brake"]


def test_pictures_come_before_criteria() -> None:
    for runs in ([drive()], three()):
        for run in runs:
            run.summary["criteria"] = CRITERIA
        text = page.document(runs)
        assert text.index("Energy flow") < text.index("criteria met")


def test_a_flow_picture_says_how_it_differs_from_the_best() -> None:
    """The ideal vehicle's flows, one by one: what is returned less goes where the rest says."""
    runs = three()
    found = [flow_of(run) for run in runs]
    best = max((flow for flow in found if flow is not None), key=lambda flow: flow.returned_j)
    document = read(page.document(runs))
    texts = [node.words() for node in document.all("p", "difference")]
    assert len(texts) == len(runs)
    for text, flow in zip(texts, found, strict=True):
        assert flow is not None
        if flow is best:
            assert text == "Returns the most of them."
            continue
        assert f"Returns {markup.kilojoules(best.returned_j - flow.returned_j)} less than" in text
        parts = differences_j(flow, best)
        assert sum(parts.values()) == pytest.approx(
            best.returned_j - flow.returned_j + flow.work_j - best.work_j,
            abs=1e-3 * best.work_j,
        )


def test_one_run_is_compared_with_the_ideal_stop_and_not_with_itself() -> None:
    run = drive()
    run.summary["ideal_stop"] = IDEAL
    document = read(page.document([run]))
    found = table(document, "Energies")
    assert "Share of the series optimum" not in found
    assert found["Returned to the battery"][2] == "30.00"
    assert found["Braking work at the wheels"][2] == "39.00"  # without the bearings' friction
    assert found["Traction"][2] == "–"
    own, ideal = float(found["Share stored"][1]), float(found["Share stored"][2])
    assert ideal == pytest.approx(100.0 * 30.0 / 39.0, abs=0.05)
    assert float(found["Share of the ideal"][1]) == pytest.approx(100.0 * own / ideal, abs=0.1)
    assert "The ideal stop has the same demand" in document.words()
    plain = read(page.document([drive()]))
    assert "Ideal stop" not in plain.words()
    assert "Share of the series optimum" in table(read(page.document(three())), "Energies")


def wheels(differing: float) -> Run:
    """Return a run of four wheels whose last wheel has different torques."""
    run = copy.deepcopy(drive())
    names = [name for name in run.signals if name.startswith("wheel0.")]
    for k in (1, 2, 3):
        for name in names:
            factor = 1.0 - differing if k == 3 and name.endswith("torque_nm") else 1.0
            run.signals[name.replace("wheel0", f"wheel{k}")] = factor * run.signals[name]
    return run


def test_equal_wheels_are_drawn_as_one_curve_and_different_ones_separately() -> None:
    same, other = panels.panels_of([wheels(0.0)]), panels.panels_of([wheels(0.5)])
    assert [panel.title for panel in same] == [panel.title for panel in panels.panels_of([drive()])]
    torque = next(panel for panel in other if panel.title == "Motor torque")
    assert [curve.name for curve in torque.curves] == [f"wheel {k}" for k in range(4)]
    run = wheels(0.5)
    for k, curve in enumerate(torque.curves):
        drawn = curve.of(run)
        assert drawn is not None
        assert np.array_equal(drawn, run.signals[f"wheel{k}.motor_torque_nm"])
    assert {panel.title for panel in other} >= {
        "Wheel speed", "Hydraulic torque", "Winding temperature", "Inverter temperature", "Voltage",
    }  # fmt: skip
    text = page.document([run])
    assert "The wheels differ: one curve for each." in text
    assert "the others do the same" in page.document([wheels(0.0)])


def test_a_reason_of_every_wheel_is_shown() -> None:
    run = wheels(0.5)
    run.signals["wheel2.reason"] = np.where(run.time_s < 10.0, 9.0, 0.0)
    shared = traces.layout([run])
    assert shared is not None
    assert 9 in [code for code, _, _ in shared.reasons]
    assert reading.wheels(run) == 4


def test_bus_and_battery_voltage_are_drawn_in_one_panel() -> None:
    run = drive()
    run.signals["bus.voltage_v"] = run.signals["battery.voltage_v"] + 1.0
    (panel,) = [panel for panel in panels.panels_of([run]) if panel.title == "Voltage"]
    battery, bus = (curve.of(run) for curve in panel.curves)
    assert battery is not None
    assert bus is not None
    assert np.allclose(bus - battery, 1.0)


def test_signals_of_one_run_are_drawn_in_three_pictures_with_every_panel_once() -> None:
    run = drive()
    whole = traces.layout([run])
    groups = [traces.layout([run], group) for group in range(3)]
    assert whole is not None
    assert [p.title for g in groups if g is not None for p, _, _ in g.panels] == [
        p.title for p, _, _ in whole.panels
    ]
    assert [code for g in groups if g is not None for code, _, _ in g.reasons] == [
        code for code, _, _ in whole.reasons
    ]
    document = read(page.document([run]))
    assert len(document.all("figure", "trace")) == 3
    assert len(read(page.document(three())).all("figure", "trace")) == 3


@pytest.mark.parametrize("factor", [0.02, 1.0, 50.0])
def test_labels_of_the_upper_lane_do_not_overlap(factor: float) -> None:
    """Seven outflows of a small vehicle: alternating rows where one is too narrow."""
    run = drive()
    for phase in ("while_driving_j", "while_braking_j"):
        run.summary[phase]["iron"] *= factor
        run.summary[phase]["bearing"] = 0.005 * run.summary["energy_j"]["traction"]
    flow = flow_of(run)
    assert flow is not None
    shared = lanes.frame([flow])
    laid = lanes.lay(flow, shared)
    leaving = [*laid.upper, *laid.road]
    for place, one in enumerate(leaving):
        for other in leaving[place + 1 :]:
            same_row = (leaving.index(other) - place) % shared.upper_rows == 0
            if same_row:
                assert abs(other.middle - one.middle) >= lanes.NARROW - 1e-9


def test_figures_and_units_equal_those_of_the_printed_summary() -> None:
    assert [markup.figure(x) for x in (0.0, 0.8, 54.69684, -1.5, 1e-4, 5.1e-7)] == [
        "0", "0.8", "54.7", "−1.5", "1.0 · 10⁻⁴", "5.1 · 10⁻⁷",
    ]  # fmt: skip
    assert [markup.unit(x) for x in ("N m", "N.m", "m/s2", "1", "km/h")] == [
        "N·m", "N·m", "m/s²", "", "km/h",
    ]  # fmt: skip
