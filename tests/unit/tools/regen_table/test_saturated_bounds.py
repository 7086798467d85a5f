# SPDX-License-Identifier: Apache-2.0
"""What monitor and safe state believe of iron that saturates contains what the iron does.

The firmware holds three constants of a flux map. The true values are those of the law that the map
was sampled from, or of the measured map itself: steady states by their circuit equations, energies
by the field energy of the law or by the integral of i dpsi in small steps.
"""

import dataclasses
import functools
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cffi
import numpy as np
import numpy.typing as npt
import pytest
from regen_table import flux_constants, flux_files, flux_map, image, schema
from regen_table.flux_map import FluxMap

Array = npt.NDArray[np.float64]
Flux = Callable[[Array, Array], tuple[Array, Array]]
Energy = Callable[[float, float], float]
Library = Any  # of cffi
Firmware = tuple[Any, Library]
ROOT = Path(__file__).resolve().parents[4]
MEASURED = Path(__file__).parent / "motulator" / "baldor_400rpm_map.npz"
SHARES = np.geomspace(0.02, 1.1, 16)  # of the largest speed
# Of the true value, where resistance and saliency decide: of a measured motor whose L_q falls from
# 139 to 32 mH, one number for which is too small at low currents, and of drawn ones.
BELOW_MEASURED, BELOW_DRAWN = 0.86, 0.97
ABOVE = 1.35
FORCED_BUS = 1.2  # of the voltage that the weakened flux needs
# Of what the bus takes up to the rating: half as much again comes from the EMF, and the firmware
# counts twice 1/2 L i^2 up to 15/16 of the rating, hence 0.29 with L as it is held; L_q falls.
ENERGY, REFUSED = 2.0 / 3.0, 0.15
STEPS = 60  # of Newton's method, at most


@dataclasses.dataclass(frozen=True, eq=False)
class Motor:
    """A motor with its map, and what its iron truly does: fluxes of currents, field energy."""

    kind: str
    pole_pairs: int
    resistance_ohm: float
    current_a: float
    weakening_a: float
    fastest_rad_s: float
    bus_v: float
    stored: FluxMap
    flux: Flux
    energy_j: Energy
    below: float


@dataclasses.dataclass(frozen=True)
class Law:
    """i_d = psi_d/L_d + k psi_d |psi|^n less the magnets' current, likewise i_q: of one energy."""

    psi_wb: float
    d_h: float
    q_h: float
    knee_wb: float
    power: float

    def currents(self, psi_d: Array, psi_q: Array) -> tuple[Array, Array]:
        more = (np.hypot(psi_d, psi_q) / self.knee_wb) ** self.power / self.q_h
        magnets = self.psi_wb * (
            1 / self.d_h + (self.psi_wb / self.knee_wb) ** self.power / self.q_h
        )
        return psi_d * (1 / self.d_h + more) - magnets, psi_q * (1 / self.q_h + more)

    def field_j(self, psi_d: float, psi_q: float) -> float:
        n, amount = self.power, float(np.hypot(psi_d, psi_q))
        magnets = self.currents(np.array(0.0), np.array(0.0))[0]
        iron = amount**2 * (amount / self.knee_wb) ** n / self.q_h / (n + 2.0)
        own = psi_d**2 / 2 / self.d_h + psi_q**2 / 2 / self.q_h + iron
        return float(own + magnets * psi_d)

    def flux(self, i_d: Array, i_q: Array) -> tuple[Array, Array]:
        """Return the fluxes of currents, by Newton's method with limited steps."""
        i_d, i_q = np.broadcast_arrays(np.asarray(i_d, float), np.asarray(i_q, float))
        psi_d, psi_q = np.full(i_d.shape, self.psi_wb), np.zeros(i_d.shape)
        h = 1e-7 * self.psi_wb
        for _ in range(STEPS):
            at = self.currents(psi_d, psi_q)
            by_d, by_q = self.currents(psi_d + h, psi_q), self.currents(psi_d, psi_q + h)
            a, c = ((by_d[k] - at[k]) / h for k in (0, 1))
            b, d = ((by_q[k] - at[k]) / h for k in (0, 1))
            f, g = at[0] - i_d, at[1] - i_q
            step_d, step_q = (d * f - b * g) / (a * d - b * c), (a * g - c * f) / (a * d - b * c)
            share = np.minimum(1.0, 0.3 * self.psi_wb / np.maximum(np.hypot(step_d, step_q), h))
            psi_d, psi_q = psi_d - share * step_d, psi_q - share * step_q
            if np.max(np.hypot(step_d, step_q)) < 1e-10 * self.psi_wb:
                break
        return psi_d, psi_q

    def energy_j(self, i_d: float, i_q: float) -> float:
        psi_d, psi_q = self.flux(np.array(i_d), np.array(i_q))
        return self.field_j(float(psi_d), float(psi_q)) - self.field_j(self.psi_wb, 0.0)


