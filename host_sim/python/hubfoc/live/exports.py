# SPDX-License-Identifier: Apache-2.0
"""Curves as files that other programs read."""

import io
from collections.abc import Mapping
from typing import Any

import numpy.typing as npt

from hubfoc.errors import HubfocError

FORMATS = ("parquet",)


def content(kind: str, columns: Mapping[str, npt.NDArray[Any]]) -> bytes:
    """Return a file of columns, the first of which is ``time_s``."""
    if kind not in FORMATS:
        raise HubfocError(f"{kind!r}: accepted: {', '.join(FORMATS)}")
    try:
        import pyarrow as pa  # noqa: PLC0415
        import pyarrow.parquet as pq  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise HubfocError("Parquet needs pyarrow: pip install 'hubfoc[formats]'") from error
    out = io.BytesIO()
    pq.write_table(pa.table(dict(columns)), out)
    return out.getvalue()
