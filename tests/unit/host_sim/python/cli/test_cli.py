# SPDX-License-Identifier: Apache-2.0
"""The command line: output, files, and one line for every error."""

import csv
import json
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hubsim import cli, moved, run
from hubsim.cli import DEFAULT_CONFIG
from hubsim.engine import ROOT
from hubsim.run import recordings

Hubsim = Callable[..., subprocess.CompletedProcess[str]]
QUICK = ("--set", "initial_speed_kmh=10", "--set", "demand_nm=60", "--set", "drag=false")


def test_json_of_the_constant_demand_stop_has_the_documented_keys(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    done = hubsim(
        "run",
        "stop",
        "--config",
        DEFAULT_CONFIG,
        "--strategy",
        "series_optimal",
        "--set",
        "initial_speed_kmh=40",
        "--set",
        "demand_nm=40",
        "--set",
        "drag=false",
        "--json",
        "stop.json",
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    found = json.loads((tmp_path / "stop.json").read_text(encoding="utf-8"))
    assert (found["cycle"], found["strategy"]) == ("stop", "series_optimal")
    assert found["kinetic_energy_j"] == pytest.approx(40740.74, abs=0.01)
    assert found["stop_distance_m"] == pytest.approx(
        63.66, abs=1.7
    )  # v^2/2a, a = 640 N / 660 kg, and 0.15 s at 40 km/h
    assert found["residual_relative"] < 1e-4
    # physics: 75.6 % of the kinetic energy in steady states, within 2 %
    assert found["energy_j"]["battery_returned"] / found["kinetic_energy_j"] == pytest.approx(
        0.756, abs=0.02
    )
    assert "series_optimal" in done.stdout


def test_csv_has_a_header_with_units_and_one_row_per_interval(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    done = hubsim(
        "run",
        "stop",
        *QUICK,
        "--set",
        "record_interval_s=0.05",
        "--csv",
        "stop.csv",
        "--signals",
        "time_s,vehicle.speed_m_per_s,wheel?.motor_torque_nm",
    )
    assert done.returncode == 0, done.stderr
    with (tmp_path / "stop.csv").open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    assert rows[0] == [
        "time_s",
        "vehicle.speed_m_per_s",
        *(f"wheel{k}.motor_torque_nm" for k in range(4)),
    ]
    times = [float(row[0]) for row in rows[1:]]
    assert times == pytest.approx([0.05 * k for k in range(len(times))])
    assert float(rows[1][1]) == pytest.approx(10 / 3.6)
    assert float(rows[-1][1]) < 0.2


def test_repeated_calls_write_identical_bytes(hubsim: Hubsim, tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        assert (
            hubsim(
                "run", "stop", *QUICK, "--set", "sensors.current_noise_a=0.3", "--csv", name
            ).returncode
            == 0
        )
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_list_shows_scenarios_cycles_drives_and_reasons(hubsim: Hubsim) -> None:
    plain = hubsim("list").stdout
    for word in (
        "stop",
        "ece15",
        "udds",
        "lu2013",
        "series_optimal",
        "demand_nm",
        "initial_speed_kmh",
    ):
        assert word in plain
    assert "plant.motor.phase_resistance_ohm" in hubsim("list", "--parameters").stdout
    assert "wheel3.current_q_a" in hubsim("list", "--signals").stdout.split()


@pytest.mark.parametrize("command", [(), ("run",), ("list",), ("sim",), ("sweep",), ("compare",)])
def test_every_command_has_a_help_text(hubsim: Hubsim, command: tuple[str, ...]) -> None:
    done = hubsim(*command, "--help")
    assert done.returncode == 0
    assert "usage: hubsim" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("run", "stpo"), "hubsim: no scenario 'stpo', did you mean stop?"),
        (("run", "none.toml"), "hubsim: none.toml: file not found"),
        (("run", "stop", "--config", "none.toml"), "hubsim: none.toml: file not found"),
        (
            ("run", "stop", "--set", "demand_mn=4"),
            "hubsim: --set demand_mn: unknown key, did you mean demand_nm?",
        ),
        (
            ("run", "stop", "--set", "demand_nm=much"),
            "hubsim: --set demand_nm: 'much' is not accepted, accepted: a number from 0 to 100000",
        ),
        (
            ("run", "stop", "--set", "motor.pole_pear=4"),
            "motor.pole_pear: unknown key, did you mean pole_pairs?",
        ),
        (
            ("run", "stop", "--set", "motor.pole_pairs=0"),
            "motor.pole_pairs: 0 is not accepted, accepted: a whole number from 1 to 60",
        ),
        (
            ("run", "stop", "--set", "plant.road.slope=9"),
            "hubsim: --set plant.road.slope: 9 is not accepted, accepted: a number from -1 to 1",
        ),
        (
            ("run", "stop", "--set", "cycle=wltp"),
            "hubsim: cycle: no cycle 'wltp', accepted: ece15, udds or a .csv file",
        ),
        (
            ("run", "stop", "--json", "none/out.json"),
            "hubsim: none/out.json: no directory ",
        ),
        (
            ("run", "stop", *QUICK, "--csv", "out.csv", "--signals", "colour"),
            "hubsim: --signals colour: no such signal",
        ),
        (
            ("sim", "--scenario", "stop"),
            "hubsim: sim: scenario stop has no cycle, accepted: one that has",
        ),
    ],
)
def test_an_error_is_one_line_and_leaves_no_output_file(
    hubsim: Hubsim, tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    extra = () if arguments[0] == "sim" or "--json" in arguments else ("--json", "out.json")
    output = ("--output", "report") if arguments[0] == "sim" else ()
    done = hubsim(*arguments, *extra, *output)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [
        (),
        ("fly",),
        ("run",),
        ("run", "stop", "--strategy", "best"),
        ("run", "stop", "--colour"),
        ("run", "stop", "extra"),
        ("run", "stop", "--config", "lu2014"),
    ],
)
def test_a_usage_error_is_one_line_and_has_the_usage_exit_status(
    hubsim: Hubsim, arguments: tuple[str, ...]
) -> None:
    done = hubsim(*arguments)
    assert done.returncode == 2
    assert done.stderr.startswith("hubsim")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (("runn", "stop"), "no 'runn', did you mean run?"),
        (("run", "stopp"), "no scenario 'stopp', did you mean stop?"),
        (("run", "stop", "--jsn", "out.json"), "no '--jsn', did you mean --json?"),
        (("run", "stop", "--strategy", "series"), "no 'series', did you mean series_optimal?"),
        (("run", "stop", "--config", "lu2014"), "no drive 'lu2014', did you mean lu2013?"),
        (("run", "stop", "--set", "cycle=ecee15"), "no cycle 'ecee15', did you mean ece15?"),
        (("faults", "hal_a_low"), "no fault 'hal_a_low', did you mean hall_a_low?"),
    ],
)
def test_a_misspelt_word_is_answered_with_the_one_that_was_meant(
    hubsim: Hubsim, arguments: tuple[str, ...], meant: str
) -> None:
    done = hubsim(*arguments)
    assert done.returncode == 2
    assert meant in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("ece15", "--set", "demand_nm=5"),
            "demand_nm: is not read, as the driver follows a",
        ),
        (
            ("udds", "--set", "drive_trace_nm=[[0, 1]]"),
            "drive_trace_nm: is not read, as the",
        ),
        (
            ("stop", "--set", "speed_scale=0.5"),
            "speed_scale: is not read, as the driver",
        ),
        (("stop", "--set", "repeats=2"), "repeats: is not read, as the driver"),
        (
            ("stop", "--set", "demand_nm=5", "--set", "demand_trace_nm=[[0, 1]]"),
            "demand_nm: is not read, as demand_trace_nm is given",
        ),
        (("pedal_series", "--set", "demand_nm=5"), "demand_nm: is not read, as the demands come"),
    ],
)
def test_a_key_that_the_scenario_does_not_read_is_refused(
    hubsim: Hubsim, arguments: tuple[str, ...], message: str
) -> None:
    done = hubsim("run", *arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"hubsim: --set {message}")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "stop", "--csv", "out.parquet"),
        ("run", "stop", "--parquet", "out.csv"),
        ("run", "stop", "--mdf", "out.json"),
        ("run", "stop", "--json", "out.csv"),
        ("run", "stop", "--layout", "out.json"),
        ("compare", "stop", "stop", "--json", "out.txt"),
        ("faults", "--json", "out.csv"),
        ("report", "out.json", "-o", "out.pdf"),
    ],
)
def test_a_file_with_the_suffix_of_another_kind_is_refused(
    hubsim: Hubsim, tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    done = hubsim(*arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"{arguments[-1]!r}, accepted: a name that ends in ." in done.stderr
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_cycle_of_the_command_line_is_a_file_of_this_folder(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    (tmp_path / "mine.csv").write_text("time_s,speed_km_h\n0,0\n2,5\n4,0\n", encoding="utf-8")
    done = hubsim("run", "ece15", "--set", "cycle=mine.csv", "--set", "speed_scale=1",
                  "--json", "mine.json")  # fmt: skip
    found = json.loads((tmp_path / "mine.json").read_text(encoding="utf-8"))
    assert found["duration_s"] == pytest.approx(4.0)
    assert found["distance_m"] == pytest.approx(4.0 * 2.5 / 3.6, rel=0.1)
    assert "no such" not in done.stderr


def test_a_drive_without_a_state_of_charge_starts_as_its_ideal_does_and_says_where(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    """A pack that starts full takes next to nothing, beside an ideal that took 76 %."""
    text = DEFAULT_CONFIG.read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(
        re.sub(r"(?m)^initial_soc = .*\n", "", text), encoding="utf-8"
    )
    stop = ("run", "stop", "--config", "mine.toml", "--set", "drag=false", "--set", "noise=false")
    done = hubsim(*stop, "--json", "stop.json")
    assert done.returncode == 0, done.stderr
    assert "battery.initial_soc: absent, work begins at 0.7" in done.stderr
    found = json.loads((tmp_path / "stop.json").read_text(encoding="utf-8"))
    assert found["soc_initial"] == pytest.approx(0.7)
    stored = found["energy_j"]["battery_returned"] / found["kinetic_energy_j"]
    assert stored == pytest.approx(found["ideal_stop"]["stored_share_of_kinetic"], abs=0.02)


@pytest.mark.parametrize(
    ("setting", "limit"),
    [
        ("battery.max_charge_current_a=20", "charge_current"),
        ("battery.charge_foldback_voltage_v=50", "fold_back"),
        ("control.handover_start_rpm=300", "blend_out"),
    ],
)
def test_the_ideal_beside_a_stop_has_its_limits_and_says_what_they_cost(
    hubsim: Hubsim, tmp_path: Path, setting: str, limit: str
) -> None:
    """Without its limits the ideal stores 76 % of the energy, whatever the drive may take."""
    plain = ("run", "stop", "--set", "drag=false", "--json")
    assert hubsim(*plain, "free.json").returncode == 0
    done = hubsim(*plain, "stop.json", "--set", setting)
    free, found = (
        json.loads((tmp_path / f"{name}.json").read_text(encoding="utf-8"))
        for name in ("free", "stop")
    )
    ideal = found["ideal_stop"]
    stored = found["energy_j"]["battery_returned"] / found["kinetic_energy_j"]
    assert stored < free["ideal_stop"]["stored_share_of_kinetic"] - 0.005
    assert stored == pytest.approx(ideal["stored_share_of_kinetic"], abs=0.02)
    cost_j = ideal["limits_cost_j"]
    assert list(cost_j) == [limit]
    without_j = ideal["energy_j"]["battery_returned"] + cost_j[limit]
    assert without_j == pytest.approx(free["ideal_stop"]["energy_j"]["battery_returned"], rel=0.02)
    line = f"what the drive's limits cost the ideal stop: {limit} {cost_j[limit] / 1e3:.2f} kJ"
    assert line in done.stdout


def test_a_list_of_faults_needs_no_library_for_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in [name for name in sys.modules if name.startswith(("matplotlib", "hubsim.sweep"))]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert cli.main(["faults", "--list"]) == 0


def test_a_drive_refused_by_the_firmware_is_reported_with_the_field(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    done = hubsim(
        "run",
        "stop",
        "--set",
        "motor.d_inductance_h=2.0",
        "--set",
        "motor.q_inductance_h=2.0",
        "--json",
        "out.json",
    )
    assert done.returncode == 2
    assert "inductance" in done.stderr
    assert done.stderr.count("\n") == 2  # one a key
    assert list(tmp_path.iterdir()) == []


def test_a_vehicle_that_does_not_reach_standstill_is_reported(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    done = hubsim(
        "run", "stop", "--set", "demand_nm=3", "--set", "max_duration_s=0.5", "--json", "out.json"
    )
    assert done.returncode == 0
    assert "still moving after 0.5 s" in done.stderr
    assert (
        json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))["stop_distance_m"] is None
    )


CRITERIA = """
initial_speed_kmh = 10.0
demand_nm = 60.0
stop_at_standstill = true
[events.late]
at_s = 90.0
inject = "abs"
[criteria.short]
text = "short enough"
unit = "m"
value = "run.distance_m"
at_most = 3.5
[criteria.no_fault]
reasons = "wheels.fault_reason"
must_not_appear = ["ANY_FAULT"]
"""


def test_criteria_are_evaluated_printed_and_decide_the_exit_status(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    (tmp_path / "mine.toml").write_text(CRITERIA, encoding="utf-8")
    met = hubsim("run", "mine.toml", "--json", "met.json")
    assert met.returncode == 0, met.stderr
    assert "mine: 3 of 3 criteria met" in met.stdout
    assert "hubsim: warning: mine: event late at 90 s never came" in met.stderr
    missed = hubsim(
        "run", "mine.toml", "--set", "criteria.short.at_most=2.0", "--json", "missed.json"
    )
    assert missed.returncode == 1
    assert missed.stderr.splitlines()[-1] == "hubsim: mine: 1 of 3 criteria not met: short"
    line = next(line for line in missed.stdout.splitlines() if line.strip().startswith("short"))
    found = json.loads((tmp_path / "missed.json").read_text(encoding="utf-8"))
    assert line.split() == ["short", f"{found['criteria'][0]['value']:.5g}", "2", "m", "FAIL"]
    assert (
        found["passed"],
        json.loads((tmp_path / "met.json").read_text(encoding="utf-8"))["passed"],
    ) == (False, True)
    assert found["criteria"][0]["text"] == "short enough"


def test_without_criteria_no_evaluation_is_printed(hubsim: Hubsim, tmp_path: Path) -> None:
    (tmp_path / "plain.toml").write_text(CRITERIA.partition("[events")[0], encoding="utf-8")
    done = hubsim("run", "plain.toml", "--json", "out.json")
    assert (done.returncode, done.stderr) == (0, "")
    assert "criteria" not in done.stdout
    assert "criteria" not in json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))


def test_a_criterion_of_an_unknown_signal_is_refused_with_file_and_key(
    hubsim: Hubsim, tmp_path: Path
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(CRITERIA.replace("run.distance_m", "run.distanse_m"), encoding="utf-8")
    done = hubsim("run", "mine.toml", "--json", "out.json")
    assert done.returncode == 2
    assert (
        done.stderr
        == "hubsim: mine.toml: criteria.short.value: no quantity 'run.distanse_m', did you mean"
        " run.distance_m?\n"
    )
    assert list(tmp_path.iterdir()) == [path]


def test_examples_of_the_help_are_valid_calls(hubsim: Hubsim) -> None:
    text = hubsim("--help").stdout
    for example in cli.EXAMPLES:
        assert example in text
        program, *arguments = shlex.split(example)
        assert program == "hubsim"
        assert cli.parser().parse_args(arguments).command == arguments[0]
    assert hubsim("list", "--criteria").returncode == 0


def test_list_describes_events_and_criteria(hubsim: Hubsim) -> None:
    text = hubsim("list", "--criteria").stdout
    for word in (
        "at_s",
        "inject",
        "can_silence",
        "settles_to",
        "must_not_appear",
        "integral",
        "LOSS_OPTIMUM",
        "ANY_FAULT",
    ):
        assert word in text


HEAVY = {
    "asammdf", "cffi", "dask", "distributed", "matplotlib", "numpy", "pandas", "pyarrow",
    "pydantic", "rich", "scipy",
}  # fmt: skip


@pytest.mark.parametrize(
    "call",
    [
        ("--help",),
        ("--version",),
        *(
            (name, "--help")
            for name in ("run", "sim", "sweep", "stops", "faults", "compare", "list", "report")
        ),
        ("run", "stop", "--colour"),
        ("envelope", "--count", "40"),
    ],
)
def test_help_and_usage_errors_import_only_the_standard_library(call: tuple[str, ...]) -> None:
    """``--help`` must be fast: a command imports its libraries itself."""
    code = (
        "import sys\nfrom hubsim.cli import main\n"
        f"try:\n    main({list(call)!r})\nexcept SystemExit:\n    pass\n"
        "print('modules:', *sorted({name.partition('.')[0] for name in sys.modules}))\n"
        "print('own:', *sorted(name for name in sys.modules if name.startswith('hubsim')))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    loaded = done.stdout.partition("modules:")[2]
    assert HEAVY & set(loaded.split()) == set()
    own = [
        *(
            "hubsim",
            "hubsim.cli",
            "hubsim.cli.arguments",
            "hubsim.cli.swarms",
            "hubsim.cli.sweeps",
            "hubsim.errors",
        ),
        "hubsim.moved",
    ]
    assert loaded.partition("own:")[2].split() == own


@pytest.mark.parametrize("name", moved.STUDIES)
def test_a_command_that_became_a_study_names_it_in_one_line(name: str, hubsim: Hubsim) -> None:
    study = ROOT / "host_sim" / "studies" / moved.STUDIES[name] / "study.py"
    assert study.is_file()
    done = hubsim(name, "--output", "out")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        f"hubsim: {name} is a study now: ./tools/dev study {moved.STUDIES[name]}\n"
    )


@pytest.mark.parametrize("name", ["blend_out", "dips", "edges", "faults_tables"])
def test_a_program_that_became_a_study_names_it_in_one_line(name: str) -> None:
    call = [sys.executable, "-m", f"hubsim.{name}", "--output", "out"]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        f"hubsim: {name} is a study now: ./tools/dev study {moved.STUDIES[name]}\n"
    )


def test_help_of_the_units_imports_no_slow_library() -> None:
    code = (
        "import runpy, sys\nsys.argv = ['hubsim.fmu', '--help']\n"
        "try:\n    runpy.run_module('hubsim.fmu', run_name='__main__')\n"
        "except SystemExit:\n    print('modules:', *sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    text, _, loaded = done.stdout.partition("modules:")
    assert "pack" in text
    assert "hubsim.fmu" in loaded.split()
    assert {name.partition(".")[0] for name in loaded.split()} & HEAVY == set()


def test_names_in_the_help_equal_those_of_the_modules() -> None:
    assert cli.STRATEGIES == run.STRATEGIES
    assert set(cli.RECORDINGS) == {*recordings.WRITERS, "layout"}


def test_a_bus_capacitor_too_small_is_one_line_of_warning(hubsim: Hubsim) -> None:
    """The default, the paper's vehicle, keeps its rating; 1 mF does not."""
    done = hubsim("run", "stop", *QUICK, "--set", "inverter.bus_capacitance_f=1e-3")
    assert done.returncode == 0, done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith("hubsim: warning: ")
    assert "lu2013.toml: inverter.bus_capacitance_f: 0.001 F" in line
    assert "above device_voltage_v = 75 V" in line
    assert hubsim("run", "stop", *QUICK).stderr == ""