def drawn(drive: schema.Drive, rng: np.random.Generator) -> Motor:
    """Return a drive's motor with iron of which the magnets saturate some or much."""
    motor = drive.motor
    knee, power = rng.uniform(1.1, 2.0), rng.uniform(2.0, 5.0)
    straight = min(1.0 + knee**-power, 4.0)
    law = Law(
        motor.flux_linkage_wb,
        motor.d_inductance_h * straight,
        motor.q_inductance_h * straight,
        knee * motor.flux_linkage_wb,
        power,
    )
    return sampled(drive, law)


def sampled(drive: schema.Drive, law: Law) -> Motor:
    """Return a drive's motor of a law, with a map of it up to the drive's current."""
    motor = drive.motor
    most = motor.max_phase_current_a
    axis_d, axis_q = np.linspace(-1.3, 0.4, 41) * most, np.linspace(-1.0, 1.0, 41) * most
    fluxes = law.flux(axis_d[:, np.newaxis], axis_q[np.newaxis, :])
    return Motor(
        motor.type,
        motor.pole_pairs,
        motor.phase_resistance_ohm,
        most,
        drive.control.field_weakening_current_a or 0.0,
        motor.max_speed_rpm * np.pi / 30.0 * motor.pole_pairs,
        drive.battery.max_voltage_v,
        FluxMap(axis_d, axis_q, *fluxes),
        law.flux,
        law.energy_j,
        BELOW_DRAWN,
    )


def hub() -> Motor:
    """Return the paper's motor with more inductance, which falls to two thirds at full current."""
    drive = schema.load(ROOT / "tools" / "motors" / "lu2013.toml")
    return sampled(drive, Law(0.0204, 0.9e-3, 0.9e-3, 0.0204, 3.0))


def measured() -> Motor:
    """Return motulator's 5.6 kW motor: 4 poles, 370 V, 14 A, as its map says."""
    found, _ = flux_files.load(MEASURED)

    def energy_j(i_d: float, i_q: float) -> float:
        share = np.linspace(0.0, 1.0, 2001)
        psi_d, psi_q = flux_map.extended_wb(found, share * i_d, share * i_q)
        mean = 0.5 * (share[1:] + share[:-1])
        return float(np.sum(mean * (i_d * np.diff(psi_d) + i_q * np.diff(psi_q))))

    def flux(i_d: Array, i_q: Array) -> tuple[Array, Array]:
        return flux_map.extended_wb(found, i_d, i_q)

    speed = 2.0 * 3000.0 * np.pi / 30.0
    return Motor("ipmsm", 2, 0.63, 20.0, 20.0, speed, 600.0, found, flux, energy_j, BELOW_MEASURED)


@pytest.fixture(scope="module")
def motors(random_drives: list[schema.Drive]) -> list[Motor]:
    rng = np.random.default_rng(34)
    return [measured(), hub(), *(drawn(drive, rng) for drive in random_drives[::10])]


@pytest.fixture(scope="module")
def firmware(tmp_path_factory: pytest.TempPathFactory, firmware_library: str) -> Firmware:
    library = tmp_path_factory.mktemp("bounds") / "bounds.so"
    folders = [
        f"-I{ROOT / 'firmware' / name / 'include'}" for name in ("core", "config", "monitor")
    ]
    source = Path(__file__).parent / "saturated_bounds.c"
    command = ["cc", "-std=c11", "-shared", "-fPIC", *folders, str(source), firmware_library]
    subprocess.run([*command, f"-Wl,-rpath,{Path(firmware_library).parent}", "-o", str(library)],
                   check=True)  # fmt: skip
    ffi: Any = cffi.FFI()
    ffi.cdef("""
        typedef struct {
            int32_t pole_pairs, resistance_uOhm, flux_nWb, d_nH, q_nH, most_mA, weakening_mA;
            int32_t device_mV, bus_nF;
        } motor_t;
        typedef struct { int32_t torque_mNm, current_mA, charging_mA, bus_mV; } steady_state_t;
        void hold(const void *image, const motor_t *motor);
        steady_state_t shorted(int32_t speed_mrad_s);
        int quiet(int32_t speed_mrad_s, int32_t bus_mV);
        int forced(int32_t speed_mrad_s, int32_t bus_mV);
        int may_open(int32_t d_mA, int32_t q_mA, int32_t bus_mV);
    """)
    return ffi, ffi.dlopen(str(library))


def set_up(firmware: Firmware, raw: bytes, motor: Motor, bus_f: float = 1e-3) -> Library:
    """Return the firmware with the constants that the generator makes of the motor's map."""
    ffi, library = firmware
    keys = {"type": motor.kind, "pole_pairs": motor.pole_pairs, "flux_map": "some",
            "max_phase_current_a": motor.current_a}  # fmt: skip
    constants = flux_constants.bounds(keys, motor.stored)
    fields = {
        "pole_pairs": motor.pole_pairs,
        "resistance_uOhm": round(motor.resistance_ohm * 1e6),
        "flux_nWb": round(constants.flux_linkage_wb * 1e9),
        "d_nH": round(constants.d_inductance_h * 1e9),
        "q_nH": round(constants.q_inductance_h * 1e9),
        "most_mA": round(motor.current_a * 1e3),
        "weakening_mA": round(motor.weakening_a * 1e3),
        "device_mV": round(1.3e3 * motor.bus_v),
        "bus_nF": round(bus_f * 1e9),
    }
    library.hold(ffi.from_buffer(raw), ffi.new("motor_t *", fields))
    return library


