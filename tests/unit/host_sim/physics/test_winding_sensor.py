# SPDX-License-Identifier: Apache-2.0
"""A winding sensor that lags, reads low or is far from the copper, with heat: no vehicle loses its
drive by a healthy one, and no winding burns by a wrong one."""

import os
from pathlib import Path

import hubsim
import numpy as np
import pytest
from hubsim.reasons import identifier

MOTORS = Path(__file__).parents[4] / "tools" / "motors"
FOR_LONG = "HUBFOC_FOR_LONG" in os.environ
LIMP = 5  # firmware/core/include/core/operating_mode.h
LIMIT_C = {"ebike36v": 130.0, "lu2013": 150.0}
# drive, torque of the driver in N m, slope in per cent, speed at the begin in km/h
HARD = (("ebike36v", 14.0, 3.0, 10.0), ("scooter48v", 18.0, 8.0, 10.0), ("lu2013", 38.0, 6.0, 15.0))


# A vehicle that has stood in the sun or in the frost: all of it is as warm.
STARTS_C = (-20.0, 0.0, 45.0, 60.0, 80.0) if FOR_LONG else (60.0,)
WRONG = {
    "a fifth low": {"gain_error": -0.2},
    "half": {"gain_error": -0.5},
    "50 K low": {"offset_k": -50.0},
    "300 s late": {"lag_s": 300.0},
}
LAGS_S = (10.0, 60.0, 120.0, 300.0) if FOR_LONG else (300.0,)


def ride(
    drive: str,
    torque: float,
    slope: float,
    kmh: float,
    duration_s: float = 90.0,
    start_c: float = 25.0,
    sensor: dict[str, float] | None = None,
) -> hubsim.Recording:
    """Drive with this torque, in N m; heat is on."""
    configuration = hubsim.load_configuration(MOTORS / f"{drive}.toml", {})
    plant = {"thermal.active": 1.0} | {f"winding_sensor.{k}": v for k, v in (sensor or {}).items()}
    bench = hubsim.Bench(
        configuration,
        None,
        plant=plant,
        record=("time_s", "wheel0.winding*", "wheel0.warning_reason", "wheel0.mode"),
        initial_speed_kmh=kmh,
        slope_percent=slope,
        record_interval_s=0.1,
        max_duration_s=duration_s,
        winding_temperature_c=start_c,
        switch_temperature_c=start_c,
        ambient_temperature_c=min(start_c, 60.0),  # hotter only in the sun
        drive_trace_nm=[[0.0, 0.0], [0.5, 0.0], [1.0, torque], [duration_s, torque]],
    )  # fmt: skip
    return bench.run()


@pytest.mark.parametrize("lag_s", LAGS_S)
@pytest.mark.parametrize("case", HARD, ids=[case[0] for case in HARD])
def test_a_healthy_sensor_that_lags_is_no_finding(
    case: tuple[str, float, float, float], lag_s: float
) -> None:
    run = ride(*case, sensor={"lag_s": lag_s})
    assert {identifier(code) for code in run["wheel0.warning_reason"]} == {"NONE"}
    assert not bool((run["wheel0.mode"] == LIMP).any())


def braking(lag_s: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return what both brakes make, N m, of a stop of 8 N m after a minute of hard driving."""
    drive, torque, slope, kmh = HARD[0]
    bench = hubsim.Bench(
        hubsim.load_configuration(MOTORS / f"{drive}.toml", {}),
        None,
        plant={"thermal.active": 1.0, "winding_sensor.lag_s": lag_s},
        record=("wheel0.motor_torque_nm", "wheel0.hydraulic_torque_nm"),
        initial_speed_kmh=kmh,
        slope_percent=slope,
        record_interval_s=0.01,
        max_duration_s=61.5,
        drive_trace_nm=[[0.0, 0.0], [1.0, torque], [60.0, torque], [60.01, 0.0]],
        demand_trace_nm=[[0.0, 0.0], [60.0, 0.0], [60.01, 8.0]],
    )  # fmt: skip
    run = bench.run()
    total = run["wheel0.hydraulic_torque_nm"] - run["wheel0.motor_torque_nm"]
    return np.asarray(total)[-100:]


def test_a_healthy_sensor_that_lags_costs_no_braking() -> None:
    plain = braking(0.0)
    assert np.all(plain > 7.6)
    for lag_s in LAGS_S:
        assert np.max(np.abs(braking(lag_s) - plain)) < 0.1


@pytest.mark.parametrize("wrong", WRONG)
def test_a_sensor_that_reads_low_lets_no_winding_burn(wrong: str) -> None:
    """Within 10 K of the limit, and hot enough that without the model it would be far beyond."""
    hottest = max(ride(*HARD[0], 400.0, sensor=WRONG[wrong])["wheel0.winding_temperature_c"])
    limit_c = LIMIT_C[HARD[0][0]]
    assert limit_c - 15.0 < hottest < limit_c + 10.0


@pytest.mark.parametrize("start_c", STARTS_C)
@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("drive", ["ebike36v", "lu2013"] if FOR_LONG else ["ebike36v"])
def test_no_winding_burns_wherever_the_vehicle_stood(
    drive: str, wrong: str, start_c: float
) -> None:
    """The switches' sensor, as warm as the winding, is where the model starts."""
    case = next(case for case in HARD if case[0] == drive)
    run = ride(*case, 200.0, start_c, WRONG[wrong])
    assert max(run["wheel0.winding_temperature_c"]) < LIMIT_C[drive] + 10.0
