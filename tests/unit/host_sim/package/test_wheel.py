# SPDX-License-Identifier: Apache-2.0
"""The wheel: contents, requirements, and results equal to those of the repository."""

import ast
import json
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest
from environments import EXTRAS, REPOSITORY, Installed, metadata_of, requirements_of
from hubsim import cli, reasons
from regen_table import generate, installation, layout, schema

pytest_plugins = ("wheel_fixtures",)

PACKAGES = {
    "hubsim": REPOSITORY / "host_sim" / "python" / "hubsim",
    "regen_table": REPOSITORY / "tools" / "regen_table",
}
# Prints the fields of config_t in a fixed order.
LAYOUT = """
import json
from dataclasses import asdict
from regen_table import layout
found = layout.load()
sections = found.sections.items()
place = found.ffi.offsetof
print(json.dumps({
    "size": found.size_bytes,
    "constants": found.constants,
    "fields": {s: {n: asdict(f) for n, f in fields.items()} for s, fields in sections},
    "places": {s: {n: place("config_t", s, n) for n in fields} for s, fields in sections},
}, sort_keys=True))
"""


def names_in(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def test_wheel_is_tagged_for_every_python_3_of_the_platform(wheel: Path) -> None:
    name, version, python, abi, platform = wheel.stem.split("-")
    assert (name, version) == ("hubfoc", installation.version())
    assert (python, abi) == ("py3", "none")
    assert platform.startswith("linux_")


def test_wheel_contains_every_module_the_type_markers_and_the_licence(wheel: Path) -> None:
    inside = names_in(wheel)
    for package, directory in PACKAGES.items():
        modules = {
            f"{package}/{p.relative_to(directory).as_posix()}" for p in directory.rglob("*.py")
        }
        left_out = {name for name in modules if name.startswith("hubsim/fmu/")}
        assert left_out < modules
        assert {
            n for n in inside if n.startswith(f"{package}/") and n.endswith(".py")
        } == modules - left_out
        assert f"{package}/py.typed" in inside
    assert any(name.endswith(".dist-info/licenses/LICENSE") for name in inside)


def test_wheel_contains_no_path_of_the_build_machine(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        for name in archive.namelist():
            assert str(REPOSITORY).encode() not in archive.read(name), name


def imports_of(path: Path) -> set[str]:
    """Return the packages that a module imports anywhere, functions included."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.partition(".")[0])
    return found


def test_requirements_of_the_wheel_are_exactly_the_imports_of_its_modules(wheel: Path) -> None:
    imported: set[str] = set()
    for name, directory in PACKAGES.items():
        for path in directory.rglob("*.py"):
            if not (name == "hubsim" and path.is_relative_to(directory / "fmu")):
                imported |= imports_of(path)
    parts = {"pydantic_core", "_cffi_backend"}  # of pydantic and cffi
    foreign = imported - sys.stdlib_module_names - set(PACKAGES) - parts
    asked = requirements_of(metadata_of(wheel)["Requires-Dist"], EXTRAS)
    assert foreign == {requirement.name for requirement in asked}
    plain = {r.name for r in requirements_of(metadata_of(wheel)["Requires-Dist"], frozenset())}
    assert set(installation.EXTRAS) == foreign - plain


def test_the_wheel_contains_what_the_live_page_is_made_of(wheel: Path) -> None:
    packages = REPOSITORY / "host_sim" / "python"
    needed = list((packages / "hubfoc" / "live" / "browser").rglob("*.*"))
    assert len(needed) > 12
    names = {path.relative_to(packages).as_posix() for path in needed}
    assert names | {"hubsim/report/palette.css"} <= names_in(wheel)


def test_installed_layout_of_the_configuration_equals_that_of_the_header(
    installed: Installed, capsys: pytest.CaptureFixture[str]
) -> None:
    exec(LAYOUT, {})  # the same fields, read with the header and a compiler
    live = json.loads(capsys.readouterr().out)
    assert json.loads(installed.run("python", "-c", LAYOUT)) == live
    assert live["size"] == layout.load().size_bytes > 1000


def test_installed_generator_writes_the_same_files_as_the_repository(installed: Installed) -> None:
    installed.run("regen_table", "generate", "lu2013", "-o", "generated")
    wanted = generate.artefacts(schema.load("lu2013")).files
    assert set(wanted) == {"lu2013.c", "lu2013.bin"}
    for name, content in wanted.items():
        assert (installed.place / "generated" / name).read_bytes() == content


def test_installed_generator_knows_the_boards(installed: Installed) -> None:
    label = ["--magnets", "30", "--kv", "16", "--rated-torque", "6", "--cells", "10"]
    installed.run("regen_table", "new", "mine", *label, "--wheel-diameter", "0.165", "--mass", "99")
    assert 'inverter.board = "vesc6_mk3"' in (installed.place / "mine.toml").read_text()


def without_machine(path: Path) -> Any:  # noqa: ANN401, JSON of any shape
    """Return a run's results without the machine's speed and the date."""

    def stripped(value: Any) -> Any:  # noqa: ANN401
        if isinstance(value, dict):
            moving = {"realtime_factor", "date"}
            return {key: stripped(inner) for key, inner in value.items() if key not in moving}
        return [stripped(inner) for inner in value] if isinstance(value, list) else value

    return stripped(json.loads(path.read_text(encoding="utf-8")))


def test_installed_simulator_gives_the_results_of_the_repository_build(
    installed: Installed, tmp_path: Path
) -> None:
    settings = ["--set", "initial_speed_kmh=40", "--set", "demand_nm=40", "--config", "lu2013"]
    installed.run("hubsim", "run", "stop", *settings, "--json", "stop.json")
    here = tmp_path / "stop.json"
    assert cli.main(["run", "stop", *settings, "--json", str(here)]) == 0
    theirs = without_machine(installed.place / "stop.json")
    assert theirs == without_machine(here)
    assert len(json.dumps(theirs)) > 1000


def test_installed_simulator_contains_scenarios_cycles_drives_and_reasons(
    installed: Installed,
) -> None:
    listed = installed.run("hubsim", "list")
    for directory, ending in (
        ("tools/motors", "toml"),
        ("host_sim/cycles", "csv"),
        ("host_sim/python/hubsim/scenario/builtin", "toml"),
    ):
        names = [path.stem for path in (REPOSITORY / directory).glob(f"*.{ending}")]
        assert len(names) > 1
        assert [name for name in names if f"  {name}" not in listed] == []
    program = "from hubsim import reasons; import json; print(json.dumps(reasons.codes()))"
    assert json.loads(installed.run("python", "-c", program)) == reasons.codes()


def test_installed_version_and_commit_equal_those_of_the_project(installed: Installed) -> None:
    for program in ("hubsim", "regen_table"):
        assert installed.run(program, "--version").strip() == installation.identity(program)
    program = (
        "from regen_table import installation as i; print(i.INSTALLED, i.version(), i.commit())"
    )
    assert installed.run("python", "-c", program).split() == [
        "True",
        installation.version(),
        installation.commit(),
    ]


def test_report_is_written_to_the_working_directory(installed: Installed) -> None:
    installed.run(
        "hubsim",
        "run",
        "stop",
        "--json",
        "one.json",
        "--parquet",
        "one.parquet",
        "--mdf",
        "one.mf4",
    )
    installed.run("hubsim", "report", "one.json", "-o", "page.html")
    assert "<svg" in (installed.place / "page.html").read_text(encoding="utf-8")
    assert (installed.place / "one.mf4").stat().st_size > 1000


def test_without_extras_the_core_works_and_each_missing_extra_is_reported(bare: Installed) -> None:
    bare.run("hubsim", "run", "stop", "--csv", "stop.csv", "--json", "stop.json")
    bare.run(
        "regen_table", "solve", "lu2013", "--speed-rpm", "100", "--winding-temperature-c", "25"
    )
    calls = {
        "report": ("regen_table", "figures", "lu2013", "-o", "figures"),
        "formats": ("hubsim", "run", "stop", "--mdf", "stop.mf4"),
        "sweep": (
            "hubsim",
            "sweep",
            "stop",
            "--vary",
            "demand_nm=10,20",
            "--output",
            "grid.parquet",
        ),
    }
    for extra, call in calls.items():
        done = bare.call(*call)
        assert done.returncode == 1, done.stderr
        assert done.stderr.count("\n") == 1, done.stderr
        # a sweep writes Parquet, so either of two extras may be reported first
        accepted = [extra, "formats"] if extra == "sweep" else [extra]
        assert any(f"pip install 'hubfoc[{name}]'" in done.stderr for name in accepted), done.stderr
