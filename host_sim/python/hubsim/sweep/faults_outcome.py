# SPDX-License-Identifier: Apache-2.0
"""What a run of the fault sweep did, and the limits that it has to hold."""

from dataclasses import dataclass

from hubsim.scenario import faults

LONGER, LONGER_BRAKE = 0.1, 0.25  # of the distance; with a wrong hydraulic brake
EXCESS_NM, EXCESS_SHARE = 5.0, 0.1  # beyond the demand, whichever is more


@dataclass(frozen=True)
class Outcome:
    """What a run did. Times in s but where the name says otherwise; NaN: never.

    Attributes
    ----------
    distance_ratio : float
        Distance from the first braking demand to standstill over that without the fault.
    wrong_sign_ms : float
        Longest time with more than 2 N m of driving torque while the driver brakes.
    wrong_nm : float
        Largest driving torque then.
    excess_nm : float
        Largest mean of 100 ms by which motor and brake together exceed the demand.
    error_share : float
        Largest mean of 20 ms of the torque's difference to the run without the fault, at the same
        time or speed, whichever is nearer; share of the rated torque.
    current_ratio : float
        Longest current vector over the over-current limit, active short circuits apart.
    healed_under_braking : int
        1: a fault that was latched went away while the driver braked, without a restart.
    acknowledged_turning : int
        1: one went away while the wheel turned, without a restart; the driver acknowledges all the
        time.
    """

    fault: str
    config: str
    rotor_sensor: str
    situation: str
    demand_nm: float
    instant_s: float
    distance_ratio: float
    wrong_sign_ms: float
    wrong_nm: float
    excess_nm: float
    error_share: float
    current_ratio: float
    bus_peak_v: float
    bus_limit_v: float
    first_reason: str
    reason_expected: int
    time_to_reason_ms: float
    harmless: int
    final_mode: str
    healed_under_braking: int
    acknowledged_turning: int

    @property
    def key(self) -> tuple[str, str, str, str, float, float]:
        """As of its case."""
        return (
            self.fault,
            self.config,
            self.rotor_sensor,
            self.situation,
            self.demand_nm,
            self.instant_s,
        )

    def misses(self, slack: float = 0.0) -> list[str]:
        """Return what this run does not hold, by the limits that every fault has to hold.

        ``slack`` widens the limits by that share, for comparisons that noise must not decide.
        """
        brake = faults.table()[self.fault].brake
        wide = 1.0 + slack
        longer = LONGER_BRAKE if brake else LONGER
        most_nm = max(EXCESS_NM, EXCESS_SHARE * self.demand_nm)
        found = {
            "distance": not self.distance_ratio - 1.0 <= wide * longer,
            "wrong sign": self.wrong_sign_ms > 5.0 * wide,
            "excess": self.excess_nm > wide * most_nm and brake != "strong",
            "current": self.current_ratio > 1.3 * wide,
            "bus": self.bus_peak_v > self.bus_limit_v,
            "reason": not (self.harmless or self.reason_expected),
            "healed": bool(self.healed_under_braking),
            "acknowledged": bool(self.acknowledged_turning),
        }
        return [name for name, missed in found.items() if missed]
