# SPDX-License-Identifier: Apache-2.0
"""Page and server need no more memory after an hour than after ten minutes.

HUBFOC_PAGE_MINUTES=2,6 looks after two and after six minutes instead.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from diagrams.chromium import Browser
from hubfoc.live.stream import CURVES

from tests.unit.host_sim.live import browser_load

MINUTES = [float(text) for text in os.environ.get("HUBFOC_PAGE_MINUTES", "10,60").split(",")]
MOST = 1.05
PEDAL_S = 8.0  # accelerator and brake by turns


def drive(browser: Browser, until_s: float) -> None:
    """Drive and brake."""
    while time.monotonic() < until_s:
        for pedal, other in (("accelerator", "brake"), ("brake", "accelerator")):
            browser.slide(f"#{other}", 0.0)
            browser.slide(f"#{pedal}", 0.3)
            time.sleep(PEDAL_S)


def memory_mb(browser: Browser, server: int) -> dict[str, float]:
    """Return what is in use, without what the next collection frees."""
    for _ in range(2):
        browser.call("HeapProfiler.collectGarbage")
    heap = browser.call("Runtime.getHeapUsage")["usedSize"] / 1e6
    return {
        "server": browser_load.resident_mb([server]),
        "browser": browser_load.resident_mb(browser_load.tree(browser.pid)),
        "scripts": heap,
    }


def test_memory_stays(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "hubfoc", "live", "--ready-json", "--can", "virtual"]
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as live,
        Browser(tmp_path) as browser,
    ):
        try:
            assert live.stdout is not None
            browser.size(1400, 900)
            browser.open(json.loads(live.stdout.readline())["url"])
            browser_load.choose(browser, CURVES)
            begun_s = time.monotonic()
            found = []
            for minutes in MINUTES:
                drive(browser, begun_s + 60.0 * minutes)
                found.append(memory_mb(browser, live.pid))
        finally:
            live.send_signal(signal.SIGINT)
    print(f"after {MINUTES} minutes: {found}")
    for name in found[0]:
        assert found[-1][name] <= MOST * found[0][name], found
