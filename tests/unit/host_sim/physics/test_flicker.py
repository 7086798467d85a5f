# SPDX-License-Identifier: Apache-2.0
"""What comes and goes while a vehicle brakes: it is named, nothing chatters, and the vehicle stands
no later than with the same device failed for good."""

import os

import pytest
from flicker import Device, Outcome, Wheel
from hubsim.sweep.drives import DRIVES

FOR_LONG = "HUBFOC_FOR_LONG" in os.environ
DEMANDS = (1.0, 2.5) if FOR_LONG else (2.5,)  # of the rated torque
FAILED_SHARES = (0.3, 0.5, 0.7) if FOR_LONG else (0.5,)  # of the time
RATES_HZ = (1.0, 2.0, 3.3, 5.0, 10.0, 25.0)
SOME_HZ = (2.0, 5.0, 25.0)
MOST_CHANGES = 5  # in any second
# The hydraulic brake answers a fall of the motor's torque with its delay: each costs distance. What
# returns more slowly each time falls little above 2 Hz; at 1 Hz by less than once more the whole.
LONGER, LONGER_SLOW = 0.012, 0.03

MEASURED = {"brake_sensor.fitted": 1.0}
BRAKE_OPEN = {"pedal_sensors.brake_a_broken": 1.0}
NAMED_AT_ANY_RATE = (
    Device("contactor", {"bus.contactor_open": 1.0}, frozenset({"BATTERY_DISCONNECTED"})),
    Device("bus sensor at zero", {"fault.bus_stuck": 1.0}, frozenset({"BUS_SENSOR"})),
    Device(
        "bus sensor at its rail",
        {"fault.bus_stuck": 1.0, "fault.bus_shown": 1.0},
        frozenset({"BUS_SENSOR"}),
    ),
    Device(
        "charge limit", {"battery.max_charge_current_a": 0.0}, frozenset({"CHARGE_CURRENT"})
    ),
    Device("brake pedal, a channel", BRAKE_OPEN, frozenset({"BRAKE_PEDAL_SENSOR"}), pedals=True),
    Device(
        "brake pedal",
        BRAKE_OPEN | {"pedal_sensors.brake_b_broken": 1.0},
        frozenset({"BRAKE_PEDAL_SENSOR"}),
        pedals=True,
    ),
    Device(
        "accelerator",
        {"pedal_sensors.accelerator_a_broken": 2.0},
        frozenset({"ACCELERATOR_SENSOR"}),
        pedals=True,
    ),
)  # fmt: skip
# One that is as it should be within hydraulic_timeout_ms, 100 ms, is none that is missing.
REPORTS = (
    Device("silent", {"brake_sensor.silent": 1.0}, frozenset({"HYDRAULIC_FEEDBACK"}), MEASURED),
    Device("invalid", {"brake_sensor.invalid": 1.0}, frozenset({"HYDRAULIC_FEEDBACK"}), MEASURED),
)
HALF = Device(
    "half of the torque",
    {"brake_sensor.gain_error": -0.5},
    frozenset({"HYDRAULIC_FEEDBACK", "HYDRAULIC_WEAK"}),
    MEASURED,
)
HALL = Device(
    "hall line", {"sensors.hall_stuck_high": 1.0}, frozenset({"ROTOR_UNCERTAIN", "ROTOR_LOST"})
)


def check(run: Outcome, healthy: Outcome, failed: Outcome, longer: float) -> None:
    assert run.stands
    assert run.distance_m <= (1.0 + longer) * max(failed.distance_m, healthy.distance_m)
    assert (
        max(run.changes[shown] for shown in ("mode", "fault", "warning", "brake")) <= MOST_CHANGES
    )


@pytest.mark.parametrize("demand", DEMANDS)
@pytest.mark.parametrize("config", DRIVES)
@pytest.mark.parametrize("device", NAMED_AT_ANY_RATE, ids=lambda d: d.name)
def test_what_flickers_is_named_and_costs_no_more_than_what_has_failed(
    device: Device, config: str, demand: float
) -> None:
    wheel = Wheel(config, device, demand)
    healthy, failed = wheel.stop(0.0, 0.0), wheel.stop(0.0, 1.0)
    for rate_hz in RATES_HZ if FOR_LONG else SOME_HZ:
        for share in FAILED_SHARES:
            run = wheel.stop(rate_hz, share)
            check(run, healthy, failed, LONGER if rate_hz > 2.0 else LONGER_SLOW)
            assert run.changes["limit"] <= MOST_CHANGES
            assert share < 0.5 or device.reasons & run.reasons


@pytest.mark.parametrize("config", DRIVES)
@pytest.mark.parametrize("device", (*REPORTS, HALF), ids=lambda d: d.name)
def test_a_report_that_flickers_is_named_and_costs_nothing(device: Device, config: str) -> None:
    wheel = Wheel(config, device, 2.5)
    healthy, failed = wheel.stop(0.0, 0.0), wheel.stop(0.0, 1.0)
    for rate_hz in RATES_HZ if FOR_LONG else SOME_HZ:
        run = wheel.stop(rate_hz)
        check(run, healthy, failed, LONGER)
        assert rate_hz > 5.0 or device.reasons & run.reasons


@pytest.mark.parametrize("demand", DEMANDS)
@pytest.mark.parametrize("config", [drive for drive in DRIVES if drive != "ipm400v"])
def test_a_hall_line_that_flickers_is_named_and_costs_no_more_than_a_dead_one(
    config: str, demand: float
) -> None:
    wheel = Wheel(config, HALL, demand)
    healthy, failed = wheel.stop(0.0, 0.0), wheel.stop(0.0, 1.0)
    for rate_hz in RATES_HZ if FOR_LONG else SOME_HZ:
        run = wheel.stop(rate_hz)
        check(run, healthy, failed, LONGER)
        assert HALL.reasons & run.reasons
