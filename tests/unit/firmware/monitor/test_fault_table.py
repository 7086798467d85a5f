# SPDX-License-Identifier: Apache-2.0
"""The failure table of the monitor's README is that of reasons and checks, whose times exist."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[4]
FIRMWARE = ROOT / "firmware"
MODULE = FIRMWARE / "monitor"
REASONS = Path("core", "include", "core", "reason.h")
FINDINGS = Path("core", "include", "core", "findings.h")
EXPLANATIONS = Path("core", "findings.c")
CONFIG = FIRMWARE / "config" / "include" / "config"
BEGIN, END = (
    "<!-- from core/reason.h and core/findings.h by generate.py -->",
    "<!-- end -->",
)
WORDS = re.compile(
    r"at once|never|at calibration|a speed error|a window of charge|torque ramp"
    r"|\d+ (ms|PWM periods?)( and more)?|\d+ to \d+ ms"
)
TIMES = ("_ms", "_periods")
CHECK_COLUMNS = [
    "check",
    "reason",
    "evidence",
    "qualify time",
    "heal time",
    "explained by",
    "reaction",
]


def run_generator(module: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(module / "generate.py"), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


def tables() -> list[list[list[str]]]:
    """Return the rows of each table of the README's failure table, the head first."""
    text = (MODULE / "README.md").read_text(encoding="utf-8")
    generated = text.partition(BEGIN)[2].partition(END)[0]
    found = re.findall(r"((?:^\|.*\n)+)", generated, re.MULTILINE)
    out = []
    for table in found:
        lines = [line.strip("|").split("|") for line in table.splitlines()]
        cells = [[cell.strip(" `") for cell in line] for line in lines]
        out.append([cells[0], *cells[2:]])
    return out


def words_of(column: str) -> dict[str, str]:
    """Return the words of a column with their texts."""
    return next(
        dict(table[1:]) for table in tables() if table[0][0] == column and len(table[0]) == 2
    )


def reasons() -> dict[int, list[str]]:
    """Return the rows of the reasons by their numbers."""
    return {int(row[0]): row for row in tables()[0][1:]}


def checks() -> list[list[str]]:
    """Return the rows of all checks, faults first."""
    return [row for table in tables() if table[0] == CHECK_COLUMNS for row in table[1:]]


def configured() -> set[str]:
    """Return the fields of the configuration as the list of checks names them."""
    texts = [path.read_text(encoding="utf-8") for path in sorted(CONFIG.glob("*.h"))]
    text = "\n".join(texts)
    sections = re.findall(r"#define CONFIG_(\w+)_FIELDS\(X\)(.*?)\n\n", text, re.DOTALL)
    return {
        f"{section.lower()}.{name}"
        for section, body in sections
        for name in re.findall(r"X\((\w+),", body)
    }


def copy_to(folder: Path) -> Path:
    """Copy what the generator reads; return the monitor's folder there."""
    for path in (
        Path("monitor", "generate.py"),
        Path("monitor", "README.md"),
        REASONS,
        FINDINGS,
        EXPLANATIONS,
        Path("core", "include", "core", "fault.h"),
    ):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(FIRMWARE / path, folder / path)
    return folder / "monitor"


def replace(path: Path, before: str, after: str) -> None:
    """Change a source file that contains `before`."""
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def test_the_table_equals_the_one_generated_from_the_lists() -> None:
    result = run_generator(MODULE, "--check")
    assert result.returncode == 0, result.stderr


def test_every_fault_of_the_protocol_is_in_the_table_with_its_number_and_name() -> None:
    header = (FIRMWARE / REASONS).read_text(encoding="utf-8")
    named = {int(n): name for n, name in re.findall(r"X\((\d+), (\w+),", header)}
    table = reasons()
    assert {number for number in named if number >= 64} <= set(table)
    assert all(table[number][1] == named[number] for number in table)


