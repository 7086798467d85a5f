# SPDX-License-Identifier: Apache-2.0
"""What a sweep has done so far, and the table it becomes.

Parts beside the output until all runs are there.

``OUTPUT.parts/`` holds ``sweep.json``, which says whose parts these are, and a Parquet file for
every finished batch. The last act joins them in the order of the runs and removes the directory.
"""

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.sweep.work import Row


def _write_parquet(table: pa.Table, path: Path) -> None:
    pq.write_table(table, path, compression="zstd")


WRITERS: Mapping[str, Callable[[pa.Table, Path], None]] = {
    ".parquet": _write_parquet,
    ".csv": pa_csv.write_csv,
}


def kind_of(output: Path) -> str:
    """Return the format of an output by its name, or refuse it."""
    if output.suffix not in WRITERS:
        raise HubsimError(f"{output}: accepted: a name that ends in {' or '.join(WRITERS)}")
    return output.suffix


class Store:
    """Where finished batches are kept."""

    def __init__(
        self,
        output: Path,
        described: Mapping[str, Any],
        fingerprint: str,
        origin: Mapping[str, Any] | None = None,
    ) -> None:
        self._origin = dict(origin or {})
        self._output = output
        self._kind = kind_of(output)
        self._directory = output.with_name(f"{output.name}.parts")
        self._described = {"fingerprint": fingerprint, **described}

    def open(self) -> set[int]:
        """Begin, or go on where an interrupted sweep ended; return the batches that are done."""
        files.check_writable(self._output)
        note = self._directory / "sweep.json"
        if note.is_file():
            found = _fingerprint(note)
            if found != self._described["fingerprint"]:
                raise HubsimError(f"{self._directory}: holds parts of another sweep, "
                                  "accepted: the same command, another --output or "
                                  "--restart")  # fmt: skip
            return {int(path.stem) for path in self._directory.glob("[0-9]*.parquet")}
        files.make_directory(self._directory)
        files.write_text(note, json.dumps(self._described, indent=2, default=str) + "\n")
        return set()

    def forget(self) -> None:
        """Throw the parts away."""
        shutil.rmtree(self._directory, ignore_errors=True)

    def put(self, batch: int, rows: Sequence[Row]) -> None:
        """Keep a finished batch; it is there completely or not at all."""
        table = pa.Table.from_pylist(
            [{"row": json.dumps(row, default=str)} for row in rows],
            schema=pa.schema([("row", pa.string())]),
        )
        files.write_by_name(
            self._directory / f"{batch:06}.parquet",
            lambda temporary: pq.write_table(table, temporary),
        )

    def rows(self) -> list[Row]:
        """Return all rows that there are, by the numbers of their runs."""
        paths = sorted(self._directory.glob("[0-9]*.parquet"))
        found = [json.loads(text) for path in paths for text in _texts(path)]
        return sorted(found, key=lambda row: int(row["run"]))

    def finish(self) -> pa.Table:
        """Write the one table and remove the parts."""
        table = as_table(self.rows()).replace_schema_metadata(
            {
                "sweep": json.dumps(self._described, default=str),
                "provenance": json.dumps(self._origin),
            }
        )
        files.write_by_name(self._output, lambda temporary: WRITERS[self._kind](table, temporary))
        self.forget()
        return table


def _texts(path: Path) -> list[str]:
    try:
        return list(pq.read_table(path)["row"].to_pylist())
    except (pa.ArrowException, KeyError, OSError, ValueError) as error:
        raise HubsimError(
            f"{path}: cannot be read: {' '.join(str(error).split())}, accepted: --restart"
        ) from error


def _fingerprint(note: Path) -> object:
    """Return whose parts a directory holds; None where its note cannot be understood."""
    try:
        stored = json.loads(files.read_text(note))
    except (ValueError, RecursionError):
        return None
    return stored.get("fingerprint") if isinstance(stored, dict) else None


def as_table(rows: Sequence[Row]) -> pa.Table:
    """Return rows as a table; a column whose values are of several kinds becomes text."""
    names: dict[str, None] = {}
    for row in rows:
        names |= dict.fromkeys(row)
    columns = {}
    for name in names:
        values = [row.get(name) for row in rows]
        kinds = {type(value) for value in values if value is not None}
        if kinds == {int, float}:
            values = [None if value is None else float(value) for value in values]
        elif len(kinds) > 1:
            values = [None if value is None else str(value) for value in values]
        columns[name] = pa.array(values, type=pa.string() if not kinds else None)
    return pa.table(columns)
