# SPDX-License-Identifier: Apache-2.0
"""Events and pedal traces with a vehicle that records its settings, and with the simulated one."""

import math
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from hubsim import engine, run, scenario
from hubsim.engine import Engine
from hubsim.scenario import events
from hubsim.scenario.events import Event, Timeline
from regen_table.schema import Drive


class Notebook:
    """Records the settings in place of a vehicle."""

    def __init__(self, **values: float) -> None:
        self.values = {name.replace("__", "."): value for name, value in values.items()}
        self.now_s = 0.0
        self.notes: list[tuple[float, str, float]] = []

    def get(self, name: str) -> float:
        return self.values.get(name, 0.0)

    def set(self, name: str, value: float) -> None:
        self.values[name] = value
        self.notes.append((self.now_s, name, value))


def played(
    timeline: Timeline, notebook: Notebook, until_s: float
) -> list[tuple[float, str, float]]:
    while notebook.now_s < until_s:
        timeline.apply(cast(Engine, notebook), notebook.now_s)
        following = timeline.next_s(notebook.now_s)
        assert following > notebook.now_s
        notebook.now_s = min(following, until_s)
    return notebook.notes


def test_a_step_is_applied_once_at_its_time() -> None:
    timeline = Timeline({"one": Event(at_s=0.5, set={"road.slope": 0.1})}, {})
    assert played(timeline, Notebook(), 10.0) == [(0.5, "road.slope", 0.1)]


def test_a_ramp_starts_at_the_present_value_of_the_parameter() -> None:
    timeline = Timeline(
        {"more": Event(at_s=1.0, over_s=0.01, set={"driver.brake_demand_nm": 60.0})}, {}
    )
    notes = played(timeline, Notebook(driver__brake_demand_nm=40.0), 2.0)
    times, values = np.array([t for t, _, _ in notes]), np.array([v for _, _, v in notes])
    assert values == pytest.approx(40.0 + 20.0 * (times - 1.0) / 0.01)
    assert np.max(np.diff(times)) <= 1e-3 + 1e-12
    assert (times[-1], values[-1]) == (pytest.approx(1.01), 60.0)


def test_parameter_is_restored_after_the_end_of_an_event() -> None:
    timeline = Timeline({"abs": Event(at_s=1.0, until_s=1.5, inject="abs")}, {})
    assert played(timeline, Notebook(driver__abs_active=0.25), 3.0) == [
        (1.0, "driver.abs_active", 1.0),
        (1.5, "driver.abs_active", 0.25),
    ]


def test_events_are_applied_in_the_order_of_their_times() -> None:
    timeline = Timeline(
        {
            "late": Event(at_s=2.0, set={"road.slope": 0.2}),
            "early": Event(at_s=1.0, set={"road.slope": 0.1}),
        },
        {},
    )
    assert [value for _, _, value in played(timeline, Notebook(), 3.0)] == [0.1, 0.2]


def test_a_trace_is_interpolated_linearly_and_constant_after_its_end() -> None:
    trace = [(0.0, 0.0), (0.004, 40.0), (0.006, 40.0), (0.008, 0.0)]
    notes = played(Timeline({}, {"driver.brake_demand_nm": trace}), Notebook(), 1.0)
    times, values = np.array([t for t, _, _ in notes]), np.array([v for _, _, v in notes])
    assert values == pytest.approx(np.interp(times, [t for t, _ in trace], [v for _, v in trace]))
    assert values[-1] == 0.0
    assert times[-1] == pytest.approx(0.008)


def test_an_event_after_the_end_of_the_run_is_reported_as_missed() -> None:
    timeline = Timeline({"never": Event(at_s=9.0, inject="abs")}, {})
    assert timeline.missed(5.0) == {"never": 9.0}
    assert timeline.missed(9.0) == {}
    assert timeline.next_s(9.0) == math.inf


@pytest.mark.parametrize("name", events.INJECTIONS)
def test_every_injection_sets_existing_parameters(name: str) -> None:
    for parameter, value in events.INJECTIONS[name].sets.items():
        known = engine.parameters()[parameter]
        assert known.lowest <= value <= known.highest


def test_a_pedal_over_time_reaches_the_controllers_of_the_real_vehicle(drive: Drive) -> None:
    trace = [[0.0, 0.0], [0.1, 0.0], [0.3, 20.0], [0.5, 20.0]]
    keys = {
        "demand_trace_nm": trace,
        "max_duration_s": 0.6,
        "stop_at_standstill": False,
        "record_interval_s": 0.001,
    }
    name, chosen, beside = scenario.load("stop", keys)
    result = run.simulate(name, drive, chosen, beside, ["time_s", "driver.brake_nm"])
    # The demand is set at a millisecond and recorded in its slow step: the same instant, one row
    # later.
    expected = np.interp(result.signal("time_s") - 1e-3, *np.transpose(trace))
    assert result.signal("driver.brake_nm") == pytest.approx(expected, abs=1e-6)


def test_a_run_with_events_is_repeatable_bit_for_bit(drive: Drive, tmp_path: Path) -> None:
    path = tmp_path / "two.toml"
    path.write_text(
        'initial_speed_kmh = 20\ndemand_nm = 30.0\nmax_duration_s = 0.8\n'
        '[events.a]\nat_s = 0.2\ninject = "abs"\nuntil_s = 0.4\n'
        "[events.b]\nat_s = 0.3\nover_s = 0.1\nset.driver.brake_demand_nm = 50.0\n",
        encoding="utf-8",
    )  # fmt: skip
    plant = {"sensors.current_noise_a": 0.4}
    name, chosen, beside = scenario.load(str(path), {})
    first, second = (run.simulate(name, drive, chosen, beside, ["*"], plant) for _ in range(2))
    assert first.rows.tobytes() == second.rows.tobytes()
    assert first.account_j == second.account_j
    other = run.simulate(name, drive, chosen.model_copy(update={"seed": 2}), beside, ["*"], plant)
    assert other.rows.tobytes() != first.rows.tobytes()
