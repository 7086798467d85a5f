# SPDX-License-Identifier: Apache-2.0
"""The page on real wheels: what they say by CAN is shown, and nothing is demanded without leave.

The real wheels are those of a virtual vehicle on the same bus, whose signals are known.
"""

import math
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from diagrams.chromium import Browser
from hubfoc.bus import join
from hubfoc.errors import HubfocError
from hubfoc.live import clock, command, desk, orders, service, terminals, xcp
from hubfoc.live.board import ON_CAN, Board, BoardVehicle
from hubfoc.live.findings import Findings
from hubfoc.live.history import History
from hubsim import can_protocol, cli, reasons
from regen_table import schema

from tests.unit.host_sim.live.support import Running, running, until

NOW = "hubfoc.last.rows.now"
CYCLES_LOST_ms = 5 * max(can_protocol.MESSAGES[m].cycle_ms for m, *_ in ON_CAN.values())


@contextmanager
def board(channel: str, *, demands: bool) -> Iterator[tuple[Board, str]]:
    """Show the wheels on a bus; yield them and the page's address."""
    ends = threading.Event()
    bus, pace, calls = join(channel), clock.Clock(paced=True), orders.Orders()
    own = Board(cli.DEFAULT_CONFIG, demands=demands)
    pages = desk.Desk(own, pace)
    with (
        terminals.Terminals(0) as lines,
        xcp.Gateways(0, 0) as gateways,
        service.Service(0, command.answers(own, pace, calls, pages)) as server,
    ):
        thread = threading.Thread(
            target=command.keep_running,
            args=(own, bus, lines, gateways, pace, calls, ends.is_set, pages),
        )
        thread.start()
        try:
            yield own, server.url
        finally:
            ends.set()
            thread.join()
            bus.close()


def frame(message: str, counter: int, wheel: int = 0, **values: float) -> tuple[int, bytes]:
    """Return a frame of a wheel; what is not given is zero."""
    zero = {name: max(signal.least, 0.0) for name, signal in
            can_protocol.MESSAGES[message].signals.items()
            if name not in ("crc", "counter")}  # fmt: skip
    return can_protocol.encode(message, zero | values, wheel=wheel, counter=counter)


def known(vehicle: BoardVehicle) -> dict[str, float]:
    """Return all signals now."""
    names = list(vehicle.meanings())
    row = np.zeros(len(names))
    vehicle.choose(names)
    vehicle.sample(row)
    return dict(zip(names, row.tolist(), strict=True))


def test_the_service_of_real_wheels_is_reached_by_can() -> None:
    """The scope's settings and signals of the wheel that is meant, beside its other frames."""
    pace = clock.Clock(paced=True)
    with running() as own:
        pages = desk.Desk(Board(cli.DEFAULT_CONFIG, demands=False), pace, channel=own.channel)
        own.do(lambda: own.world.change({"fault": "gate_driver", "wheel": "rear_left"}))
        until(lambda: own.value("wheel2.fault_reason") != 0)
        for wheel in (1, 2):
            with pages.session(wheel) as session:
                reason = session.signal("output.fault_reason")
                assert reason == own.value(f"wheel{wheel}.fault_reason")
                assert session.scope_rows(["output.fault_reason"]) > 0


def test_signals_are_those_of_the_frames_and_nan_once_they_come_no_more() -> None:
    vehicle = BoardVehicle(schema.load(cli.DEFAULT_CONFIG))
    assert math.isnan(known(vehicle)["wheel2.motor_torque_nm"])
    for counter in range(4):
        vehicle.step([
            frame("WheelState", counter, 2, motor_torque_estimate_nm=-12.5, speed_rad_s=30.0),
            frame("WheelBrake", counter, 2, hydraulic_torque_nm=7.0),
        ])  # fmt: skip
    now = known(vehicle)
    assert (now["wheel2.motor_torque_nm"], now["wheel2.speed_rad_per_s"]) == (-12.5, 30.0)
    assert math.isnan(now["wheel2.hydraulic_torque_nm"])  # hydraulic_valid is 0
    assert math.isnan(now["wheel1.motor_torque_nm"])
    assert now["vehicle.speed_m_per_s"] == pytest.approx(30.0 * vehicle.wheel_radius_m)
    for _ in range(CYCLES_LOST_ms + 1):
        vehicle.step([])
    assert math.isnan(known(vehicle)["wheel2.motor_torque_nm"])


