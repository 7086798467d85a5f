# SPDX-License-Identifier: Apache-2.0
"""Prove the contracts of a group of functions, or of one, with CBMC (README.md, Contracts).

python prove_contracts.py CBMC GROUP|FUNCTION [--ends]
python prove_contracts.py CBMC --planted   each of planted_errors.py must be found
"""

import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import contract_harness
import contracts
from planted_errors import PLANTED, PLANTED_IN_PROOFS, PlantedError, PlantedProofError


def judge(printed: str, ends: Sequence[str]) -> list[str]:
    """Return what is wrong with the results of a run: every check must hold.

    ends: the functions whose harness's end must be found reachable.
    """
    result = re.compile(r"^\[(\S+)\] (?:line \d+ )?(.*): (SUCCESS|FAILURE|UNKNOWN|ERROR)$")
    found = [match for line in printed.splitlines() if (match := result.match(line))]
    reached = {}
    wrong = []
    for check, text, status in (match.groups() for match in found):
        if end := re.search(r"the end of (\w+) is reached", text):
            reached[end[1]] = status == "FAILURE"
        elif status != "SUCCESS":
            wrong.append(f"{check}: {text}: {status}")
    wrong += [f"{name}: no input meets its preconditions" for name in ends
              if not reached.get(name)]  # fmt: skip
    return wrong if found else ["CBMC gave no result", *printed.splitlines()[-20:]]


def run(
    cbmc: str, names: Sequence[str], ends: bool, planted: PlantedError | None = None
) -> list[str]:
    """Return what CBMC finds wrong with the contracts of some functions."""
    with tempfile.TemporaryDirectory() as folder:
        command = contract_harness.command(Path(folder), list(names), ends, planted)
        done = subprocess.run([cbmc, *command], check=False, capture_output=True, text=True)
    return judge(done.stdout + done.stderr, names if ends else [])


def prove(cbmc: str, chosen: str, ends: bool) -> int:
    """Prove the contracts of a group, or of one function; with `ends` that inputs exist as well."""
    names = contract_harness.functions_of(chosen)
    apart = chosen in contract_harness.APART
    runs = [[name] for name in names] if apart else [names]
    wrong = [line for one in runs for line in run(cbmc, one, ends)]
    print("\n".join(wrong) if wrong else f"{len(names)} contracts proved: {', '.join(names)}")
    return 1 if wrong else 0


def refute(cbmc: str, error: PlantedProofError) -> list[str]:
    """Return what CBMC finds wrong with a proof written in C, given an error in a source."""
    modules = [path for path in contracts.FIRMWARE.iterdir() if path.is_dir()]
    source = contracts.FIRMWARE / error.source
    text = source.read_text(encoding="utf-8")
    assert text.count(error.right) == 1, error
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / source.name
        copy.write_text(text.replace(error.right, error.wrong), encoding="utf-8")
        command = [
            cbmc, "--function", f"prove_{error.function}", f"-I{folder}", f"-I{contracts.PROOFS}",
            *(f"-I{path / 'include'}" for path in modules), *(f"-I{path}" for path in modules),
            str(contracts.PROOFS / error.proof),
            *(str(contracts.FIRMWARE / name) for name in error.sources),
            *contract_harness.CHECKS, "--unwind", "70", "--verbosity", "4",
        ]  # fmt: skip
        done = subprocess.run(command, check=False, capture_output=True, text=True)
    return judge(done.stdout + done.stderr, [])


def find_planted(cbmc: str) -> int:
    """Refute a condition with each planted error in the sources."""
    missed = []
    for error in (*PLANTED, *PLANTED_IN_PROOFS):
        if isinstance(error, PlantedProofError):
            wrong = refute(cbmc, error)
        else:
            wrong = run(cbmc, [error.function], False, error)
        found = any(": FAILURE" in line for line in wrong)
        print(f"{'found' if found else 'MISSED'}: {error.function}: {error.wrong.strip()}")
        missed += [] if found else [error, *wrong]
    return 1 if missed else 0


if __name__ == "__main__":
    if sys.argv[2:] == ["--planted"]:
        sys.exit(find_planted(sys.argv[1]))
    sys.exit(prove(sys.argv[1], sys.argv[2], sys.argv[3:] == ["--ends"]))
