# SPDX-License-Identifier: Apache-2.0
"""No demand: the least torque that physics allows, at any speed, with and without a battery."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hubsim import run
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep import cases, drives
from regen_table import models
from studies import least_torque
from studies.coast import runs as coast
from studies.least_torque import FREEWHEEL, PWM, SHORT, State

COUNT, SEED = 80, 9  # the whole study, with --full, has more
SPEED_SHARES = (0.15, 0.4, 0.6, 0.8, 0.95)  # of the EMF limit, at most of the largest speed
RECORD_S = 1e-4
BRIDGE_SHORT = 2.0
LONGEST_SHORT_MS = 40  # the current that circles decays in 31 ms
SETTLED_MS = 200
SETTLED_SHORT_NM = 1.3  # of 0.9 to 1.1 N m: R, and 85 % of the speed
SMALL_F = 0.15e-3


def test_a_vehicle_without_a_demand_has_no_more_torque_than_it_must() -> None:
    found = cases.measured(coast.measure, coast.draw(drives.DRIVES, COUNT, SEED), workers=1)
    assert [outcome for outcome in found if not outcome.within] == []
    assert any(outcome.warning == "OVERSPEED" for outcome in found)


@pytest.mark.parametrize("volts", [41.4, 44.2, 45.2])
def test_diodes_that_conduct_in_pulses_let_go_as_soon_as_pwm_can(volts: float) -> None:
    """Just above the EMF limit they lift the bus by half of what the averaged bridge does."""
    case = coast.Case("lu2013", 64.9, 4.0, 0.5, volts, coast.COAST, math.inf)
    found = coast.measure(0, case, edges=True)
    assert found.warning == "OVERSPEED"
    assert found.within, found


def state(drive: str, speed_rad_s: float, source_v: float, connected: bool = True) -> State:
    charge_a = drives.drive_named(drive).battery.max_charge_current_a
    return State(speed_rad_s, source_v, source_v, 25.0, charge_a, connected)


def test_feasible_minimum_of_the_paper_s_motor_by_hand() -> None:
    """640 r/min = 67.0 rad/s: w = 1541/s, E = 31.4 V, w L = 0.117 ohm, R = 0.034 ohm."""
    drive = drives.drive_named("lu2013")
    # 75 A of i_d leave 22.7 and 2.6 V: 22.85 V of 0.509 v, 44.9 V. Above it zero torque is there,
    # within 1.7 % below it only braking, up to 75 A sin(atan(R / w L)) or 15 N m.
    assert least_torque.least(drive, state("lu2013", 67.0, 45.3)) == least_torque.Least(0.0, PWM)
    found = least_torque.least(drive, state("lu2013", 67.0, 44.3))
    assert found.way == PWM
    assert 0.0 < found.torque_nm < 15.0
    # At 43 V no current holds the EMF, and the diodes conduct: beyond (43 + 1.6) V / sqrt(3).
    assert least_torque.least(drive, state("lu2013", 67.0, 43.0)).way == FREEWHEEL
    torque, current, charging, bus = least_torque.freewheel(drive, state("lu2013", 67.0, 43.0))
    assert charging == pytest.approx(math.sqrt(3.0) / 2.0 * current, rel=1e-6)
    assert bus == pytest.approx(43.0 + 0.048 * charging, abs=1e-6)
    # Kirchhoff: R and bus in phase with the current, w L |i| across it, the EMF over both.
    in_phase = 0.0343 * current + (bus + 1.6) / math.sqrt(3.0)
    assert math.hypot(in_phase, 0.117 * current) == pytest.approx(31.4, rel=0.01)
    # Power: what the EMF gives is what phase resistance and bus take.
    assert torque * 67.0 == pytest.approx(1.5 * in_phase * current, rel=0.01)
    # Without a battery the capacitors settle at the EMF: sqrt(3) 31.4 V less two drops.
    alone = least_torque.freewheel(drive, state("lu2013", 67.0, 43.0, connected=False))
    assert alone[:3] == (0.0, 0.0, 0.0)
    assert alone[3] == pytest.approx(52.8, abs=0.2)


def test_short_circuit_is_the_way_of_a_salient_motor_beyond_its_field_weakening() -> None:
    """ipm400v at its largest speed and 200 V, weak magnets: psi / L_d = 178 A are admissible."""
    drive = drives.drive_named("ipm400v")
    torque, current = least_torque.short(drive, state("ipm400v", 1152.0, 200.0))
    assert torque == pytest.approx(0.9, abs=0.15)
    assert current == pytest.approx(178.0, rel=0.01)
    # On 100 V PWM has no voltage for any torque but little, and the diodes would brake with more.
    bare = State(1152.0, 100.0, 100.0, 25.0, 0.0, True)
    assert least_torque.least(drive, bare).torque_nm <= torque
    assert least_torque.freewheel(drive, bare)[0] > 10.0 * torque
    # Without a battery the open bridge brakes least, as long as the switches stand the EMF.
    assert least_torque.least(drive, replace(bare, connected=False)) == least_torque.Least(
        0.0, FREEWHEEL
    )
    faster = replace(bare, speed_rad_s=2500.0, connected=False)
    assert least_torque.least(drive, faster).way == SHORT


@pytest.mark.parametrize("name", drives.DRIVES)
def test_bridge_closes_without_a_bump_on_a_demand(name: str) -> None:
    """The bridge of a coasting wheel, a braking and a driving demand of a fifth of rated.

    From the step of the demand on the torque is the command's straight line within 2 % of rated,
    but for the iron drag that the open bridge left to the wheel, which goes within 5 ms.
    """
    drive = drives.drive_named(name)
    rated, wheels = drive.motor.rated_torque_nm, drive.vehicle.driven_wheels
    top = drive.motor.max_speed_rpm * math.pi / 30.0
    for share in SPEED_SHARES:
        speed = min(share * top, 0.88 * share_of_emf(name))
        for demand, sign in (("driver.brake_demand_nm", -1.0), ("driver.drive_demand_nm", 1.0)):
            scenario = Scenario(
                initial_speed_kmh=3.6 * speed * drive.vehicle.wheel_radius_m,
                max_duration_s=1.0,
                record_interval_s=RECORD_S,
                plant={"bus.capacitance_f": wheels * drive.inverter.bus_capacitance_f},
            )
            engine, _ = run.prepare(drive, scenario, Path(), {})
            with engine:
                stops.as_one_wheel(engine, drive)
                engine.start()
                engine.choose(("wheel0.motor_torque_nm", "wheel0.speed_rad_per_s", "wheel0.bridge"))
                before = engine.run(0.3)
                engine.set(demand, 0.2 * rated)
                after = engine.run(0.05)
            assert before[-1, 2] == 0, (name, share)
            drag = least_torque.iron_drag_nm(drive, before[-1:, 1])[0]
            assert before[-1, 0] == pytest.approx(-drag, abs=0.02 * rated + 0.02 * drag)
            closed = int(np.argmax(after[:, 2] == 1))
            assert closed * RECORD_S <= 0.002
            # Never beyond what lies between the drag and the ramp.
            ramp = sign * np.minimum(
                (np.arange(len(after)) + 10) * RECORD_S * drive.control.torque_rate_nm_per_s,
                0.2 * rated,
            )
            late = ramp - sign * 0.003 * drive.control.torque_rate_nm_per_s
            low = np.minimum(np.minimum(ramp, late), 0.0)
            high = np.maximum(np.maximum(ramp, late), 0.0)
            torque = after[:, 0]
            open_nm = np.where(np.arange(len(after)) * RECORD_S < 0.005, drag, 0.0)
            bump = np.max(np.maximum(low - open_nm - torque, torque - high))
            assert bump <= 0.02 * rated, (name, share, sign, bump)


@pytest.mark.parametrize(
    ("capacitance_f", "shares"),
    [
        (0.5e-3, (0.85, 0.92, 1.0, 1.1)),
        (0.25e-3, (0.92, 1.05)),
        (SMALL_F, (0.85, 0.92, 1.0)),
    ],
)
def test_short_circuit_is_left_once_and_within_the_devices(
    monkeypatch: pytest.MonkeyPatch, capacitance_f: float, shares: tuple[float, ...]
) -> None:
    """A contactor opens while ipm400v brakes with all it has: its over-voltage trip shorts it.

    Speeds from 85 to 110 % of the largest, an empty to a full battery, and so buses from 400 to 560
    V in the short circuit; its own capacitor, half and a third of it, which a short circuit that
    ends without a look at its energy raises to 783 V of 650, and with a look at the present energy
    alone, of a current that circles between 40 and 340 A, to 664 V. The smallest does not take the
    energy of the settled 178 A at any instant: then the short circuit stays.
    """
    drive = drives.drive_named("ipm400v")
    inverter = drive.inverter.model_copy(update={"bus_capacitance_f": capacitance_f})
    small = drive.model_copy(update={"inverter": inverter})
    monkeypatch.setattr(drives, "drive_named", lambda _name: small)
    top_kmh = 3.6 * drive.motor.max_speed_rpm * math.pi / 30.0 * drive.vehicle.wheel_radius_m
    monkeypatch.setattr(coast, "SIGNALS", (*coast.SIGNALS, "wheel0.current_d_a"))
    rating_v = inverter.device_voltage_v
    assert rating_v is not None
    cut_s, shorted = 0.45, 0
    for share in shares:
        for soc in (0.0, 0.1, 0.2, 0.4, 0.6, 0.8):
            volts = models.open_circuit_voltage_v(drive, soc)
            case = coast.Case("ipm400v", share * top_kmh, 0.0, soc, volts, coast.BRAKE, cut_s)
            rows = coast.simulated(small, case)
            after = rows[rows[:, coast.TIME] > cut_s]
            short = after[:, coast.BRIDGE] >= BRIDGE_SHORT
            entries = int(short[0]) + int(np.sum(np.diff(short.astype(int)) == 1))
            assert entries <= 1, (share, soc)
            if not entries:
                continue  # the diodes take over at once: the other tests
            bus = np.max(after[:, coast.BUS])
            assert bus < rating_v, (share, soc)
            assert after[-1, coast.FAULT] == 0.0
            shorted += entries
            if short[-1]:
                assert capacitance_f == SMALL_F, (share, soc)
                settled = after[SETTLED_MS:, coast.TORQUE]
                assert np.max(np.abs(settled)) < SETTLED_SHORT_NM, (share, soc)
                continue
            left = int(np.max(np.flatnonzero(short), initial=0)) + 2  # the diodes' last current
            assert left < LONGEST_SHORT_MS, (share, soc)
            drag = least_torque.iron_drag_nm(drive, after[left:, coast.SPEED])
            assert np.all(np.abs(after[left:, -1]) < 1.0), (share, soc)
            assert np.max(np.abs(after[left:, coast.TORQUE]) - drag) < 0.5, (share, soc)
    assert shorted >= 5


def share_of_emf(name: str) -> float:
    """Return the speed of the wheel at which the EMF reaches the drive's own open bus, rad/s."""
    drive = drives.drive_named(name)
    voltage = drive.battery.open_circuit_voltage_v
    volts = voltage if isinstance(voltage, float | int) else voltage[0][1]
    return volts / math.sqrt(3.0) / drive.motor.flux_linkage_wb / drive.motor.pole_pairs
