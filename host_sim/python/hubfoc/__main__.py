# SPDX-License-Identifier: Apache-2.0
"""``python -m hubfoc``."""

import sys

from hubfoc.cli import main

if __name__ == "__main__":
    sys.exit(main())
