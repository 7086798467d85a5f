# SPDX-License-Identifier: Apache-2.0
"""The least bus capacitance, against energy balances and a bridge of six diodes."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from regen_table import bus_capacitor, cli, derived, schema
from regen_table.bus_capacitor import Starts
from regen_table.schema import Drive
from scipy.integrate import solve_ivp

PAPER = Path(__file__).resolve().parents[4] / "tools" / "motors" / "lu2013.toml"
Change = Callable[..., Drive]

DRIVES = ("lu2013", "ebike36v", "scooter48v", "ipm400v")
LONGEST_S = 5e-3
ROUNDED = 0.005  # of the current, at which a leg's voltage begins to reverse
ANGLES = np.linspace(0.0, math.pi / 3.0, 4, endpoint=False)  # six pulses in a turn


def drive_named(name: str) -> Drive:
    return schema.load(PAPER.with_name(f"{name}.toml"))


def with_capacitor(drive: Drive, farad: float) -> Drive:
    inverter = drive.inverter.model_copy(update={"bus_capacitance_f": farad})
    return drive.model_copy(update={"inverter": inverter})


def six_diodes_v(drive: Drive, farad: float, start: tuple[float, ...], angle: float) -> float:
    """Bus voltage after the three phases have charged it through one diode each.

    A leg's voltage is minus (v/2 + V_f) times the sign of its current, rounded near zero.
    """
    machine = bus_capacitor.coldest(drive)
    ohm = float(machine.resistance_ohm) + drive.inverter.diode_resistance_ohm
    psi, forward = float(machine.flux_wb), drive.inverter.diode_forward_voltage_v
    l_d, l_q = machine.d_inductance_h, machine.q_inductance_h
    w, d, q, bus = start
    zero = ROUNDED * math.hypot(d, q)

    def slopes(t: float, x: NDArray[np.float64]) -> list[float]:
        d, q, v = x
        turn = np.exp(1j * (angle + w * t))
        vector = (d + 1j * q) * turn
        phases = [(vector * np.exp(-2j * math.pi * k / 3.0)).real for k in range(3)]
        signs = [i / math.hypot(i, zero) for i in phases]
        legs = -(0.5 * v + forward) * np.array(signs)
        shift = np.exp(2j * math.pi * np.arange(3) / 3.0)
        u = 2.0 / 3.0 * np.sum(legs * shift) / turn
        charging = 0.5 * sum(s * i for s, i in zip(signs, phases, strict=True))
        return [
            (u.real - ohm * d + w * l_q * q) / l_d,
            (u.imag - ohm * q - w * (l_d * d + psi)) / l_q,
            charging / farad,
        ]

    found = solve_ivp(
        slopes, (0.0, LONGEST_S), [d, q, bus], "LSODA", rtol=1e-5, atol=1e-4, max_step=5e-5
    )
    return float(found.y[2][-1])


@pytest.mark.parametrize("name", DRIVES)
def test_bus_after_the_worst_starts_is_that_of_six_diodes(name: str) -> None:
    """At the drive's own rating: at most 1 % below the three phases, at most 9 % above."""
    drive = drive_named(name)
    least = bus_capacitor.least_capacitance_f(drive)
    assert least is not None
    for starts in (
        bus_capacitor.braking_starts(drive, least),
        bus_capacitor.conducting_starts(drive),
    ):
        if not len(starts.bus_v):
            continue
        averaged = bus_capacitor.highest_bus_v(drive, least, starts)
        for k in np.argsort(averaged)[-1:]:
            start = tuple(
                float(x[k]) for x in (starts.speed_rad_s, starts.d_a, starts.q_a, starts.bus_v)
            )
            phases = max(six_diodes_v(drive, least, start, angle) for angle in ANGLES)
            assert 0.99 * phases < averaged[k] < 1.09 * phases, (start, phases, averaged[k])


def test_currents_of_a_motor_that_hardly_turns_leave_their_energy_in_the_capacitor(
    change: Change,
) -> None:
    """C/2 (v^2 - v0^2) = 3/4 L i^2 without resistances, drops and EMF."""
    drive = change(
        {
            "motor.phase_resistance_ohm": 1e-5,
            "inverter.diode_resistance_ohm": 0.0,
            "inverter.diode_forward_voltage_v": 0.0,
        }
    )
    one = np.ones(3)
    starts = Starts(
        1e-3 * one, np.array([-75.0, 0.0, -45.0]), np.array([0.0, -75.0, 60.0]), 50 * one
    )
    found = bus_capacitor.highest_bus_v(drive, 5e-4, starts)
    assert found == pytest.approx(math.sqrt(50.0**2 + 1.5 * 76e-6 * 75.0**2 / 5e-4), rel=2e-3)


def test_capacitor_settles_at_the_emf_without_currents(change: Change) -> None:
    """With 2 ohm in the phases the current does not swing: sqrt(3) E - 2 V_f."""
    drive = change({})
    motor = drive.motor.model_copy(update={"phase_resistance_ohm": 2.0})  # no file may have it
    drive = drive.model_copy(update={"motor": motor})
    w = derived.omega_max(drive)
    starts = Starts(np.array([w]), np.array([-1e-3]), np.array([-1.0]), np.array([40.0]))
    (settled,) = bus_capacitor.highest_bus_v(drive, 2e-4, starts)
    assert settled == pytest.approx(derived.line_emf_v(drive) - 1.6, abs=0.01)


