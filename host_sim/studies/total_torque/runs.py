# SPDX-License-Identifier: Apache-2.0
"""One run of which the sum of motor and hydraulic brake is compared with the demand.

One wheel with its share of mass and battery stands for the vehicle (stops). The torque at the wheel
is the hydraulic brake's and the motor's airgap torque with the friction of the bearings, means over
RECORD_S. Left out: the time that both brakes take after a step of the demand, dead time plus LAGS
lags of the actual hydraulic brake plus MARGIN_S, and speeds below LOWEST_M_PER_S.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from hubsim import run
from hubsim.engine import Engine, Rows
from hubsim.run import stops
from hubsim.scenario import Scenario
from regen_table.schema import Drive

RECORD_S = 0.005
LOWEST_M_PER_S = 0.5
LAGS = 2.5
MARGIN_S = 0.05
STEP_SHARE = 0.1  # a change of the demand within the settling time that counts as a step
LEAST_SHARE = 0.05  # of the rated torque: smaller demands are not counted
FEEDBACK = {
    "brake_sensor.fitted": 1.0,
    "brake_sensor.period_s": 0.02,
    "brake_sensor.delay_s": 0.01,
}
SIGNALS = (
    "driver.brake_nm",
    "vehicle.speed_m_per_s",
    "wheel0.motor_torque_nm",
    "wheel0.hydraulic_torque_nm",
    "wheel0.first_fault_reason",
)


@dataclass(frozen=True)
class Sum:
    """How well both brakes together make the demand.

    Attributes
    ----------
    rms, peak : float
        Of |sum - demand| as a share of the demand.
    counted_s : float
        For how long.
    fault : float
        Reason of the first fault, 0 none.
    """

    rms: float
    peak: float
    counted_s: float
    fault: float


def simulate(drive: Drive, scenario: Scenario, plant: Mapping[str, float]) -> Sum:
    """Run a scenario on one wheel and compare the sum with the demand."""
    recorded = scenario.model_copy(update={"record_interval_s": RECORD_S})
    engine, planned_s = run.prepare(drive, recorded, Path(), dict(plant))
    with engine:
        stops.as_one_wheel(engine, drive)
        engine.start()
        engine.choose(SIGNALS)
        parts = []
        while not engine.ended and engine.value("time_s") < planned_s - RECORD_S:
            parts.append(engine.run(min(planned_s - engine.value("time_s"), 10.0)))
        return _compared(np.concatenate(parts), drive, engine)


def weak_and_late(drive: Drive, gain: float, lateness: float) -> dict[str, float]:
    """Return a hydraulic brake of another gain, and times as late as the configuration says."""
    return {
        "brake.torque_loss": 1.0 - gain,
        "brake.hydraulic_dead_time_s": lateness * drive.brake.hydraulic_dead_time_s,
        "brake.hydraulic_time_constant_s": lateness * drive.brake.hydraulic_time_constant_s,
    }


def _compared(rows: Rows, drive: Drive, engine: Engine) -> Sum:
    demand, speed, airgap, hydraulic, _ = rows.T
    turning = speed / engine.get("vehicle.wheel_radius_m")
    friction = drive.motor.friction_torque_nm + drive.motor.viscous_friction_nm_s * turning
    total = hydraulic - airgap + friction
    settling_s = (
        engine.get("brake.hydraulic_dead_time_s")
        + LAGS * engine.get("brake.hydraulic_time_constant_s")
        + MARGIN_S
    )
    counted = settled(demand, round(settling_s / RECORD_S)) & (speed > LOWEST_M_PER_S)
    counted &= demand > LEAST_SHARE * drive.motor.rated_torque_nm
    off = total[counted] / demand[counted] - 1.0
    return Sum(
        rms=float(np.sqrt(np.sum(off**2) / max(len(off), 1))),
        peak=float(np.max(np.abs(off), initial=0.0)),
        counted_s=len(off) * RECORD_S,
        fault=float(rows[-1, 4]),
    )


def settled(demand: Rows, window: int) -> npt.NDArray[np.bool_]:
    """Return where the demand moved by no more than STEP_SHARE within the last `window` rows."""
    padded = np.concatenate([np.zeros(window), demand])
    views = np.lib.stride_tricks.sliding_window_view(padded, window + 1)
    low, high = views.min(axis=1), views.max(axis=1)
    return np.asarray(high - low <= STEP_SHARE * high)
