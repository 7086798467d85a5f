# SPDX-License-Identifier: Apache-2.0
"""The step test of the current loop: the designed response, its shape, and the virtual wheel's."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hubfoc import addresses, measuring
from hubfoc.errors import HubfocError
from hubfoc.live import step_tests
from hubfoc.live.scopes import Column
from hubsim import cli
from regen_table import schema

from tests.unit.host_sim.live.support import running, until
from tests.unit.host_sim.live.test_page import Client

PWM_HZ, BANDWIDTH_HZ = 20000.0, 1000.0


def continuous(periods: int, bandwidth_hz: float = BANDWIDTH_HZ) -> Column:
    """Return 1 - exp(-w (t - 1.5 T)) at the samples from the step on."""
    n = np.arange(periods)
    out: Column = 1.0 - np.exp(-2.0 * math.pi * bandwidth_hz / PWM_HZ * np.maximum(n - 1.5, 0.0))
    return out


def test_the_designed_response_is_a_first_order_lag_after_one_and_a_half_periods() -> None:
    """A step, and by superposition any reference: a ramp is the sum of small steps."""
    step = np.concatenate((np.zeros(10), np.ones(90)))
    answer = step_tests.designed(step, BANDWIDTH_HZ, PWM_HZ)
    assert answer[:10] == pytest.approx(np.zeros(10))
    assert answer[10:] == pytest.approx(continuous(90))
    ramp = step_tests.designed(np.arange(100.0), BANDWIDTH_HZ, PWM_HZ)
    assert ramp == pytest.approx(np.concatenate(([0.0], np.cumsum(continuous(99)))))
    assert step_tests.designed(np.full(20, 7.0), 300.0, PWM_HZ) == pytest.approx(np.full(20, 7.0))


def test_rise_time_and_overshoot_of_known_curves() -> None:
    """A straight line over ten samples; ln 9 time constants; an oscillation's first peak."""
    line = np.minimum(np.arange(20) / 10.0, 1.0)
    found = step_tests.Shape.of(line, 0.0, 1.0, 1e-3)
    assert found.rise_s == pytest.approx(8e-3)
    assert found.overshoot == 0.0
    lag = 5.0 - 3.0 * (1.0 - np.exp(-np.arange(4000) / 500.0))  # falls from 5 to 2
    found = step_tests.Shape.of(lag, 5.0, 2.0, 1.0)
    assert found.rise_s == pytest.approx(500.0 * math.log(9.0), rel=1e-3)
    assert found.overshoot == 0.0
    damping = 0.5
    turn = np.arange(20000) / 1000.0
    swing = math.sqrt(1.0 - damping**2)
    ring = 1.0 - np.exp(-damping * turn) / swing * np.sin(swing * turn + math.acos(damping))
    assert step_tests.Shape.of(ring, 0.0, 1.0, 1.0).overshoot == pytest.approx(
        math.exp(-math.pi * damping / swing), abs=1e-4
    )
    with pytest.raises(HubfocError, match="not followed"):
        step_tests.Shape.of(np.zeros(50), 0.0, 1.0, 1.0)


def recorded(current_q: Column, voltage: int = 0) -> measuring.Recording:
    """Return a recording of a step from 10 000 to 0, with this share of it left."""
    rows, before = len(current_q) + 40, 40
    values = {signal.name: np.zeros(rows, np.int64) for signal in addresses.signals()}
    values = {n: v for n, v in values.items() if n.startswith("fast_view.") and "theta" not in n}
    values["fast_view.i_q_reference_pu"][:before] = 10000
    values["fast_view.i_q_pu"][:before] = 10000
    values["fast_view.i_q_pu"][before:] = np.round(10000 * current_q)
    values["fast_view.u_q_pu"][:] = voltage
    return measuring.Recording((np.arange(rows) - before) / PWM_HZ, values)


def test_worst_difference_and_voltage_limit_are_found() -> None:
    """10 000 of 32 768 parts of 165 A; a sample beside the response by a tenth of the step."""
    drive = schema.load(cli.DEFAULT_CONFIG)
    full_a = drive.inverter.current_full_scale_a
    answer = 1.0 - continuous(160)
    found = step_tests.compared(recorded(answer), drive, BANDWIDTH_HZ, PWM_HZ)
    assert list(found.step_a) == pytest.approx([full_a * 10000 / 32768, 0.0])
    assert found.worst < 1e-4
    assert found.measured.rise_s == pytest.approx(found.expected.rise_s, rel=1e-3)
    assert not found.limited
    answer[7] += 0.1
    found = step_tests.compared(recorded(answer, 32767), drive, BANDWIDTH_HZ, PWM_HZ)
    assert found.worst == pytest.approx(0.1, abs=1e-3)
    assert found.worst_a == pytest.approx(0.1 * full_a * 10000 / 32768, rel=1e-2)
    assert found.limited


