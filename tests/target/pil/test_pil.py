# SPDX-License-Identifier: Apache-2.0
"""Processor in the loop: the emulated core's run is the host's bit for bit."""

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hubsim import cli, emulator, run, scenario
from hubsim.engine import Engine
from hubsim.errors import HubsimError
from hubsim.run import evaluation
from hubsim.run.results import RunResult, json_object
from hubsim.scenario import overrides

DRIVE = cli.DEFAULT_CONFIG
ELF_PROGRAM_HEADERS = (28, 42, 44)  # offset of the table; size and number of its entries
EVERY_PROGRAM_FAULT = {
    "restart": "fault.restart",
    "slow_doubled": "fault.slow_doubled",
    "slow_late": "fault.slow_late",
    "slow_stopped": "fault.slow_stopped",
    "fast_doubled": "fault.fast_doubled",
    "fast_late": "fault.fast_late",
    "fast_stopped": "fault.fast_stopped",
    "config_bit": "fault.config_bit",
}


def settings_of(*given: str) -> overrides.Overrides:
    return overrides.parse(list(given))


def simulated(name: str, processor: emulator.Command | None, *given: str) -> RunResult:
    """Return a run with everything recorded and its criteria evaluated."""
    settings = settings_of(*given)
    title, chosen, beside = scenario.load(name, settings.scenario)
    drive = overrides.load_drive(DRIVE, settings, chosen)
    result = run.simulate(title, drive, chosen, beside, ("*",), settings.plant, processor=processor)
    outcomes = evaluation.evaluate(chosen, drive, result)
    return replace(result, criteria=[outcome.as_object() for outcome in outcomes])


def figures(result: RunResult) -> dict[str, Any]:
    """Return what --json holds, but for the date and the speed of the simulation."""
    out = json_object(result)
    return {key: out[key] for key in out if key not in {"provenance", "realtime_factor"}}


def assert_same(here: RunResult, there: RunResult) -> None:
    assert here.names == there.names
    assert here.rows.shape == there.rows.shape
    apart = (here.rows != there.rows).any(axis=0)
    assert not apart.any(), [n for n, a in zip(here.names, apart, strict=True) if a][:10]
    assert here.rows.tobytes() == there.rows.tobytes()
    assert figures(here) == figures(there)


def with_another_bit(program: Path, symbol: str, offset: int, to: Path) -> Path:
    """Copy a program with the lowest bit of one byte of a symbol the other way round."""
    listed = subprocess.run(
        ["arm-none-eabi-nm", program], check=True, capture_output=True, text=True
    ).stdout
    address = next(int(line.split()[0], 16) for line in listed.splitlines()
                   if line.split()[-1] == symbol)  # fmt: skip
    data = bytearray(program.read_bytes())
    table, size, count = (
        int.from_bytes(data[at : at + (4 if at == ELF_PROGRAM_HEADERS[0] else 2)], "little")
        for at in ELF_PROGRAM_HEADERS
    )
    for at in range(table, table + size * count, size):
        in_file, begin = (int.from_bytes(data[at + k : at + k + 4], "little") for k in (4, 8))
        bytes_in_file = int.from_bytes(data[at + 16 : at + 20], "little")
        if begin <= address < begin + bytes_in_file:
            data[in_file + address - begin + offset] ^= 1
            break
    else:
        raise AssertionError(f"{symbol} is in no segment")
    to.write_bytes(data)
    return to


def test_four_wheels_brake_alike_on_both_processors() -> None:
    given = ("max_duration_s=0.4", "record_interval_s=5e-5")
    here = simulated("brake_onset", None, *given)
    there = simulated("brake_onset", emulator.command(), *given)
    assert here.wheels == 4
    assert len(here.rows) == 8001  # every period
    assert_same(here, there)


def test_every_fault_of_the_program_has_the_same_effect(tmp_path: Path) -> None:
    """One wheel each time, of two; what differs between them shows that it had an effect."""
    lines = ["initial_speed_kmh = 20.0", "demand_nm = 20.0", "max_duration_s = 1.2"]
    lines.append("record_interval_s = 0.001\n[plant.vehicle]\ndriven_wheels = 2")
    for k, (name, parameter) in enumerate(EVERY_PROGRAM_FAULT.items()):
        value = 900 if name == "config_bit" else 1
        lines += [
            f"[events.{name}]",
            f"at_s = {0.05 + 0.14 * k}",
            f"until_s = {0.05 + 0.14 * k + 0.03}",
            f'set = {{ "fault.wheels" = 2, "{parameter}" = {value} }}',
        ]
    path = tmp_path / "faults.toml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    here = simulated(str(path), None)
    assert_same(here, simulated(str(path), emulator.command()))
    assert (here.signal("wheel0.command_nm") != here.signal("wheel1.command_nm")).any()


