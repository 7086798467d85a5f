# SPDX-License-Identifier: Apache-2.0
"""Recorded signals as files.

CSV, Parquet and MDF4, and the layout with which PlotJuggler shows them. Each is written in blocks
of rows, so that a long recording needs no more memory than a short one.

Columns are the engine's names, which end in the unit; Parquet and MDF4 carry unit and meaning of
every column besides.
"""

import itertools
import json
import os
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from html import escape
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from regen_table import __version__

from hubsim import engine, files, reasons
from hubsim.engine import Rows
from hubsim.errors import HubsimError
from hubsim.run.results import RunResult

TIME = "time_s"
# Signals that are codes or flags besides those that end in "reason".
_CODES = (
    *("at_work", "bridge", "collapsed", "contactor", "direction", "failed", "hydraulic_valid"),
    *("mode", "stop_lamp", "valve", "waits_for"),
)
BLOCK_BYTES = 1 << 24  # of rows that are written at once, as doubles
# Four bytes, seven digits, are more than a converter or a sensor resolves. Eight remain for what is
# differentiated or adds up: times, speeds, angles, distances, energies, state of charge.
CODE = ""  # the unit of reasons, modes and flags
SHORT_UNITS = {"A", "V", "W", "N", "N.m", "degC", "m/s2", CODE}
_text = partial(escape, quote=False)
NO_DATE = datetime(2000, 1, 1, tzinfo=UTC)  # of a result without an origin
_MADE = (
    "<FHcomment><TX>{about}</TX><tool_id>hubsim</tool_id><tool_vendor>hubfoc</tool_vendor>"
    f"<tool_version>{__version__}</tool_version></FHcomment>"
)


def write_csv(result: RunResult, path: Path, names: Sequence[str]) -> None:
    """Write signals, one column each, headings with units, nine digits."""

    def fill(file: TextIO) -> None:
        file.write(",".join(names) + "\n")
        for rows in result.blocks(names, BLOCK_BYTES):
            np.savetxt(file, rows, fmt="%.9g", delimiter=",")

    files.write_with(path, fill)


def write_parquet(result: RunResult, path: Path, names: Sequence[str]) -> None:
    """Write signals as an Arrow table, a row group for each block.

    Numbers have eight bytes, or four where the unit is in SHORT_UNITS. Metadata of the table:
    ``provenance`` as JSON. Of a field: ``unit``, ``text`` and, for a code, ``codes`` with the text
    of every code as JSON.
    """
    import pyarrow as pa  # noqa: PLC0415, a big library that only this needs
    import pyarrow.parquet as pq  # noqa: PLC0415

    fields = []
    for name in names:
        unit, text = result.meanings.get(name, ("", ""))
        about = {"unit": unit, "text": text}
        if codes := code_texts(name):
            about["codes"] = json.dumps(codes)
        kind = pa.float32() if unit in SHORT_UNITS else pa.float64()
        fields.append(pa.field(name, kind, nullable=False, metadata=about))
    about = {"scenario": result.cycle, "strategy": result.strategy, "config": result.vehicle}
    about |= {"provenance": json.dumps(result.origin)}
    schema = pa.schema(fields, metadata=about)
    split = [name for name in names if result.meanings.get(name, ("", ""))[0] != CODE]

    def fill(temporary: Path) -> None:
        # The bytes of like rank of all numbers beside each other are alike and compress well;
        # codes are few and have a dictionary.
        with pq.ParquetWriter(
            temporary,
            schema,
            compression="zstd",
            use_dictionary=[name for name in names if name not in split],
            use_byte_stream_split=split,
        ) as file:
            for rows in result.blocks(names, BLOCK_BYTES):
                columns = [
                    pa.array(rows[:, k].astype(field.type.to_pandas_dtype()))
                    for k, field in enumerate(schema)
                ]
                file.write_table(pa.table(columns, schema=schema), row_group_size=len(rows))

    files.write_by_name(path, fill)


