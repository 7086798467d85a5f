# SPDX-License-Identifier: Apache-2.0
"""The FMUs in FMPy give bit-identical results to the bench and the controller."""

import itertools
import sys
from pathlib import Path

import hubsim
import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu
from hubsim.engine import ROOT
from importer import VERSIONS, Unit, path_of

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"
KINDS = ("controller", "vehicle")
SPEED_KMH = 30.0
STARTS = {"run.initial_speed_m_per_s": SPEED_KMH / 3.6, "driver.brake_demand_nm": 35.0}
EVENTS = (
    (0.3, "driver.brake_demand_nm", 12.0),
    (0.5, "motor.phase_resistance_ohm", 0.04),
    (0.7, "driver.abs_active", 1.0),
)


@pytest.mark.parametrize(("kind", "fmi"), itertools.product(KINDS, VERSIONS))
def test_fmpy_validates_every_fmu_without_a_finding(kind: str, fmi: int) -> None:
    assert validate_fmu(str(path_of(kind, fmi))) == []


@pytest.fixture(scope="module")
def bench_trace() -> hubsim.Recording:
    with hubsim.Bench(
        LU2013, initial_speed_kmh=SPEED_KMH, demand_nm=35.0, max_duration_s=1.0
    ) as bench:
        return bench.run()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_vehicle_in_fmpy_is_bit_identical_to_the_bench(
    fmi: int, bench_trace: hubsim.Recording
) -> None:
    found = simulate_fmu(
        str(path_of("vehicle", fmi)),
        start_values=STARTS,
        stop_time=1.0,
        output_interval=0.01,
        step_size=0.01,
        output=list(bench_trace),
    )
    assert len(found) == len(bench_trace["time_s"]) == 101
    assert [
        name for name in bench_trace if not np.array_equal(found[name], bench_trace[name])
    ] == []


@pytest.mark.parametrize("fmi", VERSIONS)
def test_changed_inputs_and_tunable_parameters_act_as_on_the_bench(fmi: int) -> None:
    with hubsim.Bench(
        LU2013, initial_speed_kmh=SPEED_KMH, demand_nm=35.0, record_interval_s=0.1
    ) as bench:
        rows = [bench.run(0.0).rows]
        for until_s, name, value in EVENTS:
            rows.append(bench.run(until_s - bench.time_s).rows)
            bench.set(name, value)
        rows.append(bench.run(1.0 - bench.time_s).rows)
        names = list(bench.signals())
    expected = np.concatenate(rows)
    with Unit(path_of("vehicle", fmi), STARTS) as unit:
        found = [unit.get_all(names)]
        for k in range(10):
            for at_s, name, value in EVENTS:
                if abs(at_s - 0.1 * k) < 1e-9:
                    unit.set(name, value)
            unit.step(0.1)
            found.append(unit.get_all(names))
    assert np.array_equal(np.array(found), expected)


def closed_loop_inputs() -> tuple[
    list[dict[str, float]], list[dict[str, float]], list[dict[str, float]]
]:
    """Run the controller on the page-long motor.

    Return fast inputs, slow inputs and all outputs of every period.
    """
    sys.path.insert(0, str(ROOT / "host_sim" / "python" / "examples"))
    from own_plant import Motor  # noqa: PLC0415, found through the line above

    config = hubsim.load_configuration(LU2013)
    assert config.drive is not None
    m = config.drive.motor
    motor = Motor(m.phase_resistance_ohm, m.q_inductance_h, m.flux_linkage_wb, m.pole_pairs, 15.0)
    controller = hubsim.Controller(config)
    halls = (5, 1, 3, 2, 6, 4)
    edges = np.array(config.drive.rotor.hall_edges_deg) / 360.0
    fast_inputs, slow_inputs, outputs = [], [], []
    duty, slow = None, controller.slow_step()
    controller.reset()
    for n in range(8000):
        turn = float(motor.angle_rad / (2.0 * np.pi) % 1.0)
        sector = int(np.sum(turn >= np.sort(edges))) - 1
        a, b, c = motor.phases_a()
        fast_in = {"phase_a_a": a, "phase_b_a": b, "phase_c_a": c, "bus_voltage_v": 53.0}
        fast_in["hall_state"] = float(halls[int(np.argsort(edges)[sector])])
        slow_in = {"enable": float(n > 3000), "brake_torque_nm": 10.0 if n > 5000 else 0.0}
        if n % 20 == 0:
            slow = controller.slow_step(**slow_in)
        fast = controller.fast_step(**fast_in)
        motor.step(duty, controller.period_s)
        duty = [fast.duty_a, fast.duty_b, fast.duty_c] if fast.bridge == 1.0 else None
        fast_inputs.append(fast_in)
        slow_inputs.append(slow_in)
        outputs.append(
            {f"fast_output.{name}": value for name, value in fast.items()}
            | {f"slow_output.{name}": value for name, value in slow.items()}
        )
    assert controller.mode_text(slow.mode) == "RUN"
    assert slow.motor_torque_estimate_nm < -5.0
    return fast_inputs, slow_inputs, outputs


