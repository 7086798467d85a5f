# SPDX-License-Identifier: Apache-2.0
"""Stored hashes: the file, and what differs from it."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Self

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "tests" / "oracle" / "d6b76bd7.json"
FORMAT = 1
KINDS = ("fast", "slow", "events", "bytes")


class OracleError(Exception):
    """What keeps the oracle from an answer, in one line."""


@dataclass(frozen=True)
class Hashes:
    """Of one entry, hexadecimal; empty where there is none of this kind.

    Attributes
    ----------
    fast, slow : str
        Of every fast step's output and report; of every slow step's setpoint, output and limits.
    events : str
        Of every change of a mode or reason: when, which, to what number.
    bytes : str
        Of what leaves the board.
    fast_steps, slow_steps : int
        How many were hashed.
    """

    fast: str
    slow: str
    events: str
    bytes: str
    fast_steps: int
    slow_steps: int

    @classmethod
    def of(
        cls, fast: int, slow: int, events: int, given: int, fast_steps: int, slow_steps: int
    ) -> Self:
        """Return the hashes of these numbers; ``given`` is 0 where no bytes were hashed."""
        return cls(
            f"{fast:016x}" if fast_steps else "",
            f"{slow:016x}",
            f"{events:016x}",
            f"{given:016x}" if given else "",
            fast_steps,
            slow_steps,
        )

    def differs(self, other: "Hashes") -> list[str]:
        """Return which kinds differ; "steps" where a run is shorter or longer."""
        found = [kind for kind in KINDS if getattr(self, kind) != getattr(other, kind)]
        mine, others = (self.fast_steps, self.slow_steps), (other.fast_steps, other.slow_steps)
        return found if mine == others else ["steps", *found]


@dataclass
class Results:
    """Hashes of several parts, and the names of the values in the order in which they count."""

    values: list[str]
    parts: dict[str, dict[str, Hashes]] = field(default_factory=dict)

    def add(self, part: str, entries: Mapping[str, Hashes]) -> None:
        """Take the entries of a part, or more of them."""
        self.parts.setdefault(part, {}).update(entries)

    def write(self, path: Path) -> None:
        """Write the file, one line an entry."""
        lines = [f'{{"format": {FORMAT},', '"values": ' + _wrapped(self.values) + ",", '"parts": {']
        for number, (part, entries) in enumerate(self.parts.items()):
            rows = (
                f"{json.dumps(name)}: {json.dumps(_brief(one))}" for name, one in entries.items()
            )
            lines.append(f'"{part}": {{\n' + ",\n".join(rows) + "\n}")
            lines[-1] += "," if number + 1 < len(self.parts) else "\n}}"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a file that ``write`` wrote."""
        try:
            data = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise OracleError(f"{path}: cannot be read: {error.strerror}") from error
        except ValueError as error:
            raise OracleError(f"{path}: not a file of hashes: {error}") from error
        if not isinstance(data, dict) or data.get("format") != FORMAT:
            raise OracleError(f"{path}: not a file of hashes of format {FORMAT}")
        parts = {
            part: {name: Hashes(**(_ABSENT | one)) for name, one in entries.items()}
            for part, entries in data["parts"].items()
        }
        return cls(data["values"], parts)


_ABSENT = {"fast": "", "slow": "", "events": "", "bytes": "", "fast_steps": 0, "slow_steps": 0}


def _part(name: str, entries: Mapping[str, Hashes]) -> str:
    rows = [f"{json.dumps(entry)}: {json.dumps(_brief(one))}" for entry, one in entries.items()]
    return f'"{name}": {{\n' + ",\n".join(rows) + "\n}"


def _brief(hashes: Hashes) -> dict[str, object]:
    return {key: value for key, value in asdict(hashes).items() if value}


def _wrapped(names: Sequence[str]) -> str:
    lines, line = [], ""
    for name in names:
        quoted = f'"{name}"'
        if line and len(line) + len(quoted) > 96:
            lines.append(line.rstrip())
            line = ""
        line += quoted + ", "
    return "[\n" + "\n".join([*lines, line.rstrip(", ")]) + "\n]"


def compared(stored: Results, found: Results, complete: bool) -> tuple[list[str], bool]:
    """Compare with stored hashes: lines for people, and whether all are equal.

    ``complete``: of every part that was computed all stored entries count, otherwise only those
    that were computed.
    """
    lines = []
    equal = stored.values == found.values
    if not equal:
        lines.append(f"accessors.h: {_first_difference(stored.values, found.values)}")
    for part, computed in found.parts.items():
        entries = stored.parts.get(part, {})
        kinds = {
            name: hashes.differs(computed[name]) if name in computed else ["missing"]
            for name, hashes in entries.items()
            if complete or name in computed
        }
        wrong = {name: several for name, several in kinds.items() if several}
        if wrong:
            first, several = next(iter(wrong.items()))
            all_kinds = sorted({kind for one in wrong.values() for kind in one})
            lines.append(
                f"{part}: DIFFERS in {', '.join(all_kinds)}: {len(wrong)} of {len(kinds)} entries,"
                f" the first is {first!r} ({', '.join(several)})"
            )
        else:
            lines.append(f"{part}: {len(kinds)} entries equal")
        if new := [name for name in computed if name not in entries]:
            lines.append(f"{part}: {len(new)} entries not stored, the first is {new[0]!r}")
        equal = equal and bool(kinds) and not wrong
    return lines, equal


def _first_difference(stored: Sequence[str], found: Sequence[str]) -> str:
    for place, (old, new) in enumerate(zip(stored, found, strict=False)):
        if old != new:
            return f"value {place} is {new}, in the stored hashes {old}"
    return f"{len(found)} values, in the stored hashes {len(stored)}"