def measured(config: Path) -> dict[str, Any]:
    """Return the step of a wheel that drives with half of its torque."""
    with running(config=config) as vehicle, Client(vehicle.url) as page:
        history = vehicle.desk.history
        torque = history.places(["wheel0.motor_torque_nm"])
        until(lambda: vehicle.value("wheel0.mode") == 4)
        page.say(do="step", wheel=0)
        assert "accepted: while this wheel drives" in page.message("refused")["why"]
        page.say(do="drive", accelerator=0.5, brake=0.0, direction="forward")
        page.message("state")
        with Client(vehicle.url) as watcher:
            watcher.say(do="step", wheel=0)
            assert "this page watches" in watcher.message("refused")["why"]
        for _ in range(10):  # a slow machine does not hold the pedal all the time
            while history.latest(torque)[0] < 15.0:
                page.say(do="drive", accelerator=0.5, brake=0.0, direction="forward")
                page.message("state")
            page.say(do="step", wheel=0)
            found = page.message("step", "refused")
            if found["kind"] == "step":
                break
        assert found["kind"] == "step", found
        for _ in range(3):
            page.say(do="drive", accelerator=0.5, brake=0.0, direction="forward")
            page.message("state")
        assert abs(history.latest(torque)[0]) < 1.0  # until the pedal has been let go
    return found


def allowed(found: dict[str, Any]) -> float:
    """Return what the current may be beside the designed response, as a share of the step.

    2.5 %, the property test's bound for the loop with dead time and ripple
    (tests/property/test_step_response.cpp), and a code of the current converter.
    """
    first, last = map(float, found["step_a"])
    return 0.025 + float(found["code_a"]) / abs(first - last)


def test_a_virtual_wheel_without_iron_loss_answers_as_designed(tmp_path: Path) -> None:
    """Its parameters are the motor's, so the loop's answer is the designed one.

    A response designed for half the bandwidth is not within what is allowed: it is
    e^(-x/2) - e^(-x) off, a quarter of the step where x = 2 ln 2.
    """
    text = cli.DEFAULT_CONFIG.read_text(encoding="utf-8")
    changed = re.sub(r"(?m)^iron_loss_resistance_ohm = .*\n", "", text)
    assert changed != text
    config = tmp_path / "ironless.toml"
    config.write_text(changed, encoding="utf-8")
    found = measured(config)
    first, last = found["step_a"]
    assert first > 15.0
    assert abs(last) < 1.0
    assert found["worst"] <= allowed(found)
    assert found["measured"]["overshoot"] <= allowed(found)
    assert found["designed"]["overshoot"] == pytest.approx(0.0, abs=1e-9)
    rise_ms = 1e3 * math.log(9.0) / (2.0 * math.pi * BANDWIDTH_HZ)
    # The first of the straight lines between samples begins half a period before the lag.
    assert found["designed"]["rise_ms"] == pytest.approx(rise_ms, rel=0.04)
    assert found["measured"]["rise_ms"] == pytest.approx(rise_ms, rel=0.1)
    assert not found["limited"]
    curves = {curve["name"]: np.array(curve["values"]) for curve in found["curves"]}
    slower = step_tests.designed(curves["fast_view.i_q_reference_pu"], BANDWIDTH_HZ / 2.0, PWM_HZ)
    assert np.max(np.abs(curves["fast_view.i_q_pu"] - slower)) > 0.2 * first
    after = np.array(found["time_s"]) >= 0.0
    assert np.max(np.abs(curves["fast_view.i_d_pu"][after])) <= allowed(found) * first


def test_iron_loss_is_seen_as_a_current_that_the_design_does_not_have() -> None:
    """The resistance of the iron loss lies across the inductance (1.5 ohm at standstill).

    The voltage L di/dt of the designed response drives a current through it: at most that of the
    steepest period, (b - a b) of the step. The loop sees it two periods later.
    """
    drive = schema.load(cli.DEFAULT_CONFIG)
    motor = drive.motor
    b = math.exp(-math.pi * BANDWIDTH_HZ / PWM_HZ)
    assert motor.iron_loss_resistance_ohm is not None
    seconds = motor.q_inductance_h / motor.iron_loss_resistance_ohm[0]
    share = (b - b**3) * seconds * PWM_HZ
    found = measured(cli.DEFAULT_CONFIG)
    assert 0.5 * share < found["worst"] <= share + allowed(found)
