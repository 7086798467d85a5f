# SPDX-License-Identifier: Apache-2.0
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from hubsim import run, scenario
from hubsim.engine import Engine, Rows, library_path
from hubsim.errors import HubsimError
from regen_table.schema import Drive

SIGNALS = [
    "time_s",
    "vehicle.speed_m_per_s",
    "wheel0.current_q_a",
    "wheel3.motor_torque_nm",
    "battery.chemical_w",
]


def vehicle(drive: Drive, **keys: object) -> Engine:
    settings = {
        "initial_speed_kmh": 20.0,
        "demand_nm": 30.0,
        "stop_at_standstill": False,
        "max_duration_s": 10.0,
        **keys,
    }
    engine, _ = run.prepare(
        drive, scenario.load("stop", settings)[1], Path(), {"sensors.current_noise_a": 0.5}
    )
    engine.start()
    engine.choose(SIGNALS)
    return engine


def recorded(drive: Drive, **keys: object) -> Rows:
    with vehicle(drive, **keys) as engine:
        return engine.run(0.4)


def test_the_same_seed_gives_identical_bytes_in_any_thread(drive: Drive) -> None:
    alone = recorded(drive)
    with ThreadPoolExecutor(max_workers=3) as pool:
        together = [future.result() for future in [pool.submit(recorded, drive) for _ in range(3)]]
    assert all(rows.tobytes() == alone.tobytes() for rows in together)


def test_another_seed_changes_the_noise_and_not_the_stop(drive: Drive) -> None:
    one, other = recorded(drive, seed=1), recorded(drive, seed=2)
    assert one.tobytes() != other.tobytes()
    assert np.max(np.abs(one[:, 1] - other[:, 1])) < 0.01  # m/s


def test_a_run_in_several_calls_equals_a_run_in_one_call(drive: Drive) -> None:
    whole = recorded(drive)
    with vehicle(drive) as engine:
        pieces = np.concatenate([engine.run(t) for t in (0.1, 0.03, 0.17, 0.1)])
    assert pieces.tobytes() == whole.tobytes()


def test_rows_are_recorded_at_the_interval(drive: Drive) -> None:
    rows = recorded(drive, record_interval_s=0.02)
    assert rows.shape == (21, len(SIGNALS))
    assert rows[:, 0] == pytest.approx(np.arange(21) * 0.02)


def test_samples_of_a_vehicle_that_is_stepped_are_the_rows_of_a_run(drive: Drive) -> None:
    """Step by step at equal times: sample() against run()."""
    rows = recorded(drive)
    row: Rows = np.empty(len(SIGNALS))
    with vehicle(drive) as engine:
        interval_s = engine.get("run.record_interval_s")
        for k, expected in enumerate(rows):
            engine.advance(k * interval_s)
            engine.sample(row)
            assert row.tobytes() == expected.tobytes()
        with pytest.raises(ValueError, match=r"row: shape \(2,\), accepted: \(5,\)"):
            engine.sample(np.empty(2))


def test_a_parameter_set_during_the_run_takes_effect(drive: Drive) -> None:
    with vehicle(drive, demand_nm=0.0, drag=False) as engine:
        engine.run(0.3)
        before = engine.value("vehicle.speed_m_per_s")
        engine.set("road.slope", -0.2)
        engine.run(0.5)
        gained = engine.value("vehicle.speed_m_per_s") - before
    assert gained == pytest.approx(9.80665 * 0.2 / (1 + 0.2**2) ** 0.5 * 0.5, rel=0.03)


def test_names_that_do_not_exist_are_refused(drive: Drive) -> None:
    with vehicle(drive) as engine:
        with pytest.raises(HubsimError, match=r"motor\.colour: no such parameter"):
            engine.set("motor.colour", 1.0)
        with pytest.raises(HubsimError, match=r"motor\.colour: no such parameter"):
            engine.get("motor.colour")
        with pytest.raises(HubsimError, match=r"wheel9\.mode: no such signal"):
            engine.value("wheel9.mode")
        with pytest.raises(HubsimError, match="colour: no such signal"):
            engine.choose(["colour"])


def test_the_error_for_a_refused_configuration_contains_the_field() -> None:
    with Engine() as engine, pytest.raises(HubsimError, match="configuration refused: size_bytes"):
        engine.load_config(b"no configuration")


def test_texts_of_modes_and_reasons_are_those_of_the_firmware(drive: Drive) -> None:
    with vehicle(drive) as engine:
        assert engine.mode_text(engine.value("wheel0.mode")) == "RUN"
        assert engine.reason_text(67) == "phase over-current"


def test_a_missing_engine_library_is_an_error_in_one_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HUBFOC_BUILD_DIR", str(tmp_path))
    with pytest.raises(HubsimError, match="the simulation engine is not built"):
        library_path()
