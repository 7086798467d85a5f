# SPDX-License-Identifier: Apache-2.0
"""Recorded signals as files.

CSV, Parquet and MDF4, and the layout with which PlotJuggler shows them.

Columns are the engine's names, which end in the unit; Parquet and MDF4 carry unit and meaning of
every column besides.
"""

import itertools
import json
import os
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from functools import partial
from html import escape
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from regen_table import __version__

from hubsim import engine, files, reasons
from hubsim.errors import HubsimError
from hubsim.run.results import RunResult

TIME = "time_s"
# Signals that are codes or flags besides those that end in "reason".
_CODES = (
    *("at_work", "bridge", "collapsed", "contactor", "direction", "failed", "hydraulic_valid"),
    *("mode", "stop_lamp", "valve", "waits_for"),
)
_text = partial(escape, quote=False)
NO_DATE = datetime(2000, 1, 1, tzinfo=UTC)  # of a result without an origin
_MADE = (
    "<FHcomment><TX>{about}</TX><tool_id>hubsim</tool_id><tool_vendor>hubfoc</tool_vendor>"
    f"<tool_version>{__version__}</tool_version></FHcomment>"
)


def write_csv(result: RunResult, path: Path) -> None:
    """Write the recorded signals, one column each, headings with units, nine digits."""

    def fill(file: TextIO) -> None:
        np.savetxt(
            file, result.rows, fmt="%.9g", delimiter=",", header=",".join(result.names), comments=""
        )

    files.write_with(path, fill)


def write_parquet(result: RunResult, path: Path) -> None:
    """Write the recorded signals as an Arrow table of doubles.

    Metadata of the table: ``provenance`` as JSON. Of a field: ``unit``, ``text`` and, for a code,
    ``codes`` with the text of every code as JSON.
    """
    import pyarrow as pa  # noqa: PLC0415, a big library that only this needs
    import pyarrow.parquet as pq  # noqa: PLC0415

    fields = []
    for name in result.names:
        unit, text = result.meanings.get(name, ("", ""))
        about = {"unit": unit, "text": text}
        if codes := code_texts(name):
            about["codes"] = json.dumps(codes)
        fields.append(pa.field(name, pa.float64(), nullable=False, metadata=about))
    about = {"scenario": result.cycle, "strategy": result.strategy, "config": result.vehicle}
    about |= {"provenance": json.dumps(result.origin)}
    table = pa.table(
        [pa.array(result.signal(name)) for name in result.names],
        schema=pa.schema(fields, metadata=about),
    )
    files.write_by_name(
        path, lambda temporary: pq.write_table(table, temporary, compression="zstd")
    )


def write_mdf(result: RunResult, path: Path) -> None:
    """Write the recorded signals as an ASAM MDF 4.10 measurement on one time axis.

    A channel each with its unit. Reasons and modes are codes with a conversion to their texts. The
    start time is the date of the run's origin; the header's comment holds the whole origin.
    """
    if TIME not in result.names:
        raise HubsimError(
            f"--mdf {path}: the signals do not include {TIME}, accepted: --signals with {TIME} or *"
        )
    from asammdf import MDF, Signal  # noqa: PLC0415, a big library that only this needs
    from asammdf.blocks.v4_blocks import FileHistory  # noqa: PLC0415

    time_s = result.signal(TIME)
    signals = []
    for name in result.names:
        if name != TIME:
            unit, text = result.meanings.get(name, ("", ""))
            samples, codes = result.signal(name), code_texts(name)
            if codes:
                samples = samples.astype(np.uint16)
            signals.append(
                Signal(
                    samples=samples,
                    timestamps=time_s,
                    name=name,
                    unit=unit,
                    comment=text,
                    conversion=_conversion(codes) if codes else None,
                )
            )
    begun = _date(result.origin)
    with MDF(version="4.10") as file:
        about = f"hubsim: {result.cycle}, {result.strategy}, {result.vehicle}"
        file.start_time = begun
        file.header.comment = _header(about, result)
        file.append(signals, comment=about, common_timebase=True)
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


def write_layout(result: RunResult, path: Path, csv: Path | None = None) -> None:
    """Write a PlotJuggler layout for the recorded signals.

    It loads the CSV recording if there is one.
    """
    from hubsim.run import plotjuggler  # noqa: PLC0415, only here

    recording = None if csv is None else os.path.relpath(csv.resolve(), path.resolve().parent)
    files.write_text(path, plotjuggler.layout(result.names, recording))


def write_all(result: RunResult, wanted: Mapping[str, Path]) -> None:
    """Write every recording that is wanted, by the name of its kind."""
    for name, path in wanted.items():
        if name == "layout":
            write_layout(result, path, wanted.get("csv"))
        else:
            WRITERS[name](result, path)


# Writers by the names in cli.RECORDINGS; the layout's needs the place of the CSV recording too.
WRITERS: Mapping[str, Callable[[RunResult, Path], None]] = {
    "csv": write_csv,
    "parquet": write_parquet,
    "mdf": write_mdf,
    "layout": write_layout,
}
