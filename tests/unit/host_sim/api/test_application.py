# SPDX-License-Identifier: Apache-2.0
"""The whole application in every wheel: copies that know nothing of each other, and its faults."""

from pathlib import Path

import numpy as np
import pytest
from hubsim import cli, engine, run, scenario
from hubsim.engine import Engine
from hubsim.errors import HubsimError
from hubsim.run.results import RunResult
from hubsim.scenario import overrides

SIGNALS = ("time_s", "wheel*.mode", "wheel*.hydraulic_valid", "wheel*.bridge",
           "wheel*.motor_torque_nm")  # fmt: skip
CYCLE_S = 0.010  # of Demand, and of WheelBrake
SPEED_M_PER_S = 40.0 / 3.6
BRIDGE_PWM = 1
BROKEN_S = 1.0
STOP = """
description = "a stop in which the third wheel gets a fault"
initial_speed_kmh = 40.0
demand_nm = 40.0
stop_at_standstill = true
max_duration_s = 20.0
record_interval_s = 0.001
"""
FAULT = f"""
[events.broken]
at_s = {BROKEN_S}
set = {{ "fault.wheels" = 4, "fault.NAME" = VALUE }}
"""


def simulated(path: Path, text: str, *given: str, board: bool = True) -> RunResult:
    (path / "run.toml").write_text(text, encoding="utf-8")
    settings = overrides.parse(list(given))
    title, chosen, beside = scenario.load(str(path / "run.toml"), settings.scenario)
    drive = overrides.load_drive(cli.DEFAULT_CONFIG, settings, chosen)
    return run.simulate(
        title, drive, chosen, beside, SIGNALS, settings.plant,
        application=engine.application_path() if board else None,
    )  # fmt: skip


def with_fault(path: Path, name: str, value: float = 1.0) -> RunResult:
    return simulated(path, STOP + FAULT.replace("NAME", name).replace("VALUE", str(value)))


def after_fault(result: RunResult, signal: str, wheel: int = 2) -> np.ndarray:
    return result.signal(f"wheel{wheel}.{signal}")[result.signal("time_s") > BROKEN_S]


def test_a_stop_is_that_of_the_two_steps_but_for_the_messages_delay(tmp_path: Path) -> None:
    """CAN makes demand and command a cycle older each: so much way at full speed, and its share."""
    direct, through = (simulated(tmp_path, STOP, board=board) for board in (False, True))
    late_m = 2.0 * CYCLE_S * SPEED_M_PER_S
    assert 0.0 < through.distance_m - direct.distance_m < late_m
    shares = [r.account_j["energy.chemical_j"] / r.kinetic_energy_j for r in (direct, through)]
    assert shares[0] < -0.5
    assert shares[1] == pytest.approx(shares[0], abs=late_m / direct.distance_m)


def test_the_same_run_gives_the_same_bytes(tmp_path: Path) -> None:
    assert simulated(tmp_path, STOP).rows.tobytes() == simulated(tmp_path, STOP).rows.tobytes()


def test_a_restart_concerns_one_copy_alone(tmp_path: Path) -> None:
    """Frames count as lost for a moment, then the wheel brakes with its motor again."""
    result = with_fault(tmp_path, "restart")
    for wheel in (0, 1, 3):
        assert set(after_fault(result, "bridge", wheel)) == {BRIDGE_PWM}
        assert set(after_fault(result, "hydraulic_valid", wheel)) == {1}
    assert set(after_fault(result, "hydraulic_valid")) == {0, 1}
    assert len(set(after_fault(result, "mode"))) > 1
    assert after_fault(result, "motor_torque_nm")[1000] == pytest.approx(
        after_fault(result, "motor_torque_nm", 1)[1000], rel=0.01
    )


@pytest.mark.parametrize("name", ["slow_stopped", "fast_stopped", "slow_doubled", "fast_doubled"])
def test_a_program_that_goes_wrong_leaves_its_bridge_open(tmp_path: Path, name: str) -> None:
    """From the watchdog on, 30 ms at most, until the end: it restarts the core again and again."""
    result = with_fault(tmp_path, name)
    assert set(after_fault(result, "bridge")[50:]) == {0}
    assert set(after_fault(result, "bridge", 1)) == {BRIDGE_PWM}


def test_unsent_frames_hand_over_and_a_loaded_bus_does_not(tmp_path: Path) -> None:
    """At 95 % a frame takes 5.4 ms: the two most urgent go, a little later than every 10 ms."""
    for name, value, given in (("can_unsent", 1.0, {0}), ("can_load", 1.0, {0}),
                               ("can_load", 0.95, {1})):  # fmt: skip
        result = with_fault(tmp_path, name, value)
        assert set(after_fault(result, "hydraulic_valid")[200:]) == given


def test_what_does_not_go_together_is_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(
        HubsimError, match=r"fault\.can_unsent and fault\.can_load: accepted: 0 wit"
    ):
        simulated(tmp_path, STOP, "plant.fault.can_load=0.5", board=False)
    for name in ("slow_late", "fast_late", "state_bit", "config_bit"):
        with pytest.raises(HubsimError, match="accepted: 0 with the whole application"):
            with_fault(tmp_path, name)
    vehicle = Engine()
    vehicle.attach_application(engine.application_path())
    with pytest.raises(HubsimError, match="accepted: once, before hubsim_start"):
        vehicle.attach_application(engine.application_path())
    with pytest.raises(HubsimError, match="No such file"):
        Engine().attach_application(tmp_path / "none.so")
    settings = overrides.parse([])
    title, chosen, beside = scenario.load("pedal_series", settings.scenario)
    drive = overrides.load_drive(cli.DEFAULT_CONFIG, settings, chosen)
    with pytest.raises(HubsimError, match="accepted: a configuration without wired pedals"):
        run.simulate(title, drive, chosen, beside, SIGNALS, application=engine.application_path())


def test_another_library_is_no_application(tmp_path: Path) -> None:
    (tmp_path / "text.so").write_text("no library", encoding="utf-8")
    for path, why in ((tmp_path / "text.so", "not a library that this machine can load"),
                      (engine.library_path(), "not an application of the sources")):  # fmt: skip
        settings = overrides.parse([])
        title, chosen, beside = scenario.load("stop", settings.scenario)
        drive = overrides.load_drive(cli.DEFAULT_CONFIG, settings, chosen)
        with pytest.raises(HubsimError, match=why):
            run.simulate(title, drive, chosen, beside, SIGNALS, application=path)
