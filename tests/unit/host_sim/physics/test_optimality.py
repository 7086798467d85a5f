# SPDX-License-Identifier: Apache-2.0
"""The stored table is the optimum in simulation as well: no scaled table returns more on a stop."""

import numpy as np
import pytest
from hubsim import configuration
from hubsim.run import stops
from one_wheel import quarter, started, stopped
from regen_table import image
from regen_table.schema import Drive

FACTORS = (0.8, 0.9, 1.1, 1.2)
SPEED_KMH = 40.0


def returned(
    monkeypatch: pytest.MonkeyPatch, demand_nm: float, factor: float, temperature_c: float
) -> float:
    """Return the stored share of kinetic energy with the whole table scaled."""
    reference = configuration.image_of

    def scaled(drive: Drive) -> bytes:
        stored = image.fields(drive)["regen_map"]["torque_lsb"]
        assert isinstance(stored, list)
        return configuration.changed_image(
            reference(drive),
            {("regen_map", "torque_lsb"): [round(torque * factor) for torque in stored]},
        )

    with monkeypatch.context() as patch:
        patch.setattr(configuration, "image_of", scaled)
        keys = {
            "initial_speed_kmh": SPEED_KMH, "demand_nm": demand_nm,
            "winding_temperature_c": temperature_c, "record_interval_s": 10.0
        }  # fmt: skip
        engine = started(quarter(), keys)
    with engine:
        return stopped(engine)


def share_where_the_table_matters(demand_nm: float, factor: float, temperature_c: float) -> float:
    """Return the kinetic energy (1) below the speed at which the table allows as much as the demand
    or the motor does.
    """
    best = stops.optimum_map(quarter(), temperature_c)
    bound = factor * best.optimal_nm < np.minimum(demand_nm, best.limit_nm)
    fastest = float(np.max(best.speed_rad_s[bound])) * best.wheel_radius_m
    return (fastest / (SPEED_KMH / 3.6)) ** 2


@pytest.mark.parametrize("temperature_c", [25.0, 120.0])
@pytest.mark.parametrize("demand_nm", [20.0, 40.0, 60.0, 120.0])
def test_no_scaling_of_the_table_returns_more_energy(
    monkeypatch: pytest.MonkeyPatch, demand_nm: float, temperature_c: float
) -> None:
    """From 120 N m, always limited by table or motor, to 20 N m, limited by the table below 40
    r/min only.
    """
    best = returned(monkeypatch, demand_nm, 1.0, temperature_c)
    found = {factor: returned(monkeypatch, demand_nm, factor, temperature_c) for factor in FACTORS}
    assert max(found.values()) <= best * 1.001
    # The factor acts on the motor torque only where the table is the limit.
    assert len({best, *found.values()}) == 1 + len(FACTORS)
    for factor, share in found.items():
        assert abs(share - best) < share_where_the_table_matters(
            demand_nm, min(factor, 1.0), temperature_c
        )
    # A parabola around the maximum: twice the distance costs more.
    assert found[0.8] < found[0.9]
    assert found[1.2] < found[1.1]
