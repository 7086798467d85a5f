# SPDX-License-Identifier: Apache-2.0
"""The bench from Python is the bench of ``hubsim run``.

Same results, steps of any length, events between steps.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import hubsim
import numpy as np
import pytest
from hubsim import run, scenario
from hubsim.engine import ROOT
from regen_table import schema

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"
STOP: dict[str, Any] = {"initial_speed_kmh": 10.0, "demand_nm": 30.0, "stop_at_standstill": True}


def test_a_run_is_bit_identical_to_that_of_the_command(config: hubsim.Configuration) -> None:
    with hubsim.Bench(config, "stop", **STOP) as bench:
        recording = bench.run()
    name, chosen, beside = scenario.load("stop", STOP)
    expected = run.simulate(name, schema.load(LU2013), chosen, beside, ["*"])
    assert list(recording) == expected.names
    assert np.array_equal(recording.rows, expected.rows)


def test_events_of_a_scenario_have_the_same_effect_as_in_the_command(
    config: hubsim.Configuration, tmp_path: Path
) -> None:
    path = tmp_path / "stab.toml"
    path.write_text(
        "initial_speed_kmh = 20.0\nmax_duration_s = 1.0\ndemand_trace_nm = [[0.0, 0.0], [0.2, "
        "30.0], [0.6, 0.0]]\n"
        '[events.slip]\nat_s = 0.4\ninject = "abs"\n',
        encoding="utf-8",
    )
    with hubsim.Bench(config, path) as bench:
        recording = bench.run()
    name, chosen, beside = scenario.load(str(path), {})
    expected = run.simulate(name, schema.load(LU2013), chosen, beside, ["*"])
    assert np.array_equal(recording.rows, expected.rows)
    assert np.max(recording["driver.brake_nm"]) == pytest.approx(30.0, rel=0.05)
    assert recording["wheel0.command_nm"][-1] == 0.0


def test_signals_are_arrays_and_have_units(config: hubsim.Configuration) -> None:
    with hubsim.Bench(
        config, record=("time_s", "vehicle.*", "wheel0.motor_torque_nm"), **STOP
    ) as bench:
        recording = bench.run()
        assert bench.ended
        assert abs(bench["vehicle.speed_m_per_s"]) < 1e-9
    assert recording.units["vehicle.speed_m_per_s"] == "m/s"
    assert recording.units["wheel0.motor_torque_nm"] == "N.m"
    assert "airgap" in recording.texts["wheel0.motor_torque_nm"]
    speed = recording["vehicle.speed_m_per_s"]
    assert speed.shape == recording["time_s"].shape
    assert speed[0] == pytest.approx(10.0 / 3.6)
    assert np.all(np.diff(speed) < 1e-3)
    with pytest.raises(KeyError, match="not recorded"):
        _ = recording["battery.soc"]


def test_the_result_is_independent_of_the_step_length(config: hubsim.Configuration) -> None:
    with hubsim.Bench(config, record=("time_s", "vehicle.speed_m_per_s"), **STOP) as whole:
        at_once = whole.run(0.3).rows
    with hubsim.Bench(config, record=("time_s", "vehicle.speed_m_per_s"), **STOP) as pieces:
        for _ in range(1000):
            pieces.step()
        pieces.step(0.15)
        in_pieces = pieces.run(0.1).rows
        assert pieces.time_s == pytest.approx(0.3)
    assert np.array_equal(at_once, in_pieces)


def test_a_pedal_can_be_set_during_the_run(config: hubsim.Configuration) -> None:
    with hubsim.Bench(config, initial_speed_kmh=20.0, drag=False) as bench:
        coasting = bench.run(0.5)
        bench.set("driver.brake_demand_nm", 25.0)
        assert bench.get("driver.brake_demand_nm") == 25.0
        braking = bench.run(0.5)
    # 4 wheels, 25 N m at 0.25 m on 660 kg; the demand rises for 63 ms at 400 N m/s.
    assert np.ptp(coasting["vehicle.speed_m_per_s"]) < 0.02
    assert braking["vehicle.acceleration_m_per_s2"][-1] == pytest.approx(
        -4 * 25.0 / 0.25 / 660.0, rel=0.01
    )


def test_plant_and_controller_parameters_can_differ(
    config: hubsim.Configuration, angle_config: hubsim.Configuration
) -> None:
    with hubsim.Bench(config, plant={"motor.phase_resistance_ohm": 0.05}, **STOP) as bench:
        assert bench.get("motor.phase_resistance_ohm") == 0.05
    timid = hubsim.load_configuration(
        LU2013, {"motor.max_torque_nm": 10.0, "motor.rated_torque_nm": 10.0}
    )
    settings = STOP | {"initial_speed_kmh": 20.0}
    with hubsim.Bench(
        config, controller=timid, record=("wheel0.motor_torque_nm",), **settings
    ) as bench:
        weak = bench.run(0.5)["wheel0.motor_torque_nm"]
    assert np.min(weak) == pytest.approx(-10.0, rel=0.03)


@pytest.mark.parametrize("kind", [hubsim.Bench, hubsim.Plant])
def test_a_drive_and_what_differs_from_it_are_both_given(
    kind: Callable[..., hubsim.Bench | hubsim.Plant],
) -> None:
    """The scenario's key has the name of the first argument."""
    sections = {"bus": {"capacitance_f": 0.01}}
    changed = [
        (kind("lu2013", drive=sections, **STOP), True),
        (kind(drive="lu2013", **STOP), False),
    ]
    for one, differs in changed:
        with one:
            engine = one.engine if isinstance(one, hubsim.Bench) else one._engine
            assert (engine.get("bus.capacitance_f") == 0.01) is differs


