# SPDX-License-Identifier: Apache-2.0
"""Results have the documented keys; errors are one line and a non-zero exit status."""

import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest
from regen_table import cli

ROOT = Path(__file__).resolve().parents[4]
PAPER = ROOT / "tools" / "motors" / "lu2013.toml"
SCOOTER = ROOT / "tools" / "motors" / "scooter48v.toml"
CYCLE = ROOT / "host_sim" / "cycles" / "ece15.csv"
STOP = ["stop", str(PAPER), "--initial-speed-kmh", "40", "--demand-nm"]
POINT = {
    "current_d_a",
    "current_q_a",
    "dc_power_w",
    "battery_power_w",
    "loss_copper_w",
    "loss_iron_w",
    "loss_inverter_w",
    "loss_battery_w",
}
SOLVE = {
    "speed_rpm",
    "winding_temperature_c",
    "regeneration_possible",
    "torque_optimal_nm",
    "torque_zero_nm",
    "torque_idle_nm",
    "torque_optimal_limited_nm",
}


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> list[dict[str, Any]]:
    assert cli.main(arguments) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    found = json.loads(captured.out)
    assert isinstance(found, list)
    return found


@pytest.mark.parametrize("joint", [[], ["--joint"]])
def test_solve_returns_every_combination_with_the_documented_keys(
    capsys: pytest.CaptureFixture[str], joint: list[str]
) -> None:
    found = answer(
        capsys,
        "solve",
        str(PAPER),
        "--speed-rpm",
        "100,200",
        "--winding-temperature-c",
        "25,120",
        "--json",
        *joint,
    )
    assert {(record["speed_rpm"], record["winding_temperature_c"]) for record in found} == {
        (s, t) for s in (100.0, 200.0) for t in (25.0, 120.0)
    }
    for record in found:
        assert set(record) == SOLVE | POINT | {f"{key}_limited" for key in POINT}
        assert record["torque_optimal_nm"] < 0.0
        assert record["battery_power_w"] < 0.0


def test_solve_marks_states_without_regeneration(capsys: pytest.CaptureFixture[str]) -> None:
    slow, standing, fast = answer(capsys, "solve", str(PAPER), "--speed-rpm", "3,0,10", "--json")
    assert (
        slow["regeneration_possible"],
        standing["regeneration_possible"],
        fast["regeneration_possible"],
    ) == (False, False, True)
    assert slow["torque_optimal_nm"] == slow["torque_zero_nm"] == slow["torque_idle_nm"]
    assert slow["dc_power_w"] == 0.0


