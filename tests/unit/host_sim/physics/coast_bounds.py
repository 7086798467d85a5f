# SPDX-License-Identifier: Apache-2.0
"""What the sweep of coasting holds to: the aim, and where it is missed by how much."""

import math
from collections.abc import Iterable

from hubsim.coast import Outcome

# A contactor that opens while the diodes conduct beyond the phase current: no other way to let go
# is admissible either.
CONDUCTING_BUS_SHARE = {"lu2013": 1.06}  # 78.2 V of 75 V found with another seed
CONDUCTING_SPEED_SHARE = 1.05


def misses(outcomes: Iterable[Outcome]) -> list[str]:
    """Return the cases outside their bounds, in words."""
    return [text for outcome in outcomes if (text := _miss(outcome))]


def _miss(o: Outcome) -> str:
    leaves = math.isfinite(o.cut_s)
    fast = leaves and o.speed_share_of_top > CONDUCTING_SPEED_SHARE
    most_share = CONDUCTING_BUS_SHARE.get(o.drive, 1.0) if fast else 1.0
    fine = o.excess_nm <= o.tolerance_nm and o.highest_bus_share < most_share and not o.first_fault
    return "" if fine else str(o)