def test_errors_are_reported_in_one_line(config: hubsim.Configuration, tmp_path: Path) -> None:
    image = tmp_path / "x.bin"
    image.write_bytes(config.image)
    mistakes: list[Callable[[], object]] = [
        lambda: hubsim.Bench(image),
        lambda: hubsim.Bench(config, colour="red"),
        lambda: hubsim.Bench(config, initial_speed_kmh=-500.0),
        lambda: hubsim.Bench(config, record=("wheel9.*",)),
        lambda: hubsim.Bench(config, plant={"motor.colour": 1.0}),
        lambda: hubsim.Bench(config, "nowhere"),
    ]
    for wrong in mistakes:
        with pytest.raises(hubsim.HubsimError) as caught:
            wrong()
        assert "\n" not in str(caught.value)


def test_events_of_a_scenario_are_applied_at_their_times(
    config: hubsim.Configuration, tmp_path: Path
) -> None:
    path = tmp_path / "slope.toml"
    path.write_text(
        "initial_speed_kmh = 20\nmax_duration_s = 0.6\n[drive.brake]\nparallel_electric_share = "
        "0.5\n"
        "[drive.control]\ncoast_delay_s = 0\n"  # an open bridge leaves the iron drag
        "[events.hill]\nat_s = 0.2\nover_s = 0.1\nset.road.slope = 0.1\n", encoding="utf-8",
    )  # fmt: skip
    with hubsim.Bench(config, path) as bench:
        bench.run(0.25)
        assert bench.get("road.slope") == pytest.approx(0.05, abs=1.1e-3)
        bench.step(0.1)
        rest = bench.run()
    assert bench_slope(rest) == pytest.approx(9.80665 * 0.1 / np.sqrt(1.01), rel=0.03)


def bench_slope(recording: hubsim.Recording) -> float:
    """Return the deceleration by a slope of 10 %, without rolling resistance and drag."""
    late = recording["time_s"] > 0.4
    return (
        float(-np.mean(recording["vehicle.acceleration_m_per_s2"][late]))
        - 0.014 * 9.80665
        - 0.336 * 5.4**2 / 660.0
    )
