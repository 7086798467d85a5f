# SPDX-License-Identifier: Apache-2.0
"""``--set key=value``: whose key it is, and its value.

Without a dot it is a key of the scenario (``demand_nm=60``); ``events.NAME.key`` and
``criteria.NAME.key`` are the scenario's too. ``section.key`` changes the drive's file before
anything is made of it, for plant and controller alike (``battery.initial_soc=0.5``).
``plant.section.key`` changes the simulated world alone and leaves the controller's configuration as
it is (``plant.motor.phase_resistance_ohm=0.04``).
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from regen_table import schema
from regen_table.schema import Drive
from regen_table.settings import value_of

from hubsim import engine
from hubsim.errors import HubsimError
from hubsim.scenario.events import check_parameter, range_of
from hubsim.scenario.fitting import changed
from hubsim.scenario.schema import Scenario

__all__ = ["Overrides", "changed", "load_drive", "parse", "put", "value_of"]

PLANT = "plant."
OF_THE_SCENARIO = ("events.", "criteria.")


@dataclass(frozen=True)
class Overrides:
    """Parsed settings, each for the one it belongs to."""

    scenario: dict[str, Any] = field(default_factory=dict)
    drive: dict[tuple[str, str], Any] = field(default_factory=dict)
    plant: dict[str, float] = field(default_factory=dict)


def parse(settings: Iterable[str]) -> Overrides:
    """Sort ``key=value`` texts; the last one of a key counts."""
    out = Overrides()
    for setting in settings:
        key, equals, text = setting.partition("=")
        key = key.strip()
        if not equals or not key:
            raise HubsimError(f"--set {setting!r}: accepted: key=value")
        put(out, key, value_of(text.strip()))
    return out


def put(overrides: Overrides, key: str, value: Any) -> None:  # noqa: ANN401, whatever TOML can say
    """Assign one key to scenario, drive or plant."""
    if key.startswith(PLANT):
        name = key.removeprefix(PLANT)
        overrides.plant[name] = _plant_value(name, value)
    elif "." in key and not key.startswith(OF_THE_SCENARIO):
        section, _, name = key.partition(".")
        overrides.drive[section, name] = value
    else:
        overrides.scenario[key] = value


def _plant_value(name: str, value: object) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            check_parameter(name, float(value))
        except ValueError as error:
            raise HubsimError(
                f"--set {PLANT}{str(error).replace('did you mean ', f'did you mean {PLANT}')}"
            ) from error
        return float(value)
    known = engine.parameters()
    if name not in known:
        return _plant_value(name, 0.0)  # which refuses the name
    raise HubsimError(
        f"--set {PLANT}{name}: {value!r} is not accepted, accepted: {range_of(known[name])}"
    )


def load_drive(path: Path, overrides: Overrides, scenario: Scenario | None = None) -> Drive:
    """Read a drive's file.

    With the scenario's changes and the settings of the command line.
    """
    drive = schema.load(path)
    changes = {**(scenario.drive_changes if scenario else {}), **overrides.drive}
    source = (
        f"{path} with --set" if overrides.drive or scenario is None else f"{scenario.source}: drive"
    )
    return changed(drive, changes, source)
