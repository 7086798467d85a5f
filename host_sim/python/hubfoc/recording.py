# SPDX-License-Identifier: Apache-2.0
"""A recording of a virtual vehicle as a table, written and read in groups of rows.

A row is a step of a wheel's controller (``step`` is ``boot``, ``fast`` or ``slow``) with its raw
inputs and outputs, or something that came into the vehicle from outside (``frame``, ``changed``,
``typed``). ``number`` counts a wheel's steps, so that a missing one is seen; ``millisecond`` is the
one in which it happened, -1 all before time 0. What a row does not have is null.
"""

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt
from hubsim import steps, variables
from hubsim.engine import STEP, Steps
from regen_table import outputs

from hubfoc.errors import HubfocError

if TYPE_CHECKING:
    import pyarrow as pa

STEP_NAMES = ("boot", "fast", "slow")
EVENT_NAMES = ("frame", "changed", "typed")
FORMATS = (".parquet", ".csv")
PROVENANCE = "provenance"
# What a boot and what comes from outside have, with their kinds of value.
_BOOT = {
    "boot.kept_temperature_cC": ("int32", "warmest of windings and switches before"),
    "boot.hold_direction": ("int32", "in which the wheel was held before"),
    "boot.hold_leaves": ("int32", "1: it had just driven off"),
    "boot.config": ("string", "config_t in hexadecimal digits, without the key of the service"),
}
_EVENT = {
    "frame.identifier": ("int32", "of CAN, 11 bits"),
    "frame.data": ("string", "in hexadecimal digits"),
    "changed.parameter": ("string", "of the simulated world"),
    "changed.value": ("float64", ""),
    "typed.text": ("string", "into the wheel's shell, in hexadecimal digits"),
}
_GROUP_ROWS = 100_000  # of a file, at least

Column = npt.NDArray[Any]


@dataclass(frozen=True)
class Event:
    """Something that came into the vehicle from outside; ``what`` is one of EVENT_NAMES."""

    millisecond: int
    what: str
    wheel: int | None = None
    identifier: int | None = None
    data: bytes | None = None
    parameter: str | None = None
    value: float | None = None


@dataclass(frozen=True)
class Part:
    """Steps of one wheel, in their order.

    ``numbers``, ``milliseconds`` and ``time_s`` are of each step; ``images`` are those of its
    boots.
    """

    wheel: int
    numbers: Column
    milliseconds: Column
    time_s: Column
    steps: Steps
    images: tuple[bytes, ...] = ()


@dataclass(frozen=True)
class Group:
    """All steps and events of some milliseconds."""

    parts: tuple[Part, ...]
    events: tuple[Event, ...]


def signal_columns(kind: int) -> list[str]:
    """Return the columns of a kind of step in the order of its values."""
    name = STEP_NAMES[kind]
    return [
        *(f"{name}_input.{raw}" for raw in steps.inputs(kind)),
        *(f"{name}_output.{raw}" for raw in steps.outputs(kind)),
    ]


def check_file(path: Path) -> Path:
    """Return the path if its ending says what kind of file it is."""
    if path.suffix not in FORMATS:
        raise HubfocError(f"{path}: accepted: a file that ends in {' or '.join(FORMATS)}")
    return path


def part_of(path: Path) -> Path:
    """Return the name of a file that is not complete."""
    return path.with_name(f".{path.name}.part")


def check_ready(path: Path) -> None:
    """Refuse a file that cannot be written, or for which a library is missing."""
    import pyarrow  # noqa: F401, PLC0415, as in schema()

    outputs.check_writable(check_file(path))


def schema(provenance: Mapping[str, Any]) -> "pa.Schema":
    """Return names, kinds, units and meanings of all columns."""
    import pyarrow as pa  # noqa: PLC0415, a big library that only this needs

    def field(name: str, kind: "pa.DataType", text: str, unit: str = "") -> "pa.Field":
        return pa.field(name, kind, metadata={"text": text, "unit": unit})

    kinds = {"int32": pa.int32(), "string": pa.string(), "float64": pa.float64()}
    fields = [
        field("step", pa.string(), f"{', '.join((*STEP_NAMES, *EVENT_NAMES))}"),
        field("wheel", pa.int8(), "0 front left, 1 front right, 2 rear left, 3 rear right"),
        field("number", pa.int64(), "of the wheel's steps"),
        field("millisecond", pa.int32(), "of the simulation, -1: before time 0"),
        field("time_s", pa.float64(), "of the simulation", "s"),
        field("reports", pa.int8(), "1: the slow loop got this fast step's report"),
    ]
    fields += [field(name, kinds[kind], text) for name, (kind, text) in _BOOT.items()]
    for kind in (steps.FAST, steps.SLOW):
        rows = [row for port in steps.PORTS[kind] for row in variables.of_port(port)]
        fields += [
            field(name, pa.int32(), row.text, f"raw of {row.unit}" if row.unit else "")
            for name, row in zip(signal_columns(kind), rows, strict=True)
        ]
    fields += [field(name, kinds[kind], text) for name, (kind, text) in _EVENT.items()]
    return pa.schema(fields, metadata={PROVENANCE: json.dumps(provenance)})


