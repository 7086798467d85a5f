# SPDX-License-Identifier: Apache-2.0
"""What an installed distribution cannot find out for itself, written down when it is built.

    python host_sim/python/bake.py DIRECTORY

``build.json`` has version and commit; ``config_header.i`` is config/config.h as a C preprocessor
left it, so that no compiler is needed to read and write configurations. Standard library only: this
runs before anything is installed.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

from regen_table import installation, layout


def main(directory: Path) -> None:
    """Write both files."""
    directory.mkdir(parents=True, exist_ok=True)
    record = {"version": installation.version(), "commit": installation.commit()}
    (directory / "build.json").write_text(json.dumps(record) + "\n", encoding="utf-8")
    (directory / "config_header.i").write_text(layout.expanded(), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
