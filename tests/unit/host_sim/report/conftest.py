# SPDX-License-Identifier: Apache-2.0
"""The tests of the report share a vehicle.

Found by its path from the project's root, however pytest was started.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[4]))