def _columns_of(part: Part) -> dict[str, tuple[Column, Column | None]]:
    """Return values of the columns of a part, and where they are null."""
    values, kinds = part.steps["values"], part.steps["kind"]
    out: dict[str, tuple[Column, Column | None]] = {
        "wheel": (np.full(len(kinds), part.wheel, np.int8), None),
        "number": (part.numbers, None),
        "millisecond": (part.milliseconds, None),
        "time_s": (part.time_s, None),
        "reports": (part.steps["reports"].astype(np.int8), kinds != steps.FAST),
    }
    for kind in (steps.FAST, steps.SLOW):
        absent = kinds != kind
        for place, name in enumerate(signal_columns(kind)):
            out[name] = (values[:, place], absent)
    booted = kinds == steps.BOOT
    for place, name in enumerate(list(_BOOT)[: len(steps.BOOT_VALUES)]):
        out[name] = (values[:, place], ~booted)
    if part.images:
        configs = np.full(len(kinds), None, dtype=object)
        configs[booted] = [image.hex() for image in part.images]
        out["boot.config"] = (configs, ~booted)
    return out


def table_of(group: Group, columns: "pa.Schema") -> "pa.Table":
    """Return a group's rows."""
    import pyarrow as pa  # noqa: PLC0415, as above

    tables = [_event_table(group.events, columns)] if group.events else []
    for part in group.parts:
        found = _columns_of(part)
        count = len(part.steps)
        arrays = []
        for field in columns:
            if field.name == "step":
                codes = pa.array(part.steps["kind"].astype(np.int8))
                arrays.append(pa.DictionaryArray.from_arrays(codes, STEP_NAMES).cast(field.type))
            elif field.name not in found:
                arrays.append(pa.nulls(count, field.type))
            else:
                values, absent = found[field.name]
                arrays.append(pa.array(np.ascontiguousarray(values), field.type, mask=absent))
        tables.append(pa.table(arrays, schema=columns))
    return pa.concat_tables(tables)


def _event_table(events: tuple[Event, ...], columns: "pa.Schema") -> "pa.Table":
    import pyarrow as pa  # noqa: PLC0415, as above

    rows = [
        {
            "step": event.what,
            "wheel": event.wheel,
            "millisecond": event.millisecond,
            "time_s": event.millisecond / 1e3,
            "frame.identifier": event.identifier,
            "frame.data": event.data.hex() if event.data and event.what == "frame" else None,
            "changed.parameter": event.parameter,
            "changed.value": event.value,
            "typed.text": event.data.hex() if event.data and event.what == "typed" else None,
        }
        for event in events
    ]
    return pa.Table.from_pylist(rows, schema=columns)


class Writer:
    """A file that takes its name when it is complete; until then it ends in ``.part``."""

    def __init__(self, path: Path, provenance: Mapping[str, Any]) -> None:
        check_ready(path)
        self.path = path
        self._part = part_of(path)
        self._columns = schema(provenance)
        self._waiting: list[pa.Table] = []
        self._rows = 0  # of those
        if path.suffix == ".csv":
            import pyarrow.csv as pc  # noqa: PLC0415, as above

            self._file: Any = self._part.open("wb")
            self._file.write(b"# " + json.dumps(provenance).encode() + b"\n")
            self._writer: Any = pc.CSVWriter(self._file, self._columns)
        else:
            import pyarrow.parquet as pq  # noqa: PLC0415, as above

            self._file = None
            self._writer = pq.ParquetWriter(self._part, self._columns, compression="zstd")

    def write(self, group: Group) -> None:
        """Add some milliseconds; several such are a group of the file."""
        table = table_of(group, self._columns)
        self._waiting.append(table)
        self._rows += len(table)
        if self._rows >= _GROUP_ROWS:
            self._flush()

    def _flush(self) -> None:
        import pyarrow as pa  # noqa: PLC0415, as above

        if self._rows > 0:
            table = pa.concat_tables(self._waiting)
            whole = {} if self._file is not None else {"row_group_size": len(table)}
            self._writer.write_table(table, **whole)
        self._waiting, self._rows = [], 0

    def close(self, *, complete: bool = True) -> None:
        """Give the file its name; without ``complete``, or after an error, there is none."""
        try:
            if complete:
                self._flush()
            self._writer.close()
            if self._file is not None:
                self._file.close()
            if complete:
                self._part.replace(self.path)
        finally:
            self._part.unlink(missing_ok=True)