@pytest.mark.parametrize("name", DRIVES)
def test_least_capacitance_just_keeps_the_rating(name: str) -> None:
    drive = drive_named(name)
    least, rating = bus_capacitor.least_capacitance_f(drive), drive.inverter.device_voltage_v
    assert least is not None
    assert rating is not None
    assert bus_capacitor.worst_bus_v(drive, least) < rating
    assert bus_capacitor.worst_bus_v(drive, 0.99 * least) > rating
    # More room above the trip takes less, and never more.
    inverter = drive.inverter.model_copy(update={"device_voltage_v": 1.05 * rating})
    larger = bus_capacitor.least_capacitance_f(drive.model_copy(update={"inverter": inverter}))
    assert larger is not None
    assert larger < 0.95 * least


def test_braking_starts_are_inside_the_limits_of_the_drive() -> None:
    """Torque, power, phase current and the voltage of a full pack; trip and two periods of power.

    ipm400v: 60 kW in 200 us are 12 J, which raise 0.5 mF from 423 to 477.6 V without any loss.
    """
    drive = drive_named("ipm400v")
    starts = bus_capacitor.braking_starts(drive, 5e-4)
    motor, machine = drive.motor, bus_capacitor.coldest(drive)
    w, d, q, psi = starts.speed_rad_s, starts.d_a, starts.q_a, float(machine.flux_wb)
    torque = -1.5 * 3 * (psi * q + (0.37e-3 - 1.2e-3) * d * q)
    assert np.all(np.hypot(d, q) <= 200.0 * (1.0 + 1e-9))
    assert np.all(torque <= motor.max_torque_nm * (1.0 + 1e-9))
    assert np.all(torque * w / 3.0 <= motor.max_power_w * (1.0 + 1e-9))
    volts = w * np.hypot(1.2e-3 * q, psi + 0.37e-3 * d)
    assert np.all(volts <= 403.0 / math.sqrt(3.0) * (1.0 + 1e-9))
    assert np.all(starts.bus_v >= derived.overvoltage_trip_v(drive))
    assert 470.0 < np.max(starts.bus_v) < 477.6
    # Both the torque limit and the current limit are among them.
    assert np.max(torque) > 0.99 * motor.max_torque_nm
    assert np.max(np.hypot(d, q)) == pytest.approx(200.0)


def test_diodes_conduct_only_above_the_voltage_of_an_empty_pack() -> None:
    for name in ("ebike36v", "scooter48v"):
        assert len(bus_capacitor.conducting_starts(drive_named(name)).bus_v) == 0
    drive = drive_named("lu2013")
    starts = bus_capacitor.conducting_starts(drive)
    # Kirchhoff: (R + R_ak) i and 2/pi (v + 2 V_f) in phase, w L i across; four wheels in 12 mOhm.
    current = np.hypot(starts.d_a, starts.q_a)
    ohm = float(bus_capacitor.coldest(drive).resistance_ohm) + 0.005
    in_phase = ohm * current + 2.0 / math.pi * (starts.bus_v + 1.6)
    emf = 0.0204 * starts.speed_rad_s
    assert np.hypot(in_phase, starts.speed_rad_s * 76e-6 * current) == pytest.approx(emf, rel=1e-5)
    assert starts.bus_v == pytest.approx(40.0 + 0.048 * 3.0 / math.pi * current, rel=1e-6)


def test_a_capacitor_too_small_is_one_warning_with_the_least_value() -> None:
    drive = drive_named("lu2013")
    least = bus_capacitor.least_capacitance_f(drive)
    assert least is not None
    line = bus_capacitor.warning(with_capacitor(drive, 1e-3))
    assert line is not None
    assert line.startswith("inverter.bus_capacitance_f: 0.001 F")
    assert "device_voltage_v = 75 V" in line
    assert f"at least {least / 0.8:.4g} F" in line
    assert "\n" not in line
    assert bus_capacitor.warning(with_capacitor(drive, least / 0.8 * 1.01)) is None
    assert bus_capacitor.warning(with_capacitor(drive, least / 0.8 * 0.99)) is not None


def test_what_is_not_known_gives_no_warning_here(change: Change) -> None:
    assert bus_capacitor.warning(change({"inverter.bus_capacitance_f": None})) is None
    assert bus_capacitor.warning(change({"inverter.device_voltage_v": None})) is None


def test_devices_below_the_emf_are_beyond_any_capacitor(change: Change) -> None:
    drive = change({"motor.max_speed_rpm": 830.0, "control.field_weakening_current_a": 75.0,
                    "battery.min_voltage_v": 52.0})  # fmt: skip
    assert 1.1 * derived.line_emf_v(drive) > 76.0
    assert bus_capacitor.least_capacitance_f(drive) is None
    assert "no value keeps below it" in str(bus_capacitor.warning(drive))


@pytest.mark.parametrize("name", DRIVES)
def test_every_shipped_drive_keeps_its_rating_with_four_fifths_of_its_capacitor(name: str) -> None:
    assert bus_capacitor.warning(drive_named(name)) is None


def test_generate_prints_the_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = PAPER.read_text(encoding="utf-8")
    small = tmp_path / "small.toml"
    small.write_text(text.replace("bus_capacitance_f = 2.46e-3", "bus_capacitance_f = 1e-3"))
    assert cli.main(["generate", str(small), "--output", str(tmp_path)]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert [line for line in lines if "bus_capacitance_f" in line] == [
        f"{small}: warning: {bus_capacitor.warning(schema.load(small))}"
    ]
