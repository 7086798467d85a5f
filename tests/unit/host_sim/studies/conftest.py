# SPDX-License-Identifier: Apache-2.0
"""What the tests of the studies share: the modules of the folder ``support``."""

import sys

from hubsim.engine import ROOT

sys.path.append(str(ROOT / "tests" / "unit" / "host_sim" / "support"))
