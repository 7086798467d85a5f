# SPDX-License-Identifier: Apache-2.0
"""The report: one HTML page that opens anywhere, with the energies and traces of runs.

The page needs nothing but itself: styles, pictures and the small script for reading values are
inside. Pictures are SVG made here, in colours that follow the page's light or dark scheme.
"""

from collections.abc import Sequence
from pathlib import Path

from hubsim import files
from hubsim.errors import HubsimError
from hubsim.report import page
from hubsim.report.reading import SIGNALS, CurveLike, Extras, RunLike

__all__ = ["SIGNALS", "CurveLike", "Extras", "RunLike", "write_page", "write_report"]

NAME = "index.html"


def write_report(runs: Sequence[RunLike], directory: Path, extras: Extras | None = None) -> None:
    """Write ``index.html`` into a directory, which is made if necessary.

    Raises
    ------
    HubsimError
        Without any run, or when the file cannot be written; nothing half-written remains.
    """
    files.make_directory(directory)
    write_page(runs, directory / NAME, extras)


def write_page(runs: Sequence[RunLike], path: Path, extras: Extras | None = None) -> None:
    """Write the page into a file; otherwise as ``write_report``."""
    if not runs:
        raise HubsimError("report: no runs, accepted: at least one")
    files.write_text(path, page.document(runs, extras))