def test_evaluate_returns_every_combination_with_losses_that_sum_up(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = answer(
        capsys, "evaluate", str(PAPER), "--speed-rpm", "-300,300", "--torque-nm", "-20,20", "--json"
    )
    assert len(found) == 4
    for record in found:
        mechanical = record["torque_nm"] * record["speed_rpm"] * 3.141592653589793 / 30.0
        losses = record["loss_copper_w"] + record["loss_iron_w"] + record["loss_inverter_w"]
        assert record["dc_power_w"] == pytest.approx(mechanical + losses, rel=1e-9)
        assert record["region"] == ("driving" if mechanical > 0.0 else "III")


def test_evaluate_returns_null_if_no_current_gives_the_torque(
    capsys: pytest.CaptureFixture[str],
) -> None:
    (record,) = answer(
        capsys, "evaluate", str(PAPER), "--speed-rpm", "600", "--torque-nm", "2000", "--json"
    )
    assert record["battery_power_w"] is None  # beyond the maximum battery power
    assert {"torque", "power", "phase_current", "phase_voltage"} <= set(record["limits_exceeded"])


def test_stop_returns_one_object_per_demand(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["stop", str(PAPER), "--initial-speed-kmh", "40", "--demand-nm", "20,40", "--json"]
    assert [r["demand_nm"] for r in answer(capsys, *arguments, "--strategy", "parallel_ratio")] == [
        20.0,
        40.0,
    ]
    assert len(answer(capsys, *arguments, "--strategy", "all")) == 6
    first, _ = answer(capsys, *arguments)
    assert first["strategy"] == "series_optimal"
    assert first["kinetic_energy_j"] == pytest.approx(sum(first["energy_j"].values()), rel=1e-9)


def test_stop_inside_the_limits_returns_the_limiting_reason(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """At 58 V the pack takes 200 (58.4 - 58)/(1.168 + 2.4) = 22.4 A, 1.3 of some 6 kW."""
    arguments = [*STOP, "40", "--battery", "dynamic", "--open-circuit-voltage-v", "58", "--json"]
    (free,) = answer(capsys, *arguments)
    (found,) = answer(capsys, *arguments, "--limits", "all")
    assert found["stored_share_of_kinetic"] < 0.6 * free["stored_share_of_kinetic"]
    assert max(found["hydraulic_by_reason_j"], key=found["hydraulic_by_reason_j"].get) == (
        "fold_back"
    )
    (some,) = answer(capsys, *arguments, "--limits", "blend_out,torque_rate")
    assert some["limits"] == ["torque_rate", "blend_out"]
    assert some["stored_share_of_kinetic"] == pytest.approx(
        free["stored_share_of_kinetic"], abs=0.005
    )


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["solve", "nowhere.toml", "--speed-rpm", "1"], "nowhere.toml: file not found"),
        (
            ["solve", str(PAPER), "--speed-rpm", "fast"],
            "argument --speed-rpm: 'fast', accepted: numbers from -100000 to 100000 r/min",
        ),
        (
            ["solve", str(PAPER), "--speed-rpm", "nan"],
            "argument --speed-rpm: 'nan', accepted: numbers",
        ),
        (["solve", str(PAPER)], "the following arguments are required: --speed-rpm"),
        (
            ["solve", str(PAPER), "--speed-rpm", "1", "--winding-temperature-c", "-250"],
            "argument --winding-temperature-c: '-250', accepted",
        ),
        (
            ["stop", str(PAPER), "--initial-speed-kmh", "0", "--demand-nm", "1"],
            "argument --initial-speed-kmh: '0', accepted: a number from 0.1",
        ),
        (
            ["stop", str(PAPER), "--initial-speed-kmh", "40", "--demand-nm", "-1"],
            "argument --demand-nm: '-1', accepted",
        ),
        (
            [
                "stop",
                str(PAPER),
                "--initial-speed-kmh",
                "40",
                "--demand-nm",
                "1",
                "--strategy",
                "best",
            ],
            "argument --strategy: no 'best', accepted: parallel_ratio, ",
        ),
        (
            [*STOP, "1", "--battery", "dynamic", "--limits", "voltage,luck"],
            "argument --limits: 'voltage,luck', accepted: all, or some of phase_current, voltage",
        ),
        ([*STOP, "1", "--limits", "all"], "--limits: accepted: with --battery dynamic"),
        (
            [
                "stop",
                str(SCOOTER),
                *STOP[2:],
                "1",
                "--open-circuit-voltage-v",
                "400",
            ],
            "--open-circuit-voltage-v: accepted: with a drive whose open_circuit_voltage_v",
        ),
        (["cycle", str(PAPER), "--trace", "nowhere.csv"], "nowhere.csv: file not found"),
        (
            ["cycle", str(PAPER), "--trace", str(PAPER)],
            "lu2013.toml: no heading with time and speed, accepted: a heading as in time_s,",
        ),
        (["check", str(PAPER), "-o", "/nowhere"], "/nowhere/lu2013.c: missing"),
        (["generate", str(PAPER), "-o", "/proc/nowhere"], "/proc/nowhere: cannot be written"),
        (["juggle"], "argument COMMAND: no 'juggle', accepted: generate, check"),
        ([], "the following arguments are required: COMMAND"),
    ],
)
def test_error_is_reported_in_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], expected: str
) -> None:
    try:
        code = cli.main(arguments)
    except SystemExit as stopped:
        code = int(str(stopped.code))
    captured = capsys.readouterr()
    lines = captured.err.splitlines()
    assert code != 0
    assert len(lines) == 1
    assert expected in lines[0]


IMPOSSIBLE = {
    "no regeneration": (
        "turn_on_loss_j_per_a",
        "0.01",
        "motor.max_speed_rpm: no regeneration at any speed up to 640 r/min",
    ),
    "EMF above the bus": (
        "field_weakening_current_a",
        "0.0",
        "motor.max_speed_rpm: the back-EMF at 900 r/min is 76.59 V between lines, accepted",
    ),
    "zero inductance": (
        "d_inductance_h",
        "0.0",
        "motor.d_inductance_h: 0.0 is not accepted, accepted: a number from 1e-07 to 1 H",
    ),
    "negative resistance": (
        "phase_resistance_ohm",
        "-0.031",
        (
            "motor.phase_resistance_ohm: -0.031 is not accepted, accepted: a number from 1e-05 to"
            " 100 ohm"
        ),
    ),
    "torque beyond the current": (
        "max_phase_current_a",
        "42.0",
        "motor.rated_torque_nm: 30 N m, accepted: at most 29.56 N m",
    ),
    "not a number": (
        "flux_linkage_wb",
        "nan",
        "motor.flux_linkage_wb: nan is not accepted, accepted: a number from 1e-06 to 2 Wb",
    ),
}


