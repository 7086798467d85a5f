# SPDX-License-Identifier: Apache-2.0
"""The firmware's reasons by their identifiers, read from core/reason.h."""

import re
from functools import cache

from regen_table.suggest import suggestion

from hubsim.engine import ROOT

HEADER = ROOT / "firmware" / "core" / "include" / "core" / "reason.h"
WAITS_FOR = HEADER.with_name("waits_for.h")
ANY_FAULT = "ANY_FAULT"


@cache
def codes() -> dict[str, int]:
    """Return identifier to code, without the prefix REASON_."""
    text = HEADER.read_text(encoding="utf-8")
    return {
        name: int(number)
        for number, name in re.findall(r"^\s*X\((\d+), (\w+),", text, flags=re.MULTILINE)
    }


@cache
def limits() -> frozenset[str]:
    """Return the identifiers of what bounds a healthy controller."""
    text = HEADER.read_text(encoding="utf-8")
    listed = text.partition("#define LIMIT_LIST")[2].partition("#define")[0]
    return frozenset(re.findall(r"^\s*X\(\d+, (\w+),", listed, flags=re.MULTILINE))


@cache
def first_fault() -> int:
    """Return the code from which on reasons are faults."""
    found = re.search(r"REASON_FIRST_FAULT = (\d+)", HEADER.read_text(encoding="utf-8"))
    assert found is not None
    return int(found[1])


def identifier(code: float) -> str:
    """Return the identifier of a code."""
    return next(
        (name for name, number in codes().items() if number == int(code)), f"unknown {int(code)}"
    )


@cache
def waits_for(code: int) -> str:
    """Return what driving torque waits for, in words; empty for nothing."""
    text = WAITS_FOR.read_text(encoding="utf-8")
    found = re.search(rf'^\s*X\({code}, \w+, "(.*)"\)', text, flags=re.MULTILINE)
    return (found[1] if found else f"unknown {code}") if code else ""


def shown(code: float) -> str:
    """Return the identifier of a code, empty for 0."""
    return identifier(code) if code else ""


def meant(name: str) -> frozenset[int]:
    """Return the codes that a name in a criterion stands for.

    ValueError lists the accepted values.
    """
    if name == ANY_FAULT:
        return frozenset(code for code in codes().values() if code >= first_fault())
    if name in codes():
        return frozenset({codes()[name]})
    raise ValueError(f"no reason {name!r}, {suggestion(name, [ANY_FAULT, *codes()])}")
