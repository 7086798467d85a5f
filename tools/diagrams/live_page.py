# SPDX-License-Identifier: Apache-2.0
"""The picture of the live page: a stop in which a wheel's temperature sensor breaks.

    tools/dev python -m diagrams.live_page

Needs a Chromium, and the simulator as ./tools/dev live builds it.
"""

import argparse
import json
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from diagrams.chromium import Browser

PICTURE = Path(__file__).with_name("live_page.png")
FROM_M_PER_S = 8.0  # it brakes
TO_M_PER_S = 0.9  # the motor hands over to the hydraulic brake


def drive(browser: Browser) -> None:
    """Accelerate, break a sensor, brake."""
    speed = "hubfoc.last.rows.now['vehicle.speed_m_per_s']"
    browser.until("globalThis.hubfoc?.last.rows != null")
    browser.until("hubfoc.last.rows.now['wheel0.mode'] === 4")
    browser.slide("#accelerator", 1.0)
    browser.until(f"{speed} > {FROM_M_PER_S / 2}")
    browser.slide("#fault", "current_a_dead")
    browser.slide("#fault-wheel", "rear_left")
    browser.click("#inject")
    browser.until(f"{speed} > {FROM_M_PER_S}")
    browser.slide("#accelerator", 0.0)
    browser.slide("#brake", 0.2)
    browser.until(f"{speed} < {TO_M_PER_S}")


def main() -> int:
    """Write the picture, or another one."""
    parser = argparse.ArgumentParser(prog="diagrams.live_page", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=PICTURE)
    parser.add_argument("--width", type=int, default=1400)
    parser.add_argument("--height", type=int, default=900)
    parser.add_argument("--dark", action="store_true")
    options = parser.parse_args()
    from PIL import Image  # noqa: PLC0415, comes with the plotting package

    command = [sys.executable, "-m", "hubfoc", "live", "--ready-json", "--can", "virtual"]
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as live,
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile,
    ):
        try:
            assert live.stdout is not None
            url = json.loads(live.stdout.readline())["url"]
            with Browser(Path(profile)) as browser:
                browser.size(options.width, options.height, dark=options.dark)
                browser.open(url)
                drive(browser)
                browser.picture(options.output)
        finally:
            live.send_signal(signal.SIGINT)
    with Image.open(options.output) as picture:
        fewer = picture.convert("RGB").quantize(
            method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE
        )
        fewer.save(options.output, optimize=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
