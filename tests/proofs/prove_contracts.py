# SPDX-License-Identifier: Apache-2.0
"""Prove the contracts of a group of functions, or of one, with CBMC (README.md, Contracts).

python prove_contracts.py CBMC GROUP|FUNCTION
"""

import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import contract_harness


def judge(printed: str, names: Sequence[str]) -> list[str]:
    """Return what is wrong with the results of a run that proves the functions `names`.

    Every check must hold, and the end of every function's harness must be found reachable.
    """
    result = re.compile(r"^\[(\S+)\] (?:line \d+ )?(.*): (SUCCESS|FAILURE|UNKNOWN|ERROR)$")
    found = [match for line in printed.splitlines() if (match := result.match(line))]
    ends = {}
    wrong = []
    for check, text, status in (match.groups() for match in found):
        if end := re.search(r"the end of (\w+) is reached", text):
            ends[end[1]] = status == "FAILURE"
        elif status != "SUCCESS":
            wrong.append(f"{check}: {text}: {status}")
    wrong += [f"{name}: no input meets its preconditions" for name in names
              if not ends.get(name)]  # fmt: skip
    return wrong if found else ["CBMC gave no result", *printed.splitlines()[-20:]]


def prove(cbmc: str, chosen: str) -> int:
    """Prove the contracts of a group, or of one function."""
    names = contract_harness.functions_of(chosen)
    with tempfile.TemporaryDirectory() as folder:
        command = [cbmc, *contract_harness.command(Path(folder), names)]
        run = subprocess.run(command, check=False, capture_output=True, text=True)
    wrong = judge(run.stdout + run.stderr, names)
    print("\n".join(wrong) if wrong else f"{len(names)} contracts proved: {', '.join(names)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(prove(*sys.argv[1:]))
