# SPDX-License-Identifier: Apache-2.0
"""``python -m hubsim``."""

import sys

from hubsim.cli import main

sys.exit(main())
