# SPDX-License-Identifier: Apache-2.0
"""Run one proof of prove_*.c, and the check that its assumptions can be met (README.md).

python prove.py CBMC NAME SOURCE... OPTION...   proves prove_NAME()
"""

import sys
from collections.abc import Sequence

import proved

REACHED = 'the end of the proof is reached": FAILURE'


def holds(printed: str) -> list[str]:
    """Return nothing if every check of a run holds, otherwise what CBMC printed."""
    successful = "\nVERIFICATION SUCCESSFUL" in printed
    return [] if successful else ["not proved", *printed.splitlines()]


def is_reached(printed: str) -> list[str]:
    """Return nothing if some input leads to the end of the proof."""
    return [] if REACHED in printed else ["no input meets the assumptions", *printed.splitlines()]


def prove(cbmc: str, name: str, arguments: Sequence[str]) -> int:
    """Print what CBMC finds wrong with a proof, or that it holds."""
    run = ["--function", f"prove_{name}", "--verbosity", "4"]
    files = [one for one in arguments if one.endswith(".c") or one.startswith("-I")]
    to_the_end = [*run, *files, "-DPROOF_EXPECT_REACHED", "--no-standard-checks", "--unwind", "70"]
    kept = f"proof_{name}"
    outcomes = (
        proved.check(cbmc, [*run, *arguments], holds, kept, "every check holds"),
        proved.check(cbmc, to_the_end, is_reached, kept, "the end is reached"),
    )
    wrong = [line for outcome in outcomes for line in outcome.wrong]
    cached = all(outcome.cached for outcome in outcomes)
    print("\n".join(wrong) if wrong else proved.proved_line("proof", [name], cached))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(prove(sys.argv[1], sys.argv[2], sys.argv[3:]))
