# SPDX-License-Identifier: Apache-2.0
"""Commands that became studies of the repository: each names what took its place."""

import sys

from regen_table.cli import REFUSED

STUDIES = {
    "blend_out": "blend_out",
    "coast": "coast",
    "dips": "dips",
    "edges": "edges",
    "envelope": "envelope",
    "faults_tables": "faults",
}


def answer(name: str) -> int:
    """Name the study on stderr; return the exit status of a wrong call."""
    print(f"hubsim: {name} is a study now: ./tools/dev study {STUDIES[name]}", file=sys.stderr)
    return REFUSED
