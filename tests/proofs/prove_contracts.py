# SPDX-License-Identifier: Apache-2.0
"""Prove the contracts of a group of functions, or of one, with CBMC (README.md, Contracts).

python prove_contracts.py CBMC GROUP|FUNCTION
python prove_contracts.py CBMC --planted   each of planted_errors.py must be found
"""

import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import contract_harness
import contracts
import proved
from planted_errors import PLANTED, PLANTED_IN_PROOFS, PlantedProofError


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


def missed(printed: str) -> list[str]:
    """Return nothing if CBMC found a planted error, otherwise what it says."""
    wrong = judge(printed, [])
    return [] if any(": FAILURE" in line for line in wrong) else [*wrong, "the error was missed"]


def run(cbmc: str, chosen: str, names: Sequence[str]) -> proved.Outcome:
    """Return what CBMC finds wrong with the contracts of some functions."""
    with tempfile.TemporaryDirectory() as folder:
        command = contract_harness.command(Path(folder), list(names), ends=True)
        return proved.check(
            cbmc, command, lambda printed: judge(printed, names), f"contracts_{chosen}",
            f"every check holds, reached: {' '.join(names)}", Path(folder),
        )  # fmt: skip


def prove(cbmc: str, chosen: str) -> int:
    """Prove the contracts of a group, or of one function, and that inputs meet them."""
    names = contract_harness.functions_of(chosen)
    apart = chosen in contract_harness.APART
    runs = [[name] for name in names] if apart else [names]
    outcomes = [(one, run(cbmc, chosen, one)) for one in runs]
    wrong = [line for _, outcome in outcomes for line in outcome.wrong]
    if wrong:
        print("\n".join(wrong))
    for cached in (False, True):
        good = [name for one, outcome in outcomes for name in one
                if not outcome.wrong and outcome.cached == cached]  # fmt: skip
        if good:
            print(proved.proved_line("contract", good, cached))
    return 1 if wrong else 0


def refutation(folder: Path, error: PlantedProofError) -> list[str]:
    """Return CBMC's arguments for a proof written in C, given an error in a source."""
    modules = [path for path in contracts.FIRMWARE.iterdir() if path.is_dir()]
    source = contracts.FIRMWARE / error.source
    text = source.read_text(encoding="utf-8")
    assert text.count(error.right) == 1, error
    copy = folder / source.name
    copy.write_text(text.replace(error.right, error.wrong), encoding="utf-8")
    return [
        "--function", f"prove_{error.function}", f"-I{folder}", f"-I{contracts.PROOFS}",
        *(f"-I{path / 'include'}" for path in modules), *(f"-I{path}" for path in modules),
        str(contracts.PROOFS / error.proof),
        *(str(contracts.FIRMWARE / name) for name in error.sources),
        *contract_harness.CHECKS, "--unwind", "70", "--verbosity", "4",
    ]  # fmt: skip


def find_planted(cbmc: str) -> int:
    """Refute a condition with each planted error in the sources."""
    failed = False
    for error in (*PLANTED, *PLANTED_IN_PROOFS):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            if isinstance(error, PlantedProofError):
                command = refutation(folder, error)
            else:
                command = contract_harness.command(folder, [error.function], False, error)
            outcome = proved.check(
                cbmc, command, missed, "contracts_planted_errors", "the error is found", folder
            )
        found = (
            "MISSED" if outcome.wrong else "found before (cached)" if outcome.cached else "found"
        )
        print("\n".join([f"{found}: {error.function}: {error.wrong.strip()}", *outcome.wrong]))
        failed = failed or bool(outcome.wrong)
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[2:] == ["--planted"]:
        sys.exit(find_planted(sys.argv[1]))
    sys.exit(prove(sys.argv[1], sys.argv[2]))