@pytest.fixture(scope="module")
def controller_trace() -> tuple[
    list[dict[str, float]], list[dict[str, float]], list[dict[str, float]]
]:
    return closed_loop_inputs()


@pytest.mark.parametrize("fmi", VERSIONS)
def test_a_controller_in_fmpy_is_bit_identical_to_that_of_the_api(
    fmi: int,
    controller_trace: tuple[list[dict[str, float]], list[dict[str, float]], list[dict[str, float]]],
) -> None:
    fast_inputs, slow_inputs, outputs = controller_trace
    period_s = hubsim.Controller(LU2013).period_s
    with Unit(path_of("controller", fmi)) as unit:
        for fast_in, slow_in, expected in zip(fast_inputs, slow_inputs, outputs, strict=True):
            for name, value in fast_in.items():
                unit.set(f"fast_input.{name}", value)
            for name, value in slow_in.items():
                unit.set(f"slow_input.{name}", value)
            unit.step(period_s)
            assert unit.get_all(list(expected)) == list(expected.values())


@pytest.mark.parametrize(("kind", "fmi"), itertools.product(KINDS, VERSIONS))
def test_a_restored_fmu_continues_from_the_saved_state_and_from_serialised_bytes(
    kind: str, fmi: int
) -> None:
    starts = (
        STARTS
        if kind == "vehicle"
        else {"fast_input.bus_voltage_v": 53.0, "fast_input.hall_state": 5}
    )

    def go_on(unit: Unit, from_s: float) -> list[float]:
        unit.time_s = from_s
        for _ in range(20):
            unit.step(0.01)
        return unit.get_all(unit.outputs())

    with Unit(path_of(kind, fmi), starts) as unit:
        go_on(unit, 0.0)
        state = unit.slave.getFMUState() if fmi == 3 else unit.slave.getFMUstate()
        raw = (
            unit.slave.serializeFMUState(state) if fmi == 3 else unit.slave.serializeFMUstate(state)
        )
        first = go_on(unit, 0.2)
        (unit.slave.setFMUState if fmi == 3 else unit.slave.setFMUstate)(state)
        assert go_on(unit, 0.2) == first
        (unit.slave.freeFMUState if fmi == 3 else unit.slave.freeFMUstate)(state)
    with Unit(path_of(kind, fmi), starts) as other:
        state = (
            other.slave.deserializeFMUState(raw)
            if fmi == 3
            else other.slave.deSerializeFMUstate(raw)
        )
        (other.slave.setFMUState if fmi == 3 else other.slave.setFMUstate)(state)
        assert go_on(other, 0.2) == first
        (other.slave.freeFMUState if fmi == 3 else other.slave.freeFMUstate)(state)


@pytest.mark.parametrize("fmi", VERSIONS)
def test_two_fmus_in_one_process_are_independent(fmi: int) -> None:
    with (
        Unit(path_of("vehicle", fmi), STARTS) as one,
        Unit(path_of("vehicle", fmi), STARTS | {"driver.brake_demand_nm": 5.0}) as other,
    ):
        for _ in range(10):
            one.step(0.05)
            other.step(0.05)
        strong, weak = one.get("vehicle.speed_m_per_s"), other.get("vehicle.speed_m_per_s")
    with Unit(path_of("vehicle", fmi), STARTS) as alone:
        for _ in range(10):
            alone.step(0.05)
        assert alone.get("vehicle.speed_m_per_s") == strong < weak


@pytest.mark.parametrize(
    ("name", "value", "when"),
    [
        ("run.seed", 2.0, "running"),
        ("motor.phase_resistance_ohm", -1.0, "running"),
        ("motor.phase_resistance_ohm", -1.0, "before"),
        ("road.slope", float("nan"), "running"),
    ],
)
@pytest.mark.parametrize("fmi", VERSIONS)
def test_values_refused_by_the_bench_are_refused_by_the_fmu(
    fmi: int, name: str, value: float, when: str
) -> None:
    starts = {name: value} if when == "before" else {}
    with pytest.raises(Exception, match="rror"), Unit(path_of("vehicle", fmi), starts) as unit:
        unit.set(name, value)
        pytest.fail("accepted")


def test_a_package_contains_the_parts_of_the_standard_and_none_of_its_headers() -> None:
    import zipfile  # noqa: PLC0415

    for kind, fmi in itertools.product(KINDS, VERSIONS):
        names = {Path(name).name for name in zipfile.ZipFile(path_of(kind, fmi)).namelist()}
        assert {
            "modelDescription.xml",
            "license.txt",
            "index.html",
            "table.c",
            "instance.c",
            f"fmi{fmi}.c",
        } <= names
        assert not {
            name for name in names if name.startswith("fmi") and name.endswith("Functions.h")
        }
        assert ("buildDescription.xml" in names) == (fmi == 3)
