# SPDX-License-Identifier: Apache-2.0
"""The tests of the virtual vehicle share the running one of support.py.

Found by its path from the project's root, however pytest was started.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[4]))
sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))
