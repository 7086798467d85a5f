"""The stored table is the optimum in simulation too: no other torque returns more on a stop."""

import pytest
from hubsim import images
from one_wheel import quarter, started, stopped
from regen_table import image
from regen_table.schema import Drive

FACTORS = (0.8, 0.9, 1.1, 1.2)
DEMAND_NM = 120.0  # the motor always gives what the table and its limits allow


def returned(monkeypatch: pytest.MonkeyPatch, factor: float, temperature_c: float) -> float:
    """Return the share of kinetic energy that comes back with the whole table multiplied."""
    honest = images.build

    def scaled(drive: Drive) -> bytes:
        stored = image.fields(drive)["regen_map"]["torque_mNm"]
        assert isinstance(stored, list)
        return images.changed(honest(drive), {("regen_map", "torque_mNm"): [round(torque * factor) for torque in stored]})

    with monkeypatch.context() as patch:
        patch.setattr(images, "build", scaled)
        keys = {"demand_nm": DEMAND_NM, "winding_temperature_c": temperature_c, "record_interval_s": 10.0}
        engine = started(quarter(), keys, {"battery.polarisation_capacitance_f": 1e-3})
    with engine:
        return stopped(engine)


@pytest.mark.parametrize("temperature_c", [25.0, 120.0])
def test_no_multiple_of_the_table_returns_more(monkeypatch: pytest.MonkeyPatch, temperature_c: float) -> None:
    best = returned(monkeypatch, 1.0, temperature_c)
    found = {factor: returned(monkeypatch, factor, temperature_c) for factor in FACTORS}
    assert max(found.values()) <= best * 1.001
    assert len({best, *found.values()}) == 1 + len(FACTORS)  # the factor arrives at the motor
