# SPDX-License-Identifier: Apache-2.0
"""A winding sensor that lags, reads low or is far from the copper, with heat: no vehicle loses its
drive by a healthy one, and no winding burns by a wrong one."""

from pathlib import Path

import hubsim
import pytest
from hubsim.reasons import identifier

MOTORS = Path(__file__).parents[4] / "tools" / "motors"
LIMP = 5  # firmware/core/include/core/operating_mode.h
EBIKE_LIMIT_C = 130.0
# drive, torque of the driver in N m, slope in per cent, speed at the begin in km/h
HARD = (("ebike36v", 14.0, 3.0, 10.0), ("scooter48v", 18.0, 8.0, 10.0), ("lu2013", 38.0, 6.0, 15.0))


def ride(
    drive: str, torque: float, slope: float, kmh: float, duration_s: float = 90.0, **sensor: float
) -> hubsim.Recording:
    """Drive with this torque, in N m; heat is on."""
    configuration = hubsim.load_configuration(MOTORS / f"{drive}.toml", {})
    plant = {"thermal.active": 1.0} | {f"winding_sensor.{k}": v for k, v in sensor.items()}
    bench = hubsim.Bench(
        configuration,
        None,
        plant=plant,
        record=("time_s", "wheel0.winding*", "wheel0.warning_reason", "wheel0.mode"),
        initial_speed_kmh=kmh,
        slope_percent=slope,
        record_interval_s=0.1,
        max_duration_s=duration_s,
        drive_trace_nm=[[0.0, 0.0], [0.5, 0.0], [1.0, torque], [duration_s, torque]],
    )  # fmt: skip
    return bench.run()


@pytest.mark.parametrize("lag_s", [60.0, 300.0])
@pytest.mark.parametrize("case", HARD, ids=[case[0] for case in HARD])
def test_a_healthy_sensor_that_lags_is_no_finding(
    case: tuple[str, float, float, float], lag_s: float
) -> None:
    run = ride(*case, lag_s=lag_s)
    assert {identifier(code) for code in run["wheel0.warning_reason"]} == {"NONE"}
    assert not bool((run["wheel0.mode"] == LIMP).any())


@pytest.mark.parametrize(
    "sensor",
    [{"gain_error": -0.5}, {"offset_k": -50.0}, {"lag_s": 300.0}],
    ids=["half", "50 K low", "300 s late"],
)
def test_a_sensor_that_reads_low_lets_no_winding_burn(sensor: dict[str, float]) -> None:
    """Within 10 K of the limit, and hot enough that without the model it would be far beyond."""
    drive, torque, slope, kmh = HARD[0]
    run = ride(drive, torque, slope, kmh, 400.0, **sensor)
    hottest = max(run["wheel0.winding_temperature_c"])
    assert EBIKE_LIMIT_C - 15.0 < hottest < EBIKE_LIMIT_C + 10.0