def write_mdf(result: RunResult, path: Path, names: Sequence[str]) -> None:
    """Write signals as an ASAM MDF 4.10 measurement on one time axis.

    A channel each with its unit. Reasons and modes are codes with a conversion to their texts. The
    start time is the date of the run's origin; the header's comment holds the whole origin.
    """
    if TIME not in names:
        raise HubsimError(
            f"--mdf {path}: the signals do not include {TIME}, accepted: --signals with {TIME} or *"
        )
    from asammdf import MDF, Signal  # noqa: PLC0415, a big library that only this needs
    from asammdf.blocks.v4_blocks import FileHistory  # noqa: PLC0415

    channels = [name for name in names if name != TIME]
    texts = [code_texts(name) for name in channels]

    def samples(rows: Rows) -> list[Rows]:
        of_channels = zip(channels, texts, strict=True)
        columns = (
            rows[:, names.index(name)].astype(_mdf_type(codes)) for name, codes in of_channels
        )
        return [np.ascontiguousarray(rows[:, names.index(TIME)]), *columns]

    def signals(rows: Rows) -> list[Signal]:
        time_s, *columns = samples(rows)
        out = []
        for name, codes, values in zip(channels, texts, columns, strict=True):
            unit, text = result.meanings.get(name, ("", ""))
            conversion = _conversion(codes) if codes else None
            out.append(Signal(values, time_s, name=name, unit=unit, comment=text,
                              conversion=conversion))  # fmt: skip
        return out

    begun = _date(result.origin)
    with MDF(version="4.10") as file:
        about = f"hubsim: {result.cycle}, {result.strategy}, {result.vehicle}"
        file.start_time = begun
        file.header.comment = _header(about, result)
        for k, rows in enumerate(result.blocks(names, BLOCK_BYTES)):
            if k == 0:
                file.append(signals(rows), comment=about, common_timebase=True)
            else:
                file.extend(0, [(values, None) for values in samples(rows)])
        made = FileHistory()  # the library's own entry has the clock's time
        made.time_stamp = begun
        made.comment = _MADE.format(about=_text(about))
        file.file_history.append(made)
        files.write_by_name(
            path,
            lambda temporary: file.save(temporary, overwrite=True, add_history_block=False),
            suffix=".mf4",
        )


def is_code(name: str) -> bool:
    """Return whether a signal is a code or a flag, of which there is no mean."""
    last = name.rpartition(".")[2]
    return last.endswith("reason") or last in _CODES


def code_name(name: str, code: float) -> str:
    """Return how a code is called: the reason's identifier, the mode, or else the number."""
    if name.endswith("reason"):
        return reasons.identifier(code)
    return code_texts(name).get(int(code), f"{code:g}")


def _mdf_type(codes: Mapping[int, str]) -> type[np.generic]:
    return np.uint16 if codes else np.float64


def code_texts(name: str) -> dict[int, str]:
    """Return the text of every code that a signal can have; empty for other signals."""
    last = name.rpartition(".")[2]
    if last == "mode":
        texts = itertools.takewhile(_is_known_mode, map(engine.mode_text, itertools.count()))
        return dict(enumerate(texts))
    if last.endswith("reason"):
        return {code: engine.reason_text(code) for code in sorted(reasons.codes().values())}
    return {}


def _is_known_mode(text: str) -> bool:
    return text != "unknown mode"


def _conversion(codes: Mapping[int, str]) -> dict[str, object]:
    """Return a value-to-text conversion as the library takes it."""
    out: dict[str, object] = {"default_addr": "unknown code"}
    for place, (code, text) in enumerate(codes.items()):
        out |= {f"val_{place}": float(code), f"text_{place}": text}
    return out


def _date(origin: Mapping[str, Any]) -> datetime:
    date = origin.get("date")
    return NO_DATE if date is None else datetime.fromisoformat(str(date))


def _header(about: str, result: RunResult) -> str:
    """Return the header's comment: what the run was, and its origin as common properties."""
    known = {"strategy": result.strategy} | result.origin
    entries = "".join(
        f'<e name="{_text(str(key))}">{_text(str(value))}</e>'
        for key, value in known.items()
        if value is not None
    )
    return (
        f"<HDcomment><TX>{_text(about)}</TX>"
        f"<common_properties>{entries}</common_properties></HDcomment>"
    )


def write_layout(path: Path, names: Sequence[str], csv: Path | None = None) -> None:
    """Write a PlotJuggler layout for signals.

    It loads the CSV recording if there is one.
    """
    from hubsim.run import plotjuggler  # noqa: PLC0415, only here

    recording = None if csv is None else os.path.relpath(csv.resolve(), path.resolve().parent)
    files.write_text(path, plotjuggler.layout(names, recording))


def write_all(result: RunResult, wanted: Mapping[str, Path], names: Sequence[str]) -> None:
    """Write these signals into every recording that is wanted, by the name of its kind."""
    for kind, path in wanted.items():
        if kind == "layout":
            write_layout(path, names, wanted.get("csv"))
        else:
            WRITERS[kind](result, path, names)


# Writers of rows by the names in cli.RECORDINGS, which has the layout besides.
WRITERS: Mapping[str, Callable[[RunResult, Path, Sequence[str]], None]] = {
    "csv": write_csv,
    "parquet": write_parquet,
    "mdf": write_mdf,
}
