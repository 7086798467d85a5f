# SPDX-License-Identifier: Apache-2.0
"""What a run's controllers reported besides torque: limits, modes, warnings; and what was left out.

So that "why only 22 %?" has an answer under the figure.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from hubsim import engine, reasons
from hubsim.run.results import RunResult
from hubsim.scenario import Scenario

SIGNALS = (
    *("time_s", "wheel*.reason", "wheel*.mode"),
    *("wheel*.warning_reason", "wheel*.fault_reason"),
)
_NOT_HEALTHY = ("LIMP", "FAULT")
_LEAST_SHARE = 0.005  # of a limit that is named on the terminal
PERCENT = 100.0


def observed(result: RunResult, scenario: Scenario) -> dict[str, Any]:
    """Return what a run that recorded ``SIGNALS`` showed, as JSON holds it.

    ``limits`` and ``modes``: share of the times at which any wheel showed them, the largest first.
    ``findings``: warnings and faults with their first time and the wheels. ``left_out``: physics
    that the scenario switched off.
    """
    limits = {
        name: share
        for code, share in _shares(result, "reason").items()
        if (name := reasons.identifier(code)) in reasons.limits() and code
    }
    return {
        "limits": limits,
        "modes": {engine.mode_text(code): s for code, s in _shares(result, "mode").items()},
        "findings": _findings(result),
        "left_out": _left_out(result, scenario),
    }


def _rows(result: RunResult, signal: str) -> Any:  # noqa: ANN401, an array of shape (wheels, rows)
    return np.stack([result.signal(f"wheel{k}.{signal}") for k in range(result.wheels)])


def _shares(result: RunResult, signal: str) -> dict[int, float]:
    rows = _rows(result, signal)
    shares = {int(code): float(np.mean(np.any(rows == code, axis=0))) for code in np.unique(rows)}
    return dict(sorted(shares.items(), key=lambda entry: -entry[1]))


def _findings(result: RunResult) -> list[dict[str, Any]]:
    time_s = result.signal("time_s")
    found: dict[str, dict[str, Any]] = {}
    for signal in ("warning_reason", "fault_reason"):
        rows = _rows(result, signal)
        for code in np.unique(rows[rows > 0]):
            shown = rows == code
            first = int(np.argmax(np.any(shown, axis=0)))
            found[reasons.identifier(code)] = {
                "reason": reasons.identifier(code),
                "first_s": float(time_s[first]),
                "wheels": np.flatnonzero(np.any(shown, axis=1)).tolist(),
            }
    return sorted(found.values(), key=lambda one: one["first_s"])


def _left_out(result: RunResult, scenario: Scenario) -> list[str]:
    off = {
        "heat (plant.thermal.active = 0)": result.parameters["thermal.active"] <= 0.5,
        "air drag and rolling resistance (drag = false)": not scenario.drag,
        "noise of the sensors (noise = false)": not scenario.noise,
    }
    return [what for what, is_off in off.items() if is_off]


def lines(seen: Mapping[str, Any]) -> list[str]:
    """Return what was observed for a terminal."""
    limits = _listed(seen["limits"]) or "none"
    out = [f"limits of the motor torque, share of the time: {limits}"]
    modes = _listed({mode: s for mode, s in seen["modes"].items() if mode in _NOT_HEALTHY})
    if modes:
        out.append(f"modes other than healthy, share of the time: {modes}")
    for one in seen["findings"]:
        wheels = ("wheel " if len(one["wheels"]) == 1 else "wheels ") + str(one["wheels"])[1:-1]
        out.append(f"{one['reason']} from {one['first_s']:.3f} s on {wheels}")
    if seen["left_out"]:
        out.append(f"left out: {', '.join(seen['left_out'])}")
    return out


def _listed(shares: Mapping[str, float]) -> str:
    return ", ".join(
        f"{name} {PERCENT * s:.0f} %" for name, s in shares.items() if s >= _LEAST_SHARE
    )
