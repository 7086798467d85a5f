"""Recorded signals as files: CSV, Parquet and MDF4, and the layout with which PlotJuggler shows them.

Columns are the engine's names, which end in the unit; Parquet and MDF4 carry unit and meaning of every column besides.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TextIO

import numpy as np

from hubsim import files, layout
from hubsim.errors import HubsimError
from hubsim.results import RunResult

TIME = "time_s"


@dataclass(frozen=True)
class Kind:
    """A kind of file that a run can leave."""

    name: str
    help: str
    write: Callable[[RunResult, Path], None]


def write_csv(result: RunResult, path: Path) -> None:
    """Write the recorded signals, one column each, headings with units, nine digits."""

    def fill(file: TextIO) -> None:
        np.savetxt(file, result.rows, fmt="%.9g", delimiter=",", header=",".join(result.names), comments="")

    files.write_with(path, fill)


def write_parquet(result: RunResult, path: Path) -> None:
    """Write the recorded signals as an Arrow table of doubles; field metadata: ``unit`` and ``text``."""
    import pyarrow as pa  # noqa: PLC0415, a big library that only this needs
    import pyarrow.parquet as pq  # noqa: PLC0415

    fields = []
    for name in result.names:
        unit, text = result.meanings.get(name, ("", ""))
        fields.append(pa.field(name, pa.float64(), nullable=False, metadata={"unit": unit, "text": text}))
    about = {"scenario": result.cycle, "strategy": result.strategy, "config": result.vehicle}
    table = pa.table([pa.array(result.signal(name)) for name in result.names], schema=pa.schema(fields, metadata=about))
    files.write_by_name(path, lambda temporary: pq.write_table(table, temporary, compression="zstd"))


def write_mdf(result: RunResult, path: Path) -> None:
    """Write the recorded signals as an ASAM MDF 4.10 measurement, a channel each with its unit, on one time axis."""
    if TIME not in result.names:
        raise HubsimError(f"--mdf {path}: the signals do not include {TIME}, accepted: --signals with {TIME} or *")
    from asammdf import MDF, Signal  # noqa: PLC0415, a big library that only this needs

    time_s = result.signal(TIME)
    signals = []
    for name in result.names:
        if name != TIME:
            unit, text = result.meanings.get(name, ("", ""))
            signals.append(Signal(samples=result.signal(name), timestamps=time_s, name=name, unit=unit, comment=text))
    with MDF(version="4.10") as file:
        file.start_time = datetime(2000, 1, 1, tzinfo=UTC)  # a simulated ride has no date; the same run gives the same file
        file.append(signals, comment=f"hubsim: {result.cycle}, {result.strategy}, {result.vehicle}", common_timebase=True)
        files.write_by_name(path, lambda temporary: file.save(temporary, overwrite=True), suffix=".mf4")


def write_layout(result: RunResult, path: Path) -> None:
    """Write a PlotJuggler layout for the recorded signals."""
    files.write_text(path, layout.layout(result.names))


KINDS = {
    kind.name: kind
    for kind in (
        Kind("csv", "write the recorded signals as text", write_csv),
        Kind("parquet", "write the recorded signals as a Parquet table with units", write_parquet),
        Kind("mdf", "write the recorded signals as an ASAM MDF4 measurement with units", write_mdf),
        Kind("layout", "write a PlotJuggler layout for the recorded signals", write_layout),
    )
}