@functools.cache
def way_of_short_circuit(motor: Motor) -> tuple[Array, Array]:
    """Return currents in A of a short circuit and omega/R of each: R i = -j omega psi(i).

    At an angle of the current the length is that at which it is across the flux, by halving.
    """
    angle = np.linspace(0.5 * np.pi, np.pi, 240)
    shortest, longest = np.zeros_like(angle), np.full_like(angle, 100.0 * motor.current_a)
    for _ in range(45):
        middle = 0.5 * (shortest + longest)
        i_d, i_q = middle * np.cos(angle), middle * np.sin(angle)
        psi_d, psi_q = motor.flux(i_d, i_q)
        beyond = i_d * psi_d + i_q * psi_q > 0.0
        longest, shortest = np.where(beyond, middle, longest), np.where(beyond, shortest, middle)
    return longest, longest / np.maximum(np.hypot(psi_d, psi_q), 1e-12)


def short_circuit(motor: Motor, omega: float) -> tuple[float, float]:
    """Return current in A and braking torque in N m."""
    currents, per_ohm = way_of_short_circuit(motor)
    current = float(np.interp(omega / motor.resistance_ohm, per_ohm, currents))
    return current, 1.5 * motor.resistance_ohm * current**2 * motor.pole_pairs / omega


@pytest.fixture(scope="module")
def raw() -> bytes:
    return image.build(schema.load(ROOT / "tools" / "motors" / "lu2013.toml"))


def test_short_circuit_is_never_weaker_than_held(
    firmware: Firmware, raw: bytes, motors: list[Motor]
) -> None:
    for motor in motors:
        library = set_up(firmware, raw, motor)
        for omega in SHARES * motor.fastest_rad_s:
            current, torque = short_circuit(motor, omega)
            found = library.shorted(round(omega / motor.pole_pairs * 1e3))
            share = found.current_mA * 1e-3 / current
            assert motor.below <= share <= ABOVE
            assert motor.below**2 <= found.torque_mNm * 1e-3 / torque <= ABOVE**2


def test_an_open_bridge_is_quiet_up_to_the_true_emf(
    firmware: Firmware, raw: bytes, motors: list[Motor]
) -> None:
    for motor in motors:
        library = set_up(firmware, raw, motor)
        psi_d, _ = motor.flux(np.array(0.0), np.array(0.0))
        emf_v = np.sqrt(3.0) * float(psi_d) * motor.fastest_rad_s
        bus_mV = round(1e3 * 0.9 * motor.bus_v)
        limit = 1e3 * motor.fastest_rad_s * 0.9 * motor.bus_v / emf_v / motor.pole_pairs
        assert library.quiet(round(0.997 * limit), bus_mV)
        assert not library.quiet(round(1.003 * limit), bus_mV)


def test_torque_that_the_voltage_forces_is_permitted(
    firmware: Firmware, raw: bytes, motors: list[Motor]
) -> None:
    """The weakened flux needs sqrt(3) omega |psi|, and more for the resistance."""
    for motor in motors:
        library = set_up(firmware, raw, motor)
        psi_d, _ = motor.flux(np.array(-motor.weakening_a), np.array(0.0))
        for omega in SHARES * motor.fastest_rad_s:
            needed_v = np.sqrt(3.0) * omega * max(float(psi_d), 0.0)
            speed = round(omega / motor.pole_pairs * 1e3)
            assert needed_v < 1.0 or library.forced(speed, round(1e3 * FORCED_BUS * needed_v))


def test_a_short_circuit_ends_only_where_its_energy_fits_into_the_bus(
    firmware: Firmware, raw: bytes, motors: list[Motor]
) -> None:
    """Currents up to twice that of the settled short circuit, whose energy half the buses take."""
    rng = np.random.default_rng(35)
    for motor in motors:
        settled, _ = short_circuit(motor, motor.fastest_rad_s)
        most_j = 1.5 * motor.energy_j(-settled, 0.0)
        device_v, ended = 1.3 * motor.bus_v, 0
        bus_f = rng.uniform(1.0, 4.0) * 2.0 * most_j / (device_v**2 - motor.bus_v**2)
        library = set_up(firmware, raw, motor, bus_f)
        for _ in range(60):
            amount, angle = settled * rng.uniform(0.0, 2.0), rng.uniform(0.5, 1.5) * np.pi
            i_d, i_q = amount * np.cos(angle), amount * np.sin(angle)
            bus_v = motor.bus_v * rng.uniform(0.5, 1.0)
            share = 1.5 * motor.energy_j(i_d, i_q) * 2.0 / bus_f / (device_v**2 - bus_v**2)
            ends = library.may_open(round(i_d * 1e3), round(i_q * 1e3), round(bus_v * 1e3))
            assert share <= ENERGY if ends else share >= REFUSED
            ended += ends
        assert ended >= 5
