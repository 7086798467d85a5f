# SPDX-License-Identifier: Apache-2.0
"""The stop beside a healthy run: its ideal where nothing is wrong, and what it notices."""

from dataclasses import replace

import pytest
from hubsim.run import plant
from hubsim.swarm import draw, share
from hubsim.swarm.draw import Case
from hubsim.swarm.share import Stop
from regen_table import limited_stop

CASE = next(  # of one whose ideal is inside the battery's limit
    case
    for case in (draw.case(seed, 4, healthy=True) for seed in range(1, 50))
    if share.gap(case) is not None
)
STOP = Stop(demand_nm=6.0, speed_kmh=22.0, winding_c=40.0, soc=0.5)


def test_the_ideal_in_the_files_own_vehicle_is_that_of_limited_stop() -> None:
    drive = share.braked(CASE)
    found = share.ideal_share(drive, drive, STOP)
    assert found is not None
    ideal = limited_stop.stop(
        drive, share.STRATEGY, STOP.demand_nm, STOP.speed_kmh, STOP.winding_c, STOP.soc
    )
    assert found[0] == pytest.approx(ideal.stored_share_of_kinetic, abs=1e-3)


def test_a_motor_with_more_resistance_stores_less() -> None:
    drive = share.braked(CASE)
    ohm, nominal = "motor.phase_resistance_ohm", plant.parameters(drive)
    world = {name: nominal[name] for name in CASE.data["plant"] if name in nominal}
    plain, worse = (
        share.ideal_share(drive, share.true_drive(drive, {**world, ohm: world[ohm] * factor}), STOP)
        for factor in (1.0, 2.0)
    )
    assert plain is not None
    assert worse is not None
    assert worse[0] < plain[0] - 0.02


def test_a_stop_at_the_batterys_limit_is_not_compared() -> None:
    drive = share.braked(CASE)
    small = drive.battery.model_copy(update={"max_charge_current_a": 0.5})
    assert share.ideal_share(drive, drive.model_copy(update={"battery": small}), STOP) is None


def test_a_healthy_stop_is_within_its_tolerance_and_a_dragging_brake_is_not() -> None:
    good = share.gap(CASE)
    assert good is not None
    assert not good.violated
    world = {**CASE.data["plant"], "fault.hydraulic_drag": 0.1}
    drags = share.gap(replace(CASE, data={**CASE.data, "plant": world}))
    assert drags is not None
    assert drags.violated


def test_a_stop_that_a_temperature_limits_is_not_compared() -> None:
    """60161: switches that derate because their temperature begins as that of a hot winding."""
    assert share.gap(draw.case(60161, 400, healthy=True)) is None


@pytest.mark.parametrize("seed", [64204, 65630])
def test_a_stop_of_few_ramps_is_not_compared(seed: int) -> None:
    """64204: of 0.87 s the torque rises for 0.17 s and is handed over for as long; 65630: 1.5 s."""
    assert share.gap(draw.case(seed, 400, healthy=True)) is None


def test_a_demand_is_what_can_carries() -> None:
    """64010: 1.69 N m are sent as 1.6, a twentieth less than the ideal had."""
    for seed in range(60):
        demand_nm = share.drawn(draw.case(seed, 4, healthy=True)).demand_nm
        assert demand_nm >= 0.2
        assert demand_nm / 0.2 == pytest.approx(round(demand_nm / 0.2), abs=1e-9)


def test_the_stop_of_a_run_depends_on_its_seed() -> None:
    assert share.drawn(CASE) == share.drawn(draw.case(CASE.seed, 4, healthy=True))
    assert share.drawn(CASE) != share.drawn(Case(CASE.seed + 1, CASE.config, CASE.data))
