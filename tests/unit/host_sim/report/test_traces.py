# SPDX-License-Identifier: Apache-2.0
import re

import numpy as np
import pytest
from hubsim.report import traces

from tests.unit.host_sim.report import documents
from tests.unit.host_sim.report.documents import Node
from tests.unit.host_sim.report.ideal_vehicle import Run, drive, three


def column(run: Run, runs: list[Run]) -> Node:
    shared = traces.layout(runs)
    assert shared is not None
    return documents.read(traces.draw(run, shared, "column", "Signals over time"))


def coordinates(node: Node) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    numbers = re.findall(r"-?\d+(?:\.\d+)?", node.attributes["d"])
    return np.array(numbers, dtype=np.float64).reshape(-1, 2)


def test_scales_and_heights_are_equal_in_all_columns() -> None:
    runs = three()
    ticks = [
        [
            text.words()
            for text in column(run, runs).all("text", "tick")
            if re.fullmatch(r"[−\d.]+", text.words())
        ]
        for run in runs
    ]
    assert ticks[0] == ticks[1] == ticks[2]
    assert len({column(run, runs).all("svg")[0].attributes["viewbox"] for run in runs}) == 1


def test_a_curve_is_drawn_at_its_values() -> None:
    run = drive()
    shared = traces.layout([run])
    assert shared is not None
    panel, axis, _ = shared.panels[0]
    assert panel.title == "Speed"
    actual = next(
        node
        for node in column(run, [run]).all("path", "vehicle")
        if "curve" in node.attributes["class"]
    )
    drawn = coordinates(actual)
    speed_kmh = 3.6 * np.interp(
        drawn[:, 0], shared.time.px(run.time_s), run.signals["vehicle.speed_m_per_s"]
    )
    assert np.allclose(drawn[:, 1], axis.px(speed_kmh), atol=1.0)
    assert drawn[:, 1].min() == pytest.approx(axis.at(37.5), abs=0.3)


def test_motor_and_hydraulic_areas_are_stacked_up_to_the_demand() -> None:
    run = drive("parallel_ratio")
    shared = traces.layout([run])
    assert shared is not None
    _, axis, _ = shared.panels[1]
    area = next(
        node
        for node in column(run, [run]).all("path", "hydraulic")
        if "area" in node.attributes["class"]
    )
    lowest = axis.at(-float(np.max(run.signals["driver.brake_nm"])))
    assert coordinates(area)[:, 1].max() == pytest.approx(lowest, abs=0.1)


def test_hydraulic_torque_against_a_driving_motor_is_drawn_below_zero() -> None:
    run = drive("parallel_ratio")
    driving = (run.time_s > 12.0) & (run.time_s < 14.0)
    run.signals["wheel0.hydraulic_torque_nm"] = np.where(driving, 10.0, 0.0)
    shared = traces.layout([run])
    assert shared is not None
    _, axis, _ = shared.panels[1]
    area = next(
        node
        for node in column(run, [run]).all("path", "hydraulic")
        if "area" in node.attributes["class"]
    )
    drawn = coordinates(area)
    there = drawn[(drawn[:, 0] > shared.time.at(11.5)) & (drawn[:, 0] < shared.time.at(14.5))]
    assert drawn[:, 1].min() == pytest.approx(axis.at(0.0), abs=0.1)
    assert there[:, 1].max() == pytest.approx(axis.at(-10.0), abs=0.1)


def test_the_background_is_shaded_exactly_while_the_driver_brakes() -> None:
    run = drive()
    shared = traces.layout([run])
    assert shared is not None
    outline = column(run, [run]).all("path", "braking")[0].attributes["d"]
    spans = [(float(a), float(b)) for a, b in re.findall(r"M(\S+) \S+H(\S+)V", outline)]
    # The cycle slows down to rest three times and once from 50 to 35 km/h.
    assert len(spans) == 4
    begin, end = spans[1]
    assert begin == pytest.approx(shared.time.at(85.0), abs=0.1)
    assert end == pytest.approx(shared.time.at(96.0), abs=0.1)


def test_every_reason_has_a_text_a_duration_and_a_bar_of_that_length() -> None:
    runs = three()
    shared = traces.layout(runs)
    assert shared is not None
    assert [code for code, _, _ in shared.reasons] == [1, 14]
    ratio = column(runs[0], runs)
    strip = next(
        node for node in ratio.all("path", "limit") if "fixed electric share" in node.words()
    )
    spans = [
        (float(a), float(b)) for a, b in re.findall(r"M(\S+) \S+H(\S+)V", strip.attributes["d"])
    ]
    seconds = float(np.sum(runs[0].signals["wheel0.reason"][:-1] == 14) * 0.05)
    assert sum(b - a for a, b in spans) == pytest.approx(
        seconds * (shared.time.at(1.0) - shared.time.at(0.0)), abs=0.1
    )
    assert f"{seconds:.0f} s" in ratio.words()
    series = column(runs[2], runs)
    assert "never" in series.words()
    assert "more torque would return less energy" in series.words()


def test_a_fault_is_drawn_in_the_colour_of_faults() -> None:
    run = drive()
    run.signals["wheel0.reason"][100:200] = 67.0
    run.summary["reason_texts"]["67"] = "phase over-current"
    faults = column(run, [run]).all("path", "fault")
    assert [fault.words() for fault in faults] == ["phase over-current: 5.0 s"]


def test_a_signal_missing_in_one_run_is_marked_as_missing() -> None:
    runs = three()
    runs[1].signals["battery.current_a"] = np.full(runs[1].time_s.shape, np.nan)
    assert "not recorded" in column(runs[1], runs).words()
    assert "not recorded" not in column(runs[0], runs).words()


def test_a_constant_quantity_is_stated_as_text() -> None:
    run = drive()
    run.signals["wheel0.winding_temperature_c"] = np.full(run.time_s.shape, 25.0)
    assert "25.0 °C throughout" in column(run, [run]).words()


def test_gaps_and_non_finite_values_are_not_in_the_path() -> None:
    run = drive()
    run.signals["battery.voltage_v"][::7] = np.nan
    run.signals["battery.current_a"][50] = np.inf
    for path in column(run, [run]).all("path"):
        assert "nan" not in path.attributes["d"]
        assert "inf" not in path.attributes["d"]


def test_the_cursor_read_out_shows_the_values_at_its_time() -> None:
    run = drive("parallel_ratio")
    shared = traces.layout([run])
    assert shared is not None
    data = traces.readout(run, shared)
    assert data is not None
    series = data["series"]
    assert isinstance(series, list)
    hydraulic = next(entry for entry in series if entry["name"] == "hydraulic")
    grid = np.linspace(0.0, 195.0, len(hydraulic["values"]))
    there = (grid > 88.0) & (grid < 94.0)
    # The magnitude of the brake's torque, not the place of its area.
    expected = np.interp(grid, run.time_s, run.signals["wheel0.hydraulic_torque_nm"])
    assert np.allclose(
        np.array(hydraulic["values"], dtype=np.float64)[there], expected[there], atol=0.06
    )
    assert data["left"] == traces.LEFT and data["right"] == pytest.approx(traces.RIGHT)


def test_an_empty_recording_has_no_layout() -> None:
    run = drive()
    run.signals = {}
    assert traces.layout([run]) is None
    run.time_s = np.array([])
    assert traces.layout([run]) is None
