# SPDX-License-Identifier: Apache-2.0
"""Write the diagrams beside this script, or check with ``--check`` that they are current."""

import argparse
import sys
from pathlib import Path

from diagrams import signal_flow, timing

FOLDER = Path(__file__).resolve().parent
DIAGRAMS = {"signal_flow.svg": signal_flow.draw, "timing.svg": timing.draw}


def main() -> int:
    """Return the exit status: 1 if a checked file differs."""
    parser = argparse.ArgumentParser(prog="diagrams", description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare only, write no file")
    check = parser.parse_args().check
    status = 0
    for name, draw in DIAGRAMS.items():
        path, text = FOLDER / name, draw().svg()
        if not check:
            path.write_text(text, encoding="utf-8")
        elif not path.is_file() or path.read_text(encoding="utf-8") != text:
            print(f"{path.name} is out of date: run tools/dev python -m diagrams", file=sys.stderr)
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
