"""``--set key=value``: whose key it is, and what the value says.

Without a dot it is a key of the scenario (``demand_nm=60``). ``section.key`` changes the drive's file before anything
is made of it, for plant and controller alike (``battery.initial_soc=0.5``). ``plant.section.key`` changes the simulated
world alone and leaves the controller's belief as it is (``plant.motor.phase_resistance_ohm=0.04``).
"""

import difflib
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from regen_table import schema
from regen_table.schema import Drive

from hubsim import engine
from hubsim.errors import HubsimError

PLANT = "plant."


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
        value = value_of(text.strip())
        if key.startswith(PLANT):
            name = key.removeprefix(PLANT)
            out.plant[name] = _plant_value(name, value)
        elif "." in key:
            section, _, name = key.partition(".")
            out.drive[section, name] = value
        else:
            out.scenario[key] = value
    return out


def value_of(text: str) -> Any:  # noqa: ANN401, whatever TOML can say
    """Read a value as TOML does; what TOML does not know is a text without its quotes."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, KeyError):
        return text


def _plant_value(name: str, value: object) -> float:
    known = engine.parameters()
    if name not in known:
        near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
        hint = f"did you mean {PLANT}{near[0]}?" if near else "'hubsim list --parameters' shows all"
        raise HubsimError(f"--set {PLANT}{name}: unknown key, {hint}")
    parameter = known[name]
    number = float(value) if isinstance(value, int | float) else None
    if number is None or not parameter.lowest <= number <= parameter.highest:
        unit = f" {parameter.unit}" if parameter.unit not in {"", "1"} else ""
        raise HubsimError(
            f"--set {PLANT}{name}: {value!r} is not accepted, accepted: a number from {parameter.lowest:g} to {parameter.highest:g}{unit}"
        )
    return number


def load_drive(path: Path, overrides: Overrides) -> Drive:
    """Read a drive's file with the settings that are meant for it."""
    drive = schema.load(path)
    if not overrides.drive:
        return drive
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    for (section, name), value in overrides.drive.items():
        keys = data.setdefault(section, {})
        if not isinstance(keys, dict):
            raise HubsimError(f"--set {section}.{name}: {section} is no section of {path}")
        keys[name] = value
    return schema.parse(data, name=drive.name, source=f"{path} with --set")
