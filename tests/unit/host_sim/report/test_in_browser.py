# SPDX-License-Identifier: Apache-2.0
"""The page in a headless browser, at the widths of a desktop and of a telephone, and in print.

Properties that need no browser are tested in test_whole_page.py.
"""

import html
import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
from diagrams.chromium import MISSING, PROGRAM, QUIET
from hubsim.report import Extras, page

from tests.unit.host_sim.report.ideal_extras import best_map, curves
from tests.unit.host_sim.report.ideal_vehicle import drive, three
from tests.unit.host_sim.report.test_single import CRITERIA, IDEAL

# Elements that exceed the page or their picture. Tables may be wider than a telephone: they scroll
# in their own box.
MEASURE = """
addEventListener("load", () => {
  const wide = document.documentElement.clientWidth;
  const out = [];
  for (const svg of document.querySelectorAll("svg")) {
    const box = svg.getBoundingClientRect();
    if (box.left < -0.5 || box.right > wide + 0.5) out.push("picture");
    for (const text of svg.querySelectorAll("text")) {
      const own = text.getBoundingClientRect();
      if (own.left < box.left - 8 || own.right > box.right + 8) out.push(text.textContent);
    }
  }
  parent.postMessage(JSON.stringify({ scroll: document.documentElement.scrollWidth, wide, out }),
      "*");
});
"""
# A window has a minimum width above that of a telephone; a frame has none.
FRAME = """<!DOCTYPE html><title></title>
<script>addEventListener("message", (event) => { document.title = event.data; });</script>
<iframe src="index.html" style="width: %dpx; height: 2000px; border: 0"></iframe>
"""


@pytest.fixture
def written(tmp_path: Path) -> Path:
    text = page.document(three(), Extras({"lu2013": best_map()}, curves()))
    path = tmp_path / "index.html"
    path.write_text(text.replace("</body>", f"<script>{MEASURE}</script></body>"), encoding="utf-8")
    return path


def browse(path: Path, *arguments: str) -> str:
    if PROGRAM is None:
        pytest.fail(MISSING)
    profile = path.parent / "profile"
    command = [PROGRAM, *QUIET, f"--user-data-dir={profile}", *arguments, path.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("width", [1280, 400])
def test_no_element_exceeds_the_page_or_its_picture(written: Path, width: int) -> None:
    frame = written.with_name("frame.html")
    frame.write_text(FRAME % width, encoding="utf-8")
    seen = browse(frame, "--window-size=1400,2100", "--virtual-time-budget=5000", "--dump-dom")
    title = re.search(r"<title>(\{.*?\})</title>", seen)
    assert title is not None, "the page did not load"
    measured: dict[str, Any] = json.loads(html.unescape(title[1]))
    assert measured["wide"] == width
    assert measured["scroll"] <= width
    assert measured["out"] == []


@pytest.mark.parametrize("width", [1280, 400])
def test_a_screenshot_contains_the_colours_of_the_legend(written: Path, width: int) -> None:
    from PIL import Image  # noqa: PLC0415, comes with the plotting package

    shot = written.with_name("shot.png")
    browse(written, f"--window-size={width},2400", f"--screenshot={shot}")
    with Image.open(shot) as picture:
        assert picture.size == (width, 2400)
        seen = {colour for _, colour in picture.convert("RGB").getcolors(1 << 24) or []}
    assert {(0, 122, 85), (213, 94, 0)} <= seen, "battery green and hydraulic orange"


def test_in_print_every_part_fits_one_sheet(written: Path) -> None:
    """Signals on portrait sheets, two strategies each, the rest on others.

    Content that does not fit is cut and increases their number.
    """
    sheets = written.with_name("sheets.pdf")
    browse(written, "--no-pdf-header-footer", f"--print-to-pdf={sheets}")
    sizes = [
        (float(w), float(h))
        for w, h in re.findall(rb"/MediaBox\s*\[0 0 ([0-9.]+) ([0-9.]+)\]", sheets.read_bytes())
    ]
    upright = [height > width for width, height in sizes]
    assert upright.count(True) == 2
    assert 3 <= upright.count(False) <= 4


def test_one_run_prints_on_three_sheets_with_headings_next_to_their_content(tmp_path: Path) -> None:
    """Result and pictures; energies and criteria; signals and notes, portrait."""
    run = drive(cycle="stop")
    run.summary["ideal_stop"] = IDEAL
    run.summary["criteria"] = CRITERIA
    path = tmp_path / "index.html"
    path.write_text(page.document([run], Extras({"lu2013": best_map()})), encoding="utf-8")
    sheets = path.with_name("sheets.pdf")
    browse(path, "--no-pdf-header-footer", f"--print-to-pdf={sheets}")
    sizes = re.findall(rb"/MediaBox\s*\[0 0 ([0-9.]+) ([0-9.]+)\]", sheets.read_bytes())
    upright = sorted(float(height) > float(width) for width, height in sizes)
    assert upright == [False, False, True]


@pytest.mark.parametrize("width", [1280, 400])
def test_one_run_fills_the_page_without_overflow(tmp_path: Path, width: int) -> None:
    run = drive(cycle="stop")
    run.summary["ideal_stop"] = IDEAL
    run.summary["criteria"] = CRITERIA
    text = page.document([run], Extras({"lu2013": best_map()}))
    widest = (
        "<script>addEventListener('load', () => { const rights = [...document.querySelectorAll("
        "'svg.traces')].map((s) => s.getBoundingClientRect().right); document.documentElement"
        ".dataset.right = Math.max(...rights); });</script>"
    )
    path = tmp_path / "index.html"
    path.write_text(
        text.replace("</body>", f"{widest}<script>{MEASURE}</script></body>"), encoding="utf-8"
    )
    frame = path.with_name("frame.html")
    frame.write_text(FRAME % width, encoding="utf-8")
    seen = browse(frame, "--window-size=1400,2100", "--virtual-time-budget=5000", "--dump-dom")
    title = re.search(r"<title>(\{.*?\})</title>", seen)
    assert title is not None, "the page did not load"
    measured: dict[str, Any] = json.loads(html.unescape(title[1]))
    assert measured["scroll"] <= width
    assert measured["out"] == []
    if width == 1280:
        alone = browse(path, "--window-size=1280,2100", "--dump-dom")
        right = re.search(r'data-right="([0-9.]+)"', alone)
        assert right is not None
        assert float(right[1]) > 0.9 * width
