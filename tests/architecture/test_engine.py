# SPDX-License-Identifier: Apache-2.0
"""How the simulation engine is compiled: for speed, and for the same bytes everywhere.

Speed itself is not tested, because it depends on the machine and its load. Tested is its
precondition: firmware and plant in one link-time optimisation, except for the motor's rare paths.
"""

import json
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest
from modules import PURE, ROOT, sources_of

BUILD = Path(os.environ["HUBFOC_BUILD_DIR"])
LIBRARY = BUILD / "host_sim" / "libhubsim_engine.so"
# Steps that are not one linear set (plant/pmsm_sets.c): not inlined, so that they use no registers
# of the common step.
RARE = {"energy_map.c", "pmsm_saturated.c", "pmsm_sets.c", "pmsm_straight.c"}
# Results that depend on the processor or the order of operations, or on a recorded run.
FORBIDDEN = re.compile(r"-(march|mcpu|mtune|mfma|mavx|ffast-math|funsafe|fassociative|fprofile)")


REFERENCE_GCC = "12."


def compiler() -> tuple[str, str]:
    """Return the name and the release of the compiler."""
    (path,) = BUILD.glob("CMakeFiles/*/CMakeCCompiler.cmake")
    text = path.read_text(encoding="utf-8")
    found = (
        re.search(rf'set\(CMAKE_C_COMPILER_{key} "([^"]*)"\)', text) for key in ("ID", "VERSION")
    )
    name, release = (match[1] if match else "" for match in found)
    return name, release


def commands() -> dict[Path, list[str]]:
    entries = json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8"))
    return {
        Path(entry["file"]): shlex.split(entry["command"])
        for entry in entries
        if "hubsim_engine.dir" in entry["command"]
    }


def last(options: list[str], *kinds: str) -> str:
    """Return the effective option of these kinds."""
    return [option for option in options if option.startswith(kinds)][-1]


def test_the_engine_contains_all_sources_of_the_pure_modules_and_the_plant() -> None:
    compiled = set(commands())
    absent = {path for path in compiled if path.stem.endswith("_absent")}  # a small port's
    assert absent == set()
    every = {path for module in PURE for path in sources_of(module)}
    assert {path for path in every if not path.stem.endswith("_absent")} <= compiled
    assert set((ROOT / "host_sim" / "plant").glob("*.c")) <= compiled


@pytest.mark.skipif(compiler()[0] != "GNU", reason="other compilers get no such options")
def test_all_sources_but_the_motors_rare_paths_are_link_time_optimised() -> None:
    apart = set()
    for path, options in commands().items():
        assert last(options, "-O") == "-O3", path
        if last(options, "-flto", "-fno-lto") == "-fno-lto":
            apart.add(path.name)
    assert apart == RARE


def test_no_option_makes_a_result_depend_on_the_processor() -> None:
    for path, options in commands().items():
        assert not [option for option in options if FORBIDDEN.match(option)], path
        assert last(options, "-ffp-contract") == "-ffp-contract=off", path


@pytest.mark.parametrize("option", ["-march=native", "-ffast-math", "-fprofile-use=a"])
def test_the_search_finds_such_an_option(option: str) -> None:
    assert FORBIDDEN.match(option)


def functions() -> set[str]:
    listed = subprocess.run(["nm", LIBRARY], capture_output=True, text=True, check=True).stdout
    return {line.split()[-1] for line in listed.splitlines() if " t " in line.lower()}


def test_the_motors_rare_paths_are_not_inlined() -> None:
    assert {
        "pmsm_step_in_sets",
        "pmsm_straight_advance",
        "pmsm_saturated_advance",
    } <= functions()


@pytest.mark.skipif(
    compiler()[0] != "GNU" or not compiler()[1].startswith(REFERENCE_GCC),
    reason="another release may decide otherwise",
)
def test_the_motors_common_step_is_inlined() -> None:
    assert "pmsm_step" not in functions()