def test_both_accounts_of_a_wheel_stay_until_they_come_no_more() -> None:
    vehicle = BoardVehicle(schema.load(cli.DEFAULT_CONFIG))
    for counter in range(4):
        own = {"account": 0.0, "drawn_wh": 12.5, "friction_percent": math.nan}
        life = {"account": 1.0, "life_drawn_wh": 4000.0, "life_friction_percent": 7.0}
        vehicle.step([
            can_protocol.encode("WheelEnergy", life if counter % 2 else own, counter=counter)
        ])  # fmt: skip
    now = known(vehicle)
    assert (now["wheel0.drawn_wh"], now["wheel0.life_drawn_wh"]) == (12.5, 4000.0)
    assert math.isnan(now["wheel0.friction_percent"])
    assert now["wheel0.life_friction_percent"] == 7.0
    for _ in range(CYCLES_LOST_ms + 1):
        vehicle.step([])
    assert math.isnan(known(vehicle)["wheel0.drawn_wh"])


def test_energy_is_torque_by_speed_and_a_silent_wheel_counts_nothing() -> None:
    vehicle = BoardVehicle(schema.load(cli.DEFAULT_CONFIG))
    history = History(vehicle)
    findings = Findings(history, vehicle.wheels)
    steps = 400
    for step in range(steps):
        vehicle.step([
            frame("WheelState", step % 15, motor_torque_estimate_nm=-10.0, speed_rad_s=20.0,
                  fault_reason=reasons.codes()["OVERCURRENT"]),
            frame("WheelPower", step % 15, bus_voltage_v=60.0, bus_current_a=-3.0),
        ])  # fmt: skip
        findings.look(vehicle.time_s, history.record(vehicle), {})
    now = dict(zip(history.names, history.row.tolist(), strict=True))
    silent = 3  # frames in order before the first is used
    assert now["energy.shaft_j"] == pytest.approx(-200.0 * steps / 1e3, rel=2 * silent / steps)
    assert now["battery.returned_j"] == pytest.approx(180.0 * steps / 1e3, rel=2 * silent / steps)
    assert now["battery.drawn_j"] == 0.0
    assert np.isfinite(history.cost_j).all()
    assert [(line.wheel, line.reason) for line in findings.lines] == [(0, "OVERCURRENT")]


def test_the_world_of_real_wheels_is_not_changed() -> None:
    own = Board(cli.DEFAULT_CONFIG, demands=False)
    with pytest.raises(HubfocError, match="virtual vehicle"):
        own.change({"slope": 0.1})
    pages = desk.Desk(own, clock.Clock(paced=True))
    page = object()
    pages.arrive(page)
    assert pages.cockpit.owner is None
    with pytest.raises(HubfocError, match="--allow-demand"):
        pages.do(page, {"do": "take"})


@pytest.mark.parametrize(
    ("given", "why"),
    [
        (["--board", "--scenario", "stop"], "--scenario"),
        (["--board", "--fast"], "--fast"),
        (["--allow-demand"], "with --board"),
    ],
)
def test_what_real_wheels_cannot_have_is_one_line(given: list[str], why: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "hubfoc", "live", *given, "--can", "virtual"], check=False,
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert why in done.stderr


def key(browser: Browser, kind: str) -> None:
    """Press or let go the dead-man key."""
    event = f"new KeyboardEvent('{kind}', {{ key: 'd', bubbles: true }})"
    browser.evaluate(f"document.body.dispatchEvent({event})")


@pytest.fixture
def vehicle() -> Iterator[Running]:
    with running() as own:
        yield own


def test_a_page_drives_real_wheels_only_while_its_key_is_held(
    vehicle: Running, tmp_path: Path
) -> None:
    with board(vehicle.channel, demands=True) as (_, url), Browser(tmp_path) as browser:
        browser.size(1400, 900)
        browser.open(url)
        browser.until(f"globalThis.hubfoc?.last.rows != null && {NOW}['wheel3.mode'] > 0")
        assert not browser.evaluate("document.querySelector('#break').checkVisibility()")
        browser.until("!document.querySelector('#take').disabled")
        browser.click("#take")
        browser.until("document.querySelector('#driver').innerText === 'you drive'")
        browser.slide("#accelerator", 0.5)
        browser.until(f"{NOW}['wheel0.mode'] === 4")
        assert vehicle.value("wheel0.command_nm") == 0.0
        key(browser, "keydown")
        browser.until(f"{NOW}['wheel0.motor_torque_nm'] > 15")
        until(lambda: vehicle.value("vehicle.speed_m_per_s") > 0.5)
        key(browser, "keyup")
        until(lambda: vehicle.value("wheel0.command_nm") <= 0.0)

        def is_shown() -> bool:
            shown = browser.evaluate(f"{NOW}['vehicle.speed_m_per_s']")
            moves = vehicle.value("vehicle.speed_m_per_s")
            return shown is not None and abs(float(shown) - moves) < 0.2 * moves

        until(is_shown)
        assert browser.console == []
