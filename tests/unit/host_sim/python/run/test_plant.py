# SPDX-License-Identifier: Apache-2.0
from hubsim import engine
from hubsim.run import plant
from regen_table.schema import Drive

OF_THE_RUN = (
    "road.",
    "driver.",
    "run.",
    "thermal.winding_temperature_c",
    "thermal.switch_temperature_c",
    "thermal.ambient_",
    "thermal.active",
)


def test_drive_and_run_together_set_every_parameter(drive: Drive) -> None:
    decided = set(plant.parameters(drive))
    known = {
        name for name in engine.parameters() if not name.startswith((*OF_THE_RUN, *plant.EVENTS))
    }
    assert decided == known


def test_plant_parameters_of_lu2013_equal_those_of_its_file(drive: Drive) -> None:
    found = plant.parameters(drive)
    assert found["motor.pole_pairs"] == 23.0
    assert found["motor.flux_linkage_wb"] == 0.0204
    assert found["motor.iron_loss_resistance_slope_ohm_s"] == 0.006
    assert found["vehicle.mass_kg"] == 660.0
    assert found["sensors.hall_edge_2_deg"] == 120.0
    assert plant.voltage_curve(drive) == ([0.0], [53.0])


def test_every_value_is_in_the_accepted_range_of_the_plant(drive: Drive) -> None:
    for name, value in plant.parameters(drive).items():
        parameter = engine.parameters()[name]
        assert parameter.lowest <= value <= parameter.highest, name
