# SPDX-License-Identifier: Apache-2.0
"""The safe states of motors whose iron saturates, by the monitor and by the plant.

The monitor has three constants of a map that contain what open and shorted motor do; the plant has
the map's energy as a spline, and integrates. Speeds to 1.1 of the largest, windings and magnets
cold and hot. Nothing commands the bridge but the test.
"""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cffi
import hubsim
import numpy as np
import pytest
from hubsim import configuration
from hubsim.configuration import Configuration
from hubsim.engine import ROOT
from hubsim.run import external
from saturating_drives import MOTORS, saturating

HEAVY = {"vehicle.mass_kg": 1e6}  # the speed stays
COLD_C, HOT_BELOW_MOST_K = -20.0, 10.0
OPEN_S, SHORT_S, ENDED_S, MEAN_SHARE = 0.15, 0.25, 0.05, 0.3
EVERY = 4  # PWM periods are looked at: a quarter of a millisecond at most
# Of the plant's value. Below: 0.93 of the measured motor's current where it is hot at 5 % of its
# speed; torques without the switches' resistance, of a Leaf's cold motor 0.65. Above: hot magnets
# that the monitor does not count on, 1.25; L_q that falls to half.
SHORT_CURRENT, SHORT_TORQUE = (0.9, 1.35), (0.6, 1.6)
OPEN_ABOVE = 0.99  # of the current of the diodes, resistance and drops left out
CASES = [
    ("hub", 0.05, True), ("hub", 0.5, False), ("hub", 1.1, False), ("hub", 1.1, True),
    ("leaf", 0.05, False), ("leaf", 0.5, True), ("leaf", 0.9, False), ("leaf", 1.1, True),
    ("reluctance", 0.05, True), ("reluctance", 0.05, False), ("reluctance", 1.1, True),
]  # fmt: skip


@dataclass(frozen=True)
class Seen:
    """What a bridge left as it is makes of the motor: means of the last part, and extremes."""

    i_d_a: float
    i_q_a: float
    torque_nm: float
    bus_v: float
    most_a: float
    most_bus_v: float

    @property
    def current_a(self) -> float:
        return float(np.hypot(self.i_d_a, self.i_q_a))


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Configuration]:
    folder = tmp_path_factory.mktemp("maps")
    return {
        "hub": saturating(MOTORS / "lu2013.toml", folder),
        "leaf": saturating(MOTORS / "public" / "leaf.toml", folder),
        "reluctance": configuration.load(Path(__file__).parent / "reluctance.toml"),
    }


@pytest.fixture(scope="module")
def monitor(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Any]:
    """Return the firmware's monitor."""
    library = tmp_path_factory.mktemp("monitor") / "monitor.so"
    firmware = Path(os.environ["HUBFOC_BUILD_DIR"]) / "firmware"
    source = ROOT / "tests" / "unit" / "tools" / "regen_table" / "saturated_bounds.c"
    names = ("monitor", "config", "core")
    folders = [f"-I{ROOT / 'firmware' / name / 'include'}" for name in names]
    archives = [str(firmware / name / f"libhubfoc_{name}.a") for name in names]
    subprocess.run(["cc", "-std=c11", "-shared", "-fPIC", *folders, str(source), *archives,
                    "-o", str(library)], check=True)  # fmt: skip
    ffi: Any = cffi.FFI()
    ffi.cdef("""
        typedef struct { int32_t torque_mNm, current_mA, charging_mA, bus_mV; } steady_state_t;
        typedef struct {
            int bridge; int32_t emf_mV; steady_state_t freewheel; int32_t torque_mNm;
        } safe_state_t;
        void own(const void *image);
        safe_state_t choose(int32_t speed_mrad_s, int32_t bus_mV, int32_t winding_cC,
                            int32_t charge_mA);
        steady_state_t shorted_at(int32_t speed_mrad_s, int32_t winding_cC);
        int may_open(int32_t d_mA, int32_t q_mA, int32_t bus_mV);
    """)
    return ffi, ffi.dlopen(str(library))


def left(plant: hubsim.Plant, bridge: int, duration_s: float) -> Seen:
    level, rows = np.full((plant.wheels, 3), 0.5), []
    for n in range(round(duration_s / plant.period_s)):
        now = plant.step(level, bridge=bridge)
        if n % EVERY == 0:
            currents = plant["wheel0.current_d_a"], plant["wheel0.current_q_a"]
            rows.append((*currents, now.motor_torque_nm[0], now.bus_voltage_v))
    found = np.array(rows)
    last = found[-round(MEAN_SHARE * len(rows)) :].mean(axis=0)
    most_a = float(np.max(np.hypot(found[:, 0], found[:, 1])))
    i_d_a, i_q_a, torque_nm, bus_v = (float(mean) for mean in last)
    return Seen(i_d_a, i_q_a, torque_nm, bus_v, most_a, float(np.max(found[:, 3])))


@pytest.mark.parametrize(("name", "speed_share", "hot"), CASES)
def test_safe_states_of_a_saturating_motor_are_contained_by_those_of_the_monitor(
    drives: dict[str, Configuration],
    monitor: tuple[Any, Any],
    name: str,
    speed_share: float,
    hot: bool,
) -> None:
    ffi, library = monitor
    config = drives[name]
    drive = config.drive
    assert drive is not None
    motor, device_v = drive.motor, drive.inverter.device_voltage_v
    assert device_v is not None
    winding_c = motor.max_winding_temperature_c - HOT_BELOW_MOST_K if hot else COLD_C
    top_m_per_s = motor.max_speed_rpm * np.pi / 30.0 * drive.vehicle.wheel_radius_m
    library.own(ffi.from_buffer(config.image))
    with hubsim.Plant(
        config,
        "stop",
        plant=HEAVY | {"thermal.winding_temperature_c": winding_c},
        initial_speed_kmh=3.6 * speed_share * top_m_per_s,
        noise=False,
        max_duration_s=60.0,
    ) as plant:
        speed_mrad_s = round(1e3 * float(plant.measure().speed_rad_s[0]))
        opened = left(plant, external.OFF, OPEN_S)
        shorted = left(plant, external.SHORT, SHORT_S)
        bus_mV = round(1e3 * opened.bus_v)
        may_open = library.may_open(round(1e3 * shorted.i_d_a), round(1e3 * shorted.i_q_a), bus_mV)
        ended = left(plant, external.OFF, ENDED_S)
    safe = library.choose(speed_mrad_s, bus_mV, round(1e2 * winding_c), 10**7)
    predicted = library.shorted_at(speed_mrad_s, round(1e2 * winding_c))

    assert SHORT_CURRENT[0] <= 1e-3 * predicted.current_mA / shorted.current_a <= SHORT_CURRENT[1]
    assert SHORT_TORQUE[0] <= -1e-3 * predicted.torque_mNm / shorted.torque_nm <= SHORT_TORQUE[1]
    # In its first turns |i_s| + |i - i_s| at most.
    assert shorted.most_a <= 2e-3 * predicted.current_mA + opened.current_a
    assert 1e-3 * safe.freewheel.current_mA >= OPEN_ABOVE * opened.current_a - 0.1
    assert (safe.freewheel.current_mA == 0) == (opened.current_a < 0.1)
    # The state that is taken: a current within the motor's limit where either state has one.
    taken = opened if safe.bridge == external.OFF else shorted
    other = shorted if taken is opened else opened
    assert taken.current_a <= max(motor.max_phase_current_a, other.current_a)
    assert opened.most_bus_v < device_v
    assert not may_open or ended.most_bus_v < device_v
