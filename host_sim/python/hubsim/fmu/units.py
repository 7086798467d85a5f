"""Units as the standard wants them: powers of SI base units, with factor and offset."""

import math

from hubsim.errors import HubsimError

_JOULE: dict[str, float] = {"kg": 1, "m": 2, "s": -2}
_WATT: dict[str, float] = {"kg": 1, "m": 2, "s": -3}
_VOLT: dict[str, float] = {"kg": 1, "m": 2, "s": -3, "A": -1}
_OHM: dict[str, float] = {"kg": 1, "m": 2, "s": -3, "A": -2}

# Unit, powers of base units (with "factor" and "offset": value in SI = factor * value + offset).
UNITS: dict[str, dict[str, float]] = {
    "s": {"s": 1},
    "m": {"m": 1},
    "m2": {"m": 2},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "kg": {"kg": 1},
    "kg.m2": {"kg": 1, "m": 2},
    "kg/m3": {"kg": 1, "m": -3},
    "Hz": {"s": -1},
    "1/s": {"s": -1},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "turn": {"rad": 1, "factor": 2.0 * math.pi},
    "deg": {"rad": 1, "factor": math.pi / 180.0},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    "N.m": _JOULE,
    "N.m.s": {"kg": 1, "m": 2, "s": -1},
    "N.m/s": _WATT,
    "N.m/K": _JOULE | {"K": -1},
    "J": _JOULE,
    "J/A": _JOULE | {"A": -1},
    "J/K": _JOULE | {"K": -1},
    "W": _WATT,
    "W/K": _WATT | {"K": -1},
    "K": {"K": 1},
    "K/W": {"kg": -1, "m": -2, "s": 3, "K": 1},
    "1/K": {"K": -1},
    "1/A": {"A": -1},
    "degC": {"K": 1, "offset": 273.15},
    "A": {"A": 1},
    "A/s": {"A": 1, "s": -1},
    "A.h": {"A": 1, "s": 1, "factor": 3600.0},
    "V": _VOLT,
    "V/K": _VOLT | {"K": -1},
    "V/s": _VOLT | {"s": -4},
    "ohm": _OHM,
    "ohm.s": _OHM | {"s": -2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "F": {"kg": -1, "m": -2, "s": 4, "A": 2},
    "Wb": {"kg": 1, "m": 2, "s": -2, "A": -1},
}


def known(unit: str) -> str:
    """Return a unit of the engine's lists as the standard spells it: "" for a share, a code or a flag."""
    spelt = unit.replace(" ", ".")
    if spelt in {"", "1"}:
        return ""
    if spelt not in UNITS:
        raise HubsimError(f"unit {unit!r}: not among the units of model descriptions, accepted: {', '.join(UNITS)}")
    return spelt
