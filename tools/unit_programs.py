# SPDX-License-Identifier: Apache-2.0
"""The unit test programs of the firmware's modules in a build.

The only place that knows their names: mutation testing (``mutants``) and coverage of branches and
conditions (``conditions``) build and run what is found here.
"""

import re
import subprocess
from collections.abc import Iterable
from pathlib import Path


def programs_of(modules: Iterable[str], listed: str) -> list[str]:
    """Return the unit test programs of modules, by their paths in the folder of the build.

    Parameters
    ----------
    modules : iterable of str
        Folders of ``firmware``; the tests of ``foc`` are built in ``tests/unit/firmware/foc``.
    listed : str
        What ``ninja -t targets all`` prints in that folder.
    """
    folder = rf"tests/unit/firmware/(?:{'|'.join(map(re.escape, modules))})"
    return sorted(set(re.findall(rf"(?m)^({folder}/unit_\w+): C_EXECUTABLE", listed)))


def suites_of(program: Path) -> list[str]:
    """Return the names of a program's suites, each of which it runs by itself if it is named."""
    listed = subprocess.run([str(program), "--list"], check=True, capture_output=True, text=True)
    return listed.stdout.split()
