# SPDX-License-Identifier: Apache-2.0
"""DAQ lists and recordings of the scope: what is asked of a wheel, and what its bytes mean.

``firmware/comms/include/comms/daq.h`` and ``scope.h``; raw values.
"""

import csv
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from hubsim import reasons

from hubfoc.addresses import Signal
from hubfoc.errors import HubfocError

EVERY_MOST = 255
ENTRIES = 8  # of an ODT
TIME_BYTES = 2
TICK_S = 1e-5
COMPLETE = 3  # phase of the scope
LOOK_S = 0.01  # between two looks at it
KINDS = ("none", "above", "below", "rises", "falls", "finding")
SUFFIXES = (".csv", ".parquet")
_ODTS = (8, 1)  # of the slow list and of the fast one, whose first is numbered behind the others
_CAN_BYTES = 8
_OVERLOAD = 0x80


@dataclass(frozen=True)
class Plan:
    """Which signal is in which ODT of a list."""

    number: int
    odts: tuple[tuple[Signal, ...], ...]
    least: int
    """Steps between two samples that the line carries."""

    @property
    def list_number(self) -> bytes:
        """Return it as commands have it."""
        return self.number.to_bytes(2, "little")


@dataclass(frozen=True)
class Sample:
    """Raw values of one step; ``lost``: some before it did not come."""

    time_s: float
    values: dict[str, int]
    lost: bool


@dataclass(frozen=True)
class Trigger:
    """What the scope waits for: an index into ``KINDS``, a signal, a raw level."""

    kind: int = 0
    signal: str | None = None
    level: int = 0

    @classmethod
    def of(cls, text: str) -> "Trigger":
        """Return that of a command line: ``rises:SIGNAL:VALUE``, ``finding:REASON``."""
        kind, *rest = text.split(":")
        try:
            if kind == "none" and not rest:
                return cls()
            if kind == "finding" and len(rest) <= 1:
                return cls(KINDS.index(kind), level=reasons.codes()[rest[0]] if rest else 0)
            if kind in KINDS[1:5]:
                signal, level = rest
                return cls(KINDS.index(kind), signal, int(level))
        except (KeyError, ValueError):
            pass
        raise HubfocError(f"{text!r}: accepted: none, above|below|rises|falls:SIGNAL:VALUE with a"
                          " raw value, finding, finding:REASON")  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """Rows of the scope: raw values by name; time 0 is that of the trigger's row."""

    time_s: np.ndarray
    values: dict[str, np.ndarray]

    def write(self, path: Path) -> None:
        """Write a CSV or Parquet file."""
        columns = {"time_s": self.time_s, **self.values}
        if path.suffix == ".csv":
            with path.open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(columns)
                lists = [column.tolist() for column in columns.values()]
                writer.writerows(zip(*lists, strict=True))
            return
        try:
            import pyarrow as pa  # noqa: PLC0415
            import pyarrow.parquet as pq  # noqa: PLC0415
        except ModuleNotFoundError as error:
            raise HubfocError(f"{path}: needs pyarrow: pip install 'hubfoc[formats]'") from error
        pq.write_table(pa.table(columns), path)


def plan(signals: Sequence[Signal], packet_bytes: int, *, fast: bool) -> Plan:
    """Put signals into the ODTs of a list, each into the first that has space."""
    number = int(fast)
    odts: list[list[Signal]] = [[] for _ in range(_ODTS[number])]
    for signal in signals:
        for k, odt in enumerate(odts):
            head = 1 + (TIME_BYTES if k == 0 else 0)
            used = head + sum(other.least_bytes for other in odt)
            if len(odt) < ENTRIES and used + signal.least_bytes <= packet_bytes:
                odt.append(signal)
                break
        else:
            raise HubfocError(f"{len(signals)} signals, accepted: those of {len(odts)} packets"
                              f" of {packet_bytes} bytes")  # fmt: skip
    if not signals:
        raise HubfocError("no signal: accepted: at least one")
    while len(odts) > 1 and not odts[-1]:
        odts.pop()
    return Plan(number, tuple(map(tuple, odts)), len(odts) if packet_bytes == _CAN_BYTES else 1)


def samples(plan: Plan, next_packet: Callable[[], bytes]) -> Iterator[Sample]:
    """Yield the samples that a list's packets make; what is incomplete is left out."""
    first = sum(_ODTS[: plan.number])
    ticks, wanted, lost = None, 0, False
    last_ticks = 0
    values: dict[str, int] = {}
    while True:
        packet = next_packet()
        lost = lost or bool(packet[0] & _OVERLOAD)
        odt, at = (packet[0] & ~_OVERLOAD) - first, 1
        if not 0 <= odt < len(plan.odts):
            continue
        if odt == 0:
            now = int.from_bytes(packet[1 : 1 + TIME_BYTES], "little")
            ticks = 0 if ticks is None else ticks + (now - last_ticks) % 0x10000
            last_ticks, at, wanted, values = now, 1 + TIME_BYTES, 0, {}
        if odt != wanted or ticks is None:
            continue
        for signal in plan.odts[odt]:
            signed = signal.variable.lowest_raw < 0
            part = packet[at : at + signal.least_bytes]
            values[signal.name] = int.from_bytes(part, "little", signed=signed)
            at += signal.least_bytes
        wanted += 1
        if wanted == len(plan.odts):
            yield Sample(ticks * TICK_S, values, lost)
            lost = False


def recording(
    signals: Sequence[Signal], state: Mapping[str, int], data: bytes, before: int, row_s: float
) -> Recording:
    """Return a record in the order of time."""
    count = state["record_rows"]
    table = np.frombuffer(data, np.uint8).reshape(count, state["row_bytes"])
    table = np.roll(table, -state["first_row"], axis=0)
    values, at = {}, 0
    for k, signal in enumerate(signals):
        size = (state["row_layout"] >> 4 * k) & 0xF
        kind = f"<{'i' if signal.variable.lowest_raw < 0 else 'u'}{size}"
        column = np.ascontiguousarray(table[:, at : at + size]).view(kind)
        values[signal.name] = column[:, 0].astype(np.int64)
        at += size
    return Recording((np.arange(count) - before) * row_s, values)