def test_every_check_is_in_the_table_in_the_order_of_the_list() -> None:
    header = (FIRMWARE / FINDINGS).read_text(encoding="utf-8")
    lists = header.partition("#define FINDING_FAULTS(X)")[2].partition("#define FINDING_LIST")[0]
    named = re.findall(r"X\((\w+), (\w+),", lists)
    assert len(named) > 40
    shown = [(check, "none" if reason == "NONE" else reason) for check, reason in named]
    assert [(row[0], row[1]) for row in checks()] == shown


def test_every_reason_of_a_check_is_one_of_the_table() -> None:
    names = {row[1] for row in reasons().values()} | {"none"}
    assert {row[1] for row in checks()} <= names


def test_every_time_is_a_field_of_the_configuration_or_a_number() -> None:
    fields = configured()
    assert "monitor.sensor_fault_time_ms" in fields
    for row in checks():
        for time in row[3:5]:
            for part in time.split(" + "):
                name = part.strip("` ")
                is_time = name in fields and name.endswith(TIMES)
                assert is_time or WORDS.fullmatch(name), f"{row[0]}: {name}"


def test_a_field_that_is_no_time_is_found() -> None:
    speed = "brake.blend_out_end_mrad_s"
    assert speed in configured()
    assert not speed.endswith(TIMES)
    assert not WORDS.fullmatch(speed)


def test_every_word_of_a_column_is_explained_below_the_tables() -> None:
    for row in reasons().values():
        assert row[3] in words_of("clearing")
        assert row[4] in words_of("driver")
    for row in checks():
        assert row[2] in ("measured", "inferred", "exception")
        assert row[5] in ("none", *words_of("explained by"))
        assert row[6] in words_of("reaction")


def test_an_explanation_lists_its_checks() -> None:
    listed = {word: re.findall(r"\w+", by) for word, by in words_of("explained by").items()}
    assert set(listed["BATTERY"]) == {"BUS_JUMPED", "BATTERY_LEFT", "BATTERY_UNKNOWN"}
    assert set(listed["BATTERY_OR_STEPS"]) == {*listed["BATTERY"], "STEPS"}
    assert {check for by in listed.values() for check in by} <= {row[0] for row in checks()}


@pytest.mark.parametrize(
    ("source", "before", "after", "row"),
    [
        (
            REASONS,
            "bus over-voltage",
            "bus far too high",
            "| 68 | `BUS_OVERVOLTAGE` | bus far too high |",
        ),
        (
            FINDINGS,
            'X(STEPS, PROGRAM_FLOW, MEASURED, OWN("9 ms"), AT_ONCE',
            "X(STEPS, PROGRAM_FLOW, MEASURED, FIELD(monitor, flow_ms), MS(7)",
            "| `STEPS` | `PROGRAM_FLOW` | measured | `monitor.flow_ms` | 7 ms | none |",
        ),
        (
            EXPLANATIONS,
            "X(BUS_READING, BIT(BUS_CONTRADICTED))",
            "X(BUS_READING, BIT(BUS_CONTRADICTED) | BIT(GAIN))",
            "| `BUS_READING` | `BUS_CONTRADICTED`, `GAIN` |",
        ),
    ],
)
def test_a_changed_list_is_detected_and_written_by_one_run(
    tmp_path: Path, source: Path, before: str, after: str, row: str
) -> None:
    module = copy_to(tmp_path)
    replace(tmp_path / source, before, after)
    assert run_generator(module, "--check").returncode == 1
    assert run_generator(module).returncode == 0
    assert run_generator(module, "--check").returncode == 0
    assert row in (module / "README.md").read_text(encoding="utf-8")


def test_a_row_that_is_not_understood_is_refused(tmp_path: Path) -> None:
    module = copy_to(tmp_path)
    replace(
        tmp_path / FINDINGS,
        "X(STEPS, PROGRAM_FLOW, MEASURED, OWN(",
        "X(STEPS, PROGRAM_FLOW, MEASURED, SOON(",
    )
    result = run_generator(module)
    assert result.returncode != 0
    assert "FINDING_FAULTS" in result.stderr
