"""Stops at constant demand: the one wheel that is simulated stands for the vehicle, and the ideal bounds what it stores."""

import hubsim
import pytest
from hubsim import images, run, scenario, stops
from hubsim.engine import ROOT
from regen_table import image
from regen_table import stops as ideal
from regen_table.schema import Drive

LU2013 = ROOT / "tools" / "motors" / "lu2013.toml"


@pytest.fixture(scope="module")
def drives() -> list[Drive]:
    found = [hubsim.load_configuration(LU2013, {"brake.strategy": strategy}).drive for strategy in run.STRATEGIES]
    return [drive for drive in found if drive is not None]


def test_images_of_drives_that_differ_in_strategy_are_those_of_the_generator(drives: list[Drive]) -> None:
    assert len(drives) == 3
    assert [images.build(drive) for drive in drives] == [image.build(drive) for drive in drives]
    assert len({images.build(drive) for drive in drives}) == 3


def test_one_wheel_with_its_share_of_everything_stands_for_the_vehicle(drives: list[Drive]) -> None:
    for drive, curve in zip(drives, stops.simulate(drives, (15.0, 60.0)), strict=True):
        for demand, stored in zip(curve.demand_nm, curve.stored, strict=True):
            settings = {"initial_speed_kmh": stops.SPEED_KMH, "demand_nm": demand, "drag": False}
            name, chosen, beside = scenario.load("stop", settings)
            whole = run.simulate(name, drive, chosen, beside, ())
            share = whole.account_j["energy.chemical_j"] / whole.account_j["energy.kinetic_j"]
            assert stored == pytest.approx(share, abs=2e-4), (curve.strategy, demand)


def test_simulated_stops_lie_near_the_ideal_and_series_is_never_beaten(drives: list[Drive]) -> None:
    demands = (5.0, 20.0, 40.0, 120.0)
    stored = {curve.strategy: curve.stored for curve in stops.simulate(drives, demands)}
    for drive in drives:
        for demand, share in zip(demands, stored[drive.brake.strategy], strict=True):
            bound = ideal.stop(drive, drive.brake.strategy, demand, stops.SPEED_KMH, stops.TEMPERATURE_C).stored_share_of_kinetic
            assert share == pytest.approx(bound, abs=0.02)
    for other in ("parallel_ratio", "parallel_free_travel"):
        for best, share in zip(stored["series_optimal"], stored[other], strict=True):
            assert best > share - 5e-4


def test_the_map_is_the_optimum_of_the_table(drives: list[Drive]) -> None:
    """At 100 and 300 r/min: figures of the steady-state model, twice as much to get nothing, and the motor's own limits."""
    found = stops.optimum_map(drives[2])
    import numpy as np  # noqa: PLC0415

    rpm = found.speed_rad_s * 30.0 / np.pi
    assert np.interp([100.0, 300.0], rpm, found.optimal_nm) == pytest.approx([49.60, 148.7], rel=2e-3)
    assert np.interp(100.0, rpm, found.zero_nm) == pytest.approx(98.02, rel=2e-3)
    assert np.max(found.limit_nm) == 40.0
    assert found.wheel_radius_m == 0.25
