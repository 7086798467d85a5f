# SPDX-License-Identifier: Apache-2.0
"""Entry of ``python -m regen_table``."""

import sys

from regen_table.cli import main

if __name__ == "__main__":
    sys.exit(main())
