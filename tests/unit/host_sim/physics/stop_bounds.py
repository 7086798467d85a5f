# SPDX-License-Identifier: Apache-2.0
"""How far a stop may be from the ideal inside the same limits.

The aim is stored_share.TOLERANCE and RIPPLE_MAX for every stop.
"""

from collections.abc import Sequence

from hubsim.stored_share import RIPPLE_MAX, TOLERANCE, Outcome

MOST_ABOVE = TOLERANCE  # the ideal, slow stops included


def compared(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Return the stops that have an ideal."""
    return [outcome for outcome in outcomes if outcome.comparable]


def misses(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for every stop outside its bounds."""
    found = []
    for outcome in outcomes:
        if not -outcome.tolerance <= outcome.difference <= MOST_ABOVE:
            found.append(f"difference {100.0 * outcome.difference:+.2f} %: {outcome}")
        if outcome.ripple_share_of_rated > RIPPLE_MAX:
            found.append(f"ripple {100.0 * outcome.ripple_share_of_rated:.2f} %: {outcome}")
        if outcome.first_fault:
            found.append(f"fault: {outcome}")
    return found
