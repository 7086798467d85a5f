# SPDX-License-Identifier: Apache-2.0
"""What every run at the edges of the envelope must show."""

from collections.abc import Sequence

from hubsim.envelope import SENSOR_STARTS, Outcome

DEVIATION = 0.01  # of the rated torque, torque beside its command
CURRENT_SHARE = 1.35  # of the phase current's limit: below the trip
BUS_SHARE = 1.02  # of the battery's largest voltage
DROVE_SHARE_S = 0.05  # a driving torque under the brake ends by then


def misses(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what is out of bounds."""
    found = []
    for o in outcomes:
        sound = o.start not in SENSOR_STARTS
        bounds = {
            "deviation": not sound or o.deviation <= DEVIATION,
            "current": o.current_share <= CURRENT_SHARE,
            "bus": o.bus_share <= BUS_SHARE,
            "drives under the brake": o.drove_s <= DROVE_SHARE_S,
            "fault": not (sound and o.first_fault),
        }
        found += [f"run {o.number} {o.drive} {o.start}: {k}" for k, ok in bounds.items() if not ok]
    return found
