# SPDX-License-Identifier: Apache-2.0
"""The failure table of the monitor's README is the list of faults, whose times exist."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
FIRMWARE = ROOT / "firmware"
MODULE = FIRMWARE / "monitor"
REASONS = Path("core", "include", "core", "reason.h")
CONFIG = FIRMWARE / "config" / "include" / "config"
BEGIN, END = "<!-- from core/reason.h by generate.py -->", "<!-- end -->"
WORDS = re.compile(r"at once|never|at calibration|at restart|a speed error|\d+ (ms|PWM periods?)")
TIMES = ("_ms", "_periods")


def run_generator(module: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(module / "generate.py"), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


def rows() -> dict[int, list[str]]:
    """Return the cells of each row of the README's failure table, by the number in the first."""
    text = (MODULE / "README.md").read_text(encoding="utf-8")
    table = text.partition(BEGIN)[2].partition(END)[0]
    cells = [line.strip("|").split("|") for line in table.splitlines() if line.startswith("|")]
    return {
        int(row[0]): [cell.strip(" `") for cell in row] for row in cells if row[0].strip().isdigit()
    }


def configured() -> set[str]:
    """Return the fields of the configuration as the list of faults names them."""
    texts = [path.read_text(encoding="utf-8") for path in sorted(CONFIG.glob("*.h"))]
    text = "\n".join(texts)
    sections = re.findall(r"#define CONFIG_(\w+)_FIELDS\(X\)(.*?)\n\n", text, re.DOTALL)
    return {
        f"{section.lower()}.{name}"
        for section, body in sections
        for name in re.findall(r"X\((\w+),", body)
    }


def test_the_table_equals_the_one_generated_from_the_list() -> None:
    result = run_generator(MODULE, "--check")
    assert result.returncode == 0, result.stderr


def test_every_fault_of_the_protocol_is_in_the_table_with_its_number_and_name() -> None:
    header = (FIRMWARE / REASONS).read_text(encoding="utf-8")
    named = {int(n): name for n, name in re.findall(r"X\((\d+), (\w+),", header)}
    table = rows()
    assert {number for number in named if number >= 64} <= set(table)
    assert all(table[number][1] == named[number] for number in table)


def test_every_time_is_a_field_of_the_configuration_or_a_number() -> None:
    fields = configured()
    assert "monitor.sensor_fault_time_ms" in fields
    for row in rows().values():
        for time in row[3:5]:
            for part in time.split(" + "):
                name = part.strip("` ")
                is_time = name in fields and name.endswith(TIMES)
                assert is_time or WORDS.fullmatch(name), f"{row[1]}: {name}"


def test_a_field_that_is_no_time_is_found() -> None:
    speed = "brake.hydraulic_watch_speed_mrad_s"
    assert speed in configured()
    assert not speed.endswith(TIMES)
    assert not WORDS.fullmatch(speed)


def test_a_changed_list_is_detected_and_written_by_one_run(tmp_path: Path) -> None:
    for path in (
        "monitor/generate.py",
        "monitor/README.md",
        REASONS,
        "core/include/core/fault.h",
    ):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(FIRMWARE / path, tmp_path / path)
    header = tmp_path / REASONS
    text = header.read_text(encoding="utf-8")
    header.write_text(text.replace("bus over-voltage", "bus far too high"), encoding="utf-8")
    assert run_generator(tmp_path / "monitor", "--check").returncode == 1
    assert run_generator(tmp_path / "monitor").returncode == 0
    assert run_generator(tmp_path / "monitor", "--check").returncode == 0
    readme = (tmp_path / "monitor" / "README.md").read_text(encoding="utf-8")
    assert "| 68 | `BUS_OVERVOLTAGE` | bus far too high |" in readme
