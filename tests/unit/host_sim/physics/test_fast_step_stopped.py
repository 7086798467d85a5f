# SPDX-License-Identifier: Apache-2.0
"""The fast step stops at speed, and the compare values stay: a voltage that stands still.

The stop timer of a port switches the bridge off within two periods. Until then the phase current
is at most 1.5 times the trip; what the EMF drives through the diodes of the open bridge is the
safe state's own.
"""

import math
from pathlib import Path

import pytest
from hubsim import run
from hubsim.run import stops
from hubsim.scenario import Scenario
from hubsim.sweep.faults_sweep import drive_of
from regen_table import loops

DRIVES = (("lu2013", "angle"), ("lu2013", "hall"), ("scooter48v", "hall"), ("ipm400v", "angle"),
          ("ebike36v", "hall"))  # fmt: skip
BRAKES_S, END_S = 1.0, 0.02
# While driving, within the phases of an electrical turn, and while braking.
INSTANTS_S = (0.2, 0.2003, 0.201, 0.202, 0.203, 0.205, 1.2, 1.2011, 1.2023, 1.2037)


@pytest.mark.parametrize("share", [0.3, 0.6, 0.97])
@pytest.mark.parametrize(("config", "sensor"), DRIVES)
def test_the_current_stays_below_half_more_than_the_trip(
    config: str, sensor: str, share: float
) -> None:
    drive = drive_of(config, sensor)
    trip_a = loops.overcurrent_pu(drive) * drive.inverter.current_full_scale_a
    rad_per_s = share * drive.motor.max_speed_rpm * math.pi / 30.0
    scenario = Scenario(
        initial_speed_kmh=3.6 * rad_per_s * drive.vehicle.wheel_radius_m,
        stop_at_standstill=False,
        max_duration_s=10.0,
        record_interval_s=0.01,
    )
    capacitance_f = drive.inverter.bus_capacitance_f * drive.vehicle.driven_wheels
    engine, _ = run.prepare(drive, scenario, Path(), {"bus.capacitance_f": capacitance_f})
    stops.as_one_wheel(engine, drive)
    engine.start()
    started = engine.save()
    for instant_s in INSTANTS_S:
        engine.restore(started)
        engine.set("driver.drive_demand_nm", 0.5 * drive.motor.rated_torque_nm)
        if instant_s > BRAKES_S:
            engine.run(BRAKES_S)
            engine.set("driver.drive_demand_nm", 0.0)
            engine.set("driver.brake_demand_nm", drive.motor.rated_torque_nm)
            engine.run(instant_s - BRAKES_S)
        else:
            engine.run(instant_s)
        engine.set("fault.fast_stopped", 1.0)
        engine.run(END_S)
        assert engine.value("wheel0.peak_current_a") < 1.5 * trip_a, instant_s
