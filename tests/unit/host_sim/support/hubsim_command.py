# SPDX-License-Identifier: Apache-2.0
"""The command ``hubsim`` called inside the test's own process.

Its imports take several times as long as a short simulation, so most calls share those of the test.
Calls as processes of their own: `test_cli.py` (imports), `test_files.py` (closed output),
`test_readme.py`, `test_sweep.py` (signals) and the tests of the package.
"""

import contextlib
import io
import subprocess
import warnings
from collections.abc import Callable
from pathlib import Path
from unittest import mock

from hubsim import cli, progress

LONGER_S = 1e6
Hubsim = Callable[..., subprocess.CompletedProcess[str]]


def hubsim_in(folder: Path) -> Hubsim:
    """Return a function that calls the command in a directory, as `subprocess.run` answers.

    What a process would print as a warning or a traceback is raised.
    """

    def call(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
        words = [*map(str, arguments)]
        out, error = io.StringIO(), io.StringIO()
        with (
            contextlib.chdir(folder),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(error),
            warnings.catch_warnings(),
            # How long a run takes is the machine's: its lines about that are no message.
            mock.patch.object(progress, "FIRST_S", LONGER_S),
        ):
            warnings.simplefilter("error")
            for hidden in (DeprecationWarning, PendingDeprecationWarning, ImportWarning,
                           ResourceWarning):  # fmt: skip
                warnings.simplefilter("ignore", hidden)
            try:
                status = cli.main(words)
            except SystemExit as end:
                assert end.code is None or isinstance(end.code, int), end.code
                status = end.code or 0
        return subprocess.CompletedProcess(words, status, out.getvalue(), error.getvalue())

    return call
