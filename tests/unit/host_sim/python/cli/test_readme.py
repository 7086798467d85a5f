# SPDX-License-Identifier: Apache-2.0
"""The README's commands give the described results, in its order, in an empty directory."""

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
from black_box_memory import memory, printed
from hubsim.engine import ROOT
from hubsim_command import Hubsim

README = ROOT / "host_sim" / "python" / "README.md"
COMMAND = "    ./tools/dev hubsim "
# What makes a command short, where a run is not to be long: of both cycles, half a minute, a hop.
SHORTER = {} if "HUBFOC_FOR_LONG" in os.environ else {"sim": ["--scenario", "hop.toml"]}


def block(name: str) -> str:
    """Return the indented block that begins with a comment of its name."""
    lines = README.read_text(encoding="utf-8").splitlines()
    first = lines.index(f"    # {name}")
    last = next(k for k in range(first, len(lines)) if lines[k] and not lines[k].startswith("    "))
    return "\n".join(line[4:] for line in lines[first:last])


def commands() -> list[list[str]]:
    """Return the arguments of every command; the text after three spaces is explanation."""
    lines = [
        line.removeprefix(COMMAND)
        for line in README.read_text(encoding="utf-8").splitlines()
        if line.startswith(COMMAND)
    ]
    return [shlex.split(line.partition("   ")[0]) for line in lines]


def test_every_command_of_the_readme_works(hubsim: Hubsim, tmp_path: Path) -> None:
    (tmp_path / "my_scenario.toml").write_text(block("my_scenario.toml"), encoding="utf-8")
    (tmp_path / "log.txt").write_text(printed(memory()), encoding="utf-8")
    (tmp_path / "hop.csv").write_text("time_s,speed_km_h\n0,0\n5,20\n9,0\n", encoding="utf-8")
    (tmp_path / "hop.toml").write_text('cycle = "hop.csv"\n', encoding="utf-8")
    (tmp_path / "tools").symlink_to(ROOT / "tools")
    found = commands()
    for arguments in found:
        done = hubsim(*arguments, *SHORTER.get(arguments[0], []))
        assert done.returncode == 0, f"{arguments}\n{done.stdout}\n{done.stderr}"
    first = subprocess.run(
        [sys.executable, "-m", "hubsim", *found[0]],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert first.returncode == 0, first.stderr
    assert first.stdout == hubsim(*found[0]).stdout
    for name in (
        "stop.json",
        "ece15.csv",
        "contactor.xml",
        "my.mf4",
        "my.parquet",
        "report/index.html",
        "page.html",
        "DIR/blackbox.svg",
    ):
        assert (tmp_path / name).is_file(), name
    assert pq.read_table(tmp_path / "grid.parquet").num_rows == 8
    assert pq.read_table(tmp_path / "draws.parquet").num_rows == 8
