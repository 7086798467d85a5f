# SPDX-License-Identifier: Apache-2.0
"""How old the curves of a page are when they are on the screen, and what the page takes."""

import sys
import time
from pathlib import Path

import numpy as np
from diagrams.chromium import Browser
from hubfoc.live.command import SWITCH_S

from tests.unit.host_sim.live import browser_load
from tests.unit.host_sim.live.support import running

SECONDS = 20.0
CURVES = 4  # that a page begins with
MOST_S = 0.1
QUANTILE = 0.99
# Rows drawn, with the time of the frame after that: then they are on the screen.
LOOK = """(() => {
    globalThis.seen = [];
    let row = 0, due = null;
    const look = () => {
        if (due !== null) seen.push([due, performance.now()]);
        due = hubfoc.plotted.row === row ? null : hubfoc.plotted.row;
        row = hubfoc.plotted.row;
        requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
})()"""


def zero_of(browser: Browser) -> float:
    """Return when the page's clock was zero, or a little later."""
    asked: list[tuple[float, float]] = []
    for _ in range(20):
        before_s = time.monotonic()
        now_ms = browser.evaluate("performance.now()")
        after_s = time.monotonic()
        asked.append((after_s - before_s, after_s - 1e-3 * now_ms))
    return min(asked)[1]


def test_a_frame_of_a_wheel_is_in_the_curve_within_a_tenth_of_a_second(tmp_path: Path) -> None:
    """From when the frames of a millisecond are sent on the bus until its place is drawn.

    A machine with two cores and nothing else to do: RUN_SERIAL in CMakeLists.txt.
    """
    sent_s: list[float] = []
    sys.setswitchinterval(SWITCH_S)
    with running() as vehicle, Browser(tmp_path) as browser:
        after = vehicle.desk.after

        def noticed() -> None:
            while len(sent_s) <= vehicle.desk.history.count:
                sent_s.append(time.monotonic())
            after()

        vehicle.do(lambda: setattr(vehicle.desk, "after", noticed))
        browser.size(1400, 900)
        browser.open(vehicle.url)
        browser_load.choose(browser, CURVES)
        zero_s = zero_of(browser)
        browser.evaluate(LOOK)
        share = browser_load.share(browser, SECONDS)
        seen = np.array(browser.evaluate("seen"))
        factor, vehicle_share = (
            vehicle.desk.state(None)["health"][name] for name in ("realtime_factor", "cpu_share")
        )
    first, last = int(seen[0, 0]), int(seen[-1, 0])
    rows = np.arange(first, last)
    drawn_s = zero_s + 1e-3 * seen[np.searchsorted(seen[:, 0], rows, side="right"), 1]
    late_s = drawn_s - np.array(sent_s)[rows]
    found = np.quantile(late_s, QUANTILE)
    print(
        f"{len(rows)} ms with {CURVES} curves: median {1e3 * np.median(late_s):.0f} ms,"
        f" {QUANTILE:.0%} within {1e3 * found:.0f} ms, worst {1e3 * late_s.max():.0f} ms;"
        f" the page takes {share:.0%} of a core, the vehicle {vehicle_share:.0%}"
        f" at {factor:.2f} of real time"
    )
    assert last - first > 0.8e3 * SECONDS
    assert late_s.min() > 0.0
    assert found <= MOST_S
