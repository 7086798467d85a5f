# SPDX-License-Identifier: Apache-2.0
"""The live page in a headless browser: drives a stop, breaks a sensor, exports, loses its link."""

import csv
import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from diagrams.chromium import Browser
from hubsim import cli
from hubsim.scenario import faults
from regen_table import schema

NOW = "hubfoc.last.rows.now"


@pytest.fixture(scope="module")
def process() -> Iterator[tuple[subprocess.Popen[str], str]]:
    command = [sys.executable, "-m", "hubfoc", "live", "--ready-json", "--can", "virtual"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as own:
        assert own.stdout is not None
        yield own, json.loads(own.stdout.readline())["url"]
        own.send_signal(signal.SIGINT)


@pytest.fixture(scope="module")
def browser(
    process: tuple[subprocess.Popen[str], str], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("profile")) as own:
        own.size(1400, 900)
        own.open(process[1])
        own.until("globalThis.hubfoc?.last.rows != null")
        own.evaluate(
            "globalThis.shifts = 0; new PerformanceObserver((list) => { for (const entry of"
            " list.getEntries()) globalThis.shifts += entry.value; }).observe({ type:"
            " 'layout-shift' })"
        )
        yield own


def fits(browser: Browser, dialog: str, pictures: Path) -> bool:
    """Return whether nothing in a dialog is wider than it, on a screen and on a phone.

    What another size of the window moves is not counted among the shifts.
    """
    before = browser.evaluate("globalThis.shifts")
    exceeds = False
    for width, dark in ((1400, False), (1400, True), (400, False), (400, True)):
        browser.size(width, 900, dark=dark)
        browser.picture(pictures / f"{dialog[1:]}-{width}-{'dark' if dark else 'light'}.png")
        box = f"document.querySelector('{dialog}')"
        exceeds |= bool(browser.evaluate(f"{box}.scrollWidth > {box}.clientWidth"))
    browser.size(1400, 900)
    time.sleep(0.2)
    browser.evaluate(f"globalThis.shifts = {before}")
    return not exceeds


def test_a_stop_by_slider_is_handed_over_from_motor_to_hydraulic_brake(browser: Browser) -> None:
    """Demand: the slider's share of all that both brakes can make.

    At speed motor and hydraulic brake make it together, the motor at its limit. The optimum, which
    falls with the speed (README, Why an optimum), and the blend-out hand it over.
    """
    drive = schema.load(cli.DEFAULT_CONFIG)
    most_nm = drive.motor.max_torque_nm + drive.brake.max_hydraulic_torque_nm
    demand_nm = 1.5 * drive.motor.max_torque_nm
    browser.until(f"{NOW}['wheel0.mode'] === 4")
    browser.slide("#accelerator", 1.0)
    browser.until(f"{NOW}['vehicle.speed_m_per_s'] > 3.5")
    browser.slide("#accelerator", 0.0)
    browser.slide("#brake", round(demand_nm / most_nm, 2))
    demand_nm = round(demand_nm / most_nm, 2) * most_nm
    sums, reasons, tightest = [], set(), set()
    for _ in range(400):
        values = browser.evaluate(
            f"[{NOW}['vehicle.speed_m_per_s'], {NOW}['wheel0.motor_torque_nm'],"
            f" {NOW}['wheel0.hydraulic_torque_nm'],"
            " document.querySelector('.front_left .reason').innerText,"
            " document.querySelector('#limits-note').innerText]"
        )
        speed, motor_nm, hydraulic_nm, reason, note = values
        sums.append((speed, -motor_nm, hydraulic_nm))
        reasons.add(reason)
        tightest.add(note)
        if speed < 0.05:
            break
        time.sleep(0.02)
    browser.slide("#brake", 0.0)
    fast = [s for s in sums if 1.5 < s[0] < 3.0]
    assert fast
    for _, motor_nm, hydraulic_nm in fast:
        assert motor_nm + hydraulic_nm == pytest.approx(demand_nm, rel=0.05)
    assert max(motor for _, motor, _ in fast) == pytest.approx(drive.motor.max_torque_nm, rel=0.02)
    last = [s for s in sums if 0.1 < s[0] < 0.4]
    assert last
    assert all(hydraulic > 0.8 * demand_nm > motor for _, motor, hydraulic in last)
    assert {"motor torque limit", "more torque would return less energy"} <= reasons
    assert {"braking: motor torque limit", "braking: more torque would return less energy"} <= (
        tightest
    )


def test_a_broken_sensor_is_named_acknowledged_and_mended(browser: Browser) -> None:
    right = faults.expected()["winding_sensor_shorted"]
    browser.slide("#fault", "winding_sensor_shorted")
    browser.slide("#fault-wheel", "rear_left")
    browser.click("#inject")
    browser.until("document.querySelector('#finding-lines').innerText.includes('present')")
    shown = browser.text("#finding-lines")
    assert any(reason in shown for reason in right)
    assert "rear left" in shown
    assert "after winding sensor shorted" in shown
    assert browser.text(".rear_left .says") in right
    assert browser.text(".rear_right .says") == ""
    browser.press("a")
    browser.until("document.querySelector('#finding-lines').innerText.includes('acknowledged at')")
    browser.click("#active .chip")
    browser.until("document.querySelector('#active').innerText === 'nothing is broken'")


def test_the_black_box_of_a_fault_is_drawn(browser: Browser, tmp_path: Path) -> None:
    """Four panels; the cursor shows what the record has at that time."""
    words = "document.querySelector('#blackbox-words').innerText"
    browser.until(f"{NOW}['wheel1.mode'] === 4")
    browser.slide("#accelerator", 0.5)
    browser.until(f"{NOW}['vehicle.speed_m_per_s'] > 1")
    browser.slide("#fault", "gate_driver")
    browser.slide("#fault-wheel", "front_right")
    browser.click("#inject")
    browser.until("document.querySelector('#finding-lines').innerText.includes('HARDWARE_BREAK')")
    for _ in range(100):
        browser.click("#open-blackbox")
        browser.until(f"!{words}.startsWith('reading')")
        if browser.evaluate("document.querySelectorAll('#blackbox-panels canvas').length") == 4:
            break
        browser.click("#blackbox-close")
    browser.slide("#accelerator", 0.0)
    assert browser.evaluate("document.querySelector('#blackbox-wheel').value") == "1"
    assert browser.text("#blackbox-words").startswith("HARDWARE_BREAK")
    assert "Phase currents, from the fault" in browser.text("#blackbox-panels")
    assert fits(browser, "#blackbox", tmp_path)
    browser.click("#blackbox-close")
    browser.click("#active .chip")
    browser.until("document.querySelector('#active').innerText === 'nothing is broken'")
    browser.slide("#brake", 0.3)
    browser.until(f"{NOW}['vehicle.speed_m_per_s'] < 0.01")
    browser.slide("#brake", 0.0)
    browser.press("a")
    browser.until("document.querySelector('#finding-lines').innerText.includes('acknowledged at')")


def test_the_scope_is_drawn_and_exported(browser: Browser, tmp_path: Path) -> None:
    """Around the rise of the demand, while the wheel drives; a row each PWM period."""
    words = "document.querySelector('#scope-words').innerText"
    names = ["fast_input.phase_current_code_a", "input.drive_torque_nm"]
    browser.until(f"{NOW}['wheel0.mode'] === 4")
    browser.click("#open-scope")
    for _ in range(8):
        browser.evaluate("document.querySelector('#scope-chosen button')?.click()")
    for name in names:
        browser.evaluate(f"document.querySelector('#scope-signal').value = '{name}'")
        browser.click("#scope-add")
    browser.slide("#scope-trigger", "rises")
    browser.slide("#scope-on", "input.drive_torque_nm")
    browser.slide("#scope-level", "2")
    browser.click("#scope-run")
    browser.until(f"{words}.startsWith('waiting')")
    browser.slide("#accelerator", 0.5)
    browser.until(f"{words}.includes('every PWM period')")
    browser.slide("#accelerator", 0.0)
    assert fits(browser, "#scope", tmp_path)
    browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    named = {"csv": "-scope.csv", "parquet": ".parquet", "mcap": ".mcap", "picture": "-scope.png"}
    files = []
    for button, end in named.items():  # what the service writes, one after the other
        files.append(tmp_path / f"hubfoc{end}")
        browser.click(f"#scope-{button}")
        browser.until_true(files[-1].is_file, "no file")
    with files[0].open(encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    table = pq.read_table(files[1])
    assert table.column_names == list(rows[0]) == ["time_s", *names]
    for name in table.column_names:
        values = [float(row[name]) for row in rows]
        assert values == pytest.approx(table[name].to_pylist(), rel=1e-5, abs=1e-7)
    demand = table["input.drive_torque_nm"].to_pylist()
    trigger = table["time_s"].to_pylist().index(0.0)
    assert demand[trigger - 1] < 2.0 <= demand[trigger]
    browser.click("#scope-close")
    browser.slide("#brake", 0.3)
    browser.until(f"{NOW}['vehicle.speed_m_per_s'] < 0.01")
    browser.slide("#brake", 0.0)


def test_a_step_of_the_current_loop_is_drawn_beside_the_designed_response(
    browser: Browser, tmp_path: Path
) -> None:
    """What is beside it: test_step_tests.py. Both pedals are let go before the picture is there."""
    browser.until(f"{NOW}['wheel0.mode'] === 4")
    browser.slide("#accelerator", 0.5)
    browser.until(f"{NOW}['wheel0.motor_torque_nm'] > 15")
    browser.click("#open-step")
    browser.until("document.querySelector('#step').open")
    assert browser.evaluate("document.querySelector('#accelerator').value") == "0"
    of = browser.text("#step-of")
    assert of.startswith("front left, i_q from ")
    assert of.endswith(" A to 0.0 A")
    rise, designed_rise, overshoot, designed_overshoot = browser.evaluate(
        "[...document.querySelectorAll('#step-lines td')].map((td) => parseFloat(td.innerText))"
    )
    assert rise == pytest.approx(designed_rise, rel=0.5)
    assert 0.0 <= overshoot < 30.0
    assert designed_overshoot == 0.0
    found = re.search(r"([\d.]+) A, ([\d.]+) % of the step", browser.text("#step-words"))
    assert found is not None
    assert float(found[2]) < 30.0
    assert browser.evaluate("document.querySelectorAll('#step canvas').length") == 2
    assert fits(browser, "#step", tmp_path)
    browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    for button, name in (("csv", "hubfoc-step.csv"), ("picture", "hubfoc-step.png")):
        browser.click(f"#step-{button}")
        browser.until_true((tmp_path / name).is_file, "no file")
    with (tmp_path / "hubfoc-step.csv").open(encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    worst = max(
        abs(float(row["fast_view.i_q_pu"]) - float(row["designed.i_q"]))
        for row in rows
        if float(row["time_s"]) >= 0.0
    )
    assert worst == pytest.approx(float(found[1]), abs=0.006)
    browser.click("#step-close")
    browser.until(f"Math.abs({NOW}['wheel0.motor_torque_nm']) < 1")
    browser.slide("#brake", 0.3)
    browser.until(f"{NOW}['vehicle.speed_m_per_s'] < 0.01")
    browser.slide("#brake", 0.0)


def test_the_world_and_the_pedals_obey_keys(browser: Browser) -> None:
    browser.press("w")
    browser.until("Number(document.querySelector('#accelerator').value) === 0.05")
    browser.press(" ")
    browser.until("Number(document.querySelector('#accelerator').value) === 0")
    browser.press("2")
    browser.until("document.querySelector('#limits-of').innerText === 'front right'")
    browser.press("1")
    browser.press("u")
    browser.until("hubfoc.last.state.slope === 0.005")
    browser.press("j")
    browser.until("hubfoc.last.state.slope === 0")
    browser.press("p")
    browser.until("document.querySelector('#status').innerText === 'paused'")
    browser.press("p")
    browser.until("document.querySelector('#status').innerText === 'running'")


def test_curves_are_chosen_and_exported(browser: Browser, tmp_path: Path) -> None:
    browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    browser.evaluate("document.querySelector('#signal').value = 'battery.soc'")
    browser.click("#add")
    browser.slide("#span", 3)
    browser.until("document.querySelectorAll('#legend li').length === 5")
    browser.until(f"{NOW} !== undefined && hubfoc.last.rows.curves === 5")
    browser.click("#hold")
    browser.click("#csv")
    browser.click("#parquet")
    browser.click("#picture")
    table, picture = tmp_path / "hubfoc.csv", tmp_path / "hubfoc.png"
    columns = tmp_path / "hubfoc.parquet"
    browser.until_true(
        lambda: table.is_file() and picture.is_file() and columns.is_file(), "no file"
    )
    with table.open(encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    assert next(iter(rows[0])) == "time_s"
    assert float(rows[-1]["battery.soc"]) == pytest.approx(
        schema.load(cli.DEFAULT_CONFIG).battery.initial_soc, abs=0.01
    )
    times_ms = [round(1e3 * float(row["time_s"])) for row in rows]
    assert times_ms == list(range(times_ms[0], times_ms[0] + len(rows)))
    assert 2990 <= len(rows) <= 3001
    same = pq.read_table(columns)
    assert same.column_names == list(rows[0])
    for name in ("time_s", "battery.soc", "wheel0.motor_torque_nm"):
        values = [float(row[name]) for row in rows]
        assert same[name].to_pylist() == pytest.approx(values, rel=1e-5, abs=1e-6)
    assert picture.read_bytes().startswith(b"\x89PNG")
    browser.click("#hold")


def test_curves_of_many_samples_show_the_bounds_of_each_group(browser: Browser) -> None:
    """Against the least and the largest of 64 values, picked out one by one.

    50 000 values in 800 groups of whole sixteens: 64 in each; what is left after the last is drawn
    row by row. The rows come in pieces of odd lengths and begin in the middle of a sixteen.
    """
    wrong = browser.evaluate("""(() => {
        const samples = new hubfoc.Samples();
        samples.choose(["one", "two"]);
        const all = new Map();
        let row = 70005;
        for (let piece = 1; row < 140000; piece = (piece * 7) % 31 || 1) {
            const values = Float32Array.from({ length: 2 * piece }, Math.random);
            samples.add(row, piece, values);
            for (let k = 0; k < piece; k++) all.set(row + k, [values[2 * k], values[2 * k + 1]]);
            row += piece;
        }
        const [times, ...curves] = samples.window(row - 50000, row, 800);
        const long = Math.round(2e3 * (times[1] - times[0]));
        const tail = row % 64, pairs = times.length - tail;
        let wrong = long === 64 && pairs > 1500 && pairs <= 1600 && tail > 0 ? 0 : 1;
        for (let k = 0; k < tail; k++) {
            if (Math.round(1e3 * times[pairs + k]) !== row - tail + k + 1) wrong++;
            curves.forEach((curve, which) => {
                if (curve[pairs + k] !== all.get(row - tail + k)[which]) wrong++;
            });
        }
        for (let place = 0; place < pairs; place += 2) {
            const begin = Math.round(1e3 * times[place]) - 1;
            curves.forEach((curve, which) => {
                const group = Array.from({ length: long }, (_, k) => all.get(begin + k)[which]);
                if (curve[place] !== Math.min(...group)) wrong++;
                if (curve[place + 1] !== Math.max(...group)) wrong++;
            });
        }
        const raw = samples.window(row - 50, row, 100);
        raw[1].forEach((value, k) => {
            if (value !== all.get(row - raw[1].length + k)[0]) wrong++;
        });
        return wrong;
    })()""")
    assert wrong == 0


def test_a_recording_is_replayed_bit_for_bit(browser: Browser, tmp_path: Path) -> None:
    words = "document.querySelector('#replay-words').innerText"
    browser.click("#record")
    browser.until("document.querySelector('#record').innerText.startsWith('Stop')")
    browser.until("hubfoc.last.rows?.now['wheel0.mode'] === 4")
    browser.slide("#accelerator", 1.0)
    browser.until("hubfoc.last.rows.now['vehicle.speed_m_per_s'] > 0.8")
    browser.slide("#accelerator", 0.0)
    browser.slide("#brake", 0.3)
    browser.until("hubfoc.last.rows.now['vehicle.speed_m_per_s'] < 0.01")
    browser.slide("#brake", 0.0)
    browser.click("#record")
    browser.until("!document.querySelector('#open-replay').disabled")
    browser.click("#open-replay")
    browser.until(f"{words}.includes('every output equal')")
    assert "replayed, equal" in browser.text("#replay-plot .legend")
    browser.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    browser.click("#replay-file")
    browser.until_true(lambda: any(tmp_path.glob("*.parquet")), "no file")
    browser.click("#replay-simulate")
    browser.click("#replay-run")
    browser.until(f"{words}.includes('closed loop') && {words}.includes('every output equal')")
    assert fits(browser, "#replay", tmp_path)
    browser.click("#replay-close")


def test_a_parameter_is_edited_replayed_and_stored(browser: Browser, tmp_path: Path) -> None:
    """The recorded vehicle was driven with all of its motors' torque.

    A wheel with seven eighths of it would have commanded less. Once that is stored, the drive's
    file says another value.
    """
    field = "motor.max_torque_mNm"
    lines = "document.querySelector('#parameter-lines')"
    words = "document.querySelector('#replay-words').innerText"
    browser.click("#open-parameters")
    browser.until(f"{lines}.children.length > 100")
    before = int(browser.evaluate(f"{lines}.querySelector('[data-name=\"{field}\"] input').value"))
    edit = f"{lines}.querySelector('[data-name=\"{field}\"] input')"
    for wanted, stored in (("-1", False), (str(before * 7 // 8), True)):
        browser.evaluate(
            f"{edit}.value = '{wanted}', {edit}.dispatchEvent(new Event('change')), null"
        )
        assert browser.evaluate("document.querySelector('#parameter-store').disabled") is not stored
    assert browser.evaluate(f"{edit}.closest('tr').className") == "edited"
    browser.click("#parameter-close")
    browser.click("#open-replay")
    browser.until(f"{words}.includes('closed loop, with other parameters')")
    assert "first difference" in browser.text("#replay-words")
    browser.click("#replay-steps")
    browser.click("#replay-run")
    browser.until(f"{words}.includes('open loop')")
    assert "commanded for these sensor values" in browser.text("#replay-plot .legend")
    browser.click("#replay-close")

    browser.click("#open-parameters")
    browser.until("!document.querySelector('#parameter-store').disabled")
    browser.click("#parameter-store")
    browser.until("document.querySelector('#parameter-note').innerText.startsWith('0 edited')")
    assert browser.evaluate(f"{edit}.closest('tr').className") == "other"
    assert browser.evaluate(f"{edit}.value") == str(before * 7 // 8)
    assert f"the file says {before}" in browser.text("#parameter-lines")
    assert fits(browser, "#parameters", tmp_path)
    browser.click("#parameter-close")
    browser.until("hubfoc.last.rows.now['wheel0.mode'] === 4")


def test_nothing_has_moved_and_the_console_is_empty(browser: Browser) -> None:
    """Less than 0.1 is called good; here bars and numbers change sixty times a second."""
    assert browser.evaluate("globalThis.shifts") < 0.01
    assert browser.console == []


@pytest.mark.parametrize(("width", "dark"), [(1400, False), (1400, True), (400, False)])
def test_no_element_exceeds_the_page(
    browser: Browser, tmp_path: Path, width: int, *, dark: bool
) -> None:
    """At 1400 px nothing needs scrolling; pictures show motor and hydraulic colours."""
    from PIL import Image  # noqa: PLC0415, comes with the plotting package

    browser.size(width, 900, dark=dark)
    wide, high = browser.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    assert wide <= width
    assert width < 1400 or high <= 900
    out = browser.evaluate(
        "[...document.querySelectorAll('.wheel span, header *, button')].filter((e) => {"
        " const box = e.closest('.wheel, section, header, dialog').getBoundingClientRect();"
        " const own = e.getBoundingClientRect(); return own.right > box.right + 0.5 }).length"
    )
    assert out == 0
    shot = tmp_path / "shot.png"
    browser.picture(shot)
    with Image.open(shot) as picture:
        colours = {colour for _, colour in picture.convert("RGB").getcolors(1 << 24) or []}
    expected = ((75, 163, 224), (20, 24, 29)) if dark else ((0, 114, 178), (255, 255, 255))
    assert set(expected) <= colours
    browser.size(1400, 900)


def test_where_the_link_is_lost_values_grey_and_controls_go_off(
    browser: Browser, process: tuple[subprocess.Popen[str], str]
) -> None:
    browser.slide("#brake", 0.4)
    process[0].send_signal(signal.SIGINT)
    browser.until("document.body.className === 'stale'")
    assert browser.text("#status").startswith("link lost, values are ")
    browser.until("document.querySelector('#brake').disabled")
    assert browser.evaluate("document.querySelector('#brake').value") == "0"
    assert browser.evaluate(
        "[...document.querySelectorAll('[data-needs]')].every((element) => element.disabled)"
    )
