# SPDX-License-Identifier: Apache-2.0
"""How far a stop may be from the ideal inside the same limits, and what is known to be further.

The aim is stored_share.TOLERANCE for every stop; none stores less. Where the firmware is known to
ripple more, the bound is what it reaches today, by the limit under which most energy goes past the
motor.
"""

from collections.abc import Sequence

from hubsim.stored_share import RIPPLE_MAX, TOLERANCE, Outcome

MOST_ABOVE = TOLERANCE  # the ideal, slow stops included
# Hall sensors, whose edges are seen up to a PWM period late, with a large negative i_d: in loss
# braking, where the sectors take too long for the EMF observer to tell when an edge was.
KNOWN_RIPPLE = {("lu2013", "BUS_VOLTAGE_HIGH"): 0.015}


def compared(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Return the stops that have an ideal."""
    return [outcome for outcome in outcomes if outcome.comparable]


def misses(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for every stop outside its bounds."""
    found = []
    for outcome in outcomes:
        case = (outcome.drive, outcome.reason)
        ripple = KNOWN_RIPPLE.get(case, RIPPLE_MAX)
        if not -outcome.tolerance <= outcome.difference <= MOST_ABOVE:
            found.append(f"difference {100.0 * outcome.difference:+.2f} %: {outcome}")
        if outcome.ripple_share_of_rated > ripple:
            found.append(f"ripple {100.0 * outcome.ripple_share_of_rated:.2f} %: {outcome}")
        if outcome.first_fault:
            found.append(f"fault: {outcome}")
    return found
