# SPDX-License-Identifier: Apache-2.0
"""``python -m hubsim``."""

import sys

from regen_table.cli import interrupted


def run() -> int:
    """Load the command line and run it."""
    try:
        from hubsim.cli import main  # noqa: PLC0415, Ctrl-C may come while it loads

        return main()
    except KeyboardInterrupt as interrupt:
        return interrupted("hubsim", interrupt)


sys.exit(run())
