# SPDX-License-Identifier: Apache-2.0
"""A page with many curves, and what it takes of the machine."""

import os
import time
from pathlib import Path

from diagrams.chromium import Browser


def choose(browser: Browser, curves: int) -> None:
    """Wait for the page, and have it draw so many curves."""
    browser.until("globalThis.hubfoc?.last.rows != null")
    browser.evaluate(
        "[...document.querySelectorAll('#signals option')].slice(0, 100).forEach((option) => {"
        f" if (document.querySelectorAll('#legend li').length >= {curves}) return;"
        " document.querySelector('#signal').value = option.value;"
        " document.querySelector('#add').click(); })"
    )
    browser.until(f"hubfoc.last.rows?.curves === {curves}")


def tree(pid: int) -> list[int]:
    """Return a process with those that it has begun."""
    parents: dict[int, int] = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdecimal():
            try:
                stat = (folder / "stat").read_text(encoding="utf-8")
            except OSError:
                continue
            parents[int(folder.name)] = int(stat.rpartition(")")[2].split()[1])
    found = [pid]
    for one in found:
        found += [child for child, parent in parents.items() if parent == one]
    return found


def _cpu_s(pids: list[int]) -> float:
    ticks = 0
    for pid in pids:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        ticks += int(stat[11]) + int(stat[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def share(browser: Browser, seconds: float) -> float:
    """Return what the browser takes of a core in this time."""
    pids = tree(browser.pid)
    before_s = _cpu_s(pids)
    time.sleep(seconds)
    return (_cpu_s(pids) - before_s) / seconds


def resident_mb(pids: list[int]) -> float:
    """Return the memory of processes, in megabytes."""
    pages = 0
    for pid in pids:
        pages += int(Path(f"/proc/{pid}/statm").read_text(encoding="utf-8").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6
