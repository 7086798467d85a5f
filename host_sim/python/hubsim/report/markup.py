# SPDX-License-Identifier: Apache-2.0
"""Elements of HTML and SVG, and numbers as a page writes them.

Text is escaped exactly once: a plain ``str`` is text, a ``Markup`` is an element. A number has a
real minus sign, a dash where it is not known, and as many digits as mean something.
"""

import html
import json
import math
import re

_VOID = frozenset({"meta", "link", "br", "hr", "col", "img"})


class Markup(str):
    """Text that is already HTML."""

    __slots__ = ()


Attribute = str | float | None


def number(value: float) -> str:
    """Return a coordinate with at most two decimals and no superfluous zero."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def element(tag: str, *children: str, **attributes: Attribute) -> Markup:
    """Make an element. ``class_`` is class, ``data_x`` is data-x.

    An attribute of None is left out.
    """
    written = []
    for key, value in attributes.items():
        if value is not None:
            text = value if isinstance(value, str) else number(value)
            written.append(f' {key.rstrip("_").replace("_", "-")}="{html.escape(text)}"')
    head = f"<{tag}{''.join(written)}>"
    return Markup(head if tag in _VOID else f"{head}{join(*children)}</{tag}>")


def join(*children: str) -> Markup:
    """Join children in their order."""
    return Markup(
        "".join(
            child if isinstance(child, Markup) else html.escape(child, quote=False)
            for child in children
        )
    )


def data(value: object) -> Markup:
    """Make an element that holds a value as JSON for a script.

    Nothing in it can end the element.
    """
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False).replace(
        "<", "\\u003c"
    )
    return element("script", Markup(text), type="application/json")


def picture(
    identity: str,
    title: str,
    description: str,
    width: float,
    height: float,
    *children: str,
    class_: str,
) -> Markup:
    """Make an SVG that a screen reader announces by its title and description."""
    return element(
        "svg",
        element("title", title, id=f"{identity}-title"),
        element("desc", description, id=f"{identity}-desc"),
        *children,
        class_=class_,
        role="img",
        aria_labelledby=f"{identity}-title {identity}-desc",
        viewBox=f"0 0 {number(width)} {number(height)}",
    )


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