@pytest.mark.parametrize("command", ["generate", "check", "solve", "stop"])
@pytest.mark.parametrize("what", IMPOSSIBLE)
def test_an_invalid_drive_is_an_error_in_one_line_without_output(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, what: str
) -> None:
    key, value, expected = IMPOSSIBLE[what]
    text = re.sub(rf"(?m)^{key} = \S+", f"{key} = {value}", PAPER.read_text(encoding="utf-8"))
    if what == "EMF above the bus":
        text = text.replace("max_speed_rpm = 640.0", "max_speed_rpm = 900.0")
    path, out = tmp_path / "impossible.toml", tmp_path / "out"
    path.write_text(text, encoding="utf-8")
    arguments = {
        "generate": ["-o", str(out), "--report", str(out / "report.json")],
        "check": [],
        "solve": ["--speed-rpm", "100", "--json"],
        "stop": ["--initial-speed-kmh", "40", "--demand-nm", "20", "--json"],
    }
    assert cli.main([command, str(path), *arguments[command]]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    line, *others = captured.err.splitlines()
    assert all(other.startswith(line.partition(": ")[0]) for other in others)
    assert line.startswith(f"{path}: {expected}")
    assert list(tmp_path.iterdir()) == [path]


def test_the_module_runs_as_a_command_with_a_help_text() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "regen_table", "--help"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    for command in ("generate", "check", "solve", "evaluate", "stop", "cycle", "figures"):
        assert command in done.stdout
        explained = subprocess.run(
            [sys.executable, "-m", "regen_table", command, "--help"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert explained.returncode == 0
        assert "DRIVE" in explained.stdout


@pytest.mark.parametrize(
    "command",
    [
        ["solve", str(PAPER), "--speed-rpm", "100,200"],
        ["evaluate", str(PAPER), "--speed-rpm", "100", "--torque-nm", "-20"],
        ["stop", str(PAPER), "--initial-speed-kmh", "40", "--demand-nm", "20"],
        ["cycle", str(PAPER), "--trace", str(CYCLE)],
    ],
    ids=lambda command: command[0],
)
def test_a_result_file_contains_its_provenance(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    command: list[str],
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    path = tmp_path / "answer.json"
    printed = answer(capsys, *command, "--json", "--output", str(path))
    written = json.loads(path.read_text(encoding="utf-8"))
    assert written["results"] == printed
    origin = written["provenance"]
    assert (origin["configuration"], origin["date"]) == ("lu2013", "1970-01-01T00:00:00Z")
    generated = (ROOT / "firmware" / "config" / "generated" / "lu2013.c").read_text(
        encoding="ascii"
    )
    assert f".crc32 = {origin['configuration_crc32']}," in generated


def unreadable(tmp_path: Path, kind: str) -> Path:
    """Make a file that is neither a drive file nor a recording."""
    path = tmp_path / "given"
    if kind == "directory":
        path.mkdir()
    elif kind == "link to itself":
        path.symlink_to(path)
    elif kind == "rows of different lengths":
        path.write_bytes(b"time_s,speed_km_h,v_ab_v,v_bc_v,index\n1,2,3\n")
    elif kind == "one row":
        path.write_bytes(b"time_s,speed_km_h,v_ab_v,v_bc_v,index\n1,2,3,4,1\n")
    elif kind == "not finite":
        path.write_bytes(b"time_s,speed_km_h,v_ab_v,v_bc_v,index\n" + b"nan,1,nan,1,1\n" * 20)
    elif kind == "standing still":
        path.write_bytes(b"time_s,speed_km_h,v_ab_v,v_bc_v,index\n0,0,0,0,0\n1,0,0,0,0\n" * 1)
    else:
        contents = {
            "binary": bytes(range(256)),
            "zeros": bytes(4096),
            "empty": b"",
            "wide": b"\xff\xfea\0",
        }
        path.write_bytes(contents[kind])
    return path


@pytest.mark.parametrize(
    "command", ["solve", "check", "generate", "calibrate", "cycle", "figures", "fit"]
)
@pytest.mark.parametrize(
    "kind",
    [
        *("binary", "zeros", "empty", "wide", "directory", "link to itself", "not finite"),
        *("rows of different lengths", "one row", "standing still"),
    ],
)
def test_a_file_of_another_format_is_an_error_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, kind: str
) -> None:
    path = str(unreadable(tmp_path, kind))
    more = {
        "solve": ["--speed-rpm", "100"],
        "generate": ["-o", str(tmp_path / "out")],
        "figures": ["-o", str(tmp_path / "out")],
    }
    arguments = [command, path, *more.get(command, [])]
    if command == "cycle":
        arguments = ["cycle", str(PAPER), "--trace", path, "--top-speed-kmh", "30"]
    assert cli.main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    line, *others = captured.err.splitlines()
    assert all(other.startswith(line.partition(": ")[0]) for other in others)
    assert re.match(rf"{re.escape(path)}(:\d+)?: ", line)
    assert not (tmp_path / "out").exists()


def test_a_byte_order_mark_is_accepted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mark = b"\xef\xbb\xbf"
    drive, trace = tmp_path / "lu2013.toml", tmp_path / "ece15.csv"
    drive.write_bytes(mark + PAPER.read_bytes().replace(b"\n", b"\r\n"))
    trace.write_bytes(mark + CYCLE.read_bytes())
    command = ["cycle", "--json", "--trace"]
    assert answer(capsys, *command, str(trace), str(drive)) == answer(
        capsys, *command, str(CYCLE), str(PAPER)
    )


@pytest.mark.parametrize("option", ["--report", "--output", "-o"])
def test_an_unwritable_output_is_an_error_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str
) -> None:
    (tmp_path / "full").symlink_to("/dev/full")
    blocked = tmp_path / "file" / "below"
    blocked.parent.write_text("here")
    where = blocked if option == "-o" else tmp_path / "full"
    arguments = {
        "-o": ["generate", str(PAPER), "-o", str(where)],
        "--report": ["generate", str(PAPER), "-o", str(tmp_path / "out"), "--report", str(where)],
        "--output": ["solve", str(PAPER), "--speed-rpm", "100", "--output", str(where)],
    }
    assert cli.main(arguments[option]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert re.fullmatch(rf"{re.escape(str(where))}: cannot be written: [\w ]+", line)
    assert (tmp_path / "full").is_symlink()


HEAVY = ("numpy", "scipy", "matplotlib", "pydantic", "cffi", "regen_table.commands")


@pytest.mark.parametrize(
    "command",
    [
        "",
        "generate",
        "check",
        "solve",
        "evaluate",
        "stop",
        "cycle",
        "figures",
        "calibrate",
        "fit",
        "flux",
    ],
)
def test_help_imports_no_slow_library(command: str) -> None:
    code = (
        "import sys\nfrom regen_table import cli\n"
        f"try:\n    cli.main({[command, '--help'] if command else ['--help']!r})\n"
        "except SystemExit as left:\n    assert left.code == 0\n"
        f"print([name for name in {HEAVY!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_generate_writes_its_report_on_request(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        cli.main(
            [
                *("generate", str(PAPER), "-o", str(tmp_path)),
                *("--report", str(tmp_path / "found.json"), "--date", "2026-01-31T12:00Z"),
            ]
        )
        == 0
    )
    found = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert min(m["phase_margin_deg"] for m in found["margins"]) > 45.0
    assert all(
        proof["allowed"]["low"] <= proof["found"]["low"]
        and proof["found"]["high"] < proof["allowed"]["high"]
        for proof in found["formats"]
    )
    assert max(loss["relative"] for loss in found["grid_losses"]) <= 2e-4
    origin, source = found["provenance"], (tmp_path / "lu2013.c").read_text(encoding="ascii")
    assert origin["configuration"] == "lu2013"
    assert f".crc32 = {origin['configuration_crc32']}," in source
    assert origin["date"] == "2026-01-31T12:00:00Z"
    assert {"version", "commit", "scenario", "seed"} <= set(origin)
    assert "2026" not in source  # the generated files depend on the TOML file alone
    assert "phase margin" in capsys.readouterr().out


def test_figures_are_reproducible_as_png_and_svg(tmp_path: Path) -> None:
    for name in ("first", "second"):
        assert cli.main(["figures", str(PAPER), "-o", str(tmp_path / name)]) == 0
    first, second = (
        {p.name: p.read_bytes() for p in (tmp_path / name).iterdir()}
        for name in ("first", "second")
    )
    assert set(first) == {
        f"lu2013_fig{n:02d}.{kind}"
        for n in (3, 4, 5, 7, 8, 10, 11, 12, 13, 14)
        for kind in ("svg", "png")
    }
    assert first == second
    for name, content in first.items():
        if name.endswith(".svg"):
            text = "".join(ET.fromstring(content).itertext())
            assert f"Fig. {int(name[10:12])} " in text
        else:
            assert content.startswith(b"\x89PNG")
            assert len(content) > 10_000


def test_figures_of_another_motor_have_no_number_of_the_paper(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    mine.write_text(PAPER.read_text(encoding="utf-8"), encoding="utf-8")
    assert cli.main(["figures", str(mine), "-o", str(tmp_path / "figures")]) == 0
    drawn = sorted((tmp_path / "figures").glob("*.svg"))
    assert len(drawn) == 10
    for path in drawn:
        text = "".join(ET.fromstring(path.read_text(encoding="utf-8")).itertext())
        assert "Fig." not in text
        assert "mine" in text
