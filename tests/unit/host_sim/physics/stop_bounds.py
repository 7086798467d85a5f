# SPDX-License-Identifier: Apache-2.0
"""How far a stop may be from the ideal inside the same limits, and what is known to be further.

The aim is stored_share.TOLERANCE for every stop. Where the firmware is known to miss it, the bound
is what it reaches today, by the limit under which most energy goes past the motor.
"""

import math
from collections.abc import Sequence

from hubsim.stored_share import RIPPLE_MAX, TOLERANCE, Outcome, drive_named

MOST_ABOVE = TOLERANCE  # the ideal, slow stops included
KNOWN = {
    # i_d ends at field_weakening_current_a and at -psi/L_d instead of the phase current
    ("ipm400v", "VOLTAGE"): 0.055,
    # the share of the charge current kept back for a hall sensor's late edge
    ("scooter48v", "CHARGE_CURRENT"): 0.017,
    ("scooter48v", "BUS_VOLTAGE_HIGH"): 0.022,
    # loss braking returns less than the fold-back would let it
    ("ebike36v", "BUS_VOLTAGE_HIGH"): 0.04,
    ("ebike36v", "LOSS_OPTIMUM"): 0.04,
    ("lu2013", "BUS_VOLTAGE_HIGH"): 0.045,
}
# The fold-back's allowance settles slowly close to the end of the voltage range.
KNOWN_ABOVE = {("lu2013", "BUS_VOLTAGE_HIGH"): 0.03}
# At the end of the voltage circle, and on the derating line.
KNOWN_RIPPLE = {
    ("lu2013", "MAX_POWER"): 0.02,
    ("lu2013", "MAX_TORQUE"): 0.03,
    ("lu2013", "BUS_VOLTAGE_HIGH"): 0.02,
    ("lu2013", "LOSS_OPTIMUM"): 0.02,
    ("ipm400v", "VOLTAGE"): 0.025,
    ("ipm400v", "MAX_TORQUE"): 0.025,
    ("scooter48v", "WINDING_TEMPERATURE"): 0.025,
}


def begins_above_the_emf_limit(outcome: Outcome) -> bool:
    """Whether the EMF at the initial speed is beyond the open-circuit voltage.

    Regeneration then needs a demagnetising current from the first period on.
    """
    motor = drive_named(outcome.drive).motor
    top_rad_s = motor.max_speed_rpm * math.pi / 30.0
    emf_v = math.sqrt(3.0) * motor.flux_linkage_wb * motor.pole_pairs * top_rad_s
    return outcome.speed_share_of_top * emf_v > outcome.open_circuit_v


def compared(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Return the stops that have an ideal.

    Not those of surface magnets above the EMF limit, where the firmware does not start, or not
    without a fault.
    """
    return [
        outcome
        for outcome in outcomes
        if outcome.comparable
        and not (outcome.drive == "lu2013" and begins_above_the_emf_limit(outcome))
    ]


def misses(outcomes: Sequence[Outcome]) -> list[str]:
    """Return a line for every stop outside its bounds."""
    found = []
    for outcome in outcomes:
        case = (outcome.drive, outcome.reason)
        below = max(outcome.tolerance, KNOWN.get(case, 0.0))
        ripple = KNOWN_RIPPLE.get(case, RIPPLE_MAX)
        above = KNOWN_ABOVE.get(case, MOST_ABOVE)
        if not -below <= outcome.difference <= above:
            found.append(f"difference {100.0 * outcome.difference:+.2f} %: {outcome}")
        if outcome.ripple_share_of_rated > ripple:
            found.append(f"ripple {100.0 * outcome.ripple_share_of_rated:.2f} %: {outcome}")
        if outcome.first_fault:
            found.append(f"fault: {outcome}")
    return found
