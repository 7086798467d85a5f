# SPDX-License-Identifier: Apache-2.0
"""Files generated from hubfoc.dbc are up to date, compile without warnings and contain no floating
point.

The bus load is below a half.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import cantools
import pytest
from cantools.database.can import Database
from protocol import DBC, MODULE, ROOT, attribute

PYTHON = Path("host_sim/python/hubsim/can_protocol.py")
WARNINGS = [
    *(
        "-Wall",
        "-Wextra",
        "-Werror",
        "-Wconversion",
        "-Wshadow",
        "-Wundef",
        "-Wswitch-enum",
        "-Wmissing-prototypes",
    ),
    *("-Wstrict-prototypes", "-Wcast-align", "-std=c11", "-pedantic-errors"),
]


def run_generator(module: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(module / "generate.py"), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )


def test_code_and_tables_equal_those_generated_from_the_dbc() -> None:
    result = run_generator(MODULE, "--check")
    assert result.returncode == 0, result.stderr


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """Return a copy of the module that a test may change."""
    module = tmp_path / "firmware/comms"
    for folder in (module / "generated", module / "include/comms", tmp_path / PYTHON.parent):
        folder.mkdir(parents=True)
    shutil.copy(ROOT / PYTHON, tmp_path / PYTHON)
    for name in (
        "generate.py",
        "protection.py",
        "can_protocol.py.in",
        "include/comms/e2e.h",
        "include/comms/node.h",
        "generated/protection.h",
        "hubfoc.dbc",
        "hubfoc_four_wheels.dbc",
        "README.md",
        "generated/hubfoc.h",
        "generated/hubfoc.c",
    ):
        shutil.copy(MODULE / name, module / name)
    core = Path("firmware", "core", "include", "core")
    (tmp_path / core).mkdir(parents=True)
    for name in ("reason.h", "waits_for.h"):
        shutil.copy(ROOT / core / name, tmp_path / core / name)
    return module


def test_a_new_reason_is_detected_and_written_into_the_value_tables_of_the_dbc(
    copy: Path,
) -> None:
    header = copy.parent / "core" / "include" / "core" / "reason.h"
    text = header.read_text(encoding="utf-8")
    header.write_text(
        text.replace('X(16, ABS, "', 'X(63, INVENTED, "invented") X(16, ABS, "').replace(
            "X(63, ", "\n    X(63, "
        ),
        encoding="utf-8",
    )
    stale = run_generator(copy, "--check")
    assert stale.returncode == 1
    assert "hubfoc.dbc" in stale.stderr
    assert run_generator(copy).returncode == 0
    dbc = (copy / "hubfoc.dbc").read_text(encoding="utf-8")
    tables = [line for line in dbc.splitlines() if re.match(r"VAL_ \d+ \w*reason ", line)]
    assert len(tables) >= 8
    assert all('30 "ACCELERATOR_LOCKED" 63 "INVENTED" 64 ' in line for line in tables)


def test_a_changed_message_is_detected_in_code_and_tables_and_updated_by_one_run(
    copy: Path,
) -> None:
    dbc = copy / "hubfoc.dbc"
    dbc.write_text(
        dbc.read_text(encoding="utf-8").replace("46|8@1+ (1,0)", "47|8@1+ (1,0)", 1),
        encoding="utf-8",
    )
    stale = run_generator(copy, "--check")
    assert stale.returncode == 1
    assert [line.split(" ")[0] for line in stale.stderr.splitlines()] == [
        "firmware/comms/hubfoc_four_wheels.dbc",
        "firmware/comms/generated/hubfoc.c",
        "host_sim/python/hubsim/can_protocol.py",
        "firmware/comms/README.md",
    ]
    assert run_generator(copy).returncode == 0
    assert run_generator(copy, "--check").returncode == 0


def test_the_dbcs_of_another_base_have_their_identifiers_and_data_ids_moved(
    tmp_path: Path, database: Database
) -> None:
    made = run_generator(MODULE, "--base", "0x320", "--output", str(tmp_path))
    assert made.returncode == 0, made.stderr
    one = cantools.database.load_file(str(tmp_path / "hubfoc.dbc"), strict=True)
    four = cantools.database.load_file(str(tmp_path / "hubfoc_four_wheels.dbc"), strict=True)
    assert isinstance(one, Database)
    assert isinstance(four, Database)
    for message in database.messages:
        other = one.get_message_by_name(message.name)
        assert other.frame_id - 0x320 == message.frame_id - 0x100
        assert other.cycle_time == message.cycle_time
        assert [str(signal) for signal in other.signals] == [str(s) for s in message.signals]
    assert attribute(one.get_message_by_name("Demand"), "E2EDataID") == 2 << 11 | 0x320
    assert four.get_message_by_name("DemandRearRight").frame_id == 0x323
    refused = run_generator(MODULE, "--base", "0x330", "--output", str(tmp_path))
    assert refused.returncode == 2
    assert "0x330, accepted: a multiple of 32" in refused.stderr
    assert run_generator(MODULE, "--base", "0x320").returncode == 2


def test_overlapping_signals_are_refused_in_one_line_without_output(copy: Path) -> None:
    before = {path: path.read_bytes() for path in copy.rglob("*.[ch]")}
    dbc = copy / "hubfoc.dbc"
    dbc.write_text(
        dbc.read_text(encoding="utf-8").replace("50|14@1+", "40|14@1+", 1),
        encoding="utf-8",
    )
    refused = run_generator(copy)
    assert refused.returncode == 1
    assert len(refused.stderr.splitlines()) == 1
    assert "brake_torque_nm" in refused.stderr
    assert {path: path.read_bytes() for path in copy.rglob("*.[ch]")} == before
    assert not list(copy.rglob("hubfoc.[ch]?*"))


def test_a_missing_dbc_is_an_error_in_one_line(copy: Path) -> None:
    (copy / "hubfoc.dbc").unlink()
    missing = run_generator(copy)
    assert missing.returncode == 1
    assert len(missing.stderr.splitlines()) == 1
    assert missing.stderr.startswith("hubfoc.dbc: ")


def test_the_generated_code_compiles_without_a_warning_and_without_floating_point(
    tmp_path: Path,
) -> None:
    compiler = shutil.which("cc") or shutil.which("gcc")
    assert compiler is not None
    source = MODULE / "generated/hubfoc.c"
    command = [
        compiler,
        *WARNINGS,
        "-O2",
        "-c",
        str(source),
        "-o",
        str(tmp_path / "hubfoc.o"),
    ]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    for path in (source, source.with_suffix(".h")):
        assert not re.search(r"\b(?:float|double)\b", path.read_text(encoding="utf-8")), path.name


def test_the_generated_code_does_not_depend_on_the_date() -> None:
    for path in (MODULE / "generated").iterdir():
        assert not re.search(
            r"\b(?:Mon|Tue|Wed|Thu|Fri|Sat|Sun) \w{3} +\d",
            path.read_text(encoding="utf-8"),
        ), path.name


def longest_frame(length_bytes: int) -> int:
    """Return the bits of the longest standard frame, by stuffing the worst pattern bit by bit.

    After five equal bits comes one of the opposite kind; the worst content continues with that one,
    so that four more suffice for the next. ISO 11898-1: 1 start, 11 identifier, RTR, IDE, reserved,
    4 length, content, 15 CRC are stuffed; CRC delimiter, acknowledge, its delimiter, 7 end of frame
    and 3 intermission are not.
    """
    content = 1 + 11 + 3 + 4 + 8 * length_bytes + 15
    sent: list[int] = []
    level, run = 0, 0
    for index in range(content):
        sent.append(level)
        run += 1
        if run == 5 and index + 1 < content:
            level = 1 - level
            sent.append(level)
            run = 1
    assert all(
        0 < sum(six) < 6 for six in zip(*(sent[k:] for k in range(6)), strict=False)
    )  # never six equal bits
    return len(sent) + 1 + 2 + 7 + 3


def test_four_wheels_take_less_than_half_of_a_bus_of_500_kbit_per_second(
    database: Database,
) -> None:
    bits = longest_frame(8)
    assert bits == 135
    load = 0.0
    for message in database.messages:
        share = bits * 1000.0 / (message.cycle_time or 0) / 500_000
        load += share * (1 if message.senders == ["battery"] else 4)
    assert 0.1 < load < 0.5


def test_the_example_of_the_readme_decodes_every_wheel(tmp_path: Path) -> None:
    """The command is run unchanged, with a recorded line in place of the bus."""
    readme = (MODULE / "README.md").read_text(encoding="utf-8")
    line = re.search(
        r"^ +candump can0 \| \./tools/dev python (-m cantools decode .*)$",
        readme,
        re.MULTILINE,
    )
    assert line is not None
    arguments = line.group(1).replace("firmware/comms/hubfoc.dbc", str(DBC)).split()
    for wheel in range(4):
        # mode 4 in bits 12 .. 15
        recorded = f"  can0  {0x180 + wheel:03X}   [8]  00 40 00 00 00 00 00 00\n"
        command = [sys.executable, *arguments]
        decoded = subprocess.run(
            command,
            input=recorded,
            capture_output=True,
            text=True,
            check=True,
            cwd=tmp_path,
        ).stdout
        assert "WheelState(" in decoded
        assert "mode: RUN" in decoded
