# SPDX-License-Identifier: Apache-2.0
"""Numbers as a reader wants them.

A real minus sign, a dash for what is not known, as many digits as mean something.
"""

import math
import re

UNKNOWN = "–"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def fixed(value: float, decimals: int) -> str:
    """Return a number with fixed decimals; never a negative zero."""
    if not math.isfinite(value):
        return UNKNOWN
    text = f"{value:.{decimals}f}"
    if not text.strip("-0."):
        text = text.lstrip("-")
    return text.replace("-", "−")


def significant(value: float, digits: int = 3) -> str:
    """Return a number rounded to so many digits, without an exponent."""
    if not math.isfinite(value):
        return UNKNOWN
    if value == 0.0:
        return "0"
    decimals = digits - 1 - math.floor(math.log10(abs(value)))
    return fixed(round(value, decimals), max(decimals, 0))


def figure(value: float) -> str:
    """Return a number with four digits, as a power of ten where zeros would pile up."""
    if not math.isfinite(value) or value == 0.0 or 1e-3 <= abs(value) < 1e6:
        return f"{value:.4g}".replace("-", "−") if math.isfinite(value) else UNKNOWN
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa.replace('-', '−')} · 10{str(int(exponent)).translate(_SUPERSCRIPT)}"


def unit(text: str) -> str:
    """Return a unit of the engine's lists or of a scenario as it is printed."""
    if text == "1":
        return ""
    spelt = text.replace("N m", "N·m").replace("N.m", "N·m")
    return re.sub(r"(?<=[a-z])([23])\b", lambda found: "²³"[int(found[1]) - 2], spelt)


def kilojoules(energy_j: float) -> str:
    """Return an energy as a label of a figure, e.g.

    ``15.0 kJ``; what would be two zeros is in joules.
    """
    if not math.isfinite(energy_j):
        return UNKNOWN
    if abs(energy_j) < 10.0:
        return f"{fixed(energy_j, 0)} J"
    energy_kj = energy_j / 1e3
    decimals = 0 if abs(energy_kj) >= 100.0 else 1 if abs(energy_kj) >= 10.0 else 2
    return f"{fixed(energy_kj, decimals)} kJ"


def percent(share: float, decimals: int = 1) -> str:
    """Return a share as per cent."""
    return f"{fixed(100.0 * share, decimals)} %" if math.isfinite(share) else UNKNOWN


def small_percent(share: float) -> str:
    """Return a very small share as per cent, with a power of ten where zeros would pile up."""
    if not math.isfinite(share):
        return UNKNOWN
    per_cent = 100.0 * share
    if per_cent == 0.0 or abs(per_cent) >= 1e-3:
        return f"{significant(per_cent, 2)} %"
    mantissa, exponent = f"{per_cent:.1e}".split("e")
    return f"{mantissa.replace('-', '−')} · 10{str(int(exponent)).translate(_SUPERSCRIPT)} %"
