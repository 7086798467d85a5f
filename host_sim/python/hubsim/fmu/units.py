# SPDX-License-Identifier: Apache-2.0
"""Units as the standard wants them: powers of SI base units, with factor and offset.

A unit is written as in the engine's lists: names with powers, multiplied with a dot or a blank,
divided with a slash; every slash divides by what follows up to the next one.
"""

import math
import re

from hubsim.errors import HubsimError

_BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_DERIVED: dict[str, dict[str, float]] = {
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "F": {"kg": -1, "m": -2, "s": 4, "A": 2},
    "Wb": {"kg": 1, "m": 2, "s": -2, "A": -1},
    "turn": {"rad": 1, "factor": 2.0 * math.pi},
    "deg": {"rad": 1, "factor": math.pi / 180.0},
    "h": {"s": 1, "factor": 3600.0},
    "min": {"s": 1, "factor": 60.0},
}
_DEGREE = {"degC": {"K": 1.0, "offset": 273.15}}  # of a temperature, never part of another unit
_TOKEN = re.compile(r"([A-Za-z]+)(\d*)")


def known(unit: str) -> str:
    """Return a unit of the engine's lists as the standard spells it.

    "" for a share, a code or a flag.
    """
    spelt = unit.replace(" ", ".")
    if spelt in {"", "1"}:
        return ""
    base_powers(spelt)
    return spelt


def base_powers(unit: str) -> dict[str, float]:
    """Return the powers of base units, with ``factor`` and ``offset``.

    Value in SI = factor * value + offset.
    """
    if unit in _DEGREE:
        return _DEGREE[unit]
    above, *below = unit.split("/")
    found: dict[str, float] = {}
    parts = [(above, 1)] + [(part, -1) for part in below]
    for part, sign in parts:
        for name in part.split("."):
            if name != "1":
                _multiply(found, name, sign, unit)
    return {
        key: power for key, power in found.items() if power != (1.0 if key == "factor" else 0.0)
    }


def _multiply(found: dict[str, float], name: str, sign: int, unit: str) -> None:
    token = _TOKEN.fullmatch(name)
    if token is None or (token[1] not in _DERIVED and token[1] not in _BASE):
        raise HubsimError(
            f"unit {unit!r}: {name!r} is no unit of model descriptions, accepted: "
            f"{', '.join([*_BASE, *_DERIVED, *_DEGREE])}"
        )
    power = sign * int(token[2] or "1")
    for key, value in _DERIVED.get(token[1], {token[1]: 1.0}).items():
        if key == "factor":
            found["factor"] = found.get("factor", 1.0) * value**power
        else:
            found[key] = found.get(key, 0.0) + power * value