def test_one_bit_of_the_program_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lowest bit of one of 256 sines."""
    build = emulator.build_directory()
    for path in (emulator.PROGRAM, emulator.PLUGIN):
        (tmp_path / "qemu" / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(build / path, tmp_path / "qemu" / path)
    with_another_bit(
        build / emulator.PROGRAM, "ANGLE_TABLE", 4 * 100, tmp_path / "qemu" / emulator.PROGRAM
    )
    here = simulated("brake_onset", None, "max_duration_s=0.25")
    monkeypatch.setattr(emulator, "build_directory", lambda: tmp_path / "qemu")
    there = simulated("brake_onset", emulator.command(), "max_duration_s=0.25")
    assert here.rows.shape == there.rows.shape
    assert here.rows.tobytes() != there.rows.tobytes()


@pytest.fixture
def started() -> Callable[[], tuple[Engine, float]]:
    def start() -> tuple[Engine, float]:
        settings = settings_of()
        _, chosen, beside = scenario.load("stop", settings.scenario)
        return run.prepare(overrides.load_drive(DRIVE, settings, chosen), chosen, beside, {})

    return start


def test_an_emulator_that_ends_is_an_error_of_the_run(
    started: Callable[[], tuple[Engine, float]], monkeypatch: pytest.MonkeyPatch
) -> None:
    engine, _ = started()
    cores = []
    popen = subprocess.Popen

    def noted(*arguments: Any, **options: Any) -> Any:  # noqa: ANN401, passed on
        cores.append(popen(*arguments, **options))
        return cores[-1]

    monkeypatch.setattr(subprocess, "Popen", noted)
    with (
        pytest.raises(HubsimError, match="the emulated core has ended during the run"),
        engine,
        emulator.attached(engine, emulator.command()),
    ):
        engine.start()
        threading.Timer(0.1, cores[0].kill).start()
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            engine.run(0.1)
    assert cores[0].poll() is not None


def test_the_shared_file_is_deleted_and_saving_is_refused(
    started: Callable[[], tuple[Engine, float]],
) -> None:
    own = f"hubfoc_pil_{os.getpid()}_*"
    engine, _ = started()
    with engine, emulator.attached(engine, emulator.command()):
        engine.start()
        assert len(list(emulator.SHARED_MEMORY.glob(own))) == 1
        with pytest.raises(HubsimError, match="without hubsim_processor"):
            engine.save()
    assert not list(emulator.SHARED_MEMORY.glob(own))
    with pytest.raises(HubsimError, match="not the memory of an emulated core"):
        Engine().attach_processor("/dev/null")


def test_the_command_writes_which_processor_it_was(tmp_path: Path) -> None:
    arguments = ["run", "brake_onset", "--on", "qemu", "--json", str(tmp_path / "run.json")]
    cli.main([*arguments, "--set", "max_duration_s=0.01", "--set", "vehicle.driven_wheels=1"])
    found = json.loads((tmp_path / "run.json").read_text(encoding="utf-8"))
    assert found["provenance"]["processor"] == "qemu"
    assert found["duration_s"] == pytest.approx(0.01)


def test_what_is_missing_is_named_in_one_line(tmp_path: Path) -> None:
    def failed(**environment: str) -> str:
        done = subprocess.run(
            [sys.executable, "-m", "hubsim", "run", "stop", "--on", "qemu"],
            check=False, capture_output=True, text=True, env=os.environ | environment,
        )  # fmt: skip
        assert done.returncode == 2
        assert done.stderr.count("\n") == 1
        return done.stderr

    compiler = str(shutil.which("cc"))  # reads the configuration's layout
    assert "qemu-system-arm was not found" in (shown := failed(PATH=str(tmp_path), CC=compiler))
    assert emulator.BRINGS in shown
    # An engine without a program for the emulator beside it.
    built = Path(os.environ["HUBFOC_BUILD_DIR"])
    (tmp_path / "host").symlink_to(built)
    shown = failed(HUBFOC_BUILD_DIR=str(tmp_path / "host"))
    assert "hubfoc_pil.elf is not built" in shown
    assert emulator.BRINGS in shown
