# SPDX-License-Identifier: Apache-2.0
"""What the sweep of coasting holds to: the aim."""

from collections.abc import Iterable

from hubsim.coast import Outcome


def misses(outcomes: Iterable[Outcome]) -> list[str]:
    """Return the cases outside their bounds, in words."""
    return [text for outcome in outcomes if (text := _miss(outcome))]


def _miss(o: Outcome) -> str:
    fine = o.excess_nm <= o.tolerance_nm and o.highest_bus_share < 1.0 and not o.first_fault
    return "" if fine else str(o)