class Recording:
    """A recorded vehicle, read in groups."""

    def __init__(self, path: Path) -> None:
        self.path = check_file(path)
        if not path.is_file():
            raise HubfocError(f"{path}: file not found")
        with self._readable():
            self.provenance, self._names = self._head()
        missing = [field.name for field in schema({}) if field.name not in self._names]
        if missing or not isinstance(self.provenance, dict):
            what = f"no column {missing[0]}" if missing else "no provenance"
            raise self._incomplete(what)

    def _incomplete(self, what: str) -> HubfocError:
        return HubfocError(
            f"{self.path}: not the complete inputs of a controller ({what}), accepted: a file of"
            " 'hubfoc record' of this version"
        )

    def _readable(self) -> "_Readable":
        return _Readable(self.path)

    def _head(self) -> tuple[Any, list[str]]:
        if self.path.suffix == ".csv":
            with self.path.open(encoding="utf-8") as file:
                first, second = file.readline(), file.readline()
            with suppress(ValueError):
                found = json.loads(first.removeprefix("# "))
                return found, [name.strip('"') for name in second.strip().split(",")]
            return None, first.strip().split(",")
        import pyarrow.parquet as pq  # noqa: PLC0415, as above

        found = pq.read_schema(self.path)
        stated = (found.metadata or {}).get(PROVENANCE.encode())
        return None if stated is None else json.loads(stated), found.names

    def _tables(self) -> Iterator["pa.Table"]:
        import pyarrow as pa  # noqa: PLC0415, as above

        if self.path.suffix == ".csv":
            import pyarrow.csv as pc  # noqa: PLC0415, as above

            kinds = {field.name: field.type for field in schema({})}
            rest: list[pa.Table] = []
            with pc.open_csv(
                self.path,
                read_options=pc.ReadOptions(skip_rows=1, block_size=1 << 24),
                convert_options=pc.ConvertOptions(column_types=kinds, strings_can_be_null=True),
            ) as file:
                for batch in file:
                    rest.append(pa.table(batch))
                    yield rest.pop()
            return
        import pyarrow.parquet as pq  # noqa: PLC0415, as above

        with pq.ParquetFile(self.path) as file:
            for k in range(file.num_row_groups):
                yield file.read_row_group(k)

    def groups(self) -> Iterator[Group]:
        """Return everything in its order, and refuse what is not complete."""
        expected: dict[int, int] = {}
        with self._readable():
            for table in self._tables():
                yield self._group(table, expected)
        if not expected:
            raise self._incomplete("no step")

    def _group(self, table: "pa.Table", expected: dict[int, int]) -> Group:
        import pyarrow.compute as pc  # noqa: PLC0415, as above

        names = table["step"].to_numpy()
        wheels = pc.fill_null(table["wheel"], -1).to_numpy()
        is_step = np.isin(names, STEP_NAMES)
        parts = []
        for wheel in sorted({int(k) for k in wheels[is_step]}):
            rows = table.filter((wheels == wheel) & is_step)
            part = self._part(wheel, rows)
            begin = expected.get(wheel, 0)
            count = len(part.steps)
            if not np.array_equal(part.numbers, np.arange(begin, begin + count)):
                raise self._incomplete(f"steps of wheel {wheel} are missing from {begin} on")
            if begin == 0 and part.steps["kind"][0] != steps.BOOT:
                raise self._incomplete(f"wheel {wheel} does not begin with its boot")
            expected[wheel] = begin + count
            parts.append(part)
        events = tuple(_event(row) for row in table.filter(~is_step).to_pylist())
        return Group(tuple(parts), events)

    def _part(self, wheel: int, table: "pa.Table") -> Part:
        import pyarrow.compute as pc  # noqa: PLC0415, as above

        found = np.zeros(len(table), dtype=STEP)
        names = table["step"].to_numpy()
        for kind, name in enumerate(STEP_NAMES):
            found["kind"][names == name] = kind
        found["reports"] = pc.fill_null(table["reports"], 0).to_numpy()
        for kind in (steps.FAST, steps.SLOW):
            self._take(table, found, kind, signal_columns(kind))
        self._take(table, found, steps.BOOT, list(_BOOT)[: len(steps.BOOT_VALUES)])
        texts = [text for text in table["boot.config"].to_pylist() if text is not None]
        if len(texts) != np.count_nonzero(found["kind"] == steps.BOOT):
            raise self._incomplete("a boot without configuration")
        return Part(
            wheel,
            table["number"].to_numpy(),
            table["millisecond"].to_numpy(),
            table["time_s"].to_numpy(),
            found,
            tuple(bytes.fromhex(text) for text in texts),
        )

    def _take(self, table: "pa.Table", found: Steps, kind: int, columns: list[str]) -> None:
        import pyarrow.compute as pc  # noqa: PLC0415, as above

        rows = found["kind"] == kind
        if not rows.any():
            return
        for place, name in enumerate(columns):
            values = table[name].filter(rows)
            if values.null_count:
                raise self._incomplete(f"{name} has gaps")
            found["values"][rows, place] = pc.cast(values, "int32").to_numpy()


def _event(row: Mapping[str, Any]) -> Event:
    text = row["frame.data"] or row["typed.text"]
    return Event(
        row["millisecond"], row["step"], row["wheel"], row["frame.identifier"],
        bytes.fromhex(text) if text else b"", row["changed.parameter"], row["changed.value"],
    )  # fmt: skip


class _Readable:
    """Whatever a library has to object to a file is one line."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        import pyarrow as pa  # noqa: PLC0415, as above

        if isinstance(error, pa.ArrowException | OSError | ValueError):
            line = str(error).partition("\n")[0]
            raise HubfocError(f"{self._path}: cannot be read: {line}") from error
