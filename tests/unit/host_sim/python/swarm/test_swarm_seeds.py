# SPDX-License-Identifier: Apache-2.0
"""Sixty seeds from 24 drives hold every invariant, and a planted error is found."""

import json
from pathlib import Path

import pytest
from hubsim.swarm import draw, work
from hubsim_command import Hubsim

SEEDS = "0:60"


def test_sixty_seeds_hold_every_invariant(hubsim: Hubsim, tmp_path: Path) -> None:
    done = hubsim("swarm", "--seeds", SEEDS, "--drives", "24", "--json", "all.json")
    assert done.returncode == 0, done.stdout
    found = json.loads((tmp_path / "all.json").read_bytes())
    assert found["runs"] == 60
    assert 20 <= found["healthy"]["runs"] <= 40
    assert found["healthy"]["warnings"] == 0
    assert 0.0 < found["healthy"]["worst_share_gap"] <= 0.05
    assert found["coverage"]["seen"] > 100


@pytest.mark.parametrize(
    ("seed", "drives", "healthy"),
    [
        *((seed, 400, False) for seed in (79, 170, 333)),
        (1200, 24, False),
        *((seed, 400, True) for seed in (60079, 60220, 61360, 63728, 63808, 64533, 65146)),
    ],
)
def test_a_seed_that_was_mended_holds_every_invariant(
    seed: int, drives: int, healthy: bool
) -> None:
    """79: halls that turn round while the current of a salient motor rises. 170: a contactor.

    333: a switch opens beside a small current.
    1200: one hall line bounces while the wheel rolls back and the driver acknowledges.
    60079, 60220: halls show the speed before a stop while the observer keeps a current's flux.
    61360: a road that slow halls showed too steep, and a hold beside the whole demand.
    63728: all of the voltage on d, so that i_q stayed whatever the command was.
    63808: slow halls that are late had slipped.
    65146: halls at the end of a stop, and the dead time's voltage beside their EMF.
    64533: a wheel that had just stopped without a current turned for the observer.
    """
    record = work.done({"seed": seed, "drives": drives, "healthy": healthy})
    assert record["violations"] == []


@pytest.mark.parametrize(
    ("seed", "world", "invariant"),
    [
        (0, {"winding_sensor.open": 1.0}, "warning"),
        (1, {"fault.hydraulic_drag": 0.1}, "braking_without_demand"),
        (0, {"fault.can_delay_s": 0.0, "fault.leg_low": 2.0}, "warning"),
    ],
)
def test_what_is_planted_in_a_healthy_vehicle_is_found(
    seed: int, world: dict[str, float], invariant: str
) -> None:
    case = draw.case(seed, 4, healthy=True)
    data = {**case.data, "plant": {**case.data["plant"], **world}}
    record = work.done({"seed": seed, "config": case.config, "data": data})
    assert invariant in {violation["invariant"] for violation in record["violations"]}
