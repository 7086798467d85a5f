# SPDX-License-Identifier: Apache-2.0
"""Simulated time against the clock on the wall."""

import time
from dataclasses import dataclass, field

LATE_MOST_S = 0.1  # beyond that the vehicle gives up the lost time instead of running after it
SLOW_SHOWN_S = 10.0
WINDOW_S = 5.0  # over which factor and processor's share are means


@dataclass
class Clock:
    """When the next step is due, and how well that is kept.

    Every step is simulated: a machine that is too slow makes a slower vehicle, not one with gaps.
    """

    paced: bool  # False: as fast as it can
    late_s: float = 0.0  # the largest since the start
    _due: float = field(default_factory=time.monotonic)
    _window: tuple[float, float, float] = (0.0, 0.0, 0.0)
    _factor: float = 1.0
    _share: float = 0.0
    _complained: float = -SLOW_SHOWN_S

    def begin(self, time_s: float = 0.0) -> None:
        """Count from now, where the simulated time is this."""
        self._due = time.monotonic()
        self._window = (self._due, time.process_time(), time_s)

    def wait_s(self) -> float:
        """Return for how long there is nothing to do; 0: a step is due, its lateness counts."""
        if not self.paced:
            return 0.0
        left = self._due - time.monotonic()
        if left <= 0.0:
            self.late_s = max(self.late_s, -left)
        return max(left, 0.0)

    def stepped(self, time_s: float, step_s: float) -> str | None:
        """Count a step; return one line if the vehicle has become too slow to keep up."""
        now = time.monotonic()
        self._due += step_s
        begun, cpu, simulated = self._window
        if now - begun >= WINDOW_S:
            self._factor = (time_s - simulated) / (now - begun)
            self._share = (time.process_time() - cpu) / (now - begun)
            self._window = (now, time.process_time(), time_s)
        if not self.paced or now - self._due < LATE_MOST_S:
            return None
        self._due = now
        if now - self._complained < SLOW_SHOWN_S:
            return None
        self._complained = now
        return f"this machine is too slow: {1e3 * LATE_MOST_S:.0f} ms late, not made up for"

    def health(self) -> dict[str, float]:
        """Return how well real time is kept: over some seconds, lateness since the start."""
        return {
            "realtime_factor": round(self._factor, 3),
            "late_ms_max": round(1e3 * self.late_s, 2),
            "cpu_share": round(self._share, 3),
        }
