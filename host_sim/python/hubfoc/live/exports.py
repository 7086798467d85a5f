# SPDX-License-Identifier: Apache-2.0
"""Curves as files that other programs read."""

import importlib
import io
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy.typing as npt

from hubfoc.errors import HubfocError
from hubfoc.live.viewers import NS, grouped, schema

FORMATS = ("parquet", "mcap")
TIME = "time_s"

Columns = Mapping[str, npt.NDArray[Any]]
Meanings = Mapping[str, Sequence[str]]


def content(kind: str, columns: Columns, meanings: Meanings) -> bytes:
    """Return a file of columns, the first of which is ``time_s``; with their units and texts."""
    if kind not in FORMATS:
        raise HubfocError(f"{kind!r}: accepted: {', '.join(FORMATS)}")
    return (_parquet if kind == "parquet" else _mcap)(columns, meanings)


def _parquet(columns: Columns, meanings: Meanings) -> bytes:
    try:
        import pyarrow as pa  # noqa: PLC0415
        import pyarrow.parquet as pq  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise HubfocError("Parquet needs pyarrow: pip install 'hubfoc[formats]'") from error
    arrays = [pa.array(column) for column in columns.values()]
    fields = []
    for name, array in zip(columns, arrays, strict=True):
        unit, text = meanings.get(name, ("s", "time") if name == TIME else ("", ""))
        fields.append(pa.field(name, array.type, metadata={"unit": unit, "text": text}))
    out = io.BytesIO()
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), out)
    return out.getvalue()


def _mcap(columns: Columns, meanings: Meanings) -> bytes:
    """Topics and fields are those of ``viewers.Foxglove``; the last row is of now, on the clock."""
    try:
        foxglove = importlib.import_module("foxglove")
    except ModuleNotFoundError as error:
        raise HubfocError("MCAP needs foxglove-sdk: pip install 'hubfoc[live]'") from error
    times_s = columns[TIME].tolist()
    begin_ns = time.time_ns() - round(NS * (times_s[-1] if times_s else 0.0))
    out, context = io.BytesIO(), foxglove.Context()
    known = {name: (str(unit), str(text)) for name, (unit, text) in meanings.items()}
    with foxglove.open_mcap(out, context=context):
        for group, members in grouped(name for name in columns if name != TIME).items():
            described = schema([TIME, *members], {TIME: ("s", "of the simulation"), **known})
            channel = foxglove.Channel(
                f"/{group}", message_encoding="json", context=context, schema=described
            )
            fields = [TIME, *(name.partition(".")[2] or name for name in members)]
            rows = zip(times_s, *(columns[name].tolist() for name in members), strict=True)
            for row in rows:
                message = dict(zip(fields, row, strict=True))
                channel.log(message, log_time=begin_ns + round(NS * row[0]))
    return out.getvalue()
